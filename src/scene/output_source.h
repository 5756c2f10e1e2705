#pragma once
/// [output]: results that are written.
#include <string>
#include <vector>

#include "base/units.h"

namespace talus {

/// A point whose history is written.
struct OutputPoint {
  std::string name;  ///< the table's own name, [output.point.NAME]
  std::vector<double> position;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.point("position", position, metre,
            "position at the start, in the soil or at its surface; the nearest particle is tracked, stages by finite "
            "elements show the place itself; [x, y] in a 3D body from a section is in the middle of its thickness");
  }
};

/// A line that is followed with the soil.
struct OutputLine {
  std::string name;  ///< the table's own name, [output.line.NAME]
  std::vector<std::vector<double>> points;
  double spacing = 0;  ///< [m]; 0: 40 places
  template <class Visitor>
  void fields(Visitor &&v) {
    v.points("points", points, metre,
             "the line at the start, through these points: an inclinometer, a slip surface; particles along it are "
             "followed, stages by finite elements show the places themselves");
    v.number("spacing", spacing, metre, Range{0, 1e5}, "distance of the places along the line; 0: 40 places");
  }
};

enum class Units { si, us };

struct Output {
  std::string project, author;     ///< on the first screen of the report
  Units units = Units::si;         ///< of report and pictures
  double interval = 0;             ///< time between snapshots [s]; 0: start and end of stages only
  double history_interval = 0;     ///< [s]; 0: every 200th of the longest stage
  double checkpoint_interval = 0;  ///< [s]; 0: with every snapshot
  std::vector<OutputPoint> point;
  std::vector<OutputLine> line;
  std::vector<std::string>
      picture;  ///< empty: displacement, plastic strain, velocity and pore pressure, as far as there are
  template <class Visitor>
  void fields(Visitor &&v) {
    v.text("project", project, "name or number of the project, for the report");
    v.text("author", author, "who is responsible for the scene, for the report");
    v.choice("units", units, {{"SI", Units::si}, {"US", Units::us}},
             "units of report, pictures and tables: SI, or US (ft, psf, ksf, pcf); files of results keep SI");
    v.number("interval", interval, second, Range{0, 1e9},
             "time between snapshots; 0: only at the start and end of stages");
    v.number("history_interval", history_interval, second, Range{0, 1e9},
             "time between lines of history.csv; 0: a 200th of the longest stage");
    v.number("checkpoint_interval", checkpoint_interval, second, Range{0, 1e9},
             "time between checkpoints, from which --resume continues; 0: one with every snapshot; results do not "
             "depend on them");
    v.named("point", point, "points whose history is written, [output.point.NAME]");
    v.named("line", line,
            "lines that are followed with the soil, [output.line.NAME]; line_NAME.csv has their places at the times of "
            "history.csv");
    v.texts("picture", picture,
            "fields that are drawn: a vector by its magnitude, a tensor by its mean, or one component such as "
            "stress_xy; default: those of displacement, plastic_strain, velocity, pore_pressure, suction, saturation, "
            "surface and mobilised_friction that exist, and state where soil has softened; in 3D also thickness, the "
            "volume of sliding soil per area");
  }
};

}  // namespace talus
