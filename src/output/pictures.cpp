#include "output/pictures.h"

#include <cstdio>
#include <exception>
#include <stdexcept>

#include "base/temporary_folder.h"
#include "output/replace_file.h"
#include "output/script.h"
#include "output/strength.h"

namespace talus {
namespace {

bool warn(const std::string &what, const std::string &cause) {
  std::fprintf(stderr, "warning: no %s: %s\n", what.c_str(), cause.c_str());
  return false;
}

/// Runs a script on the results in `dir`: its exit status, 1 where it cannot be run. Status 2, an error in what it was
/// asked for, is one that it has told.
int status_of(const char *name, const std::string &dir, const std::vector<std::string> &options) {
  std::vector<std::string> arguments{dir};
  arguments.insert(arguments.end(), options.begin(), options.end());
  try {
    const int status = run_script(name, arguments);
    if (status != 0 && status != 2) warn("pictures of " + dir, std::string(name) + " failed");
    return status;
  } catch (const std::runtime_error &error) {
    warn("pictures of " + dir, error.what());
    return 1;
  }
}

bool draw(const char *name, const std::string &dir, const std::vector<std::string> &options) {
  return status_of(name, dir, options) == 0;
}

}  // namespace

int status_of_pictures(const std::string &dir, const PictureChoice &choice) {
  std::vector<std::string> options;
  if (!choice.fields.empty()) options.push_back("--fields");
  options.insert(options.end(), choice.fields.begin(), choice.fields.end());
  if (!choice.times.empty()) options.push_back("--times");
  options.insert(options.end(), choice.times.begin(), choice.times.end());
  if (choice.logarithmic) options.push_back("--log");
  if (choice.slip_surface) options.push_back("--slip-surface");
  if (!choice.since.empty()) options.insert(options.end(), {"--since", choice.since});
  if (choice.pdf) options.push_back("--pdf");
  if (choice.movie) options.push_back("--movie");
  try {
    write_strength(dir);
  } catch (const std::exception &) {  // stress paths are then drawn without envelopes
  }
  return status_of("talus_plot.py", dir, options);
}

bool draw_pictures(const std::string &dir, const PictureChoice &choice) { return status_of_pictures(dir, choice) == 0; }

std::string without_pictures(const std::string &dir) {
  return "the results in " + dir + " are complete, but have no pictures and no report; talus plot " + dir +
         " draws them, and --no-pictures does without them";
}

bool draw_model(const std::string &model, const std::string &picture) {
  const std::string what = "picture " + picture;
  try {
    TemporaryFolder folder;
    if (!folder.make()) return warn(what, "cannot make a temporary folder");
    const std::string file = folder.path() + "/model.json";
    replace_file(file, model);
    return run_script("talus_model.py", {file, picture}) == 0 || warn(what, "talus_model.py failed");
  } catch (const std::runtime_error &error) {
    return warn(what, error.what());
  }
}

bool draw_element_tests(const std::string &dir, const std::vector<std::string> &tests, const std::string &title) {
  std::vector<std::string> options{"--title", title, "--tests"};
  options.insert(options.end(), tests.begin(), tests.end());
  return draw("talus_soil.py", dir, options);
}

bool draw_records(const std::string &dir, const std::vector<std::string> &names) {
  return draw("talus_record.py", dir, names);
}

bool draw_newmark(const std::string &dir, const std::vector<std::string> &names) {
  return draw("talus_newmark.py", dir, names);
}

}  // namespace talus
