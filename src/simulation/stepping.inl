// One step after another: its length, the step itself, what all ranks agree on after it, the remap; docs/theory section
// 5.
#include <algorithm>
#include <cmath>

#include "simulation/simulation_impl.h"

namespace talus {

template <int dim>
double Simulation<dim>::single_step() {
  if (stage_name_.empty()) stage_name_ = scene_.stage.front().name;
  set_loading(scene_.stage.front(), time_);
  require(motion_->begin(time_));
  require(step(std::numeric_limits<double>::max()));
  const Verdict verdict = agree();
  refuse(verdict);
  require(remap_due_ ? remap() : motion_->settle());
  heed_interrupt(verdict);
  return last_step_;
}

template <int dim>
void Simulation<dim>::advance_to(double t) {
  while (time_ < t * (1 - 1e-12)) {
    set_loading(scene_.stage.front(), time_);
    require(motion_->begin(time_));
    require(step(t));
    const Verdict verdict = agree();
    refuse(verdict);
    require(remap_due_ ? remap() : motion_->settle());
    heed_interrupt(verdict);
  }
}

template <int dim>
double Simulation<dim>::critical_step() {
  require(motion_->begin(time_));
  double local = std::numeric_limits<double>::infinity(), step;
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const PointSet &points = motion_->points()[b];
    int last = -1;
    for (int q = 0; q < points.count; ++q)
      if (points.cell[q] != last)
        local = std::min(local, critical_[b](motion_->grid().mesh_cell[last = points.cell[q]]));
  }
  MPI_Allreduce(&local, &step, 1, MPI_DOUBLE, MPI_MIN, comm_);
  if (!phases_.liquid)
    if (step_rule(integrator_settings_).bound == FrequencyBound::mesh) {
      constexpr int first = 60, further = 6,
                    apart = 8;  // iterations; steps between two estimates where remaps come thick and fast
      const bool anew = omega_step_ < 0;
      if (anew || steps_ >= omega_step_ + apart) {
        require(motion_->largest_frequency(anew ? first : further, &omega_max_));
        omega_step_ = steps_;
      }
      step = std::max(step, 2 / omega_max_);
    }
  if (phases_.liquid)
    if (explicit_drag()) {
      double mine = motion_->drag_rate(), rate;
      MPI_Allreduce(&mine, &rate, 1, MPI_DOUBLE, MPI_MAX, comm_);
      step = with_explicit_drag(step, rate);
    }
  return step;
}

template <int dim>
PetscErrorCode Simulation<dim>::step(double until) {
  PetscFunctionBeginUser;
  if (critical_step_ == 0 || explicit_drag())
    critical_step_ = critical_step();  // drag follows saturation from step to step
  const StepRule rule = step_rule(integrator_settings_);
  if (rule.fixed > rule.limit * critical_step_)
    fail("the soil has come to cells with a critical step of " + rounded(rule.limit * critical_step_) +
         " s, but integrator.step = " + rounded(rule.fixed) + " s; take a smaller step, or leave it out");
  PetscLogDouble start, end;
  double step = 0;
  PetscCall(PetscTime(&start));
  PetscCall(integrator_->advance(*motion_, time_, {critical_step_ * shrink_, until}, &step));
  PetscCall(PetscTime(&end));
  if (const std::string cause = integrator_->obstacle(); !cause.empty()) {
    const int component = integrator_->obstructing_component();
    const Vec<dim> where =
        component < 0 ? Vec<dim>{} : motion_->grid().position[component / dim % motion_->grid().node_count()];
    const std::string particle = text_of(component >= 0, component < 0 ? "" : nearest_particle(where));
    fail(cause + "; it is largest near " + place_of(component >= 0, where) + ", at " + particle);
  }
  breakdown_.step += end - start;
  time_ += step, last_step_ = step;
  if (!hold_loads_) load_time_ += step;
  ++steps_;
  remap_due_ = scene_.transfer.remap_interval == 0;
  PetscFunctionReturn(0);
}

/// "particle 12 of body.sand" of this rank, the nearest to a place.
template <int dim>
std::string Simulation<dim>::nearest_particle(const Vec<dim> &where) const {
  double nearest = std::numeric_limits<double>::infinity();
  std::string found = "no particle";
  for (const auto &body : bodies_)
    for (int i = 0; i < body->particles().count; ++i) {
      Vec<dim> x, v;
      motion_->present(*body, i, &x, &v);
      const double distance = (map<dim>(x) - map<dim>(where)).norm();
      if (distance < nearest)
        nearest = distance, found = "particle " + std::to_string(body->particles().id[i]) + " of body." + body->name();
    }
  return found;
}

