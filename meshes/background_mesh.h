#pragma once
/// The background mesh of one rank, for the hot loops. Cells are in Morton order; every simplex is positively oriented.
/// `dim` = 2: triangles, 3: tetrahedra. A DMPlex exists where a host program brings it, and of the soil where finite
/// elements need it: of air it would take more memory than all of this.
#include <petscdmplex.h>

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/owned.h"
#include "base/vec.h"
#include "meshes/halo.h"
#include "meshes/linked_nodes.h"
#include "meshes/mesh_needs.h"
#include "meshes/mesh_report.h"
#include "meshes/partition.h"
#include "meshes/simplices.h"

namespace talus {

template <int dim>
struct MeshPart;  // meshes/mesh_part.h
template <int dim>
class WholeMesh;  // meshes/whole_mesh.h

/// One cell: what the walk and the gathers need, together in memory (128 bytes in 3D).
template <int dim>
struct Cell {
  Vec<dim> origin;                     ///< position of vertex 0 [m]
  std::array<Vec<dim>, dim> gradient;  ///< gradients of the barycentric coordinates 1..dim [1/m]
  std::array<int, dim + 1> node;       ///< local node numbers
  std::array<int, dim + 1> neighbour;  ///< cell across the face opposite to vertex k; boundary; or beyond(k)
};
inline constexpr int boundary = -1;  ///< no cell across this face
/// A face shared with another rank is entry `-2 - neighbour` of BackgroundMesh::partition_faces.
struct PartitionFace {
  int rank, cell;  ///< the rank across, and the cell there (its local number)
};
/// A facet of a named group, on the domain's boundary or inside it (then listed once for each adjacent local cell).
template <int dim>
struct Facet {
  int cell, face;             ///< local cell, and the vertex opposite to the facet
  std::array<int, dim> node;  ///< local node numbers
  Vec<dim> normal;            ///< unit normal pointing out of `cell`
  double area;                ///< [m2], in 2D per metre of thickness [m]
};

/// The DMPlex on which finite elements number their nodes.
struct ElementPlex {
  Dm dm;
  std::vector<PetscInt> vertex;   ///< point of a node of the mesh, -1 where there is none
  std::vector<long long> number;  ///< of vertices that of their node, of edges another one; the same on any partition
};

template <int dim>
class BackgroundMesh {
 public:
  /// Reads a Gmsh file on rank 0, checks it, cuts patches, distributes it; then all edges are halved as often as
  /// `halvings` says (meshes/refine.h), and the new cells form patches within the old ones. `region_weight` gives the
  /// weight of a cell from the names of its regions (particles it will hold plus one; the largest counts, 1/1000
  /// without); only these regions, or all where there are none, can have finite elements. `given`, if it is for as many
  /// ranks, is the partition instead. Patches of cells, theory 4.5, stay on one rank and do not depend on the number of
  /// ranks. Collective. Throws std::invalid_argument (the same on all ranks) for a file that cannot be read, a wrong
  /// dimension, cells of zero volume or that overlap, cells in no named group, and more cells or `seeds` than there are
  /// numbers and memory for, before edges are halved. Columns of cells are added beside the groups `sides`
  /// (meshes/side_columns.h).
  static BackgroundMesh read(MPI_Comm comm, const std::string &file,
                             const std::vector<std::pair<std::string, double>> &region_weight, const Cuts &given = {},
                             int halvings = 0, const SeedCounts &seeds = {},
                             const std::vector<std::string> &sides = {});
  /// Takes a distributed DMPlex of a host program (a reference is kept). Labels with a physical name are regions and
  /// groups; patches are cut within each rank, `global_cell` is DMPlex's cell numbering. Collective; throws as `read`
  /// does.
  static BackgroundMesh adopt(DM plex);

  /// Can the mesh be divided among the ranks in another way? Not on one rank, and not the mesh of a host program.
  bool divisible() const { return !cuts_.empty(); }
  /// Weight of the heaviest patch over the mean weight of ranks when the mesh was read: imbalance may be as much above
  /// 1, since patches stay whole. 0 where the mesh is not divisible.
  double heaviest_patch() const { return heaviest_patch_; }
  const Cuts &cuts() const { return cuts_; }  ///< the partition; empty where the mesh is not divisible
  /// The partition with nearly equal sums of weight, where `filled` are the cells of this rank that weigh something,
  /// and a new partition costs as much as `cost` of weight in a step. Collective, the same on all ranks.
  Cuts balanced_cuts(const std::vector<FilledCell<dim>> &filled, double cost, PartitionForecast *forecast) const;
  /// This mesh on another partition: the mesh that `read` would give with these cuts, to the bit. Collective.
  BackgroundMesh divided(const Cuts &cuts) const;

