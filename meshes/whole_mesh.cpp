#include "meshes/whole_mesh.h"

#include <algorithm>
#include <numeric>

namespace talus {
namespace {

/// Weight of a cell without a body: so small that much air weighs nothing against the soil, and not 0, so that air
/// alone is divided too.
constexpr double empty_weight = 1e-3;

}  // namespace

template <int dim>
MeshPart<dim> part_of_file(const GmshMesh &source, std::string &complaint) {
  MeshPart<dim> part;
  if (source.cells.empty()) return part;  // as on other ranks
  read_mesh<dim>(source, part.cells, part.groups, complaint);
  if (!complaint.empty()) return part;
  const long long cells = static_cast<long long>(part.cells.node.size());
  part.regions = combine(static_cast<int>(cells), source.regions);
  part.cell_number.resize(cells), part.node_number.resize(part.cells.position.size());
  std::iota(part.cell_number.begin(), part.cell_number.end(), 0);
  std::iota(part.node_number.begin(), part.node_number.end(), cells);
  part.all_cells = cells, part.end_of_numbers = cells + static_cast<long long>(part.node_number.size());
  part.owned.assign(part.node_number.size(), 1);
  part.mean_edge = mean_edges<dim>(part.cells, source);
  return part;
}

template <int dim>
std::vector<FilledCell<dim>> filled_cells(const Regions &regions,
                                          const std::vector<std::pair<std::string, double>> &region_weight) {
  std::vector<double> of_combination(regions.names.size(), 0);
  for (std::size_t k = 0; k < regions.names.size(); ++k)
    for (const auto &[name, value] : region_weight)
      if (std::count(regions.names[k].begin(), regions.names[k].end(), name))
        of_combination[k] = std::max(of_combination[k], value);
  std::vector<FilledCell<dim>> filled;
  for (std::size_t c = 0; c < regions.combination.size(); ++c)
    if (const double weight = of_combination[regions.combination[c]]; weight > 0)
      filled.push_back({static_cast<long long>(c), weight, {}});
  return filled;
}

template <int dim>
WholeMesh<dim>::WholeMesh(GmshMesh source, const MeshPart<dim> &all) : source_(std::move(source)), patch_(all.patch) {
  const int count = patch_.empty() ? 0 : *std::max_element(patch_.begin(), patch_.end()) + 1;
  centre_.assign(count, Vec<dim>{}), touching_.resize(count);
  std::vector<int> size(count, 0);
  for (std::size_t c = 0; c < patch_.size(); ++c) {
    const int p = patch_[c];
    for (const auto &x : all.cells.corners(static_cast<int>(c))) map<dim>(centre_[p]) += map<dim>(x) / (dim + 1);
    ++size[p];
    for (int other : all.cells.neighbour[c])
      if (other >= 0 && patch_[other] != p) touching_[p].push_back(patch_[other]);
  }
  for (int p = 0; p < count; ++p) map<dim>(centre_[p]) /= size[p];
}

template <int dim>
MeshPart<dim> WholeMesh<dim>::part() const {
  std::string complaint;  // there was none when it was read
  MeshPart<dim> all = part_of_file<dim>(source_, complaint);
  all.patch = patch_;
  return all;
}

template <int dim>
std::vector<int> WholeMesh<dim>::ranks_of_cells(const Cuts &cuts) const {
  const std::vector<int> rank_of_patch = ranks_by_cuts<dim>(centre_, cuts);
  std::vector<int> rank;
  rank.reserve(patch_.size());
  for (const int p : patch_) rank.push_back(rank_of_patch[p]);
  return rank;
}

template <int dim>
typename WholeMesh<dim>::Balance WholeMesh<dim>::balance(const std::vector<FilledCell<dim>> &filled, double cost,
                                                         int ranks) const {
  PatchLoad<dim> load{std::vector<double>(centre_.size(), 0), std::vector<Vec<dim>>(centre_.size()), cost};
  for (const int p : patch_) load.weight[p] += empty_weight;
  for (const FilledCell<dim> &one : filled) {
    const int p = patch_[one.number];
    load.weight[p] += one.weight - empty_weight;
    map<dim>(load.way[p]) += one.weight * map<dim>(one.way);
  }
  for (std::size_t p = 0; p < load.way.size(); ++p) map<dim>(load.way[p]) /= load.weight[p];
  Balance balance;
  balance.cuts = find_cuts<dim>(centre_, load, touching_, ranks, &balance.forecast);
  const double all = std::accumulate(load.weight.begin(), load.weight.end(), 0.);
  if (all > 0) balance.heaviest_patch = ranks * *std::max_element(load.weight.begin(), load.weight.end()) / all;
  return balance;
}

template class WholeMesh<2>;
template class WholeMesh<3>;
template std::vector<FilledCell<2>> filled_cells(const Regions &, const std::vector<std::pair<std::string, double>> &);
template std::vector<FilledCell<3>> filled_cells(const Regions &, const std::vector<std::pair<std::string, double>> &);
template MeshPart<2> part_of_file(const GmshMesh &, std::string &);
template MeshPart<3> part_of_file(const GmshMesh &, std::string &);

}  // namespace talus
