#include "particles/escaped_particles.h"

#include <functional>

namespace talus {
namespace {

EscapedSums sum_of(const EscapedSums &a, const EscapedSums &b) {
  EscapedSums sum = a;
  sum.particles += b.particles, sum.mass += b.mass, sum.energy += b.energy;
  for (int k = 0; k < 2; ++k) sum.fluid_mass[k] += b.fluid_mass[k];
  for (int d = 0; d < 3; ++d) sum.momentum[d] += b.momentum[d];
  return sum;
}

}  // namespace

template <int dim>
void EscapedParticles<dim>::enter(const Body<dim> &body, int number, int i, int group, double time) {
  const ParticleArrays<dim> &p = body.particles();
  EscapedParticle<dim> one{.time = time, .id = p.id[i], .body = number, .group = group, .mass = p.mass[i]};
  one.position = p.position[i], one.velocity = p.velocity[i];
  EscapedSums with{.particles = 1, .mass = p.mass[i]};
  for (int d = 0; d < dim; ++d) {
    one.momentum[d] = p.mass[i] * p.velocity[i][d];
    with.energy += p.mass[i] * p.velocity[i][d] * p.velocity[i][d] / 2;
  }
  with.energy += p.volume[i] * stored_energy<dim>(body.law(), &p.stress[i * stress_size<dim>]);
  for (int a = 0; a < 2; ++a) {
    if (!p.fluid_mass[a]) continue;
    with.fluid_mass[a] = one.fluid_mass[a] = p.fluid_mass[a][i];
    for (int d = 0; d < dim; ++d) one.momentum[d] += p.fluid_mass[a][i] * p.fluid_velocity[a][i][d];
  }
  for (int d = 0; d < dim; ++d) with.momentum[d] = one.momentum[d];
  list_.push_back(one);
  entered_ = sum_of(entered_, with);
}

template <int dim>
EscapedSums EscapedParticles<dim>::settle(MPI_Comm comm) {
  static_assert(sizeof(EscapedSums) % sizeof(double) == 0, "the sums are numbers side by side");
  EscapedSums all;
  MPI_Allreduce(&entered_, &all, sizeof(EscapedSums) / sizeof(double), MPI_DOUBLE, MPI_SUM, comm);
  entered_ = {};
  sums_ = sum_of(sums_, all);
  return all;
}

template class EscapedParticles<2>;
template class EscapedParticles<3>;

}  // namespace talus
