#pragma once
#include "earthquake/record_file.h"

namespace talus {

/// A recorded motion.
struct RecordSource {
  static constexpr const char *name = "record";
  std::string file, component;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.path(
        "file", file,
        "record, relative to the scene: PEER NGA (.AT2), CSMIP or COSMOS volume 2 (.V2, .V2c), ESM (.ASC), or CSV with "
        "the units in its header, \"time [s], acceleration [g]\"");
    v.text("component", component,
           "which of several accelerations of the file: the name of a column, or the number of a channel from 1 on");
  }
  std::string problem() const { return file.empty() ? "file must name a record" : ""; }
  GroundMotion make() const { return read_record(file, component); }
};

}  // namespace talus
