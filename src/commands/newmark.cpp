#include "earthquake/newmark.h"

#include <petscsys.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <sstream>

#include "base/rounded.h"
#include "commands/commands.h"
#include "commands/foreign_code.h"
#include "commands/gallery.h"
#include "earthquake/column_response.h"
#include "earthquake/intensity.h"
#include "earthquake/shaking.h"
#include "earthquake/sources.h"
#include "output/csv.h"
#include "output/pictures.h"
#include "physics/laws/law.h"
#include "scene/reader.h"
#include "scene/tables.h"
#include "simulation.h"

namespace talus {
namespace {

constexpr double gravity = 9.80665;  // of coefficients [m/s2]

struct NewmarkArguments {
  std::string scene, directory, direction;
  std::vector<std::string> set, records;
  double magnitude = 0;
  bool no_pictures = false, no_umat = false;
};

/// The slope at its yield coefficient.
struct Yielding {
  double coefficient = 0;       ///< horizontal inertia over weight at which the factor is 1 [-]
  int direction = 1;            ///< of the inertia along x
  Mechanism mechanism;          ///< there
  double height = 0;            ///< of the mechanism [m]
  double shear_wave_speed = 0;  ///< of its soil, at small strain [m/s]
  double period() const { return 4 * height / shear_wave_speed; }
};

/// Searches for the yield coefficient of a scene by factors of safety under a horizontal inertia.
class YieldSearch {
 public:
  YieldSearch(Scene scene) : scene_(std::move(scene)) {
    std::erase_if(scene_.stage, [](const Stage &stage) { return !stage.is_static() || stage.finds_factor(); });
    if (scene_.stage.empty())
      scene_.complain(
          "stage",
          "has none by finite elements: a yield coefficient needs the slope at rest under its weight, kind = "
          "\"quasi_static\"");
    scene_.earthquake.clear();
    QuasiStaticKeys keys;
    keys.when_lost = WhenLost::go_on;
    Stage inertia;
    inertia.name = "inertia", inertia.kind = keys, inertia.duration = 1, inertia.softening = false;
    scene_.stage.push_back(inertia);
    scene_.add_factor_stage();
    scene_.factor_of_safety->by_damped_motion = false;
  }

  /// `direction`: 1, -1, or 0 for the one in which the slope is weaker.
  Yielding find(int direction) {
    constexpr double first = 0.1, enough = 0.02;  // coefficient; factor
    constexpr int most = 10;
    const double still = factor_at(0, 1);
    if (still <= 1)
      throw std::runtime_error("the slope does not stand without an earthquake: its factor of safety is " +
                               rounded(still));
    double factor = factor_at(first, direction == 0 ? 1 : direction);
    if (direction == 0) {
      const FactorOfSafety one_way = last_;
      const double other = factor_at(first, -1);
      direction = other < factor ? -1 : 1;
      if (other >= factor) last_ = one_way;
      factor = std::min(factor, other);
    }
    // 1 / F is nearly linear in the coefficient: the last piece to F = 1 is found by that line
    double low = 0, at_low = 1 / still, high = first, at_high = 1 / factor, yield = 0;
    for (int n = 0;; ++n) {
      yield = low + (1 - at_low) / (at_high - at_low) * (high - low);
      if (!(yield > 0) || yield > 3)
        throw std::runtime_error(
            "the slope has no yield coefficient up to 3: its factor falls too little with the inertia");
      if (std::abs(factor - 1) <= enough) break;
      if (n == most)
        throw std::runtime_error("the search for the yield coefficient does not end between " + rounded(low) + " and " +
                                 rounded(high));
      factor = factor_at(yield, direction);
      // the two that lie closest to 1
      if (std::abs(at_low - 1) > std::abs(at_high - 1))
        low = yield, at_low = 1 / factor;
      else
        high = yield, at_high = 1 / factor;
    }
    Yielding found;
    found.coefficient = yield, found.direction = direction, found.mechanism = last_;
    const int up = scene_.vertical();
    found.height = last_.high[up] - last_.low[up];
    found.shear_wave_speed = shear_wave_speed_;
    return found;
  }
  const std::vector<std::array<double, 2>> &trials() const { return trials_; }

