#pragma once
/// The particles of one soil, in a DMSwarm of their own. So a law runs over one array without looking at body numbers,
/// and a body has the history fields of its own law only.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "base/archive.h"
#include "base/owned.h"
#include "base/vec.h"
#include "meshes/background_mesh.h"
#include "physics/laws/lanes.h"
#include "physics/laws/law.h"
#include "physics/laws/stress.h"
#include "scene/function.h"

namespace talus {

struct BodySource;

/// The piece of a loaded face that a particle carries (physics/boundary/surface_loads.h).
template <int dim>
struct SurfacePiece {
  Vec<dim> offset{};  ///< from the particle to the piece [m]
  Vec<dim> normal{};  ///< mean normal at the last remap, out of the soil; shorter than 1 where the piece goes around a
                      ///< corner
  Vec<dim> place{};   ///< undeformed place [m]
  double area = 0;    ///< undeformed area [m2]; 0: the particle carries nothing
};

/// A field of a body's swarm, which one writes to through what is not const only.
template <class T>
class FieldArray {
 public:
  FieldArray() = default;
  explicit FieldArray(void *values) : values_(static_cast<T *>(values)) {}
  T &operator[](std::ptrdiff_t i) { return values_[i]; }
  const T &operator[](std::ptrdiff_t i) const { return values_[i]; }
  operator T *() { return values_; }
  operator const T *() const { return values_; }
  T *data() { return values_; }
  const T *data() const { return values_; }

 private:
  T *values_ = nullptr;
};

/// The arrays of a body's swarm fields, valid until particles are added, removed or migrated. One entry per local
/// particle.
template <int dim>
struct ParticleArrays {
  int count = 0;
  FieldArray<Vec<dim>> position;   ///< at the last remap [m]
  FieldArray<Vec<dim>> velocity;   ///< at the last remap [m/s]
  FieldArray<Vec<dim>> reference;  ///< where displacement is counted from [m]
  FieldArray<double> mass;  ///< [kg], in 2D per metre of thickness; of the grains alone where fluids move on their own
  FieldArray<double> volume;                          ///< V_p [m3]
  FieldArray<double> initial_volume;                  ///< V_p0 [m3]
  FieldArray<double> rest_volume;                     ///< without stress, gaps and dilation [m3], theory (3.9)
  FieldArray<double> stress;                          ///< [stress_size] Cauchy effective stress [Pa]
  FieldArray<double> history;                         ///< [history_size(law)] internal variables of the law
  FieldArray<double> cohesion_share, friction_share;  ///< of the law's c and phi [-]; null where the law reads none
  FieldArray<double> fluid_mass[2];        ///< of liquid and gas in the pores [kg]; null where the phase model has none
  FieldArray<Vec<dim>> fluid_velocity[2];  ///< their velocities [m/s]; null likewise
  FieldArray<SurfacePiece<dim>> surface;   ///< [loaded faces] pieces of them; null when the scene has none
  FieldArray<PetscInt> cell;               ///< local cell
  FieldArray<PetscInt> id;                 ///< number that does not depend on the partition
};

/// Least volume of a particle whose volume is capped, as a share of its rest volume: 1/e, theory (3.9).
inline constexpr double smallest_volume_share = 0.36787944117144233;

template <int dim>
class Body {
 public:
  /// Registers the fields; `fluids` is 0, 1 (the liquid) or 2 (liquid and gas), `faces` the number of loaded faces.
  PetscErrorCode create(MPI_Comm comm, const BodySource &source, Law law, int fluids, int faces);
  /// Makes room for `count` particles. The first ones keep their values, new ones have none yet.
  PetscErrorCode resize(PetscInt count);

