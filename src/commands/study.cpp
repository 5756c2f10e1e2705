#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "commands/gallery.h"
#include "commands/study_file.h"
#include "commands/sweep.h"
#include "scene/materials.h"
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
  /// Six digits, so that tables read well; the run takes the same number.
  std::string sampled(double u) const {
    return std::visit(
        [&](const auto &kind) -> std::string {
          if constexpr (requires { kind.quantile(u); }) return in_digits(kind.quantile(u), 6);
          return "";
        },
        variation);
  }
};

class Study {
 public:
  explicit Study(const StudyArguments &arguments)
      : root_(TableReader::from_file(arguments.file, arguments.set)), options_(arguments) {
    TableReader(root_).fill(file_);
    read_scene_name(arguments.file);
    read_variables();
    read_correlation();
    check_outcomes();
    if (options_.directory.empty()) options_.directory = "results/study_" + short_name(arguments.file);
  }

  int perform() {
    make_trials();
    check_runs_before();
    const bool factor = file_.runs == StudyRuns::factor_of_safety;
    return talus::perform(
        {.scene = scene_,
         .set = file_.set,
         .options = options_,
         .measures = file_.measures,
         .shown = design(),
         .command = factor ? std::vector<std::string>{"solve", "--factor-of-safety"} : std::vector<std::string>{"run"},
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
      if (v.key.empty())
        root_.complain(path, "needs key, the key of the scene that varies, such as body.clay.cohesion");
      read_one_of(v.kind, "kind", v.variation);
      if (const auto *list = std::get_if<NumberList>(&v.variation))
        for (const double value : list->values) v.listed.push_back(in_digits(value, 6));
      if (const auto *words = std::get_if<Choices>(&v.variation)) v.listed = words->choices;
      if (const std::string wrong = mixed_units(v.listed); !wrong.empty()) root_.complain(path + ".choices", wrong);
      if (!v.unit.empty() && !v.numeric()) root_.complain(path + ".unit", "belongs to numbers; write units in choices");
      keys.insert(keys.end(), v.key.begin(), v.key.end());
      if (const std::string wrong = same_keys(base_, keys); !wrong.empty()) root_.complain(path + ".key", wrong);
      for (const std::string &key : v.key) check_material(path, key, v.listed);
      variables_.push_back(v);
    }
  }

  /// A material gives what a body does not state: a choice of materials has no effect on stated keys.
  void check_material(const std::string &path, const std::string &key, const std::vector<std::string> &chosen) {
    if (!key.starts_with("body.") || !key.ends_with(".material")) return;
    const std::string body = key.substr(0, key.size() - std::string("material").size());
    const toml::table stated = toml::parse(base_.source);
    std::map<std::string, std::set<std::string>> values;
    for (const Material &soil : soils())
      if (std::ranges::count(chosen, soil.name))
        for (const MaterialKey &one : soil.keys) values[one.key].insert(one.value);
    std::string without;
    for (const auto &[name, different] : values)
      if (different.size() > 1 && stated.at_path(body + name)) without += (without.empty() ? "" : ", ") + name;
    if (!without.empty())
      root_.complain(path + ".key",
                     "varies " + key + ", and the scene states " + without + " of this body, which has " +
                         "precedence over every material: take these keys out of the scene, or vary them");
  }

  /// The triangle of the correlation matrix of the random variables.
  void read_correlation() {
    std::vector<std::string> names;
    for (const Varying &v : variables_)
      if (v.random()) names.push_back(v.name);
    const auto count = static_cast<Eigen::Index>(names.size());
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(count, count);
    for (std::size_t k = 0; k < file_.correlation.size(); ++k) {
      const std::string path = "correlation." + std::to_string(k) + ".between";
      std::vector<Eigen::Index> at;
      for (const std::string &name : file_.correlation[k].between) {
        at.push_back(std::ranges::find(names, name) - names.begin());
        if (at.back() == count)
          root_.complain(path,
                         "names " + name + ", which is no variable with a distribution; " + suggestion(name, names));
      }
      if (at.size() != 2 || at[0] == at[1]) root_.complain(path, "must name two different variables");
      if (matrix(at[0], at[1]) != 0) root_.complain(path, "names two variables whose correlation is given before");
      matrix(at[0], at[1]) = matrix(at[1], at[0]) = file_.correlation[k].coefficient;
    }
    const Eigen::LLT<Eigen::MatrixXd> parts(matrix);
    if (parts.info() != Eigen::Success)
      root_.complain("correlation",
                     "is not possible: its matrix is not positive definite; take coefficients nearer to 0");
    triangle_ = parts.matrixL();
    if (count > 0 && file_.samples == 0)
      root_.complain("samples", "is missing: give the number of samples of the distributions, such as 200");
    if (count == 0 && file_.samples > 0)
      root_.complain("samples", "belongs to variables with a distribution, and all variables here are lists");
  }

  std::vector<std::string> outcome_names() const {
    std::vector<std::string> names = file_.measures;
    if (file_.runs == StudyRuns::factor_of_safety) {
      names.insert(names.end(), {"factor_of_safety", "moving_volume_m3"});
      return names;
    }
    names.insert(names.end(), {"fails", "load_time_of_failure_s", "largest_displacement_m", "travel_distance_m",
                               "volume_of_slide_m3", "depth_of_slide_m", "run_out_from_toe_m", "fall_height_m",
                               "angle_of_reach_deg", "area_m2"});
    for (const auto &point : base_.output->point)
      names.insert(names.end(), {point.name + "_displacement_m", point.name + "_largest_speed_m_s"});
    return names;
  }

  void check_outcomes() const {
    if (file_.runs == StudyRuns::factor_of_safety && !file_.measures.empty())
      root_.complain("measures", "belong to runs = \"motion\": a factor of safety has no history");
    const std::vector<std::string> known = outcome_names();
    for (const StudyCriterion &one : file_.criterion)
      if (!std::ranges::count(known, one.outcome))
        root_.complain("criterion." + one.name + ".outcome",
                       "is no outcome of these runs; " + suggestion(one.outcome, known));
    std::vector<std::string> columns = known;
    columns.insert(columns.end(), {"run", "folder", "overrides", "processor_s", "wall_s", "failure", "escaped_mass_kg",
                                   "escaped_share", "warning_count", "warnings", "state", "line"});
    for (const Varying &v : variables_)
      if (std::ranges::count(columns, v.name))
        root_.complain("variable." + v.name, "must have another name: study.csv has a column of this name");
  }

  /// Sample after sample, and in each the whole grid, so that more samples only add trials at the end.
  void make_trials() {
    Series grid;
    for (const Varying &v : variables_)
      if (!v.random()) grid.lists.emplace_back(v.name, v.listed);
    const auto cells = products(grid);
    std::vector<std::vector<double>> coordinates;
    for (Eigen::Index i = 0; i < triangle_.rows(); ++i)
      coordinates.push_back(nested_hypercube(static_cast<std::size_t>(file_.samples),
                                             static_cast<std::uint64_t>(file_.seed), static_cast<std::uint64_t>(i)));
    for (std::size_t s = 0; s < static_cast<std::size_t>(std::max(1, file_.samples)); ++s) {
      Eigen::VectorXd u(triangle_.rows());
      for (std::size_t i = 0; i < coordinates.size(); ++i) u[static_cast<Eigen::Index>(i)] = coordinates[i][s];
      u = correlated(u, triangle_);
      for (const auto &cell : cells) {
        Trial trial;
        Eigen::Index sampled = 0;
        std::size_t listed = 0;
        for (const Varying &v : variables_) {
          std::string value = v.random() ? v.sampled(u[sampled++]) : cell[listed++].substr(v.name.size() + 1);
          trial.columns[v.name] = v.numeric() ? Json(typed(value).number) : Json(value);
          if (!v.unit.empty()) value = "\"" + value + " " + v.unit + "\"";
          for (const std::string &key : v.key) trial.overrides.push_back(key + "=" + value);
        }
        trials_.push_back(trial);
      }
    }
  }

  /// Fewer samples than were run before would cut the tables of the study.
  void check_runs_before() const {
    if (!options_.force && fs::exists(fs::path(options_.directory) / run_name(trials_.size()) / "trial"))
      throw SceneError(
          options_.directory + " holds more runs of this study than the " + std::to_string(trials_.size()) +
          " that are asked for, and its tables would lose the others. Ask for as many as there are, choose "
          "another folder with -o, or give --force to leave them out of the tables; their folders stay");
  }

  /// What the script needs to know of the study.
  Json design() const {
    Json design{{"preset", "study"}, {"title", file_.title}, {"confidence", file_.confidence}};
    design["variables"] = Json::array(), design["criteria"] = Json::array();
    for (const Varying &v : variables_)
      design["variables"].push_back({{"name", v.name},
                                     {"unit", v.unit.empty() && v.numeric() ? unit_of_key(v.key.front()) : v.unit},
                                     {"random", v.random()},
                                     {"numeric", v.numeric()}});
    for (const StudyCriterion &c : file_.criterion) {
      const bool below = c.below > any_number.low;
      design["criteria"].push_back({{"name", c.name},
                                    {"outcome", c.outcome},
                                    {"side", below ? "below" : "above"},
                                    {"limit", below ? c.below : c.above}});
    }
    return design;
  }

  TableReader root_;
  SweepOptions options_;
  StudyFile file_;
  std::string scene_;
  Scene base_;  ///< without variables
  std::vector<Varying> variables_;
  Eigen::MatrixXd triangle_;  ///< lower one of the correlation of the random variables
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
