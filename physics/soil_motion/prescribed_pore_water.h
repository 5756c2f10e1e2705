#pragma once
/// Pore water whose pressure the scene prescribes (phase model `drained`): its force on the skeleton, docs/theory (2.8)
/// and (2.9), its suction (2.10), and the mass that soil has gained since seeding because the water table moved past it
/// (section 3). The pressure is sampled at the nodes now and a few steps ahead; between the two samples it is linear in
/// time.
#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "base/archive.h"
#include "particles/body.h"
#include "physics/prescribed_pressure.h"
#include "physics/soil_motion/soil_state.h"

namespace talus {

template <int dim>
class PrescribedPoreWater {
 public:
  using Bodies = std::vector<std::unique_ptr<Body<dim>>>;

  /// The references must outlive it.
  PrescribedPoreWater(const BackgroundMesh<dim> &mesh, const Bodies &bodies, const PrescribedPressure<dim> &pressure);

  /// At a remap: measures the pore water and discards the samples. `time` is that of the scene's functions. Collective.
  PetscErrorCode begin(FilledGrid<dim> &grid, double time);
  /// At an accepted state: renews the samples once `time` has left them, and measures the pore water where the water
  /// table moves. `blend` [cell] is that of docs/theory (4.5). Collective.
  PetscErrorCode advance_to(double time, FilledGrid<dim> &grid, const double *blend);

  /// Adds the force of the pressure at `time`, times `ramp`, on the nodes of this rank [N]. With open water on
  /// submerged faces it is the body force -grad p, which contains the weight of the water on a face without knowing
  /// where the face is; otherwise the pressure is a part of the stress. So is, in any case, the difference that water
  /// of the soil's own makes: it may jump at the soil's border, across which total stress is continuous.
  void add_force(const FilledGrid<dim> &grid, const SoilState<dim> &state, double time, double ramp,
                 Vec<dim> *force) const;
  /// Suction at the stress points of a body [Pa].
  const double *suction(const FilledGrid<dim> &grid, const double *blend, const PointSet &points, double time,
                        double ramp);

  const PrescribedPressure<dim> &pressure() const { return pressure_; }
  /// Pore water gained since seeding, which weighs but is not inert [node] [kg].
  const std::vector<double> &extra_mass() const { return extra_mass_; }

  void serialize(Archive &archive, const FilledGrid<dim> &grid, const typename FilledGrid<dim>::Rows &rows);

 private:
  struct Sample {
    std::vector<Vec<dim>> gradient;      ///< [cell] [Pa/m]
    std::vector<Vec<dim>> body_force;    ///< [node] of this rank, with open water on submerged faces [N]
    std::vector<double> value, suction;  ///< [cell] [Pa]
    std::vector<double> nodal;           ///< [node] of the common water [Pa]
    std::vector<double> jump;            ///< [cell] how far the mean of the soil's own water is above it [Pa]
  };
  PetscErrorCode measure(FilledGrid<dim> &grid, double time);
  void find_body_force(const FilledGrid<dim> &grid, Sample &sample) const;
  void sample(double time, const FilledGrid<dim> &grid, const double *blend);
  std::array<double, 2> shares(double time, double ramp) const;

  const BackgroundMesh<dim> &mesh_;
  const Bodies &bodies_;
  const PrescribedPressure<dim> &pressure_;
  std::array<Sample, 2> sample_;
  double sample_time_[2] = {0, 0};
  double last_time_ = 0;          ///< of the last accepted state [s]
  bool table_moves_ = false;      ///< pores may have filled or dried since they were measured
  bool apart_ = false;            ///< some soil has water of its own
  bool suction_matters_ = false;  ///< a law reads it: pressure below zero is suction, not stress
  std::vector<double> extra_mass_;
  std::vector<double> suction_;  ///< room for the points of one body [Pa]
};

}  // namespace talus
