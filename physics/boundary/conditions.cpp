#include "physics/boundary/conditions.h"

#include <algorithm>

#include "base/local_numbers.h"
#include "base/room.h"
#include "physics/boundary/node_normals.h"
#include "physics/boundary/rigid_bodies.h"
#include "physics/boundary/soil_contact.h"
#include "physics/structures/structures_in_motion.h"
#include "scene/contact_source.h"
#include "scene/rigid_source.h"

namespace talus {

template <int dim>
Conditions<dim>::Conditions() = default;
template <int dim>
Conditions<dim> &Conditions<dim>::operator=(Conditions &&) noexcept = default;
template <int dim>
Conditions<dim>::~Conditions() = default;

template <int dim>
void Conditions<dim>::take_rigid_bodies(std::unique_ptr<RigidBodies<dim>> bodies) {
  rigid_ = std::move(bodies);
  work_.resize(sources_.size() + rigid_->sources().size(), 0);
}

template <int dim>
void Conditions<dim>::take_soil_contact(std::unique_ptr<SoilContact<dim>> contact) {
  contact_ = std::move(contact);
  work_.resize(work_.size() + contact_->sources().size(), 0);
}

template <int dim>
void Conditions<dim>::take_structures(std::unique_ptr<StructuresInMotion<dim>> structures) {
  structures_ = std::move(structures);
}

template <int dim>
void Conditions<dim>::add_structures(const FilledGrid<dim> &grid, const StressOf &stress, Vec<dim> *force) {
  structures_->add_force(grid, stress, force);
}

template <int dim>
PetscErrorCode Conditions<dim>::setup(const BackgroundMesh<dim> &mesh, std::vector<Source> sources) {
  PetscFunctionBeginUser;
  sources_ = std::move(sources);
  impulse_.assign(sources_.size(), Vec<dim>{});
  work_.assign(sources_.size(), 0);
  prescribed_.setup(mesh.node_count(), sources_);
  bases_.setup(mesh.node_count(), sources_);
  std::vector<SourceFacets<dim>> faces;
  for (int s = 0; s < static_cast<int>(sources_.size()); ++s) {
    const Boundary &kind = sources_[s].kind;
    if (kind.fluids_only()) continue;
    std::vector<Facet<dim>> facets;
    for (const std::string &group : sources_[s].groups) {
      const auto more = mesh.facets(group);
      facets.insert(facets.end(), more.begin(), more.end());
    }
    if (kind.in_motion == OnSoil::load) {
      surface_loads_.add_face(s, kind, std::move(facets));
    } else {
      if (kind.in_motion == OnSoil::dashpot && !kind.has_column) dashpots_.push_back({s, -1, facets});
      if (kind.in_motion == OnSoil::contact) bases_.add_facets(s, facets);
      faces.push_back({s, std::move(facets)});
    }
  }
  columns_ = find_columns<dim>(mesh, sources_), column_nodes_.resize(columns_.size());
  std::vector<int> met(sources_.size(), 0);
  std::size_t links = 0;
  for (int c = 0; c < static_cast<int>(columns_.size()); ++c) {
    const int s = columns_[c].source;
    dashpots_.push_back({s, c, mesh.facets(sources_[s].groups[met[s]++])});
    column_nodes_[c].reserve(columns_[c].nodes.size()), links += columns_[c].links.nodes().size();
  }
  pulls_.reserve(links);
  std::vector<NodeNormal<dim>> normals;
  PetscCall(find_node_normals(mesh, faces, normals));
  // the order must not depend on the partition, so that all ranks build the same constraints
  std::stable_sort(normals.begin(), normals.end(), [&](const NodeNormal<dim> &a, const NodeNormal<dim> &b) {
    const auto key = [&](const NodeNormal<dim> &n) {
      return std::make_tuple(sources_[n.source].kind.precedence, n.source, n.normal, n.area);
    };
    return key(a) < key(b);
  });
  for (const NodeNormal<dim> &n : normals) {
    if (sources_[n.source].kind.in_motion == OnSoil::contact) bases_.add_contact(n.node, n.source, n.normal, n.area);
    prescribed_.add(n.node, n.source, n.normal);
  }
  size_t reactions = dim * prescribed_.reserve() + bases_.finish_setup();
  for (const DashpotFace &face : dashpots_) reactions += dim * face.facets.size();
  impulses_.reserve(reactions);
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode Conditions<dim>::begin(FilledGrid<dim> &grid, const std::vector<std::array<double, 2>> &impedance,
                                      const std::vector<double> &filling) {
  PetscFunctionBeginUser;
  const BackgroundMesh<dim> &mesh = grid.mesh();
  const int nodes = grid.node_count();
  active_dashpots_.clear(), active_frozen_.clear(), impulses_.clear(), pulls_.clear();
  first_dashpot_.assign(columns_.size() + 1, 0);
  counted_.resize(nodes);
  for (int i = 0; i < nodes; ++i) counted_[i] = mesh.counted[grid.mesh_node[i]];
  prescribed_.begin(grid, stand_ins_);
  for (const Reaction &r : frozen_)
    if (!stand_ins_ && grid.find_node(r.node) >= 0)
      active_frozen_.push_back({grid.find_node(r.node), r.source, r.value});
  PetscCall(bases_.begin(grid, filling));
  if (rigid_) PetscCall(rigid_->search(grid));
  if (structures_) structures_->begin(grid);
  if (!dashpots_.empty()) {
    constexpr int width = dim * dim;
    for (const auto &[source, column, facets] : dashpots_) {
      if (column >= 0) first_dashpot_[column] = static_cast<int>(active_dashpots_.size());
      if (stand_ins_ && sources_[source].kind.stands_in()) continue;
      const auto &dashpot = sources_[source].kind.template on_soil<dim>().dashpot;
      zeros_with_room(nodal_, static_cast<size_t>(nodes) * width);
      for (const Facet<dim> &f : facets) {
        const int cell = grid.find_cell(f.cell);
        if (cell < 0) continue;
        const Square<dim> matrix = dashpot(impedance[cell], f.normal);
        for (int node : f.node)
          for (int i = 0; i < dim; ++i)
            for (int j = 0; j < dim; ++j)
              nodal_[grid.find_node(node) * width + i * dim + j] += f.area / dim * matrix(i, j);
      }
      PetscCall(grid.sum(nodal_.data(), width));
      for (int i = 0; i < nodes; ++i) {
        const Square<dim> matrix = Eigen::Map<const Square<dim>>(&nodal_[i * width]);
        const Vec<dim> beyond = sources_[source].kind.incoming_wave ? ground_velocity_ : Vec<dim>{};
        if (matrix.trace() > 0) active_dashpots_.push_back({i, source, matrix, beyond});
      }
    }
  }
  const int dashpots = static_cast<int>(active_dashpots_.size());
  first_dashpot_.back() = dashpots;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (stand_ins_) first_dashpot_[c] = dashpots;
    const auto compact = [&](int node) { return grid.find_node(node); };
    columns_[c].links.find_places(compact), column_nodes_[c].clear();
    for (const int node : columns_[c].nodes)
      if (compact(node) >= 0) column_nodes_[c].push_back(compact(node));
  }
  PetscFunctionReturn(0);
}

/// How the other ends of dashpots move: as the ground in an earthquake, and at columns as these. Collective.
template <int dim>
void Conditions<dim>::see_columns(const Vec<dim> *v) {
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    zeros_with_room(nodal_, counted_.size() * dim);
    for (const int i : column_nodes_[c]) std::copy_n(v[i].begin(), dim, &nodal_[static_cast<std::size_t>(i) * dim]);
    (void)columns_[c].links.sum(nodal_.data(), dim);
    for (int k = first_dashpot_[c]; k < first_dashpot_[c + 1]; ++k)
      std::copy_n(&nodal_[static_cast<std::size_t>(active_dashpots_[k].node) * dim], dim,
                  active_dashpots_[k].beyond.begin());
  }
}