 private:
  double factor_at(double coefficient, int direction) {
    std::vector<double> &inertia = std::get<QuasiStaticKeys>(scene_.stage.end()[-2].kind).seismic_coefficient;
    inertia.assign(static_cast<std::size_t>(scene_.dimension), 0);
    inertia[0] = direction * coefficient;
    RunOptions options;
    options.pictures = options.checkpoints = false;
    const auto simulation = make_simulation(PETSC_COMM_WORLD, scene_, options);
    last_ = simulation->factor_of_safety();
    if (last_.failed() || !(last_.lower > 0 && last_.upper > 0))
      throw std::runtime_error("no factor of safety was found with a coefficient of " + rounded(coefficient));
    double stiffness = 0, mass = 0;
    const std::vector<BodyReport> bodies = simulation->bodies();
    for (std::size_t b = 0; b < bodies.size(); ++b)
      stiffness += bodies[b].volume * shear_modulus(read_law(scene_.body[b].law)), mass += bodies[b].mass;
    shear_wave_speed_ = std::sqrt(stiffness / mass);
    trials_.push_back({direction * coefficient, last_.value()});
    std::fprintf(stderr, "coefficient %.4f: factor of safety %.3f\n", direction * coefficient, last_.value());
    return last_.value();
  }

  Scene scene_;
  FactorOfSafety last_;
  double shear_wave_speed_ = 0;
  std::vector<std::array<double, 2>> trials_;
};

/// A motion of the ground along x, and what the block does under it.
struct Slid {
  std::string name;
  GroundMotion motion;  ///< positive along x
  Intensity intensity;
  std::vector<double> way, reversed;         ///< downhill, also of the reversed motion [m]
  double level_ground = 0;                   ///< net, the larger of both polarities, with one yield both ways [m]
  double decoupled = 0;                      ///< the larger of both, under the mean acceleration of a layer [m]
  Estimate ratio, with_magnitude, of_arias;  ///< Jibson (2007)
  BrayMacedo bray;
  double largest() const { return std::max(way.back(), reversed.back()); }
};

GroundMotion times(GroundMotion motion, double factor) {
  for (double &a : motion.acceleration) a *= factor;
  return motion;
}

Slid slide(const std::string &name, const GroundMotion &motion, const Yielding &slope, double magnitude) {
  constexpr double damping = 0.1;  // of the sliding mass, between small and large strain
  const double yield = slope.coefficient * gravity, period = slope.period();
  Slid one;
  one.name = name, one.motion = motion, one.intensity = intensity_of(motion);
  const GroundMotion uphill = times(motion, -slope.direction), downhill = times(motion, slope.direction);
  one.way = sliding_block(uphill, yield), one.reversed = sliding_block(downhill, yield);
  for (const GroundMotion &of : {uphill, downhill}) {
    one.level_ground = std::max(one.level_ground, std::abs(sliding_block(of, yield, yield).back()));
    one.decoupled = std::max(one.decoupled, sliding_block(layer_response(of, period, damping), yield).back());
  }
  const double peak = one.intensity.peak_acceleration;
  one.ratio = jibson_ratio(yield, peak), one.of_arias = jibson_arias(yield, one.intensity.arias);
  if (magnitude > 0) {
    one.with_magnitude = jibson_magnitude(yield, peak, magnitude);
    one.bray = bray_macedo(slope.coefficient, period, spectral_acceleration(motion, 1.3 * period) / gravity, magnitude);
  }
  return one;
}

/// The motion along x of the scene's earthquake, at the smallest step of its components.
GroundMotion along_x(const GroundShaking &shaking) {
  GroundMotion motion;
  motion.step = std::numeric_limits<double>::infinity();
  for (const auto &one : shaking.components()) motion.step = std::min(motion.step, one.motion.step);
  const auto count = static_cast<std::size_t>(std::ceil(shaking.duration() / motion.step - 1e-9));
  for (std::size_t k = 0; k <= count; ++k)
    motion.acceleration.push_back(shaking.acceleration(static_cast<double>(k) * motion.step)[0]);
  return motion;
}

std::string in_centimetres(const Estimate &estimate) {
  return rounded(100 * estimate.median) + " cm (" + rounded(100 * estimate.median * std::exp(-estimate.deviation)) +
         " to " + rounded(100 * estimate.median * std::exp(estimate.deviation)) + ")";
}

/// One line per motion, and what share of them remains below three of the displacements.
void print_table(const std::vector<Slid> &all, double magnitude) {
  std::printf("%-24s %8s %8s | %8s %8s %9s %8s%s\n", "motion", "peak", "Arias", "block", "reversed", "decoupled",
              "Jibson", magnitude > 0 ? "     Bray" : "");
  std::printf("%-24s %8s %8s | %8s %8s %9s %8s%s\n", "", "[g]", "[m/s]", "[cm]", "[cm]", "[cm]", "[cm]",
              magnitude > 0 ? "     [cm]" : "");
  std::vector<double> largest;
  for (const Slid &one : all) {
    std::printf("%-24s %8.3g %8.3g | %8.3g %8.3g %9.3g %8.3g", one.name.c_str(),
                one.intensity.peak_acceleration / gravity, one.intensity.arias, 100 * one.way.back(),
                100 * one.reversed.back(), 100 * one.decoupled, 100 * one.ratio.median);
    if (magnitude > 0) std::printf(" %8.3g", 100 * one.bray.median);
    std::printf("\n");
    largest.push_back(one.largest());
  }
  std::ranges::sort(largest);
  const auto quantile = [&](double share) {
    const double place = share * static_cast<double>(largest.size() - 1);
    const auto k = std::min(static_cast<std::size_t>(place), largest.size() - 2);
    return 100 * std::lerp(largest[k], largest[k + 1], place - static_cast<double>(k));
  };
  std::printf("rigid block, the larger of both ways: median %.3g cm, 16 to 84 %% of the %zu motions %.3g to %.3g cm\n",
              quantile(0.5), all.size(), quantile(0.16), quantile(0.84));
}

void print(const Yielding &slope, const std::vector<Slid> &all, double magnitude) {
  std::printf("yield coefficient %.3f, inertia towards %s\n", slope.coefficient, slope.direction > 0 ? "+x" : "-x");
  std::printf("  slides from x = %.4g to %.4g m, %.3g m high; period 4 H / v_s = %.3g s with v_s = %.3g m/s\n",
              slope.mechanism.low[0], slope.mechanism.high[0], slope.height, slope.period(), slope.shear_wave_speed);
  if (all.size() > 1) {
    print_table(all, magnitude);
    return;
  }
  const Slid &one = all.front();
  std::printf("%s: peak %.3g g, Arias %.3g m/s\n", one.name.c_str(), one.intensity.peak_acceleration / gravity,
              one.intensity.arias);
  std::printf("  rigid block              %8.3g cm, reversed motion %.3g cm\n", 100 * one.way.back(),
              100 * one.reversed.back());
  std::printf(
      "  slips both ways          %8.3g cm net, where it yields uphill as downhill and ways cancel: level ground\n",
      100 * one.level_ground);
  std::printf("  decoupled from the layer %8.3g cm\n", 100 * one.decoupled);
  if (one.ratio.median > 0)
    std::printf("  Jibson (2007)            a_c/a_max %s; Arias %s%s%s\n", in_centimetres(one.ratio).c_str(),
                in_centimetres(one.of_arias).c_str(), magnitude > 0 ? "; magnitude " : "",
                magnitude > 0 ? in_centimetres(one.with_magnitude).c_str() : "");
  if (magnitude > 0 && slope.period() <= 0.7)
    std::printf("  Bray & Macedo (2019)     %s; does not move with a probability of %.2g\n",
                in_centimetres(one.bray).c_str(), one.bray.none);
}

/// Numbers of a motion, as in newmark.json and newmark.csv.
std::vector<std::pair<const char *, double>> numbers_of(const Slid &one) {
  return {{"peak_acceleration_m_s2", one.intensity.peak_acceleration},
          {"arias_m_s", one.intensity.arias},
          {"significant_duration_s", one.intensity.significant_end - one.intensity.significant_begin},
          {"rigid_block_m", one.way.back()},
          {"reversed_m", one.reversed.back()},
          {"level_ground_m", one.level_ground},
          {"decoupled_m", one.decoupled},
          {"jibson_2007_ratio_m", one.ratio.median},
          {"jibson_2007_magnitude_m", one.with_magnitude.median},
          {"jibson_2007_arias_m", one.of_arias.median},
          {"bray_macedo_2019_m", one.bray.median}};
}

nlohmann::ordered_json json_of(const Yielding &slope, const std::vector<std::array<double, 2>> &trials,
                               const std::vector<Slid> &all) {
  nlohmann::ordered_json document{{"yield_coefficient", slope.coefficient},
                                  {"direction", slope.direction},
                                  {"factor_of_safety_at_coefficient", trials},
                                  {"low_m", slope.mechanism.low},
                                  {"high_m", slope.mechanism.high},
                                  {"slip_surface_m", slope.mechanism.slip_surface},
                                  {"period_s", slope.period()}};
  for (const Slid &one : all) {
    nlohmann::ordered_json motion{{"name", one.name}};
    for (const auto &[name, value] : numbers_of(one)) motion[name] = value;
    document["motions"].push_back(std::move(motion));
  }
  return document;
}

/// One line per motion.
std::string table_of(const std::vector<Slid> &all) {
  std::ostringstream table;
  table.precision(8);
  table << "motion";
  for (const auto &[name, value] : numbers_of(all.front())) table << ',' << name;
  table << '\n';
  for (const Slid &one : all) {
    table << csv_field(one.name);
    for (const auto &[name, value] : numbers_of(one)) table << ',' << value;
    table << '\n';
  }
  return table.str();
}

void write(const std::string &path, const std::string &text) {
  std::ofstream out(path);
  out << text;
  out.close();
  if (!out) throw std::runtime_error("cannot write " + path);
}

void write_history(const std::string &path, const Slid &one) {
  std::ofstream csv(path);
  csv << "time_s,acceleration_m_s2,way_m,reversed_way_m\n";
  csv.precision(8);
  const auto value = [](const std::vector<double> &of, std::size_t k, double after) {
    return k < of.size() ? of[k] : after;
  };
  for (std::size_t k = 0; k < std::max(one.way.size(), one.reversed.size()); ++k)
    csv << static_cast<double>(k) * one.motion.step << ',' << value(one.motion.acceleration, k, 0) << ','
        << value(one.way, k, one.way.back()) << ',' << value(one.reversed, k, one.reversed.back()) << '\n';
  csv.close();
  if (!csv) throw std::runtime_error("cannot write " + path);
}

/// A name that no other motion has, nor a table of all of them.
std::string own_name(const std::string &name, const std::vector<std::pair<std::string, GroundMotion>> &others) {
  const auto taken = [&](const std::string &one) {
    return one == "newmark" || std::ranges::any_of(others, [&](const auto &other) { return other.first == one; });
  };
  std::string own = name;
  for (int k = 2; taken(own); ++k) own = name + "_" + std::to_string(k);
  return own;
}

int newmark(const NewmarkArguments &arguments) {
  const std::string file = find_scene(arguments.scene);
  const Scene scene = read_scene(file, arguments.set);
  if (arguments.no_umat) refuse_umat(scene);
  std::vector<std::pair<std::string, GroundMotion>> motions;
  if (!scene.earthquake.empty()) {
    motions.emplace_back("earthquake", along_x(GroundShaking(scene.earthquake)));
    if (std::ranges::all_of(motions.back().second.acceleration, [](double a) { return a == 0; }))
      scene.complain("earthquake.0.direction", "must have a component along x: the block slides along it");
  }
  for (const std::string &record : arguments.records)
    motions.emplace_back(own_name(std::filesystem::path(record).stem().string(), motions),
                         read_motion(record_source(record)));
  if (motions.empty())
    throw std::invalid_argument(file + " has no [[earthquake]]: add one, or give records by --record");
  const std::string dir =
      arguments.directory.empty() ? default_results(file, arguments.set, "_newmark") : arguments.directory;
  YieldSearch search(scene);
  const Yielding slope = search.find(arguments.direction == "+x" ? 1 : arguments.direction == "-x" ? -1 : 0);
  std::vector<Slid> all;
  for (const auto &[name, motion] : motions) all.push_back(slide(name, motion, slope, arguments.magnitude));
  int rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank) return 0;
  print(slope, all, arguments.magnitude);
  std::filesystem::create_directories(dir);
  write(dir + "/newmark.json", json_of(slope, search.trials(), all).dump(1) + '\n');
  write(dir + "/newmark.csv", table_of(all));
  std::vector<std::string> names;
  for (const Slid &one : all) write_history(dir + "/" + one.name + ".csv", one), names.push_back(one.name);
  const bool drawn = !arguments.no_pictures && draw_newmark(dir, names);
  std::printf("results are in %s: %snewmark.json, newmark.csv and the way over time of each motion\n", dir.c_str(),
              drawn ? "newmark.png, " : "");
  return drawn || arguments.no_pictures ? 0 : 1;
}

}  // namespace

