#pragma once
/// Pictures and report of a finished run, drawn by src/output/plots/talus_plot.py with matplotlib.
#include <string>
#include <vector>

namespace talus {

/// What to draw; empty lists are the script's choice.
struct PictureChoice {
  std::vector<std::string> fields;  ///< columns of the snapshots
  std::vector<std::string> times;   ///< [s], the nearest snapshots
  bool logarithmic = false;         ///< scale of plastic strain
};

/// Draws DIR/pictures/*.png and DIR/report.html from the results in `dir`; call it on one rank. Pictures never fail a
/// run: false, after a warning on standard error, if it went wrong.
bool draw_pictures(const std::string &dir, const PictureChoice &choice = {});

}  // namespace talus
