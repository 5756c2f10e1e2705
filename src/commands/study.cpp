#include <algorithm>
#include <cmath>
#include <filesystem>

#include "commands/gallery.h"
#include "commands/study_file.h"
#include "commands/sweep.h"
#include "scene/output_source.h"
#include "scene/scene.h"
#include "scene/words.h"

namespace talus {
namespace {

namespace fs = std::filesystem;
struct StudyArguments : SweepOptions {
  std::string file;
};

/// A variable with its kind read.
struct Varying : StudyVariable {
  Variation variation;
  std::vector<std::string> listed;  ///< values of a list or of choices, as written into the scene
  bool random() const { return listed.empty(); }
  bool numeric() const { return !std::holds_alternative<Choices>(variation); }
  std::vector<std::string> overrides(const std::string &value) const {
    std::vector<std::string> all;
    const std::string with_unit = unit.empty() ? value : "\"" + value + " " + unit + "\"";
    for (const std::string &one : key) all.push_back(one + "=" + (numeric() ? with_unit : value));
    return all;
  }
};

/// Columns of the table that no variable may have the name of.
const std::vector<std::string> of_all_runs{"run",     "folder",          "overrides",     "processor_s",   "wall_s",
                                           "failure", "escaped_mass_kg", "escaped_share", "warning_count", "warnings",
                                           "state"};

/// Six digits, so that tables read well; the run takes the same number.
std::string in_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

class Study {
 public:
  explicit Study(const StudyArguments &arguments)
      : root_(TableReader::from_file(arguments.file, arguments.set)), options_(arguments) {
    const std::string &path = arguments.file;
    TableReader(root_).fill(file_);
    read_scene_name(path);
    read_variables();
    read_correlation();
    check_samples();
    check_outcomes();
    if (options_.directory.empty()) options_.directory = "results/study_" + short_name(path);
  }

  int perform() {
    make_trials();
    check_runs_before();
    check_extremes();
    return talus::perform({.scene = scene_,
                           .set = file_.set,
                           .options = options_,
                           .measures = file_.measures,
                           .shown = design(),
                           .command = file_.runs == StudyRuns::factor_of_safety
                                          ? std::vector<std::string>{"solve", "--factor-of-safety"}
                                          : std::vector<std::string>{"run"},
                           .refusal_ends = false,
                           .trials = trials_});
  }

 private:
  void read_scene_name(const std::string &path) {
    if (file_.scene.empty()) root_.complain("scene", "is missing: name the scene file that the study varies");
    const fs::path beside = fs::path(path).parent_path() / file_.scene;
    try {
      scene_ = fs::exists(beside) ? beside.string() : find_scene(file_.scene);
    } catch (const SceneError &error) {
      root_.complain("scene", std::string("cannot be found: ") + error.what());
    }
    base_ = read_scene(scene_, file_.set);
  }

  void read_variables() {
    if (file_.variable.empty()) root_.complain("variable", "is missing: add a table [variable.NAME] with key and kind");
    std::vector<std::string> keys;
    for (const StudyVariable &one : file_.variable) {
      Varying v{one, {}, {}};
      const std::string path = "variable." + v.name;
      if (std::ranges::count(of_all_runs, v.name))
        root_.complain(path, "must have another name: study.csv has a column of this name");
      if (v.key.empty())
        root_.complain(path, "needs key, the key of the scene that varies, such as body.clay.cohesion");
      read_one_of(v.kind, "kind", v.variation);
      if (const auto *list = std::get_if<NumberList>(&v.variation))
        for (const double value : list->values) v.listed.push_back(in_digits(value));
      if (const auto *words = std::get_if<Choices>(&v.variation)) {
        v.listed = words->choices;
        if (const std::string wrong = mixed_units(v.listed); !wrong.empty()) root_.complain(path + ".choices", wrong);
      }
      if (!v.unit.empty() && !v.numeric()) root_.complain(path + ".unit", "belongs to numbers; write units in choices");
      if (!v.unit.empty()) try {
          parse_quantity("1 " + v.unit);
        } catch (const std::invalid_argument &error) {
          root_.complain(path + ".unit", std::string("must be a unit such as kPa, deg or m: ") + error.what());
        }
      variables_.push_back(v);
      keys.insert(keys.end(), v.key.begin(), v.key.end());
      if (const std::string wrong = same_keys(base_, keys); !wrong.empty()) root_.complain(path + ".key", wrong);
    }
  }