template <int dim>
typename Simulation<dim>::Verdict Simulation<dim>::agree() {
  double mine[7] = {motion_->moved(),
                    1 / motion_->step_ratio(),
                    motion_->speed_squared(),
                    -1,
                    motion_->smallest_volume_ratio() <= 0.2 ? 1. : 0.,
                    !(motion_->speed_squared() < 1e300) ? 1. : 0.,
                    interrupted ? 1. : 0.};
  if (!watched_.empty())
    for (Followed &point : points_)
      if (point.name == watched_) {
        const int i = find(point);
        if (i < 0) continue;
        Vec<dim> x, v;
        motion_->present(*bodies_[point.body], i, &x, &v);
        mine[3] = map<dim>(v).norm();
      }
  for (const auto &body : bodies_)
    if (!law_trouble(body->law()).text.empty()) mine[5] = 1;
  if (mine[5]) mine[2] = 0;
  double all[7];
  MPI_Allreduce(mine, all, 7, MPI_DOUBLE, MPI_MAX, comm_);
  const Verdict verdict{all[0], all[1], all[2], all[3], all[4] > 0, all[5] > 0, all[6] > 0};
  shrink_ = 1 / verdict.shrink;
  if (verdict.moved > scene_.transfer.remap_interval || verdict.inverted) remap_due_ = true;
  return verdict;
}

template <int dim>
void Simulation<dim>::refuse(const Verdict &verdict) {
  if (verdict.broken) {
    Vec<dim> where{};
    std::string cause;
    const bool refused = motion_->find_trouble(&where, &cause);
    const std::string place = place_of(refused, where);
    if (!place.empty()) fail("near " + place + ", " + text_of(refused, cause));
    const bool mine = motion_->find_broken(&where);
    fail("the velocity is not finite near " + place_of(mine, where) +
         "; look at the loads there; a smaller integrator.fraction, a volume_cap or transfer.remap_interval = 0 may "
         "help");
  }
}

/// The checkpoint comes first: what a run writes because it is interrupted must not be in the way when it goes on.
template <int dim>
void Simulation<dim>::heed_interrupt(const Verdict &verdict) {
  if (!verdict.interrupted) return;
  write_checkpoint();
  write_history();
  write_snapshot();
  fail("interrupted");
}

/// Hands the particles what the nodes learned and walks them to their cells.
template <int dim>
PetscErrorCode Simulation<dim>::release(bool to_next) {
  PetscFunctionBeginUser;
  PetscLogDouble start, middle, end;
  PetscCall(PetscTime(&start));
  for (auto &list : movers_) list.clear();
  PetscCall(to_next ? motion_->release_to_next(time_, movers_) : motion_->release(time_, movers_));
  PetscCall(PetscTime(&middle));
  bool lost = false;
  Vec<dim> where{};
  for (size_t b = 0; b < bodies_.size(); ++b) PetscCall(relocate<dim>(*bodies_[b], mesh_, movers_[b], &lost, &where));
  critical_step_ = 0, shrink_ = 1;
  integrator_->restart();
  PetscCall(PetscTime(&end));
  breakdown_.release += middle - start, breakdown_.relocate += end - middle;
  const std::string outside = place_of(lost, where);
  if (!outside.empty())
    fail("a particle left the mesh near " + outside + "; add free space there, or a boundary that keeps soil in");
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode Simulation<dim>::remap() {
  PetscFunctionBeginUser;
  PetscLogDouble start, end;
  constexpr int remaps_between_sorts = 20;
  const bool sorting = ++since_sort_ >= remaps_between_sorts;
  PetscCall(release(!sorting));
  ++remaps_;
  if (sorting) {
    PetscCall(PetscTime(&start));
    for (auto &body : bodies_) PetscCall(body->sort(mesh_.cell_count()));
    PetscCall(PetscTime(&end));
    since_sort_ = 0, breakdown_.relocate += end - start;
  }
  PetscCall(check_conservation());
  PetscCall(PetscTime(&start));
  PetscCall(motion_->begin(time_));
  PetscCall(PetscTime(&end));
  breakdown_.gather += end - start;
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode Simulation<dim>::check_conservation() {
  PetscFunctionBeginUser;
  double mine[2]{}, all[2];
  for (const auto &body : bodies_) {
    const ParticleArrays<dim> &p = body->particles();
    mine[0] += p.count;
    double mass = 0;
#pragma omp simd reduction(+ : mass)
    for (int i = 0; i < p.count; ++i) mass += p.mass[i];
    mine[1] += mass;
  }
  PetscCallMPI(MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_SUM, comm_));
  if (all[0] != static_cast<double>(particle_count_) || std::abs(all[1] - total_mass_) > 1e-12 * total_mass_)
    fail("particles were lost or doubled: " + std::to_string(static_cast<long long>(all[0])) + " of " +
         std::to_string(particle_count_) + " are left");
  PetscFunctionReturn(0);
}

}  // namespace talus
