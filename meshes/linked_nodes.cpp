#include "meshes/linked_nodes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>

#include "base/local_numbers.h"
#include "meshes/background_mesh.h"

namespace talus {

LinkedNodes::LinkedNodes(MPI_Comm comm, std::vector<std::vector<long long>> groups,
                         const std::vector<long long> &global_node, const std::vector<char> &owned)
    : comm_(comm), groups_(std::move(groups)) {
  MPI_Comm_size(comm, &ranks_);
  const LocalNumbers local(global_node);
  first_.push_back(0);
  for (const auto &group : groups_) {
    for (const long long number : group) {
      const int node = local.find(number);
      members_.push_back(node), counts_.push_back(node >= 0 && owned[node]);
      if (node >= 0) nodes_.push_back(node);
    }
    first_.push_back(static_cast<int>(members_.size()));
  }
  place_.assign(members_.size(), -1);
}

PetscErrorCode LinkedNodes::sum(double *values, int width) {
  PetscFunctionBeginUser;
  if (empty()) PetscFunctionReturn(0);
  const std::size_t count = members_.size() * width;
  if (records_.size() < count) records_.resize(count);
  for (std::size_t m = 0; m < members_.size(); ++m)
    for (int k = 0; k < width; ++k)
      records_[m * width + k] =
          counts_[m] && place_[m] >= 0 ? values[static_cast<std::size_t>(place_[m]) * width + k] : 0;
  if (ranks_ > 1)  // all but one add zero, which is exact
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, records_.data(), static_cast<int>(count), MPI_DOUBLE, MPI_SUM, comm_));
  for (std::size_t g = 0; g + 1 < first_.size(); ++g)
    for (int k = 0; k < width; ++k) {
      double total = 0;
      for (int m = first_[g]; m < first_[g + 1]; ++m) total += records_[static_cast<std::size_t>(m) * width + k];
      for (int m = first_[g]; m < first_[g + 1]; ++m)
        if (place_[m] >= 0) values[static_cast<std::size_t>(place_[m]) * width + k] = total;
    }
  PetscFunctionReturn(0);
}

