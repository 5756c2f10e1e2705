#include "meshes/halo.h"

#include <algorithm>
#include <map>
#include <utility>

namespace talus {
namespace {

constexpr int own = -1;
constexpr int tag = 17;

}  // namespace

Halo::Halo(MPI_Comm comm, std::vector<int> neighbour_ranks, std::vector<std::vector<int>> shared)
    : comm_(comm), neighbours_(std::move(neighbour_ranks)), shared_(std::move(shared)) {
  int rank;
  MPI_Comm_rank(comm_, &rank);
  std::map<int, std::vector<std::pair<int, int>>> sources;  // node -> (rank, record)
  first_.push_back(0);
  for (std::size_t k = 0; k < neighbours_.size(); ++k) {
    int record = first_.back();
    for (int node : shared_[k]) sources[node].emplace_back(neighbours_[k], record++);
    first_.push_back(record);
  }
  first_source_.push_back(0);
  for (auto &[node, from] : sources) {
    from.emplace_back(rank, own);
    std::sort(from.begin(), from.end());
    node_.push_back(node);
    for (const auto &one : from) source_.push_back(one.second);
    first_source_.push_back(static_cast<int>(source_.size()));
  }
  requests_.resize(2 * neighbours_.size());
}

PetscErrorCode Halo::sum(double *values, int width) {
  PetscFunctionBeginUser;
  if (neighbours_.empty()) PetscFunctionReturn(0);
  const std::size_t size = static_cast<std::size_t>(first_.back()) * width;
  if (sent_.size() < size) sent_.resize(size), received_.resize(size);
  const int count = static_cast<int>(neighbours_.size());
  for (int k = 0; k < count; ++k)
    PetscCallMPI(MPI_Irecv(&received_[first_[k] * width], (first_[k + 1] - first_[k]) * width, MPI_DOUBLE,
                           neighbours_[k], tag, comm_, &requests_[k]));
  for (int k = 0; k < count; ++k) {
    double *record = &sent_[first_[k] * width];
    for (int node : shared_[k]) record = std::copy_n(values + static_cast<std::size_t>(node) * width, width, record);
    PetscCallMPI(MPI_Isend(&sent_[first_[k] * width], (first_[k + 1] - first_[k]) * width, MPI_DOUBLE, neighbours_[k],
                           tag, comm_, &requests_[count + k]));
  }
  PetscCallMPI(MPI_Waitall(2 * count, requests_.data(), MPI_STATUSES_IGNORE));
  for (std::size_t i = 0; i < node_.size(); ++i) {
    double *here = values + static_cast<std::size_t>(node_[i]) * width;
    for (int k = 0; k < width; ++k) {
      double total = 0;
      for (int j = first_source_[i]; j < first_source_[i + 1]; ++j)
        total += source_[j] == own ? here[k] : received_[static_cast<std::size_t>(source_[j]) * width + k];
      here[k] = total;
    }
  }
  PetscFunctionReturn(0);
}

}  // namespace talus
