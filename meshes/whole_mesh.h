#pragma once
/// The mesh of a file while it is whole, on rank 0: as such it is divided among the ranks, when it is read and again
/// where soil has moved. Where the parts of ranks are refined (meshes/refine.h) it is the mesh before that.
#include <string>
#include <utility>
#include <vector>

#include "meshes/gmsh_file.h"
#include "meshes/mesh_part.h"
#include "meshes/partition.h"

namespace talus {

/// A mesh that is whole on this rank, without patches. A complaint is about a facet that no cell has.
template <int dim>
MeshPart<dim> part_of_file(const GmshMesh &source, std::string &complaint);

/// The cells whose regions have a weight, with the largest of them.
template <int dim>
std::vector<FilledCell<dim>> filled_cells(const Regions &regions,
                                          const std::vector<std::pair<std::string, double>> &region_weight);

/// What is kept on rank 0 for new partitions.
template <int dim>
class WholeMesh {
 public:
  WholeMesh() = default;
  /// `all` are the cells of this file, with patches.
  WholeMesh(GmshMesh source, const MeshPart<dim> &all);

  std::size_t cell_count() const { return patch_.size(); }
  MeshPart<dim> part() const;  ///< all of it
  std::vector<int> ranks_of_cells(const Cuts &cuts) const;
  /// Cuts that balance the weights of these cells, where a new partition costs as much as `cost` of weight in a step.
  struct Balance {
    Cuts cuts;
    PartitionForecast forecast;
    double heaviest_patch = 0;  ///< its weight over the mean of ranks
  };
  Balance balance(const std::vector<FilledCell<dim>> &filled, double cost, int ranks) const;

 private:
  GmshMesh source_;
  std::vector<int> patch_;                  // of cells
  std::vector<Vec<dim>> centre_;            // of patches [m]
  std::vector<std::vector<int>> touching_;  // patches that share faces with a patch
};

}  // namespace talus
