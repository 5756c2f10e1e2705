#pragma once
/// Files of strong-motion records.
#include <string>

#include "earthquake/ground_motion.h"

namespace talus {

/// Reads a record: PEER NGA (.AT2), CSMIP and COSMOS volume 2 (.V2, .V2c), ESM (.ASC), or CSV with columns of time and
/// acceleration whose header names their units. `component` chooses one of several accelerations of a file: the name of
/// a column, or the number of a channel from 1 on; empty where there is one. Throws SceneError with file, line, what is
/// wrong and what to do.
GroundMotion read_record(const std::string &file, const std::string &component);

}  // namespace talus