  std::vector<std::string> random_names() const {
    std::vector<std::string> names;
    for (const Varying &v : variables_)
      if (v.random()) names.push_back(v.name);
    return names;
  }

  /// The triangle of the correlation matrix of the random variables.
  void read_correlation() {
    const std::vector<std::string> names = random_names();
    std::vector<std::vector<double>> matrix(names.size(), std::vector<double>(names.size()));
    for (std::size_t i = 0; i < names.size(); ++i) matrix[i][i] = 1;
    for (std::size_t k = 0; k < file_.correlation.size(); ++k) {
      const StudyCorrelation &one = file_.correlation[k];
      const std::string path = "correlation." + std::to_string(k) + ".between";
      std::vector<std::size_t> at;
      for (const std::string &name : one.between) {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end())
          root_.complain(path,
                         "names " + name + ", which is no variable with a distribution; " + suggestion(name, names));
        at.push_back(static_cast<std::size_t>(found - names.begin()));
      }
      if (at.size() != 2 || at[0] == at[1]) root_.complain(path, "must name two different variables");
      if (matrix[at[0]][at[1]] != 0) root_.complain(path, "names two variables whose correlation is given before");
      matrix[at[0]][at[1]] = matrix[at[1]][at[0]] = one.coefficient;
    }
    asked_ = matrix, triangle_ = cholesky(matrix);
    if (triangle_.empty() && !names.empty())
      root_.complain("correlation",
                     "is not possible: the correlation matrix is not positive definite; take "
                     "coefficients nearer to 0");
  }

  bool random() const { return !triangle_.empty(); }

  void check_samples() const {
    if (random() && file_.samples == 0)
      root_.complain("samples", "is missing: give the number of samples of the distributions, such as 200");
    if (!random() && file_.samples > 0)
      root_.complain("samples", "belongs to variables with a distribution, and all variables here are lists");
  }

  std::vector<std::string> outcome_names() const {
    std::vector<std::string> names = file_.measures;
    if (file_.runs == StudyRuns::factor_of_safety) {
      names.insert(names.end(), {"factor_of_safety", "moving_volume_m3"});
      return names;
    }
    names.insert(names.end(), {"fails", "load_time_of_failure_s", "largest_displacement_m", "travel_distance_m",
                               "volume_of_slide_m3", "depth_of_slide_m"});
    for (const auto &point : base_.output->point)
      names.insert(names.end(), {point.name + "_displacement_m", point.name + "_largest_speed_m_s"});
    return names;
  }

  void check_outcomes() const {
    for (std::size_t k = 0; k < file_.measures.size(); ++k) try {
        parse_measure(file_.measures[k]);
      } catch (const SceneError &) {
        root_.complain("measures", "must be COLUMN, COLUMN@TIME or max:COLUMN of history.csv");
      }
    if (file_.runs == StudyRuns::factor_of_safety && !file_.measures.empty())
      root_.complain("measures", "belong to runs = \"motion\": a factor of safety has no history");
    const std::vector<std::string> known = outcome_names();
    for (const Varying &v : variables_)
      if (std::find(known.begin(), known.end(), v.name) != known.end())
        root_.complain("variable." + v.name, "must have another name: it is the name of an outcome");
    for (const StudyCriterion &one : file_.criterion)
      if (std::find(known.begin(), known.end(), one.outcome) == known.end())
        root_.complain("criterion." + one.name + ".outcome",
                       "is no outcome of these runs; " +
                           (nearest(one.outcome, known).empty() ? "" : suggestion(one.outcome, known) + " ") +
                           "known are " + join(known));
  }

  /// Sample after sample, and in each the whole grid, so that more samples only add trials at the end.
  void make_trials() {
    Series grid;
    for (const Varying &v : variables_)
      if (!v.random()) grid.lists.emplace_back(v.name, v.listed);
    const auto cells = products(grid);
    std::vector<std::vector<double>> coordinates;
    for (std::size_t i = 0; i < triangle_.size(); ++i)
      coordinates.push_back(nested_hypercube(static_cast<std::size_t>(file_.samples),
                                             static_cast<std::uint64_t>(file_.seed), static_cast<std::uint64_t>(i)));
    scores_.resize(triangle_.size());
    for (std::size_t s = 0; s < (random() ? static_cast<std::size_t>(file_.samples) : 1); ++s) {
      std::vector<double> u;
      for (const auto &of_variable : coordinates) u.push_back(of_variable[s]);
      u = correlated(u, triangle_);
      for (std::size_t i = 0; i < u.size(); ++i) scores_[i].push_back(normal_quantile(u[i]));
      for (const auto &cell : cells) add_trial(u, cell);
    }
  }

