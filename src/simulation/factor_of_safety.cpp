#include "simulation/stages/factor_of_safety.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iterator>

#include "base/rounded.h"
#include "output/replace_file.h"
#include "scene/body_source.h"
#include "scene/factor_source.h"
#include "scene/quasi_static_source.h"
#include "scene/scene.h"
#include "scene/stress_at_rest.h"
#include "scene/water_source.h"
#include "simulation/factor_document.h"
#include "simulation/search_region.h"
#include "solvers/quasi_static/trial_strength.h"

namespace talus {

/// Refuses laws whose strength cannot be divided. Soil that never fails, and soil that keeps its strength, may stand
/// beside soil that does not, or on a base with friction.
template <int dim>
void check_strength(const World<dim> &world) {
  if constexpr (dim == 3)
    for (const auto &source : world.conditions.sources())
      if (source.kind.quasi_static == OnSoil::contact)
        world.scene.complain("boundary." + source.name + ".kind",
                             "leaves no factor of safety in 3D, which needs elements of second order: the corners of "
                             "their facets bear nothing on a base; take fixed or roller, or a section in plane strain");
  bool some_fail = std::ranges::any_of(world.conditions.sources(),
                                       [](const auto &source) { return source.kind.quasi_static == OnSoil::contact; });
  for (size_t b = 0; b < world.laws.size(); ++b)
    some_fail = some_fail || (!never_fails(world.laws[b]) && world.scene.body[b].reduce_strength);
  if (!some_fail && !std::ranges::all_of(world.laws, never_fails))
    world.scene.complain("body",
                         "has no soil whose strength a factor of safety divides: set reduce_strength = true in one");
  const auto is_divided = [&](size_t b) {
    return *no_strength_reduction(world.laws[b]) == 0 && world.scene.body[b].reduce_strength;
  };
  std::vector<size_t> without;  // bodies whose strength is nothing
  size_t divided = 0;
  for (size_t b = 0; b < world.laws.size(); ++b) {
    const StrengthRange &range = world.strength[b];
    divided += is_divided(b);
    if (is_divided(b) && frictional_strength(world.laws[b]) && range.cohesion[1] == 0 && range.friction_angle[1] == 0 &&
        !reads_suction(world.laws[b]))
      without.push_back(b);
  }
  if (!without.empty() && without.size() == divided)
    world.scene.complain("body." + world.scene.body[without[0]].name,
                         "has no strength that a factor of safety could divide: its cohesion and friction angle are 0");
  for (size_t b = 0; b < world.laws.size(); ++b) {
    const std::string law = law_name(world.laws[b]), reason = no_strength_reduction(world.laws[b]);
    if (!reason.empty() && (!never_fails(world.laws[b]) || !some_fail))
      world.scene.complain("body." + world.scene.body[b].name + ".law",
                           "must have a strength that a factor of safety can divide, but " + law + " " + reason +
                               "; take mohr_coulomb, drucker_prager or hoek_brown");
    if (!world.scene.factor_of_safety->tension_crack.empty() && frictional_strength(world.laws[b]) &&
        !may_crack(world.laws[b]))
      world.scene.complain("body." + world.scene.body[b].name + ".law",
                           "must know a tension cut-off beside factor_of_safety.tension_crack, and " + law +
                               " does not; take mohr_coulomb or hoek_brown");
  }
}

/// Names bodies that yield under level ground of their own weight, because their Poisson's ratio gives elastic ground
/// less lateral stress than their strength asks for. The factor does not depend on it, displacements of the stages do.
template <int dim>
void note_yielding_ground(const World<dim> &world, Recorder<dim> &recorder) {
  for (size_t b = 0; b < world.laws.size(); ++b) {
    const BodySource &body = world.scene.body[b];
    if (begins_at_rest(world.scene, body.name)) continue;
    const double nu = poisson_ratio(world.laws[b]);
    const double phi = world.strength[b].friction_angle[0];  // the least asks for most
    if (phi > 0 && std::sin(phi) < 1 - 2 * nu)
      recorder.note("body." + body.name + " yields under its own weight even where it is level: with poisson_ratio " +
                    rounded(nu) + " its lateral stress is " + rounded(nu / (1 - nu)) +
                    " of the vertical stress, and phi = " + rounded(phi / degree.si) + " deg asks for " +
                    rounded((1 - std::sin(phi)) / (1 + std::sin(phi))) +
                    "; the factor of safety does not depend on this, displacement and strain of the stages do");
  }
}

namespace {

std::string bracket_in_words(const FactorBracket &b) {
  return (b.decided    ? ""
          : b.failed() ? "not found: the search has failed, it is somewhere between "
                       : "between ") +
         rounded(b.decided ? b.value() : b.lower) + (b.decided ? "" : " and " + rounded(b.upper)) +
         " (equilibrium with strength divided by " + rounded(b.lower) + ", a mechanism with " + rounded(b.upper) + ")";
}

EventValues values_of(const FactorBracket &b, int mechanism) {
  return {{"mechanism", mechanism}, {"factor", b.value()}, {"equilibrium_at", b.lower}, {"mechanism_at", b.upper}};
}

/// What psi < phi leaves open.
std::string bounds_in_words(const Mechanism &m) {
  return "lower estimate with the strength of Davis (1968) " + bracket_in_words(m.by_flow.at(TrialFlow::davis)) +
         ", upper bound with psi = phi, which limit equilibrium assumes, " +
         bracket_in_words(m.by_flow.at(TrialFlow::associated));
}

/// Volume and place of the soil that moves.
std::string motion_in_words(const Mechanism &m, int dim) {
  return "moves " + rounded(m.moving_volume) + (dim == 2 ? " m3 of soil per metre" : " m3 of soil") +
         " from x = " + rounded(m.low[0]) + " to " + rounded(m.high[0]) + " m";
}

/// Mean size of the cells in a box, as the side of a regular simplex [m]; 0: there are none. Collective.
template <int dim>
double cell_size_in(const World<dim> &world, const Mechanism &box) {
  double sums[2]{}, all[2];
  for (int c = 0; c < world.mesh.cell_count(); ++c) {
    bool inside = true;
    for (int d = 0; d < dim; ++d) {
      double middle = 0;
      for (const int node : world.mesh.cells[c].node) middle += world.mesh.position[node][d] / (dim + 1);
      inside = inside && box.low[d] <= middle && middle <= box.high[d];
    }
    if (inside) ++sums[0], sums[1] += world.mesh.volume[c];
  }
  MPI_Allreduce(sums, all, 2, MPI_DOUBLE, MPI_SUM, world.comm);
  if (all[0] == 0) return 0;
  return dim == 2 ? std::sqrt(4 / std::sqrt(3.) * all[1] / all[0]) : std::cbrt(6 * std::sqrt(2.) * all[1] / all[0]);
}

constexpr double too_far = 0.2;  ///< displacement over the height of the soil; also in talus_factor.py

/// A trial goes on from the state of the one before, and where that bears the loads with the new strength too there is
/// nothing to iterate.
std::string trial_in_words(const StrengthTrial &t, double height) {
  std::string text = "strength divided by " + rounded(t.factor) +
                     (t.flow == TrialFlow::associated  ? ""
                      : t.flow == TrialFlow::own       ? ", own psi"
                      : t.flow == TrialFlow::undrained ? ", no flow"
                                                       : ", strength of Davis") +
                     ": " + name_of(t.outcome);
  const bool at_once = t.outcome == TrialOutcome::equilibrium && t.iterations == 0 && t.steps == 0;
  text += at_once ? " at once, since the state that the trials before have led to bears it; "
                  : " after " + std::to_string(t.iterations) + (t.iterations == 1 ? " iteration" : " iterations") +
                        (t.steps > 0 ? " and " + std::to_string(t.steps) + " steps of damped motion, " : ", ");
  if (t.outcome == TrialOutcome::mechanism)
    return text + "displacement grows without bound, and " + rounded(100 * t.surplus) +
           " % of the work of the loads finds no resistance";
  return text + "moved " + rounded(t.displacement) + " m at most since strength was first divided" +
         (at_once ? "" : ", out-of-balance force " + rounded(t.residual)) +
         (t.outcome == TrialOutcome::equilibrium && t.displacement > too_far * height
              ? "; this is more than " + rounded(100 * too_far) + " % of the " + rounded(height) +
                    " m that the soil is high: so near to a mechanism the displacement has no meaning, and the balance "
                    "of forces alone counts"
              : "");
}

/// A doubt about a mechanism that is few cells high; empty if it is not.
template <int dim>
std::string too_few_cells(const World<dim> &world, const Mechanism &m) {
  constexpr double enough = 10;  // with 8 cells factors were 2 % too large, with 4.5 cells 5 %
  const int up = world.scene.vertical();
  const double height = m.high[up] - m.low[up], size = cell_size_in(world, m);
  if (size == 0 || height >= enough * size) return "";
  return "the mechanism from x = " + rounded(m.low[0]) + " to " + rounded(m.high[0]) + " m is " + rounded(height) +
         " m high, and its cells measure " + rounded(size) + " m: the factor of a mechanism of fewer than " +
         rounded(enough) + " cells is some per cent too large. Take smaller cells there ([[mesh.refine]]) and compare";
}

/// Why a bracket has one end, or none; `confined` to a part of the soil.
std::string why_open(const FactorBracket &b, bool confined) {
  const char *where = confined ? " inside factor_of_safety.within and along" : "";
  if (b.decided && b.lower == 0)
    return "even with its strength divided by " + rounded(b.upper) + where + " the soil does not stand" +
           (confined ? ": soil outside may fail, which keeps its strength" : "");
  if (b.decided)
    return "strength divided by " + rounded(b.lower) + where + " still has an equilibrium: there is nothing to fail";
  const std::string found =
      b.lower > 0   ? "an equilibrium with strength divided by " + rounded(b.lower) + ", but no mechanism"
      : b.upper > 0 ? "a mechanism with strength divided by " + rounded(b.upper) + ", but no equilibrium"
                    : "neither an equilibrium nor a mechanism";
  return "the trials found " + found +
         ": the iterations of the others led nowhere, and there is no factor of safety; factor_of_safety.csv lists "
         "them. Take quasi_static.linear_solver = \"direct\" or another mesh";
}

/// The factor with the other assumption on the pore water; empty where it does not move.
std::string other_water_in_words(const Mechanism &m, TrialFlow flow) {
  if (!m.by_flow.contains(TrialFlow::undrained)) return "";
  const TrialFlow other = other_flow(m, flow);
  const FactorBracket &b = m.by_flow.at(other);
  return "the factor" + about_water(m, other) + ": " +
         (b.lower > 0 && b.upper > 0 ? bracket_in_words(b) : why_open(b, false));
}

/// Tables of the trials, of their load-displacement curves, and of the slip surfaces that were found.
class FactorTables {
 public:
  explicit FactorTables(const std::string &name) {
    if (name.empty()) return;
    trials_ = std::fopen((name + ".csv").c_str(), "w");
    curves_ = std::fopen((name + "_curves.csv").c_str(), "w");
    surfaces_ = std::fopen((name + "_slip_surfaces.csv").c_str(), "w");
    if (trials_)
      std::fprintf(trials_,
                   "factor,flow,outcome,iterations,steps,residual,displacement_m,surplus_of_work,wall_s,search\n");
    if (curves_) std::fprintf(curves_, "trial,factor,iteration,displacement_m,residual\n");
    if (surfaces_) std::fprintf(surfaces_, "mechanism,equilibrium,failure,x_m,y_m\n");
  }
  FactorTables(const FactorTables &) = delete;
  ~FactorTables() {
    for (std::FILE *file : {trials_, curves_, surfaces_})
      if (file) std::fclose(file);
  }
  void add(const StrengthTrial &t) {
    ++trial_count_;
    if (trials_)
      std::fprintf(trials_, "%.6g,%s,%s,%d,%d,%.3g,%.6g,%.3g,%.3g,%d\n", t.factor, name_of(t.flow), name_of(t.outcome),
                   t.iterations, t.steps, t.residual, t.displacement, t.surplus, t.wall_seconds, t.search),
          std::fflush(trials_);
    for (size_t k = 0; curves_ && k < t.curve.size(); ++k)
      std::fprintf(curves_, "%d,%.6g,%zu,%.6g,%.3g\n", trial_count_, t.factor, k, t.curve[k].first, t.curve[k].second);
  }
  void add(const Mechanism &m) {
    ++mechanism_count_;
    for (size_t k = 0; surfaces_ && k < m.slip_surface.size(); ++k)
      std::fprintf(surfaces_, "%d,%.6g,%.6g,%.6g,%.6g\n", mechanism_count_, m.lower, m.upper, m.slip_surface[k][0],
                   m.slip_surface[k][1]);
  }

