// Factor of safety by reduction of strength after the stages, docs/theory/finite_elements.md section 5.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "simulation/simulation_impl.h"

namespace talus {

/// Refuses laws whose strength cannot be divided. Soil that never fails may stand beside soil that does.
template <int dim>
void check_strength(const World<dim> &world) {
  const bool some_fail = std::ranges::any_of(world.laws, [](const Law &law) { return !never_fails(law); });
  for (size_t b = 0; b < world.laws.size(); ++b) {
    const std::string law = law_name(world.laws[b]), reason = no_strength_reduction(world.laws[b]);
    if (!reason.empty() && (!never_fails(world.laws[b]) || !some_fail))
      world.scene.complain("body." + world.scene.body[b].name + ".law",
                           "must have a strength that a factor of safety can divide, but " + law + " " + reason +
                               "; take mohr_coulomb or drucker_prager");
  }
}

/// Names bodies that yield under level ground of their own weight, because their Poisson's ratio gives elastic ground
/// less lateral stress than their strength asks for. The factor does not depend on it, displacements of the stages do.
template <int dim>
void note_yielding_ground(const World<dim> &world, Recorder<dim> &recorder) {
  for (size_t b = 0; b < world.laws.size(); ++b) {
    const BodySource &body = world.scene.body[b];
    const double K = bulk_modulus(world.laws[b]), G = shear_modulus(world.laws[b]),
                 nu = (3 * K - 2 * G) / (6 * K + 2 * G);
    const double phi = world.strength[b].friction_angle[0];  // the least asks for most
    if (phi > 0 && std::sin(phi) < 1 - 2 * nu)
      recorder.note("body." + body.name + " yields under its own weight even where it is level: with poisson_ratio " +
                    rounded(nu) + " its lateral stress is " + rounded(nu / (1 - nu)) +
                    " of the vertical stress, and phi = " + rounded(phi / degree.si) + " deg asks for " +
                    rounded((1 - std::sin(phi)) / (1 + std::sin(phi))) +
                    "; the factor of safety does not depend on this, displacement and strain of the stages do");
  }
}

template <int dim>
FactorOfSafety Simulation<dim>::factor_of_safety() {
  const Scene &scene = run_.scene;
  for (size_t k = 0; k < scene.stage.size(); ++k)
    if (!is_static(scene.stage[k].kind))
      scene.complain("stage." + std::to_string(k) + ".kind", "must be \"quasi_static\" for a factor of safety");
  check_strength(run_.world);
  run_.statics.for_factor = true;
  if (run_.clock.steps == 0) run();
  return told([&] { return reduce_strength(); });
}

namespace {

std::string bracket_in_words(const FactorBracket &b) {
  return (b.decided ? "" : "between ") + rounded(b.decided ? b.value() : b.lower) +
         (b.decided ? "" : " and " + rounded(b.upper)) + " (equilibrium with strength divided by " + rounded(b.lower) +
         ", a mechanism with " + rounded(b.upper) + ")";
}

/// Why a bracket has one end, or none.
std::string why_open(const FactorBracket &b) {
  if (b.decided && b.lower == 0)
    return "even with its strength divided by " + rounded(b.upper) + " the soil does not stand";
  if (b.decided)
    return "strength divided by " + rounded(b.lower) + " still has an equilibrium: there is nothing to fail";
  const std::string found =
      b.lower > 0   ? "an equilibrium with strength divided by " + rounded(b.lower) + ", but no mechanism"
      : b.upper > 0 ? "a mechanism with strength divided by " + rounded(b.upper) + ", but no equilibrium"
                    : "neither an equilibrium nor a mechanism";
  return "the trials found " + found +
         ": the iterations of the others led nowhere, and there is no factor of safety; factor_of_safety.csv lists "
         "them. Take quasi_static.linear_solver = \"direct\" or another mesh";
}

/// One table of the trials and one of their load-displacement curves.
struct TrialTables {
  explicit TrialTables(const std::string &directory) {
    if (directory.empty()) return;
    trials = std::fopen((directory + "/factor_of_safety.csv").c_str(), "w");
    curves = std::fopen((directory + "/factor_of_safety_curves.csv").c_str(), "w");
    if (trials) std::fprintf(trials, "factor,psi,outcome,iterations,residual,displacement_m,surplus_of_work,wall_s\n");
    if (curves) std::fprintf(curves, "trial,factor,iteration,displacement_m,residual\n");
  }
  TrialTables(const TrialTables &) = delete;
  ~TrialTables() {
    if (trials) std::fclose(trials);
    if (curves) std::fclose(curves);
  }
  void add(const StrengthTrial &t) {
    ++count;
    if (trials)
      std::fprintf(trials, "%.6g,%s,%s,%d,%.3g,%.6g,%.3g,%.3g\n", t.factor, t.dilating ? "phi" : "own",
                   name_of(t.outcome), t.iterations, t.residual, t.displacement, t.surplus, t.wall_seconds),
          std::fflush(trials);
    for (size_t k = 0; curves && k < t.curve.size(); ++k)
      std::fprintf(curves, "%d,%.6g,%zu,%.6g,%.3g\n", count, t.factor, k, t.curve[k].first, t.curve[k].second);
  }
  std::FILE *trials = nullptr, *curves = nullptr;
  int count = 0;
};

}  // namespace

/// From the state that the stages have led to.
template <int dim>
FactorOfSafety Simulation<dim>::reduce_strength() {
  FactorOfSafety result;
  World<dim> &world = run_.world;
  double low[dim], high[dim], extent = 0;
  for (int d = 0; d < dim; ++d) low[d] = 1e300, high[d] = -1e300;
  for (const BodyReport &body : bodies())
    for (int d = 0; d < dim; ++d) low[d] = std::min(low[d], body.low[d]), high[d] = std::max(high[d], body.high[d]);
  for (int d = 0; d < dim; ++d) extent = std::max(extent, high[d] - low[d]);
  int rank;
  MPI_Comm_rank(world.comm, &rank);
  TrialTables tables(rank == 0 ? run_.options.directory : "");
  run_.clock.stage = "strength reduction";
  for (size_t b = 0; b < world.laws.size(); ++b)
    if (never_fails(world.laws[b]))
      run_.recorder.note("the strength of body." + run_.scene.body[b].name +
                         " is not reduced: " + law_name(world.laws[b]) + " " + no_strength_reduction(world.laws[b]));
  note_yielding_ground(world, run_.recorder);
  bool stopped = false;
  ReductionSettings settings;
  settings.load_time = run_.clock.load_time, settings.time = run_.clock.time;
  settings.shown_displacement = 0.01 * extent;
  settings.tell = [&](const StrengthTrial &t) {
    std::string text = "strength divided by " + rounded(t.factor) + (t.dilating ? ", psi = phi" : "") + ": " +
                       name_of(t.outcome) + ", " + std::to_string(t.iterations) + " iterations, ";
    if (t.outcome == TrialOutcome::mechanism)
      text += "displacement grows without bound, and " + rounded(100 * t.surplus) +
              " % of the work of the loads finds no resistance";
    else
      text += "largest displacement " + rounded(t.displacement) + " m, out-of-balance force " + rounded(t.residual);
    run_.recorder.note(text);
    tables.add(t);
  };
  require(talus::reduce_strength<dim>(run_.statics.problem(), world.laws, settings, &result, &stopped));
  result.lost_stages = run_.statics.lost_stages;
  if (stopped) throw RunFailure("interrupted");
  if (result.lower == 0 || result.upper == 0) throw RunFailure(why_open(result));
  run_.recorder.note("factor of safety " + bracket_in_words(result) + "; the mechanism moves " +
                     rounded(result.moving_volume) + (dim == 2 ? " m3 of soil per metre" : " m3 of soil"));
  if (result.davis)
    run_.recorder.note(
        "psi < phi: this is the factor of soil with the strength of Davis (1968) on its slip surface; with "
        "psi = phi, as limit equilibrium assumes, it is " +
        bracket_in_words(result.dilating));
  for (const std::string &stage : result.lost_stages)
    run_.recorder.note("WARNING: stage " + stage +
                       " found no equilibrium, so the search for the factor began out of balance; the factor does not "
                       "depend on it, but displacement and stress of that stage are not those of this soil");
  ++run_.clock.steps;
  run_.hand_to_particles();
  run_.recorder.write_history();
  run_.recorder.write_snapshot();
  return result;
}

template FactorOfSafety Simulation<2>::factor_of_safety();
template FactorOfSafety Simulation<3>::factor_of_safety();
template FactorOfSafety Simulation<2>::reduce_strength();
template FactorOfSafety Simulation<3>::reduce_strength();

}  // namespace talus
