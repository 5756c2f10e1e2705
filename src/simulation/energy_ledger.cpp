#include "simulation/energy_ledger.h"

#include <optional>

#include "scene/scene.h"

namespace talus {

template <int dim>
EnergySums EnergyLedger<dim>::sums() {
  EnergySums sums;
  require(world_.motion->begin(clock_.time));
  require(world_.motion->balance(clock_.time, &sums.balance));
  if (statics_.current()) sums.balance.strain = statics_.strain_energy();
  std::vector<double> work = world_.conditions.work();
  const WorkDone &done = world_.motion->work();
  work.insert(work.end(), {done.gravity, done.imposed, done.damping});
  MPI_Allreduce(MPI_IN_PLACE, work.data(), static_cast<int>(work.size()), MPI_DOUBLE, MPI_SUM, world_.comm);
  const PathWork by_statics = statics_.work();
  for (std::size_t s = 0; s < by_statics.of_boundary.size(); ++s) work[s] += by_statics.of_boundary[s];
  work.end()[-3] += by_statics.gravity, work.end()[-2] += statics_.imposed_work();
  if (clock_.time == 0) work_before_ = work, first_ = sums.balance.kinetic + sums.balance.strain;
  work_before_.resize(work.size());
  for (std::size_t k = 0; k < work.size(); ++k) work[k] -= work_before_[k];
  sums.first = first_, sums.escaped = world_.escaped.sums().energy;
  sums.work = {work.end()[-3], work.end()[-2], work.end()[-1]};
  work.resize(work.size() - 3);
  sums.of_boundary = work;
  return sums;
}

template <int dim>
std::string EnergyLedger<dim>::look() {
  const EnergySums found = sums();
  std::optional<double> in_motion;
  if (fluids_move(world_.scene.phases)) {
    constexpr double slow = 1;  // [m/s]: soil that fluids push is slower where there is no other work to compare with
    const double moving = found.balance.kinetic + found.escaped;
    in_motion = moving > world_.total_mass * slow * slow / 2 ? moving : 0;
  }
  return watch_.look(found.dissipated(), found.turnover(), in_motion);
}

template class EnergyLedger<2>;
template class EnergyLedger<3>;

}  // namespace talus