 private:
  std::FILE *trials_ = nullptr, *curves_ = nullptr, *surfaces_ = nullptr;
  int trial_count_ = 0, mechanism_count_ = 0;
};

}  // namespace

template <int dim>
std::string FactorStage<dim>::results() const {
  int rank;
  MPI_Comm_rank(run_.world.comm, &rank);
  if (rank > 0 || run_.options.directory.empty()) return "";
  const auto &stages = run_.scene.stage;
  const auto last = std::find_if(stages.rbegin(), stages.rend(), std::mem_fn(&Stage::finds_factor));
  return run_.options.directory + "/factor_of_safety" + (&stage_ == &*last ? "" : "_" + stage_.name);
}

template <int dim>
void FactorStage<dim>::run() {
  if (run_.progress.met) return;  // a resumed run has it behind it
  begin();
  QuasiStatic<dim> &problem = run_.statics.problem();
  const auto before = problem.save();
  const FactorOfSafety &found = run_.factors.emplace_back(search());
  report(found);
  const Clock now = run_.clock;
  const FluidBooks books = run_.recorder.fluids();
  std::vector<std::vector<Vec<dim>>> reference;
  for (const auto &body : run_.world.bodies)
    reference.emplace_back(body->particles().reference.data(),
                           body->particles().reference.data() + body->particles().count);
  if (run_.last_stage()) show_mechanism();
  problem.restore(before), problem.soil().displacement_is_taken();
  if (run_.last_stage()) {
    run_.statics.to_particles();
    for (std::size_t b = 0; b < reference.size(); ++b)
      std::ranges::copy(reference[b], run_.world.bodies[b]->particles().reference.data());
    run_.clock = now, run_.recorder.fluids() = books;
  }
  run_.progress.met = true;
  run_.write_checkpoint();
}

/// The last stage that was no search for a factor.
template <int dim>
const Stage *FactorStage<dim>::stage_before() const {
  return &*std::find_if_not(std::make_reverse_iterator(run_.scene.stage.begin() + run_.progress.number),
                            run_.scene.stage.rend(), std::mem_fn(&Stage::finds_factor));
}

/// The problem is in the state of the stage before; a run that was resumed since has still to bring it under the loads.
template <int dim>
void FactorStage<dim>::begin() {
  const Stage *before = stage_before();
  run_.clock.stage = stage_.name;
  if (run_.world.structures) run_.world.structures->begin_stage(stage_);
  run_.recorder.begin_stage(stage_);
  if (run_.options.resume) {
    QuasiStatic<dim> &problem = run_.statics.problem();
    const auto state = problem.save();
    problem.set_acceleration(run_.scene.acceleration_in(*before));
    require(problem.begin_path(run_.clock.load_time));
    problem.restore(state);
  }
  if (run_.scene.quasi_static->elements != Elements::quadratic)
    run_.recorder.note(
        "the factor of safety is computed with elements of second order: those of first order, which the scene sets "
        "(quasi_static.elements), give factors that are 13 to 34 % too large");
}

template <int dim>
FactorOfSafety FactorStage<dim>::search() {
  FactorOfSafety result;
  World<dim> &world = run_.world;
  double low[dim], high[dim], extent = 0;
  for (int d = 0; d < dim; ++d) low[d] = 1e300, high[d] = -1e300;
  for (const BodyReport &body : world.report())
    for (int d = 0; d < dim; ++d) low[d] = std::min(low[d], body.low[d]), high[d] = std::max(high[d], body.high[d]);
  for (int d = 0; d < dim; ++d) extent = std::max(extent, high[d] - low[d]);
  const double height = high[run_.scene.vertical()] - low[run_.scene.vertical()];
  FactorTables tables(results());
  for (size_t b = 0; b < world.laws.size(); ++b)
    if (!run_.scene.body[b].reduce_strength)
      run_.recorder.note("the strength of body." + run_.scene.body[b].name +
                         " is not reduced: reduce_strength = false");
    else if (never_fails(world.laws[b]))
      run_.recorder.note("the strength of body." + run_.scene.body[b].name +
                         " is not reduced: " + law_name(world.laws[b]) + " " + no_strength_reduction(world.laws[b]));
  note_yielding_ground(world, run_.recorder);
  bool stopped = false;
  const SearchRegion region(*run_.scene.factor_of_safety);
  ReductionSettings<dim> settings;
  if (world.phases.liquid) settings.flow = &run_.statics.flow();
  settings.stands = run_.statics.lost_stages.empty(), settings.by_own_flow = settings.stands && !run_.statics.dilated;
  settings.by_damped_motion = run_.scene.factor_of_safety->by_damped_motion;
  settings.load_time = run_.clock.load_time, settings.time = run_.clock.time;
  settings.shown_displacement = 0.01 * extent, settings.mechanisms = run_.scene.factor_of_safety->mechanisms;
  if (!region.everywhere())
    settings.divided = [&, vertical = run_.scene.vertical()](const Vec<dim> &x, double size) {
      return region.holds(x[0], x[vertical], size);
    };
  const TensionCrack crack(*run_.scene.factor_of_safety);
  if (crack.given()) {
    const double weight = run_.scene.water->density * run_.scene.gravity_size();
    settings.crack = [&crack, weight, vertical = run_.scene.vertical()](const Vec<dim> &x) {
      return crack.reaches(x[0], x[vertical]) ? weight * crack.head(x[vertical]) : -1;
    };
    settings.tell_cracked = [&](bool any) {
      if (!any)
        run_.scene.complain("factor_of_safety.tension_crack", "must have soil above it that fails; it has none");
      run_.recorder.note(std::string("soil above factor_of_safety.tension_crack bears no tension") +
                         (crack.wet() ? ", and water stands in its cracks" : ""));
    };
  }
  settings.tell_confined = [&](double share) {
    if (share == 0)
      run_.scene.complain(
          std::string("factor_of_safety.") + (run_.scene.factor_of_safety->within.empty() ? "along" : "within"),
          "must lie in the soil; it holds none");
    run_.recorder.note("the search is confined to " + rounded(100 * share) +
                       " % of the soil; elsewhere soil keeps its strength");
  };
  settings.tell_shoulder = [&](const FactorBracket &b, int of, double beside) {
    run_.recorder.note("strength divided by " + rounded(b.upper) + " moves the shoulder of mechanism " +
                       std::to_string(of) + " (" + rounded(100 * beside) +
                       " % of its shear is beside the soil that is held): it is held too");
  };
  for (const BodySource &body : run_.scene.body) settings.kept.push_back(!body.reduce_strength);
  settings.tell = [&](const StrengthTrial &t) {
    run_.recorder.note(trial_in_words(t, height), event::strength_trial,
                       {{"factor", t.factor}, {"displacement_m", t.displacement}});
    tables.add(t);
  };
  std::vector<Law> laws;
  for (size_t b = 0; b < world.laws.size(); ++b) {
    laws.push_back(run_.statics.law_in(*stage_before(), b));
    if (laws[b].pore_stiffness() > 0 && *no_strength_reduction(laws[b]) == 0)
      run_.recorder.note("body." + run_.scene.body[b].name +
                         " is undrained: its strength is that of its effective stress at the end of the stages, which "
                         "does not change while it fails, s_u = c cos(phi) + s' sin(phi)");
  }
  require(reduce_strength<dim>(run_.statics.problem(), laws, settings, &result, &stopped));
  result.lost_stages = run_.statics.lost_stages;
  if (stopped) throw RunFailure("interrupted");
  if (result.lower == 0 || result.upper == 0) throw RunFailure(why_open(result, !region.everywhere()));
  tables.add(result);
  for (const Mechanism &m : result.further) tables.add(m);
  return result;
}

template <int dim>
void FactorStage<dim>::report(const FactorOfSafety &found) {
  const auto doubt = [&](const Mechanism &m) {
    if (const std::string sentence = too_few_cells(run_.world, m); !sentence.empty()) run_.recorder.warn(sentence);
  };
  const auto named = [&](const Mechanism &m) {
    const std::string water = about_water(m, found.flow);
    return "factor of safety" + water + (water.empty() ? " " : ": ") + bracket_in_words(m);
  };
  run_.recorder.note(named(found) + "; the mechanism " + motion_in_words(found, dim), event::factor_of_safety,
                     values_of(found, 1));
  doubt(found);
  if (const std::string other = other_water_in_words(found, found.flow); !other.empty()) run_.recorder.note(other);
  if (found.by_flow.contains(TrialFlow::own))
    run_.recorder.note(std::string(found.flow == TrialFlow::own ? "this" : "that") +
                       " is the factor of soil with its own psi < phi; " + bounds_in_words(found));
  if (found.weakened.upper > 0)
    run_.recorder.note(
        "it begins with the stress that the stages found with psi = phi; if this soil weakens from great "
        "strength, it fails already " +
        bracket_in_words(found.weakened) +
        ": whether it stands with its own strength depends on how it came to its stress");
  for (size_t k = 0; k < found.further.size(); ++k) {
    const Mechanism &m = found.further[k];
    const std::string other = other_water_in_words(m, found.flow);
    run_.recorder.note("mechanism " + std::to_string(k + 2) + ": " + named(m) + (other.empty() ? "" : "; " + other) +
                           (m.by_flow.contains(TrialFlow::own) ? ", " + bounds_in_words(m) : "") + "; it " +
                           motion_in_words(m, dim) + ", and " + rounded(100 * m.of_critical) +
                           " % of the soil of mechanism 1",
                       event::factor_of_safety, values_of(m, static_cast<int>(k) + 2));
    doubt(m);
  }
  if (static_cast<int>(found.further.size()) + 1 < run_.scene.factor_of_safety->mechanisms)
    run_.recorder.note("no further mechanism was found: the rest of the soil stands while that of those found is held");
  run_.recorder.note_cut_off([&](const auto &visit) {
    run_.statics.each_gauss_point([&](const Vec<dim> &x, const Vec<dim> &way, double mass, double strain) {
      visit({x, way, mass, strain});
    });
  });
  for (const std::string &stage : found.lost_stages)
    run_.recorder.note("stage " + stage + " found no equilibrium" +
                       (found.lower < 1
                            ? ": the soil does not stand with its own strength"
                            : " by its load steps, though the soil stands at the end of all stages: "
                              "displacement and stress of that stage are not those of this soil. This factor "
                              "does not need them; that of the stage itself needs a scene that ends there"));
  if (const std::string name = results(); !name.empty()) replace_file(name + ".json", document_of(found));
}

/// In the last row of the history and the last snapshot.
template <int dim>
void FactorStage<dim>::show_mechanism() {
  ++run_.clock.steps, run_.clock.stage = strength_reduction;
  run_.hand_to_particles();
  run_.recorder.write_history();
  run_.recorder.write_snapshot();
}

template void check_strength(const World<2> &);
template void check_strength(const World<3> &);
template class FactorStage<2>;
template class FactorStage<3>;

}  // namespace talus
