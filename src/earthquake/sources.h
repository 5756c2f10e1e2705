#pragma once
/// The list of what the motion of the ground may be taken from: one line to add one. A source is a plain struct with
/// `name`, its parameters in `fields`, `problem` where it needs one, and `make()`, which gives the motion.
#include <string>
#include <variant>

#include "earthquake/sources/gabor.h"
#include "earthquake/sources/kanai_tajimi.h"
#include "earthquake/sources/record.h"
#include "earthquake/sources/ricker.h"
#include "earthquake/sources/sine.h"
#include "scene/earthquake_source.h"

namespace talus {

using MotionSource = std::variant<RecordSource, RickerSource, GaborSource, SineSource, KanaiTajimiSource>;

/// The motion of a component of the scene, in this order: the part that is used, baseline, high-pass filter, scale.
/// Throws SceneError for a record that cannot be read or used.
GroundMotion read_motion(const EarthquakeSource &source);

/// A record by itself.
EarthquakeSource record_source(const std::string &file, const std::vector<std::string> &overrides = {});
/// The components of a text that has no more than [[earthquake]], with overrides. Throws SceneError.
std::vector<EarthquakeSource> read_components(const std::string &text, const std::vector<std::string> &overrides = {});

/// A sentence on a motion that leaves the ground with a velocity, as wrong baselines do, with the corrections that its
/// source does not have yet; empty where it does not.
std::string drift_of(const GroundMotion &motion, const EarthquakeSource &source);

}  // namespace talus