template <int dim>
PetscErrorCode Conditions<dim>::add_columns(FilledGrid<dim> &grid, const Traction &traction, Vec<dim> *force) {
  PetscFunctionBeginUser;
  pulls_.clear();
  for (SideColumn<dim> &column : columns_) {
    zeros_with_room(nodal_, counted_.size() * dim);
    for (const Facet<dim> &f : column.facets) {
      const int cell = grid.find_cell(f.cell);
      if (cell < 0) continue;
      const Vec<dim> on_column = traction(cell, f.normal);  // the side pulls back
      for (const int node : f.node)
        for (int d = 0; d < dim; ++d) nodal_[grid.find_node(node) * dim + d] -= f.area / dim * on_column[d];
    }
    PetscCall(grid.sum(nodal_.data(), dim));
    PetscCall(column.links.sum(nodal_.data(), dim));
    for (const int node : column.beside) {
      const int i = grid.find_node(node);
      if (i < 0) continue;
      Reaction pull{i, column.source, {}};
      std::copy_n(&nodal_[static_cast<std::size_t>(i) * dim], dim, pull.value.begin());
      add_scaled<dim>(force[i], 1, pull.value);
      pulls_.push_back(pull);
    }
  }
  PetscFunctionReturn(0);
}

template <int dim>
void Conditions<dim>::freeze_reactions(const FilledGrid<dim> &grid, const Vec<dim> *force) {
  frozen_.clear();
  for (const ActivePrescribed &p : prescribed_.active())
    for (int k = 0; k < p.condition->count; ++k) {
      const int source = p.condition->source[k];
      if (!sources_[source].kind.stands_in()) continue;
      if (sources_[source].kind.has_column) {  // a column pulls along the side too: what nobody bears balances it
        Reaction rest{grid.mesh_node[p.node], source, {}};
        add_scaled<dim>(rest.value, -1, force[p.node]), p.condition->take_from(rest.value);
        frozen_.push_back(rest);
      }
      Reaction r{grid.mesh_node[p.node], source, {}};
      add_scaled<dim>(r.value, -dot<dim>(force[p.node], p.condition->direction[k]), p.condition->direction[k]);
      frozen_.push_back(r);
    }
}

