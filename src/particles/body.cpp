#include "particles/body.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "base/local_numbers.h"
#include "meshes/exchange.h"
#include "scene/body_source.h"

namespace talus {
namespace {

struct FieldSpec {
  const char *name;
  int components;
  PetscDataType type;
};
constexpr const char *fluid_mass[] = {"liquid_mass", "gas_mass"},
                     *fluid_velocity[] = {"liquid_velocity", "gas_velocity"};

template <int dim>
std::vector<FieldSpec> field_specs(const Law &law, int fluids, int faces) {
  std::vector<FieldSpec> specs{{"position", dim, PETSC_DOUBLE},  {"velocity", dim, PETSC_DOUBLE},
                               {"reference", dim, PETSC_DOUBLE}, {"mass", 1, PETSC_DOUBLE},
                               {"volume", 1, PETSC_DOUBLE},      {"initial_volume", 1, PETSC_DOUBLE},
                               {"rest_volume", 1, PETSC_DOUBLE}, {"stress", stress_size<dim>, PETSC_DOUBLE},
                               {"cell", 1, PETSC_INT},           {"id", 1, PETSC_INT}};
  if (history_size(law)) specs.push_back({"history", history_size(law), PETSC_DOUBLE});
  if (reads_shares(law))
    specs.push_back({"cohesion_share", 1, PETSC_DOUBLE}), specs.push_back({"friction_share", 1, PETSC_DOUBLE});
  for (int a = 0; a < fluids; ++a)
    specs.push_back({fluid_mass[a], 1, PETSC_DOUBLE}), specs.push_back({fluid_velocity[a], dim, PETSC_DOUBLE});
  if (faces)
    specs.push_back({"surface", faces * static_cast<int>(sizeof(SurfacePiece<dim>) / sizeof(double)), PETSC_DOUBLE});
  return specs;
}

}  // namespace

template <int dim>
void Body<dim>::refer_to_stress(int i) {
  const double *stress = &arrays_.stress[i * stress_size<dim>];
  const double pressure = -(stress[0] + stress[1] + stress[2]) / 3;
  double &rest = arrays_.rest_volume[i];
  rest = arrays_.volume[i];
  if (!comes_apart(law_)) return;
  if (history_count_ > 0) rest /= expansion(arrays_.history + i * history_count_);
  if (pressure > 0) rest *= std::exp(pressure / bulk_modulus(law_));
}

template <int dim>
PetscErrorCode Body<dim>::create(MPI_Comm comm, const BodySource &source, Law law, int fluids, int faces) {
  PetscFunctionBeginUser;
  source_ = &source, law_ = std::move(law), history_count_ = history_size(law_), fluids_ = fluids, face_count_ = faces;
  // where fluids move pressure follows volume: a cap would pump it up, pores.md section 4
  const bool capped = source.volume_cap > 0 || (source.volume_cap < 0 && fluids == 0 && comes_apart(law_));
  volume_cap_ = !capped ? std::numeric_limits<double>::infinity() : source.volume_cap > 0 ? source.volume_cap : 1;
  dilation_field_ = history_field(law_, field_of_dilation.name);
  PetscCall(DMCreate(comm, swarm_.create()));
  PetscCall(DMSetType(swarm_, DMSWARM));
  PetscCall(DMSetDimension(swarm_, dim));
  PetscCall(DMSwarmSetType(swarm_, DMSWARM_BASIC));
  PetscCall(DMSwarmInitializeFieldRegister(swarm_));
  for (const FieldSpec &f : field_specs<dim>(law_, fluids, faces))
    PetscCall(DMSwarmRegisterPetscDatatypeField(swarm_, f.name, f.components, f.type));
  PetscCall(DMSwarmFinalizeFieldRegister(swarm_));
  PetscFunctionReturn(0);
}

/// A swarm zeroes all its spare memory at each change of its size, and may copy all particles where it has none left.
template <int dim>
PetscErrorCode Body<dim>::resize(PetscInt count) {
  PetscFunctionBeginUser;
  const PetscInt spare = 64 + count / 64;
  if (count > room_ || room_ - count > 2 * spare) room_ = count + spare;
  PetscCall(give_back());
  PetscCall(DMSwarmSetLocalSizes(swarm_, count, room_ - count));
  PetscCall(borrow());
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode Body<dim>::borrow() {
  PetscFunctionBeginUser;
  PetscInt count;
  PetscCall(DMSwarmGetLocalSize(swarm_, &count));
  const auto take = [&]<class T>(const char *name, FieldArray<T> &array) -> PetscErrorCode {
    void *values;
    PetscFunctionBeginUser;
    PetscCall(DMSwarmGetField(swarm_, name, nullptr, nullptr, &values));
    array = FieldArray<T>(values);
    PetscFunctionReturn(0);
  };
  arrays_ = {};
  arrays_.count = count;
  PetscCall(take("position", arrays_.position));
  PetscCall(take("velocity", arrays_.velocity));
  PetscCall(take("reference", arrays_.reference));
  PetscCall(take("mass", arrays_.mass));
  PetscCall(take("volume", arrays_.volume));
  PetscCall(take("initial_volume", arrays_.initial_volume));
  PetscCall(take("rest_volume", arrays_.rest_volume));
  PetscCall(take("stress", arrays_.stress));
  PetscCall(take("cell", arrays_.cell));
  PetscCall(take("id", arrays_.id));
  if (reads_shares(law_)) {
    PetscCall(take("cohesion_share", arrays_.cohesion_share));
    PetscCall(take("friction_share", arrays_.friction_share));
  }
  if (history_count_) PetscCall(take("history", arrays_.history));
  for (int a = 0; a < fluids_; ++a) {
    PetscCall(take(fluid_mass[a], arrays_.fluid_mass[a]));
    PetscCall(take(fluid_velocity[a], arrays_.fluid_velocity[a]));
  }
  if (face_count_) PetscCall(take("surface", arrays_.surface));
  borrowed_ = true;
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode Body<dim>::give_back() {
  PetscFunctionBeginUser;
  if (!borrowed_) PetscFunctionReturn(0);
  for (const FieldSpec &f : field_specs<dim>(law_, fluids_, face_count_)) {
    void *array = nullptr;
    PetscCall(DMSwarmRestoreField(swarm_, f.name, nullptr, nullptr, &array));
  }
  borrowed_ = false;
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode Body<dim>::sort(int cell_count) {
  PetscFunctionBeginUser;
  const int count = arrays_.count;
  if (count == 0) PetscFunctionReturn(0);
  const auto [low, high] = std::minmax_element(arrays_.cell.data(), arrays_.cell.data() + count);
  const int first = *low, cells = *high - first + 1;
  start_.reserve(cell_count + 1), start_.assign(cells + 1, 0), order_.resize(count);
  for (int p = 0; p < count; ++p) ++start_[arrays_.cell[p] - first + 1];
  for (int c = 0; c < cells; ++c) start_[c + 1] += start_[c];
  for (int p = 0; p < count; ++p)
    order_[p] = start_[arrays_.cell[p] - first]++;  // counting sort: stable, so results repeat
  rearrange();
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode Body<dim>::remove(const std::vector<int> &which) {
  PetscFunctionBeginUser;
  const int count = arrays_.count, kept = count - static_cast<int>(which.size());
  order_.resize(count);
  int gone = 0;
  for (int p = 0; p < count; ++p) {
    const bool goes = gone < static_cast<int>(which.size()) && which[gone] == p;
    order_[p] = goes ? kept + gone++ : p - gone;
  }
  rearrange();
  PetscCall(resize(kept));
  PetscFunctionReturn(0);
}

template <int dim>
template <class F>
void Body<dim>::each_field(F &&f) {
  const auto visit = [&f](void *array, size_t bytes) {
    if (array && bytes) f(static_cast<char *>(array), bytes);
  };
  visit(arrays_.position, sizeof(Vec<dim>));
  visit(arrays_.velocity, sizeof(Vec<dim>));
  visit(arrays_.reference, sizeof(Vec<dim>));
  visit(arrays_.mass, sizeof(double));
  visit(arrays_.volume, sizeof(double));
  visit(arrays_.initial_volume, sizeof(double));
  visit(arrays_.rest_volume, sizeof(double));
  visit(arrays_.stress, sizeof(double) * stress_size<dim>);
  visit(arrays_.history, sizeof(double) * history_count_);
  visit(arrays_.cohesion_share, sizeof(double));
  visit(arrays_.friction_share, sizeof(double));
  for (int a = 0; a < fluids_; ++a)
    visit(arrays_.fluid_mass[a], sizeof(double)), visit(arrays_.fluid_velocity[a], sizeof(Vec<dim>));
  visit(arrays_.surface, sizeof(SurfacePiece<dim>) * face_count_);
  visit(arrays_.cell, sizeof(PetscInt));
  visit(arrays_.id, sizeof(PetscInt));
}

template <int dim>
void Body<dim>::rearrange() {
  const int count = arrays_.count;
  each_field([&](char *array, size_t bytes) {
    scratch_.resize(std::max(scratch_.size(), bytes * count));
    for (int p = 0; p < count; ++p) std::memcpy(&scratch_[bytes * order_[p]], array + bytes * p, bytes);
    std::memcpy(array, scratch_.data(), bytes * count);
  });
}

/// Not DMSwarmMigrate: it looks for the leavers among all particles several times, and took a twentieth of the time of
/// two ranks.
template <int dim>
PetscErrorCode Body<dim>::migrate(const BackgroundMesh<dim> &mesh, const std::vector<std::pair<int, int>> &leavers,
                                  int *first_arrival) {
  PetscFunctionBeginUser;
  const std::vector<int> &ranks = mesh.halo.neighbours();
  std::vector<std::vector<char>> sent(ranks.size());
  for (const auto &[particle, rank] : leavers) {
    std::vector<char> &rows = sent[std::ranges::lower_bound(ranks, rank) - ranks.begin()];
    each_field([&rows, p = particle](const char *array, size_t bytes) {
      rows.insert(rows.end(), array + bytes * p, array + bytes * (p + 1));
    });
  }
  const std::vector<std::vector<char>> arrived = exchange(mesh.comm(), ranks, sent);
  int count = arrays_.count;
  for (auto leaver = leavers.rbegin(); leaver != leavers.rend(); ++leaver) {
    --count;
    each_field([p = leaver->first, last = count](char *array, size_t bytes) {
      if (p != last) std::memcpy(array + bytes * p, array + bytes * last, bytes);
    });
  }
  size_t of_particle = 0, bytes_arrived = 0;
  each_field([&of_particle](char *, size_t bytes) { of_particle += bytes; });
  for (const auto &rows : arrived) bytes_arrived += rows.size();
  *first_arrival = count;
  PetscCall(resize(count + static_cast<PetscInt>(bytes_arrived / of_particle)));
  for (const auto &rows : arrived)
    for (const char *row = rows.data(); row != rows.data() + rows.size(); ++count)
      each_field(
          [&row, p = count](char *array, size_t bytes) { std::memcpy(array + bytes * p, row, bytes), row += bytes; });
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode Body<dim>::serialize(Archive &archive, const BackgroundMesh<dim> &mesh) {
  PetscFunctionBeginUser;
  std::vector<long long> cells;
  for (int i = 0; i < arrays_.count; ++i) cells.push_back(mesh.global_cell[arrays_.cell[i]]);
  const Archive::Rows particles = archive.rows("particles", Belongs::to_cells, cells);
  if (archive.reading()) {
    PetscCall(resize(static_cast<PetscInt>(cells.size())));
    const LocalNumbers cell_of(mesh.global_cell);
    for (int i = 0; i < arrays_.count; ++i)
      arrays_.cell[i] = i > 0 && cells[i] == cells[i - 1] ? arrays_.cell[i - 1] : cell_of(cells[i]);
  }
  PetscCall(give_back());
  for (const FieldSpec &f : field_specs<dim>(law_, fluids_, face_count_)) {
    if (std::string("cell") == f.name) continue;
    void *values;
    PetscCall(DMSwarmGetField(swarm_, f.name, nullptr, nullptr, &values));
    archive.column(particles, f.name, values, (f.type == PETSC_INT ? sizeof(PetscInt) : sizeof(double)) * f.components);
    PetscCall(DMSwarmRestoreField(swarm_, f.name, nullptr, nullptr, &values));
  }
  PetscCall(borrow());
  PetscFunctionReturn(0);
}

template <int dim>
const std::string &Body<dim>::name() const {
  return source_->name;
}
template <int dim>
double Body<dim>::grain_density() const {
  return source_->grain_density;
}
template <int dim>
double Body<dim>::averaging_length() const {
  return source_->averaging_length;
}

template class Body<2>;
template class Body<3>;

}  // namespace talus
