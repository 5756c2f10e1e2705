// Factor of safety by reduction of strength after the stages, docs/theory/finite_elements.md section 5.
#include <algorithm>
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

template <int dim>
FactorOfSafety Simulation<dim>::factor_of_safety() {
  constexpr double least_factor = 0.1;
  const Scene &scene = run_.scene;
  for (size_t k = 0; k < scene.stage.size(); ++k)
    if (!is_static(scene.stage[k].kind))
      scene.complain("stage." + std::to_string(k) + ".kind", "must be \"quasi_static\" for a factor of safety");
  check_strength(run_.world);
  for (double &factor = run_.statics.strength_factor;; factor /= 2) {
    try {
      if (run_.clock.steps == 0) run();
      break;
    } catch (const RunError &) {  // no equilibrium with this strength: come from a larger one
      if (interrupted || !run_.statics.current() || factor / 2 < least_factor) throw;
      run_.recorder.note("strength divided by " + rounded(factor) +
                         " is too little for the stages; they start again with twice of it");
      run_.start_again();
    }
  }
  return told([&] { return reduce_strength(); });
}

/// From the state that the stages have led to.
template <int dim>
FactorOfSafety Simulation<dim>::reduce_strength() {
  World<dim> &world = run_.world;
  double low[dim], high[dim], extent = 0;
  for (int d = 0; d < dim; ++d) low[d] = 1e300, high[d] = -1e300;
  for (const BodyReport &body : bodies())
    for (int d = 0; d < dim; ++d) low[d] = std::min(low[d], body.low[d]), high[d] = std::max(high[d], body.high[d]);
  for (int d = 0; d < dim; ++d) extent = std::max(extent, high[d] - low[d]);
  FactorOfSafety result;
  std::FILE *table = nullptr;
  int rank;
  MPI_Comm_rank(world.comm, &rank);
  if (rank == 0 && !run_.options.directory.empty()) {
    table = std::fopen((run_.options.directory + "/factor_of_safety.csv").c_str(), "w");
    if (table) std::fprintf(table, "factor,stable,iterations,residual,displacement_m,reason\n");
  }
  run_.clock.stage = "strength reduction";
  for (size_t b = 0; b < world.laws.size(); ++b)
    if (never_fails(world.laws[b]))
      run_.recorder.note("the strength of body." + run_.scene.body[b].name +
                         " is not reduced: " + law_name(world.laws[b]) + " " + no_strength_reduction(world.laws[b]));
  require(talus::reduce_strength<dim>(
      run_.statics.problem(), world.laws, run_.statics.strength_factor, run_.clock.load_time, run_.clock.time,
      0.1 * extent, 0.01,
      [&](const StrengthTrial &t) {
        run_.recorder.note("strength divided by " + rounded(t.factor) + ": " + (t.stable ? "stable" : t.reason) + ", " +
                           std::to_string(t.iterations) + " iterations, largest displacement " +
                           rounded(t.displacement) + " m");
        if (table)
          std::fprintf(table, "%.6g,%d,%d,%.3g,%.6g,%s\n", t.factor, t.stable, t.iterations, t.residual, t.displacement,
                       t.reason.c_str()),
              std::fflush(table);
      },
      &result));
  if (table) std::fclose(table);
  if (result.upper == 0)
    throw RunFailure("strength divided by " + rounded(result.lower) +
                     " still has an equilibrium: there is nothing to fail");
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
