#pragma once
/// What may be different in a run that starts at the state of another (scene.start_from).
#include <string>
#include <vector>

#include "output/checkpoint.h"

namespace talus {

struct Scene;

/// Refuses what the state of the other run does not admit: SceneError at the key, std::invalid_argument with the cause
/// where it is none of the scene. Returns the keys that are others, without those of stages and results.
std::vector<std::string> check_start(const Scene &scene, const CheckpointHeader &found, const CheckpointHeader &mine);

/// Refuses another strength of a body whose strength varies with place: particles bring their shares of it.
void check_strength_by_place(const Scene &scene, const std::string &body, const std::vector<std::string> &changed);

}  // namespace talus
