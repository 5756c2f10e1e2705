#pragma once
/// Pictures and report of a finished run, and of element tests, drawn by src/output/plots/*.py with matplotlib.
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

/// Draws DIR/compare.png from DIR/compare.csv; otherwise the same.
bool draw_comparison(const std::string &dir);

/// Draws DIR/soil.png from the CSV files of element tests in `dir`; otherwise the same.
bool draw_element_tests(const std::string &dir, const std::vector<std::string> &tests, const std::string &title);

}  // namespace talus
