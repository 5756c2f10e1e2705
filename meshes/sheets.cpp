// Sheets of the mesh: copies of its nodes and cells for groups of bodies that meet in contact.
#include <algorithm>

#include "meshes/background_mesh.h"

namespace talus {
namespace {

/// Appends copies of the first entries to themselves, changed by `change(entry, sheet)`.
template <class T, class Change>
void repeat(std::vector<T> &values, int sheets, Change change) {
  const std::size_t count = values.size();
  values.reserve(count * sheets);
  for (int s = 1; s < sheets; ++s)
    for (std::size_t k = 0; k < count; ++k) {
      T copy = values[k];
      change(copy, s);
      values.push_back(copy);
    }
}
template <class T>
void repeat(std::vector<T> &values, int sheets) {
  repeat(values, sheets, [](T &, int) {});
}

/// One above the largest number on any rank. Collective.
long long end_of(MPI_Comm comm, const std::vector<long long> &numbers) {
  long long end = numbers.empty() ? 0 : *std::max_element(numbers.begin(), numbers.end()) + 1;
  MPI_Allreduce(MPI_IN_PLACE, &end, 1, MPI_LONG_LONG, MPI_MAX, comm);
  return end;
}

}  // namespace

template <int dim>
PetscErrorCode BackgroundMesh<dim>::divide_into_sheets(const std::vector<std::vector<std::string>> &regions_of_sheets) {
  const int sheets = static_cast<int>(regions_of_sheets.size()), cell_number = cell_count(), node_number = node_count(),
            faces = static_cast<int>(partition_faces.size()), patches = patch_count;
  PetscFunctionBeginUser;
  std::vector<int> sheet_of(cell_number, 0);
  for (int s = 1; s < sheets; ++s)
    for (const std::string &name : regions_of_sheets[s])
      for (const int cell : region(name)) sheet_of[cell] = s;

  const std::vector<PetscInt> cells_across = across(std::vector<PetscInt>(cell_number, cell_number));
  repeat(cells, sheets, [&](Cell<dim> &cell, int s) {
    for (int &node : cell.node) node += s * node_number;
    for (int &next : cell.neighbour)
      if (next != boundary) next += next > boundary ? s * cell_number : -s * faces;
  });
  repeat(volume, sheets), repeat(closed, sheets);
  repeat(patch, sheets, [&](int &number, int s) { number += s * patches; });
  patch_count *= sheets;
  repeat(position, sheets), repeat(mean_edge, sheets), repeat(nodal_volume, sheets);
  repeat(owned, sheets), repeat(counted, sheets);
  for (auto *numbers : {&global_cell, &global_node}) {
    const long long end = end_of(comm(), *numbers);
    repeat(*numbers, sheets, [&](long long &number, int s) { number += s * end; });
  }
  int face = 0;
  repeat(partition_faces, sheets, [&](PartitionFace &one, int s) {
    one.cell += s * static_cast<int>(cells_across[face]), face = (face + 1) % faces;
  });
  const auto behind = [&](Side &side, int s) { side.cell += s * cell_number; };
  for (Seam &seam : seams_) repeat(seam.sides, sheets, behind);
  for (auto &group : groups_) repeat(group.second, sheets, behind);
  std::vector<std::vector<int>> shared = halo.shared();
  for (std::vector<int> &nodes : shared) repeat(nodes, sheets, [&](int &node, int s) { node += s * node_number; });
  halo = Halo(comm(), halo.neighbours(), std::move(shared));

  const int none = static_cast<int>(regions_.names.size());
  regions_.names.emplace_back();
  repeat(regions_.combination, sheets);
  for (int s = 0; s < sheets; ++s)
    for (int c = 0; c < cell_number; ++c)
      if (sheet_of[c] != s) regions_.combination[s * cell_number + c] = none;
  sheets_ = sheets;
  PetscFunctionReturn(0);
}

template PetscErrorCode BackgroundMesh<2>::divide_into_sheets(const std::vector<std::vector<std::string>> &);
template PetscErrorCode BackgroundMesh<3>::divide_into_sheets(const std::vector<std::vector<std::string>> &);

}  // namespace talus
