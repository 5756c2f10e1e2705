#pragma once
/// Ledger of the particles that left the mesh and were taken out of the simulation (mesh.leaving_particles = "remove").
#include <mpi.h>

#include <vector>

#include "base/archive.h"
#include "particles/body.h"

namespace talus {

/// Sums over all particles that have left, of all ranks; in 2D per metre of thickness.
struct EscapedSums {
  double particles = 0;    ///< their number
  double mass = 0;         ///< as particles have it: of the grains alone where fluids move on their own [kg]
  double fluid_mass[2]{};  ///< of liquid and gas in their pores, where these move on their own [kg]
  double momentum[3]{};    ///< of soil and fluids [kg m/s]
  double energy = 0;       ///< kinetic and elastic energy of the soil, as in the balance of energy [J]
};

/// A particle at the remap that found it outside.
template <int dim>
struct EscapedParticle {
  double time = 0;             ///< [s]
  long long id = 0, body = 0;  ///< its number, and that of its body
  long long group = -1;        ///< of faces by which it left, a number of BackgroundMesh::group_names; -1: no name
  double mass = 0;             ///< [kg]
  double fluid_mass[2]{};      ///< of liquid and gas [kg]
  Vec<dim> position{};         ///< at the boundary of the mesh where it left [m]
  Vec<dim> velocity{};         ///< of the soil [m/s]
  Vec<dim> momentum{};         ///< of soil and fluids [kg m/s]
};

template <int dim>
class EscapedParticles {
 public:
  /// Enters a particle of this rank, while the body still has it.
  void enter(const Body<dim> &body, int number, int particle, int group, double time);
  /// Adds what was entered since the last call, on any rank, to the sums, and returns it. Collective.
  EscapedSums settle(MPI_Comm comm);

  const EscapedSums &sums() const { return sums_; }
  const std::vector<EscapedParticle<dim>> &of_this_rank() const { return list_; }
  void serialize(Archive &archive) {
    archive.records("escaped particles", list_);
    archive.serialize("sums of escaped particles", sums_);
  }

 private:
  std::vector<EscapedParticle<dim>> list_;
  EscapedSums entered_;  ///< of this rank since the sums were last settled
  EscapedSums sums_;
};

}  // namespace talus
