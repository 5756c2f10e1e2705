#pragma once
/// A scene with law = "umat" loads a library and runs it: such a scene is a program. Who runs a stranger's scene can
/// refuse that.
#include <string>
#include <vector>

#include "scene/scene.h"

namespace talus {

/// Bodies whose law is a UMAT; their libraries are not loaded for the answer.
std::vector<std::string> bodies_with_umat(const Scene &scene);

/// Throws SceneError at the first of them. To be called before a simulation is made, which loads libraries.
void refuse_umat(const Scene &scene);

}  // namespace talus