Action add_newmark(CLI::App &app) {
  auto arguments = std::make_shared<NewmarkArguments>();
  CLI::App *command = app.add_subcommand(
      "newmark", "yield coefficient of a slope, and how far it slides in earthquakes as a rigid block (Newmark 1965)");
  command->add_option("SCENE", arguments->scene, "scene file (.toml) or the name of a gallery scene")->required();
  command
      ->add_option("--record", arguments->records,
                   "records beside the scene's [[earthquake]], as of its key file: one line of a table each")
      ->take_all();
  command
      ->add_option("--direction", arguments->direction,
                   "direction of the inertia; default: that in which the slope is weaker")
      ->check(CLI::IsMember({"+x", "-x"}));
  command->add_option("--magnitude", arguments->magnitude, "moment magnitude, for the estimates that need it")
      ->check(CLI::Range(4., 9.5));
  command->add_option("-o,--output", arguments->directory, "folder of the results (default results/NAME_newmark)");
  command->add_option("--set", arguments->set, "override a key of the scene: key.path=value")->take_all();
  command->add_flag("--no-umat", arguments->no_umat, "refuse laws that load a library: for scenes of strangers");
  command->add_flag("--no-pictures", arguments->no_pictures, "do not draw pictures at the end");
  return [arguments] { return newmark(*arguments); };
}

}  // namespace talus