  int cell_count() const { return static_cast<int>(cells.size()); }
  int node_count() const { return static_cast<int>(position.size()); }

  std::vector<Cell<dim>> cells;
  std::vector<double> volume;  ///< of cells [m3], in 2D [m2]
  std::vector<int> patch;      ///< patch of a cell, 0 .. patch_count - 1, local
  int patch_count = 0;
  std::vector<Vec<dim>> position;      ///< of nodes [m]
  std::vector<double> mean_edge;       ///< of the edges at a node, over all ranks [m]
  std::vector<double> nodal_volume;    ///< sum of cell volumes / (dim + 1) at a node, over all ranks [m3]
  std::vector<char> owned;             ///< 1 on one of the ranks that have the node
  std::vector<char> counted;           ///< the same, but of nodes that are tied for one alone: it counts in global sums
  std::vector<long long> global_cell;  ///< number of the cell that does not depend on the partition (order in the file)
  std::vector<long long> global_node;  ///< likewise of the node
  std::vector<PetscInt> host_vertex;   ///< point of a node in the DMPlex of a host program; empty without a host
  std::vector<PartitionFace> partition_faces;
  /// Of each partition face, what `of_cells` holds for the cell across, on its rank. Collective.
  std::vector<char> across(const std::vector<char> &of_cells) const;
  std::vector<PetscInt> across(const std::vector<PetscInt> &of_cells) const;
  /// Of a cell, one bit for each of its faces (1 << k, opposite to vertex k): a point beyond it by less than half of
  /// the cell's altitude is put back inside. Empty: no face is of this kind.
  std::vector<char> closed;
  Halo halo;
  LinkedNodes ties;  ///< nodes that move alike
  /// From now on the nodes of each group (global numbers) move alike, as if they were one. Collective.
  void tie(const std::vector<std::vector<long long>> &groups);

  /// From now on the mesh has one sheet of nodes and cells per list of regions: copies at the same places that share no
  /// node, one behind the other. The cells of these regions are those of their sheet, all other ones those of the first
  /// one; facets are those of all sheets. Finite elements cannot number the nodes of several sheets. Before `tie`.
  /// Collective.
  PetscErrorCode divide_into_sheets(const std::vector<std::vector<std::string>> &regions_of_sheets);
  int sheet_count() const { return sheets_; }
  int cells_in_sheet() const { return cell_count() / sheets_; }
  int nodes_in_sheet() const { return node_count() / sheets_; }

  /// Local cells of a named group of cells, ascending; found on some rank or `has_region` is false on all.
  std::vector<int> region(const std::string &name) const;
  bool has_region(const std::string &name) const;
  /// Local facets of a named group, by cell and face. One between two local cells is listed for each of them, one on a
  /// partition face on each of its two ranks.
  std::vector<Facet<dim>> facets(const std::string &group) const;
  bool has_group(const std::string &name) const;
  /// From now on puts points back inside that are a little beyond a face of this group.
  void close(const std::string &group);
  /// The DMPlex for finite elements, made when it is first asked for. Collective.
  const ElementPlex &element_plex() const;
  /// Numbers of the edges of this rank that finite elements can have, by `ElementPlex::number`. Collective.
  std::vector<long long> global_edges() const;
  /// Tells meshes apart, the same on all ranks and on any partition.
  unsigned long long fingerprint() const { return fingerprint_; }
  /// Tells partitions apart: of the cells of this rank and their order.
  unsigned long long partition_fingerprint() const;
  const std::vector<std::string> &region_names() const { return region_names_; }  ///< the same on all ranks, sorted
  const std::vector<std::string> &group_names() const { return group_names_; }    ///< the same on all ranks, sorted
  MeshReport report() const;                                                      ///< collective
  MPI_Comm comm() const { return comm_; }

 private:
  /// Makes the flat copy of what this rank has.
  PetscErrorCode flatten(MeshPart<dim> part);
  /// Distributes a mesh that is whole on rank 0 by the cuts, refines and flattens it.
  PetscErrorCode settle(MeshPart<dim> part);
  PetscErrorCode find_fingerprint();

  Communicator comm_;
  Regions regions_;  // of cells
  Groups groups_;
  std::vector<Seam> seams_;
  int sheets_ = 1;
  std::vector<std::string> region_names_, group_names_, remarks_;
  mutable std::shared_ptr<const ElementPlex> elements_;
  std::vector<std::string> element_regions_;     // that can have finite elements; none: all
  long long end_of_numbers_ = 0;                 // of nodes
  std::shared_ptr<const WholeMesh<dim>> whole_;  // of a mesh that several ranks share: on rank 0 that of the file
  Cuts cuts_;
  int halvings_ = 0;
  double heaviest_patch_ = 0;
  unsigned long long fingerprint_ = 0;
};

}  // namespace talus