  void add_trial(const std::vector<double> &u, const std::vector<std::string> &cell) {
    Trial trial;
    std::size_t sampled = 0, listed = 0;
    for (const Varying &v : variables_) {
      const std::string value = v.random() ? value_of(v, u[sampled++]) : cell[listed++].substr(v.name.size() + 1);
      trial.columns[v.name] = v.numeric() ? Json(number_of(value)) : Json(value);
      for (const std::string &one : v.overrides(value)) trial.overrides.push_back(one);
    }
    trials_.push_back(trial);
  }

  static std::string value_of(const Varying &v, double u) {
    return std::visit(
        [&](const auto &kind) -> std::string {
          if constexpr (requires { kind.quantile(u); }) return in_digits(kind.quantile(u));
          return "";
        },
        v.variation);
  }

  /// The scene and its laws must take the smallest and largest value of each variable: what it says of them is said of
  /// the variable.
  void check_extremes() const {
    for (const Varying &v : variables_) {
      std::vector<std::string> values = v.listed;
      if (v.random()) {
        const auto [low, high] =
            std::ranges::minmax(trials_, {}, [&](const Trial &trial) { return trial.columns[v.name].get<double>(); });
        values = {in_digits(low.columns[v.name]), in_digits(high.columns[v.name])};
      }
      for (const std::string &value : values) try_value(v, value);
    }
  }

  void try_value(const Varying &v, const std::string &value) const {
    std::vector<std::string> all = file_.set;
    for (const std::string &one : v.overrides(value)) all.push_back(one);
    try {
      read_wholly(scene_, all, options_.no_umat);
    } catch (const SceneError &error) {
      root_.complain("variable." + v.name,
                     "takes the value " + value + (v.unit.empty() ? "" : " " + v.unit) +
                         ", which the scene refuses: " + error.what() +
                         (v.random() ? ". Mend the key, or cut the distribution off with low and high" : ""));
    }
  }

  /// Fewer samples than were run before would cut the tables of the study.
  void check_runs_before() const {
    if (options_.force) return;
    std::size_t before = trials_.size();
    while (fs::exists(fs::path(options_.directory) / run_name(before) / "trial")) ++before;
    if (before > trials_.size())
      throw SceneError(options_.directory + " holds " + std::to_string(before) + " runs of this study, and " +
                       std::to_string(trials_.size()) +
                       " are asked for: the tables would lose the others. Ask for as many as there are, choose another "
                       "folder with -o, or give --force to leave them out of the tables; their folders stay");
  }

  /// What the script needs to know of the study.
  Json design() const {
    Json design{{"preset", "study"}, {"title", file_.title}, {"confidence", file_.confidence}};
    design["variables"] = Json::array(), design["criteria"] = Json::array();
    for (const Varying &v : variables_)
      design["variables"].push_back({{"name", v.name},
                                     {"unit", !v.numeric()      ? ""
                                              : !v.unit.empty() ? v.unit
                                                                : unit_of_key(v.key.front())},
                                     {"random", v.random()},
                                     {"numeric", v.numeric()}});
    for (const StudyCriterion &c : file_.criterion) {
      const bool below = c.below > any_number.low;
      design["criteria"].push_back({{"name", c.name},
                                    {"outcome", c.outcome},
                                    {"side", below ? "below" : "above"},
                                    {"limit", below ? c.below : c.above}});
    }
    design["asked"] = asked_, design["scores"] = scores_;
    return design;
  }

  TableReader root_;
  SweepOptions options_;
  StudyFile file_;
  std::string scene_;
  Scene base_;  ///< without variables
  std::vector<Varying> variables_;
  std::vector<std::vector<double>> asked_, triangle_;  ///< correlation of the random variables, and its triangle
  std::vector<std::vector<double>> scores_;            ///< normal scores of each random variable in all samples
  std::vector<Trial> trials_;
};

}  // namespace

Action add_study(CLI::App &app) {
  auto arguments = std::make_shared<StudyArguments>();
  CLI::App *command = app.add_subcommand(
      "study",
      "run a scene over lists, grids or samples of distributions: outcomes, sensitivities, probability of failure");
  command->add_option("FILE", arguments->file, "study file (.toml), see docs/reference/study.md")->required();
  add_sweep_options(*command, *arguments, "override a key of the study: samples=400",
                    "folder of runs, table and pictures (default results/study_NAME)");
  return [arguments] { return Study(*arguments).perform(); };
}

}  // namespace talus
