// Open water beside the soil, and what a stage of seepage leaves as a function of place.
#include <algorithm>
#include <utility>

#include "base/gather.h"
#include "solvers/quasi_static/pore_flow.h"

namespace talus {

template <int dim>
PetscErrorCode PoreFlow<dim>::find_open_water(double t, std::function<double(const Vec<dim> &)> *pressure) const {
  PetscFunctionBeginUser;
  struct Shore {
    Vec<dim> place;
    int source;  ///< whose water stands there, or none
  };
  std::vector<Shore> shores;
  for (int i = 0; i < nodes_.count(); ++i)
    if (nodes_.owned[i] && at_surface_[i] && pressed_[i] != none)
      shores.push_back(
          {nodes_.position[i], pressed_[i] >= 0 && sources_[pressed_[i]].kind.open_water ? pressed_[i] : none});
  int rank, ranks;
  PetscCallMPI(MPI_Comm_rank(nodes_.comm(), &rank));
  PetscCallMPI(MPI_Comm_size(nodes_.comm(), &ranks));
  std::vector<int> others;
  for (int r = 0; r < ranks; ++r)
    if (r != rank) others.push_back(r);
  PetscCall(gather_from(nodes_.comm(), others, shores));
  if (std::ranges::all_of(shores, [](const Shore &shore) { return shore.source == none; })) shores.clear();
  *pressure = [this, t, shores](const Vec<dim> &x) {
    double highest = 0;  // of what any of them would put there
    for (int s = 0; s < static_cast<int>(sources_.size()) && !shores.empty(); ++s)
      if (sources_[s].kind.open_water) highest = std::max(highest, outside(s, x, t));
    if (!(highest > 0)) return 0.;
    const auto square = [&](const Shore &shore) {
      double sum = 0;
      for (int d = 0; d < dim; ++d) sum += (shore.place[d] - x[d]) * (shore.place[d] - x[d]);
      return sum;
    };
    const Shore &nearest = *std::ranges::min_element(shores, {}, [&](const Shore &shore) {
      return std::pair(square(shore), shore.source);  // of two as near always the same one, on any number of ranks
    });
    return nearest.source == none ? 0 : outside(nearest.source, x, t);
  };
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode PoreFlow<dim>::pressure_of_cells(double t, std::vector<double> *cells) const {
  PetscFunctionBeginUser;
  std::function<double(const Vec<dim> &)> open_water;
  PetscCall(find_open_water(t, &open_water));
  std::vector<double> water(mesh_.node_count(), 0);
  std::vector<char> beside(mesh_.node_count(), 0);
  for (int c = 0; c < cell_count(); ++c)
    for (const int node : mesh_.cells[c].node) beside[node] |= !active_[c];
  for (int node = 0; node < mesh_.node_count(); ++node)
    if (beside[node]) water[node] = open_water(mesh_.position[node]);
  cells->clear();
  const auto add = [&](const Vec<dim> &place, double p) {
    cells->insert(cells->end(), place.begin(), place.end());
    cells->push_back(p);
  };
  for (int c = 0; c < cell_count(); ++c) {
    const auto &corner = mesh_.cells[c].node;
    if (active_[c])
      for (int a = 0; a <= dim; ++a) add(nodes_.position[nodes_.of_cell(c)[a]], accepted[nodes_.of_cell(c)[a]]);
    else if (std::ranges::any_of(corner, [&](int node) { return water[node] > 0; }))
      for (const int node : corner) add(mesh_.position[node], water[node]);
  }
  PetscFunctionReturn(0);
}

template PetscErrorCode PoreFlow<2>::find_open_water(double, std::function<double(const Vec<2> &)> *) const;
template PetscErrorCode PoreFlow<3>::find_open_water(double, std::function<double(const Vec<3> &)> *) const;
template PetscErrorCode PoreFlow<2>::pressure_of_cells(double, std::vector<double> *) const;
template PetscErrorCode PoreFlow<3>::pressure_of_cells(double, std::vector<double> *) const;

}  // namespace talus