  const BodySource &source() const { return *source_; }
  const std::string &name() const;
  double grain_density() const;     ///< [kg/m3]
  double averaging_length() const;  ///< of plastic strain [m]; 0: none
  const Law &law() const { return law_; }
  int history_count() const { return history_count_; }
  /// The volume closest to `volume` that a point of this rest volume may have [m3], theory (3.9): at most the cap times
  /// e^(dilation), (3.10), and at least 1/e of the rest volume.
  double admissible_volume(double volume, double rest, const double *history) const {
    if (!capped()) return volume;
    const double largest = volume_cap_ * volume_without_gaps(rest, history);
    return std::min(std::max(volume, smallest_volume_share * rest), largest);
  }
  /// The largest volume of a point in which no gaps have opened, uncompressed [m3].
  double volume_without_gaps(double rest, const double *history) const { return rest * expansion(history); }
  /// Lets particle i, whose stress was set, have no gaps as it is: its volume is what the stress makes of its rest
  /// volume.
  void refer_to_stress(int i);
  /// Index of dilation among the history of the law, -1 where it has none.
  int dilation_field() const { return dilation_field_; }
  /// Is the volume of a particle limited?
  bool capped() const { return volume_cap_ != std::numeric_limits<double>::infinity(); }
  const ParticleArrays<dim> &particles() const { return arrays_; }
  ParticleArrays<dim> &particles() { return arrays_; }

  /// Orders the particles by cell, so that those of one cell are neighbours in memory.
  PetscErrorCode sort(int cell_count);
  /// Takes out the particles `which` (ascending); the others keep their order. For this rank alone.
  PetscErrorCode remove(const std::vector<int> &which);
  /// Sends each leaver (particle, neighbour of the mesh) away, particles ascending; collective, also for ranks without
  /// leavers. The last particles take the places of those that left, and the arrived ones come behind:
  /// `first_arrival` is the index of the first.
  PetscErrorCode migrate(const BackgroundMesh<dim> &mesh, const std::vector<std::pair<int, int>> &leavers,
                         int *first_arrival);
  /// All particles of this rank, with every field that is registered, as rows of their cells.
  PetscErrorCode serialize(Archive &archive, const BackgroundMesh<dim> &mesh);

 private:
  /// Ratio of volumes by dilation, theory (3.10): not by the gaps that open.
  double expansion(const double *history) const {
    if (dilation_field_ < 0) return 1;
    const double volume_strain = history[dilation_field_];
    return volume_strain > 0 ? exponential(volume_strain) : 1;
  }
  PetscErrorCode borrow();     ///< takes the arrays from the swarm
  PetscErrorCode give_back();  ///< returns them to the swarm, which every change of its size requires
  void rearrange();            ///< particle p goes to order_[p]
  /// Calls f(array, bytes of a particle) for each field.
  template <class F>
  void each_field(F &&f);

  const BodySource *source_ = nullptr;
  Law law_;
  int history_count_ = 0, dilation_field_ = -1, fluids_ = 0, face_count_ = 0;
  double volume_cap_ = 0;
  bool borrowed_ = false;
  PetscInt room_ = 0;  ///< particles for which the swarm has memory
  Dm swarm_;
  ParticleArrays<dim> arrays_;
  std::vector<int> start_, order_;
  std::vector<char> scratch_;
};

/// Particles in a cell of the body where no box asks for others.
template <int dim>
int particles_per_cell(const BodySource &source);

/// Fills `body` with particles on barycentric lattices in the cells of its regions: equal volumes that add up to the
/// cell's, mass from density, initial velocity, displacement and stress from the scene. `mass_density(x)` is the total
/// density at a place. Throws std::invalid_argument for an empty region or a number of particles that has no lattice.
template <int dim>
void seed(Body<dim> &body, const BackgroundMesh<dim> &mesh, int id_stride,
          const std::function<double(const Vec<dim> &)> &density);

/// Deformation gradient of an initial displacement at an undeformed place, by central differences over `h` [m].
template <int dim>
Square<dim> displacement_gradient(const std::vector<Function> &displacement, const Vec<dim> &x, double h);

/// Barycentric coordinates of the lattice of n points in a simplex; empty when there is none.
template <int dim>
std::vector<std::array<double, dim + 1>> lattice(int n);

}  // namespace talus
