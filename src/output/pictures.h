#pragma once
/// Pictures and report of a finished run, drawn by src/output/plots/talus_plot.py with matplotlib.
#include <string>
#include <vector>

namespace talus {

/// Draws DIR/pictures/*.png and DIR/report.html from the results in `dir`; call it on one rank. `fields` are columns of
/// the snapshots; none: the script's choice. Pictures never fail a run: false, after a warning on standard error, if it
/// went wrong.
bool draw_pictures(const std::string &dir, const std::vector<std::string> &fields = {});

}  // namespace talus
