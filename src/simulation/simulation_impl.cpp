#include "simulation/simulation_impl.h"

#include <algorithm>
#include <limits>
#include <set>
#include <sstream>

#include "base/freed_memory.h"
#include "scene/body_source.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "simulation/stages/stage_runner.h"

namespace talus {

template <int dim>
void Simulation<dim>::run() {
  if (run_.options.resume)
    run_.resume();
  else
    run_.recorder.open();
  told([&] {
    if (run_.progress.number < 0) begin();
    hand_back_freed_memory();
    const long long before = run_.clock.steps;
    for (;; run_.begin_next_stage()) {
      make_stage_runner(run_)->run();
      if (run_.last_stage()) break;
    }
    note_state();
    note_volumes();
    run_.recorder.note_created_energy();
    run_.recorder.note_lost_soil();
    run_.recorder.note_cut_off();
    if (run_.options.resume && run_.clock.steps == before)
      run_.recorder.note(
          run_.is_past_stage() ? "nothing was left to do: the last stage had lasted longer than its duration is now"
          : run_.recorder.has_changed("stage." + std::to_string(run_.progress.number) + ".duration")
              ? "nothing was left to do: the last stage had followed its loads to their end, which another duration "
                "would spread otherwise; add a stage to go on from here"
              : "nothing was left to do: the run had reached its end before it was resumed");
  });
  run_.recorder.close(run_.motion_left);
}

template <int dim>
FactorOfSafety Simulation<dim>::factor_of_safety() {
  if (run_.progress.number < 0) run();
  if (run_.factors.empty())
    throw RunError("the scene has no stage of kind = \"factor_of_safety\" that was carried out");
  return run_.factors.back();
}

/// What is unlikely of the state at the end. Collective.
template <int dim>
void Simulation<dim>::note_state() {
  std::vector<std::string> doubts;
  if (run_.options.doubts_at_end) doubts = run_.options.doubts_at_end(*this);
  for (const std::string &point : run_.points.without_soil())
    doubts.push_back("output.point." + point +
                     " has no soil at the end: what stood there has left the mesh, or no stage has added it");
  if (!run_.moved_before.empty()) doubts.push_back(run_.moved_before);  // in the summary too
  for (const std::string &sentence : doubts) run_.recorder.warn(sentence);
}

/// What has become of the volume of soil, at an end of the run in order or not. Collective.
template <int dim>
void Simulation<dim>::note_volumes() {
  note_gaps();
  note_dilation();
}

/// Where no cap holds the volume of particles, gaps between the pieces of soil that has come apart count as soil. Soil
/// that its law lets swell or stretch is not apart.
template <int dim>
void Simulation<dim>::note_gaps() {
  constexpr double visible = 0.02;  // of the volume of a body
  bool apart = false;
  for (const auto &body : run_.world.bodies) {
    if (!comes_apart(body->law())) continue;
    const ParticleArrays<dim> &p = body->particles();
    double sum[2] = {0, 0}, largest = 0;  // of gaps, and of the rest [m3]; share of its own volume that a particle has
    for (int i = 0; i < p.count; ++i) {
      const double *history = p.history ? p.history + static_cast<std::size_t>(i) * body->history_count() : nullptr;
      const double rest = body->volume_without_gaps(p.rest_volume[i], history);
      sum[0] += std::max(0., p.volume[i] - rest), sum[1] += rest, largest = std::max(largest, p.volume[i] / rest);
    }
    require(MPI_Allreduce(MPI_IN_PLACE, sum, 2, MPI_DOUBLE, MPI_SUM, run_.world.comm));
    require(MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, run_.world.comm));
    if (!(sum[0] > visible * sum[1])) continue;  // nothing is said of volumes that are no numbers
    apart = true;
    std::ostringstream text;
    text.precision(3);
    text << "body." << body->name()
         << " has come apart, and the gaps between its pieces count as soil: " << 100 * sum[0] / sum[1]
         << " % of its volume, and up to " << largest
         << " times the volume of a particle. Volume and area of a deposit come out too large, and such particles "
            "may throw others out"
         << (fluids_move(run_.scene.phases) ? ""
                                            : "; volume_cap = 1, which is the default of such soil, leaves gaps out");
    run_.recorder.warn(text.str(), event::came_apart, {{"share_of_gaps", sum[0] / sum[1]}, {"largest_ratio", largest}});
  }
  if (apart) note_water_drawn();
}

/// Pores that open draw in water, also where no water stands outside.
template <int dim>
void Simulation<dim>::note_water_drawn() {
  constexpr double visible = 0.05;
  const double drawn = run_.recorder.fluids().drawn();
  if (run_.scene.phases != PhaseModel::saturated || !(drawn > visible)) return;
  std::ostringstream text;
  text.precision(3);
  text
      << "the pores have drawn in " << 100 * drawn
      << " % of the water that they had. Where no water stands outside, gaps fill with air, which phases = "
         "\"saturated\" does not have: this soil is too heavy, and suction holds its pieces together. Compare phases = "
         "\"unsaturated\", or a lower permeability";
  run_.recorder.warn(text.str(), event::water_drawn, {{"share", drawn}});
}

