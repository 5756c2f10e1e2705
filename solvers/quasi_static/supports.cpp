#include "solvers/quasi_static/supports.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "base/gather.h"

namespace talus {
namespace {

template <int dim>
struct Wanted {
  int priority, source;
  PetscInt global;
  Vec<dim> direction;
  auto key() const { return std::make_tuple(global, priority, source, direction); }
};

/// Completes the prescribed directions to a frame. Where they are axes, the frame is the identity.
template <int dim>
void make_frame(Support<dim> &s) {
  s.frame.setIdentity(), s.held.fill(0), s.turned = false;
  bool axes = true;
  for (int k = 0; k < s.count; ++k) {
    int axis = 0;
    map<dim>(s.direction[k]).cwiseAbs().maxCoeff(&axis);
    if (std::abs(s.direction[k][axis]) < 1 - 1e-14)
      axes = false;
    else
      s.held[axis] = 1;
  }
  if (axes || s.count == dim) {
    if (s.count == dim) s.held.fill(1);
    return;
  }
  s.turned = true, s.held.fill(0);
  int rows = 0;
  const auto add = [&](ColumnVector<dim> v) {
    for (int r = 0; r < rows; ++r) v -= v.dot(s.frame.row(r)) * s.frame.row(r).transpose();
    if (rows < dim && v.norm() > 0.3) s.frame.row(rows++) = v.normalized().transpose();
  };
  for (int k = 0; k < s.count; ++k) add(map<dim>(s.direction[k])), s.held[k] = 1;
  for (int d = 0; d < dim; ++d) add(ColumnVector<dim>::Unit(d));
}

}  // namespace

template <int dim>
PetscErrorCode Supports<dim>::setup(const BackgroundMesh<dim> &mesh, const ElementNodes<dim> &nodes,
                                    const std::vector<char> &active, const std::vector<Source> &sources) {
  PetscFunctionBeginUser;
  sources_ = &sources, moves_ = false;
  std::vector<Wanted<dim>> all;
  for (int s = 0; s < static_cast<int>(sources.size()); ++s) {
    const Boundary &kind = sources[s].kind;
    if (kind.quasi_static != OnSoil::support) continue;
    for (const std::string &group : sources[s].groups)
      for (const Facet<dim> &facet : mesh.facets(group)) {
        if (!active[facet.cell]) continue;
        for (int node : nodes.of_facet(facet.cell, facet.face))
          for (const Vec<dim> &direction : kind.template on_soil<dim>().directions(facet.normal))
            all.push_back({kind.precedence, s, nodes.global()[node], direction});
      }
  }

  for (const Wanted<dim> &w : all) moves_ |= static_cast<bool>(sources[w.source].kind.template on_soil<dim>().speed);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &moves_, 1, MPI_CXX_BOOL, MPI_LOR, mesh.comm()));

  // a facet lies on one rank and its nodes may lie on others too, which are neighbours
  PetscCall(gather_from(mesh.comm(), mesh.halo.neighbours(), all));
  std::sort(all.begin(), all.end(), [](const Wanted<dim> &a, const Wanted<dim> &b) { return a.key() < b.key(); });

  std::map<PetscInt, int> local;
  for (int i = 0; i < nodes.count(); ++i) local[nodes.global()[i]] = i;
  of_node_.assign(nodes.count(), -1), supports_.clear();
  for (const Wanted<dim> &w : all) {
    const auto found = local.find(w.global);
    if (found == local.end()) continue;
    int &index = of_node_[found->second];
    if (index < 0) index = static_cast<int>(supports_.size()), supports_.push_back({});
    supports_[index].add(w.direction, w.source);
  }
  for (Support<dim> &s : supports_) make_frame(s);
  PetscFunctionReturn(0);
}

template <int dim>
Vec<dim> Supports<dim>::increment(int node, const Vec<dim> &x, double from, double to) const {
  Vec<dim> prescribed{}, in_frame{};
  const Support<dim> &s = *at(node);
  for (int k = 0; k < s.count; ++k) {
    const auto &speed = (*sources_)[s.source[k]].kind.template on_soil<dim>().speed;
    const double travel = speed ? speed(s.direction[k], x, (from + to) / 2) * (to - from) : 0;
    for (int d = 0; d < dim; ++d) prescribed[d] += travel * s.direction[k][d];
  }
  map<dim>(in_frame) = s.frame * map<dim>(prescribed);
  for (int d = 0; d < dim; ++d)
    if (!s.held[d]) in_frame[d] = 0;
  return in_frame;
}

template class Supports<2>;
template class Supports<3>;

}  // namespace talus