namespace {

template <class Record>
std::vector<Record> gather_all(MPI_Comm comm, const std::vector<Record> &mine) {
  int ranks, bytes = static_cast<int>(mine.size() * sizeof(Record));
  MPI_Comm_size(comm, &ranks);
  std::vector<int> counts(ranks), first(ranks, 0);
  MPI_Allgather(&bytes, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  for (int r = 1; r < ranks; ++r) first[r] = first[r - 1] + counts[r - 1];
  std::vector<Record> all((first.back() + counts.back()) / sizeof(Record));
  MPI_Allgatherv(mine.data(), bytes, MPI_BYTE, all.data(), counts.data(), first.data(), MPI_BYTE, comm);
  return all;
}

template <int dim>
std::string text_of(const Vec<dim> &x) {
  std::ostringstream text;
  text.precision(4);
  for (int d = 0; d < dim; ++d) text << (d ? ", " : "(") << x[d];
  return text.str() + ") m";
}

}  // namespace

template <int dim>
std::vector<FaceNode<dim>> nodes_of_planes(const BackgroundMesh<dim> &mesh, const std::vector<Facet<dim>> &facets,
                                           Vec<dim> &normal, std::string &complaint) {
  constexpr double parallel = 1 - 1e-9, flat = 1e-6;  // cosine; distance from the plane over its size
  std::vector<Vec<dim>> normals;
  for (const Facet<dim> &f : facets) normals.push_back(f.normal);
  normals = gather_all(mesh.comm(), normals);
  if (normals.empty()) {
    complaint = "has no facets";
    return {};
  }
  normal = *std::max_element(normals.begin(), normals.end());
  std::vector<FaceNode<dim>> nodes;
  for (const Vec<dim> &n : normals)
    if (std::abs(dot<dim>(n, normal)) < parallel) {
      complaint = "must lie in parallel planes, and one of its facets looks along " + text_of<dim>(n) +
                  ", another along " + text_of<dim>(normal);
      return {};
    }
  for (const Facet<dim> &f : facets)
    for (const int i : f.node)
      nodes.push_back({mesh.global_node[i], mesh.position[i], dot<dim>(f.normal, normal) > 0 ? 1 : -1});
  nodes = gather_all(mesh.comm(), nodes);
  const auto before = [](const FaceNode<dim> &a, const FaceNode<dim> &b) {
    return std::pair(a.number, a.side) < std::pair(b.number, b.side);
  };
  std::sort(nodes.begin(), nodes.end(), before);
  nodes.erase(std::unique(nodes.begin(), nodes.end(),
                          [](const auto &a, const auto &b) { return a.number == b.number && a.side == b.side; }),
              nodes.end());
  for (const int side : {1, -1}) {
    double low = std::numeric_limits<double>::max(), high = -low, size = 0;
    Vec<dim> first{};
    bool found = false;
    for (const FaceNode<dim> &one : nodes) {
      if (one.side != side) continue;
      if (!found) first = one.position, found = true;
      const double along = dot<dim>(one.position, normal);
      low = std::min(low, along), high = std::max(high, along);
      size = std::max(size, (map<dim>(one.position) - map<dim>(first)).norm());
    }
    if (found && high - low > flat * size)
      complaint = "must be one plane on each side, and has facets from " + std::to_string(low) + " to " +
                  std::to_string(high) + " m along " + text_of<dim>(normal);
  }
  return nodes;
}

template <int dim>
std::vector<std::vector<long long>> opposite_nodes(const std::vector<FaceNode<dim>> &one,
                                                   const std::vector<FaceNode<dim>> &other, const Vec<dim> &normal,
                                                   double near, std::string &complaint) {
  const auto across = [&](const Vec<dim> &x) {
    Vec<dim> rest = x;
    add_scaled<dim>(rest, -dot<dim>(x, normal), normal);
    return rest;
  };
  // sorted by the component across that differs most between places of a face; others are compared one by one
  int axis = 0;
  for (int d = 1; d < dim; ++d)
    if (std::abs(normal[d]) < std::abs(normal[axis])) axis = d;
  std::vector<std::pair<double, const FaceNode<dim> *>> sorted;
  for (const FaceNode<dim> &node : other) sorted.emplace_back(across(node.position)[axis], &node);
  std::sort(sorted.begin(), sorted.end(), [](const auto &a, const auto &b) {
    return a.first != b.first ? a.first < b.first : a.second->number < b.second->number;
  });
  std::vector<std::vector<long long>> pairs;
  for (const FaceNode<dim> &node : one) {
    const Vec<dim> x = across(node.position);
    const FaceNode<dim> *found = nullptr;
    double nearest = near;
    for (auto at = std::lower_bound(sorted.begin(), sorted.end(), x[axis] - near,
                                    [](const auto &a, double value) { return a.first < value; });
         at != sorted.end() && at->first <= x[axis] + near; ++at) {
      const double distance = (map<dim>(across(at->second->position)) - map<dim>(x)).norm();
      if (distance <= nearest) nearest = distance, found = at->second;
    }
    if (!found) {
      complaint = "has a node at " + text_of<dim>(node.position) + " without a partner opposite to it";
      return {};
    }
    pairs.push_back({node.number, found->number});
  }
  return pairs;
}

std::vector<std::vector<long long>> united(const std::vector<std::vector<long long>> &groups) {
  std::map<long long, long long> lower;  // of a node: itself or another one of its group
  const auto root = [&](long long i) {
    while (lower.at(i) != i) i = lower.at(i);
    return i;
  };
  for (const auto &group : groups)
    for (const long long number : group) lower.try_emplace(number, number);
  for (const auto &group : groups)
    for (const long long number : group) {
      const long long a = root(group[0]), b = root(number);
      lower[std::max(a, b)] = std::min(a, b);
    }
  std::map<long long, std::vector<long long>> members;
  for (const auto &[number, other] : lower) members[root(number)].push_back(number);
  std::vector<std::vector<long long>> all;
  for (auto &[first, list] : members) all.push_back(std::move(list));
  return all;
}

#define TALUS_LINKED_NODES(dim)                                                                        \
  template std::vector<FaceNode<dim>> nodes_of_planes<dim>(                                            \
      const BackgroundMesh<dim> &, const std::vector<Facet<dim>> &, Vec<dim> &, std::string &);        \
  template std::vector<std::vector<long long>> opposite_nodes<dim>(const std::vector<FaceNode<dim>> &, \
                                                                   const std::vector<FaceNode<dim>> &, \
                                                                   const Vec<dim> &, double, std::string &);
TALUS_LINKED_NODES(2)
TALUS_LINKED_NODES(3)

}  // namespace talus