/// Soil that shears on dilates no more, once it is as loose as it can be; a constant dilation angle knows no such end.
template <int dim>
void Simulation<dim>::note_dilation() {
  constexpr double visible = 0.05;  // of the volume of a body
  for (const auto &body : run_.world.bodies) {
    if (body->dilation_field() < 0) continue;
    const ParticleArrays<dim> &p = body->particles();
    double sum[2] = {0, 0}, largest = 1;  // of the rest volumes, with and without dilation [m3]; ratio of a particle
    for (int i = 0; i < p.count; ++i) {
      const double *history = p.history + static_cast<std::size_t>(i) * body->history_count();
      const double dilated = body->volume_without_gaps(p.rest_volume[i], history);
      sum[0] += dilated, sum[1] += p.rest_volume[i], largest = std::max(largest, dilated / p.rest_volume[i]);
    }
    require(MPI_Allreduce(MPI_IN_PLACE, sum, 2, MPI_DOUBLE, MPI_SUM, run_.world.comm));
    require(MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, run_.world.comm));
    if (!(sum[0] > (1 + visible) * sum[1])) continue;
    std::ostringstream text;
    text.precision(3);
    text << "body." << body->name() << " has dilated to " << sum[0] / sum[1]
         << " times its volume, and single particles to " << largest
         << " times. Soil that shears on becomes no looser than it can be: give dilation an end, by "
            "residual_dilation_angle = 0 and a shape_factor, or none";
    run_.recorder.warn(text.str(), event::dilated, {{"ratio", sum[0] / sum[1]}, {"largest_ratio", largest}});
  }
}

/// Free space is called "air", or "air_1" and so on between cuts; a region of another name that no body fills was
/// mostly forgotten.
template <int dim>
std::vector<std::string> Simulation<dim>::regions_without_soil() const {
  const BackgroundMesh<dim> &mesh = run_.world.mesh;
  std::vector<char> filled(mesh.cell_count(), false);
  std::set<std::string> named;
  for (const BodySource &body : run_.scene.body)
    for (const std::string &region : body.region) {
      named.insert(region);
      for (const int cell : mesh.region(region)) filled[cell] = true;
    }
  std::vector<std::string> sentences;
  for (const std::string &region : mesh.region_names()) {
    const std::vector<int> cells = mesh.region(region);
    const bool air = region == "air" || region.starts_with("air_");
    if (air || named.count(region) || std::any_of(cells.begin(), cells.end(), [&](int cell) { return filled[cell]; }))
      continue;
    sentences.push_back("no body fills the region " + region +
                        ", which is empty space into which soil may move. If it is soil, give it a [body.NAME]; free "
                        "space is called air");
  }
  return sentences;
}

/// What is written of the state at the start.
template <int dim>
void Simulation<dim>::begin() {
  if (!run_.start_warning.empty()) run_.recorder.warn(run_.start_warning);
  for (const std::string &sentence : run_.start_notes) run_.recorder.note(sentence);
  if (run_.recorder.writes()) note_bodies();
  for (const std::string &sentence : mesh_report().remarks) run_.recorder.warn("mesh: " + sentence);
  if (run_.options.doubts_at_start)
    for (const std::string &sentence : run_.options.doubts_at_start(*this)) run_.recorder.warn(sentence);
  run_.recorder.write_history();
  if (run_.options.gauss_points && run_.scene.stage.front().is_static()) run_.statics.prepare();
  run_.recorder.write_snapshot();
  run_.begin_next_stage();
  run_.write_checkpoint();
}

/// How much soil there is at the start, as the scene and the mesh made it.
template <int dim>
void Simulation<dim>::note_bodies() {
  for (const BodyReport &body : run_.world.report())
    if (body.particles > 0)
      run_.recorder.note(
          body.name + ": " + rounded(body.volume) + (dim == 2 ? " m3/m, " : " m3, ") + rounded(body.mass) +
              (dim == 2 ? " kg/m" : " kg") + (run_.world.phases.liquid ? " of grains in " : " in ") +
              std::to_string(body.particles) + " particles",
          event::body, {{"volume_m3", body.volume}, {"mass_kg", body.mass}, {"particles", body.particles}});
}

/// One step under the loads of the first stage.
template <int dim>
void Simulation<dim>::step_until(double t) {
  told([&] {
    run_.dynamics.set_loading(run_.scene.stage.front(), run_.clock.time);
    const Verdict verdict = run_.dynamics.cycle(t);
    run_.balance_ranks(std::numeric_limits<double>::infinity());
    run_.heed(verdict);
  });
}

template <int dim>
void Simulation<dim>::advance_to(double t) {
  while (run_.clock.time < t * (1 - 1e-12)) step_until(t);
}

template <int dim>
double Simulation<dim>::single_step() {
  if (run_.clock.stage.empty()) run_.clock.stage = run_.scene.stage.front().name;
  step_until(std::numeric_limits<double>::max());
  return run_.clock.last_step;
}

template <int dim>
void Simulation<dim>::nodal_field(const std::string &name, const std::function<void(PetscInt, const double *)> &put) {
  const bool displacement = name == "displacement";
  if (!displacement && name != "velocity")
    throw std::invalid_argument("no nodal field " + name + "; there are velocity and displacement");
  World<dim> &world = run_.world;
  require(world.motion->begin(run_.clock.time));
  std::vector<Vec<dim>> u;
  if (displacement) u = world.nodal_displacement();
  const FilledGrid<dim> &grid = world.motion->grid();
  const std::vector<PetscInt> &vertex = world.mesh.host_vertex;
  for (int i = 0; i < grid.node_count(); ++i)
    put(vertex.empty() ? grid.mesh_node[i] : vertex[grid.mesh_node[i]],
        displacement ? u[grid.mesh_node[i]].data() : world.motion->velocity() + i * dim);
}

template class Simulation<2>;
template class Simulation<3>;

}  // namespace talus