template <int dim>
void Conditions<dim>::add_reactions(Vec<dim> *force) const {
  for (const Reaction &r : active_frozen_) add_scaled<dim>(force[r.node], 1, r.value);
}

template <int dim>
void Conditions<dim>::add_work(const FilledGrid<dim> &grid, const Vec<dim> *u) {
  for (const Reaction &r : impulses_) work_[r.source] += dot<dim>(r.value, u[r.node]) / resolved_step_;
  for (const auto *held : {&active_frozen_, &pulls_})
    for (const Reaction &r : *held)
      if (counted_[r.node]) work_[r.source] += dot<dim>(r.value, u[r.node]);
  surface_loads_.add_work(u, work_);
  bases_.add_slip(u);
  if (rigid_) rigid_->advance(u, &work_[sources_.size()]);
  if (contact_) contact_->add_work(u, &work_[work_.size() - contact_->sources().size()]);
  if (structures_) structures_->advance(grid, u, resolved_step_);
}

template <int dim>
void Conditions<dim>::constrain(double t, const FilledGrid<dim> &grid, Vec<dim> *v, bool sticking) {
  bases_.constrain(t, grid, prescribed_, v, sticking);
  for (const ActivePrescribed &p : prescribed_.active()) prescribed_.impose(p, t, grid.position[p.node], v[p.node]);
}

template <int dim>
void Conditions<dim>::follow_contacts(Vec<dim> *w) const {
  if (rigid_) rigid_->follow(w);
  if (contact_) contact_->follow(w);
}

template <int dim>
void Conditions<dim>::join_bonded(Vec<dim> *v) const {
  if (contact_) contact_->join_bonded(v);
}

template <int dim>
void Conditions<dim>::project(const Vec<dim> *v, Vec<dim> *force) {
  if (contact_) contact_->project(v, force);
  see_columns(v);
  for (const Dashpot &d : active_dashpots_)
    map<dim>(force[d.node]) -= d.matrix * (map<dim>(v[d.node]) - map<dim>(d.beyond));
  bases_.project(prescribed_, v, force);
  if (rigid_) rigid_->project(v, force);
  for (const ActivePrescribed &p : prescribed_.active()) p.condition->take_from(force[p.node]);
}

template <int dim>
void Conditions<dim>::foresee(double t, double gamma, const FilledGrid<dim> &grid, Vec<dim> *v, const Pores &pores) {
  for (const Dashpot &d : active_dashpots_) damp(d, gamma, pores.mass(grid, d.node), v[d.node]);
  constrain(t, grid, v, true);
}

