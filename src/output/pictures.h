#pragma once
/// Pictures and report of a finished run, and of element tests, drawn by src/output/plots/*.py with matplotlib.
#include <string>
#include <vector>

namespace talus {

/// What to draw. An empty list leaves the choice to the script.
struct PictureChoice {
  std::vector<std::string> fields;  ///< columns of the snapshots
  std::vector<std::string> times;   ///< [s], the nearest snapshots
  bool logarithmic = false;         ///< scale of plastic strain
  bool slip_surface = false;        ///< finds it, in plane strain
  bool movie = false;               ///< draws a film of the fields and nothing else
  std::string since = {};           ///< stage from whose start displacement counts
  bool pdf = false;                 ///< the report as PDF too
};

/// Draws DIR/pictures/*.png and DIR/report.html, or DIR/pictures/movie_FIELD.gif and .mp4, from the results in `dir`;
/// call it on one rank. If drawing fails, a warning with the cause goes to standard error and the answer is false.
bool draw_pictures(const std::string &dir, const PictureChoice &choice = {});

/// The same, answered by an exit status: 0, 2 where the choice names what the results do not have, 1 for another error.
int status_of_pictures(const std::string &dir, const PictureChoice &choice);

/// Draws what a scene models, from the JSON document of AnySimulation::model(), as `picture`, a PNG file, with the same
/// answer.
bool draw_model(const std::string &model, const std::string &picture);

/// What a run says that ends without its pictures, although its results are complete.
std::string without_pictures(const std::string &dir);

/// Draws DIR/soil.png from the CSV files of element tests in `dir`, with the same answer.
bool draw_element_tests(const std::string &dir, const std::vector<std::string> &tests, const std::string &title);

/// Draws DIR/record.png from the CSV files of motions of the ground in `dir`, with the same answer.
bool draw_records(const std::string &dir, const std::vector<std::string> &names);
/// Draws DIR/newmark.png from the ways of a sliding block, likewise.
bool draw_newmark(const std::string &dir, const std::vector<std::string> &names);

}  // namespace talus
