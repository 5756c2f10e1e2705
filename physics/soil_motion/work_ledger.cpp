#include "physics/soil_motion/work_ledger.h"

namespace talus {

template <int dim>
void WorkLedger<dim>::add(const FilledGrid<dim> &grid, const Vec<dim> *u, const Vec<dim> &gravity,
                          const double *extra_mass, bool damped) {
  Vec<dim> weighted{}, damping{}, imposed{};
  for (int i = 0; i < grid.node_count(); ++i) {
    if (!grid.mesh().counted[grid.mesh_node[i]]) continue;
    const double m = grid.mass[i] + (extra_mass ? extra_mass[i] : 0);
    for (int d = 0; d < dim; ++d) weighted[d] += m * u[i][d];
    if (damped)
      for (int d = 0; d < dim; ++d) damping[d] += damping_[i][d] * u[i][d];
  }
  if (imposes())
    for (int i = 0; i < grid.node_count(); ++i)
      for (int d = 0; d < dim; ++d) imposed[d] += imposed_[i][d] * u[i][d];
  for (int d = 0; d < dim; ++d)
    done_.gravity += gravity[d] * weighted[d], done_.damping -= damping[d], done_.imposed += imposed[d];
}

template class WorkLedger<2>;
template class WorkLedger<3>;

}  // namespace talus