template <int dim>
PetscErrorCode Conditions<dim>::resolve(double t, double gamma, const FilledGrid<dim> &grid, Vec<dim> *v,
                                        const Pores &pores) {
  PetscFunctionBeginUser;
  const auto account = [&](int node, int source, const Vec<dim> &change) {
    if (!counted_[node]) return;
    Reaction r{node, source, {}};
    map<dim>(r.value) = pores.mass(grid, node) * map<dim>(change);
    for (int d = 0; d < dim; ++d) impulse_[source][d] += r.value[d];
    impulses_.push_back(r);
  };
  const auto difference = [](const Vec<dim> &after, Vec<dim> before) {
    for (int d = 0; d < dim; ++d) before[d] = after[d] - before[d];
    return before;
  };
  impulses_.clear(), resolved_step_ = gamma;
  if (contact_) contact_->resolve({t, gamma, grid, prescribed_, bases_}, v);
  const auto damp_and_account = [&](const Dashpot &d) {
    const Vec<dim> before = v[d.node];
    damp(d, gamma, pores.mass(grid, d.node), v[d.node]);
    account(d.node, d.source, difference(v[d.node], before));
  };
  const auto beside_columns =
      active_dashpots_.begin() + (columns_.empty() ? active_dashpots_.size() : first_dashpot_[0]);
  std::for_each(active_dashpots_.begin(), beside_columns, damp_and_account);
  see_columns(v);  // which dashpots below them have slowed
  std::for_each(beside_columns, active_dashpots_.end(), damp_and_account);
  bases_.resolve(t, gamma, grid, prescribed_, pores, v);
  for (const auto &c : bases_.active()) account(c.node, c.contact->source, c.change);
  for (const ActivePrescribed &p : prescribed_.active())
    for (int k = 0; k < p.condition->count; ++k) {
      const Vec<dim> &direction = p.condition->direction[k];
      Vec<dim> before = v[p.node];
      prescribed_.impose(p, k, t, grid.position[p.node], v[p.node]);
      add_scaled<dim>(before, -dot<dim>(p.change, direction), direction);
      account(p.node, p.condition->source[k], difference(v[p.node], before));
    }
  if (rigid_) PetscCall(rigid_->resolve({t, gamma, grid, prescribed_, bases_}, v));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode Conditions<dim>::take_impulses(MPI_Comm comm, std::vector<Vec<dim>> &impulse) {
  PetscFunctionBeginUser;
  impulse.resize(impulse_.size());
  if (!impulse_.empty())
    PetscCallMPI(MPI_Allreduce(impulse_.data(), impulse.data(), static_cast<int>(impulse_.size()) * dim, MPI_DOUBLE,
                               MPI_SUM, comm));
  std::fill(impulse_.begin(), impulse_.end(), Vec<dim>{});
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode Conditions<dim>::serialize(Archive &archive, FilledGrid<dim> &grid,
                                          const std::vector<std::array<double, 2>> &impedance,
                                          const std::vector<double> &filling) {
  PetscFunctionBeginUser;
  const BackgroundMesh<dim> &mesh = grid.mesh();
  archive.serialize("supports", stand_ins_);
  std::vector<long long> nodes;
  for (const Reaction &r : frozen_) nodes.push_back(mesh.global_node[r.node]);
  archive.column(archive.rows("nodes of reactions", Belongs::to_points, nodes), "reactions", frozen_);
  if (archive.reading()) {
    frozen_.resize(nodes.size());
    const LocalNumbers node_of(mesh.global_node);
    for (size_t k = 0; k < nodes.size(); ++k) frozen_[k].node = node_of(nodes[k]);
    if (structures_) structures_->resume_part();
    PetscCall(begin(grid, impedance, filling));
  }
  archive.sums("boundaries", impulse_, work_);
  bases_.serialize(archive, grid);
  if (rigid_) rigid_->serialize(archive, grid);
  if (contact_) contact_->serialize(archive, grid);
  PetscFunctionReturn(0);
}

template class Conditions<2>;
template class Conditions<3>;

}  // namespace talus
