#pragma once
/// Adds up the energies of a run, and watches that its motion creates none. What it says does not depend on when
/// results are written.
#include <string>
#include <vector>

#include "simulation/clock.h"
#include "simulation/energy_sums.h"
#include "simulation/energy_watch.h"
#include "simulation/statics.h"

namespace talus {

template <int dim>
class EnergyLedger {
 public:
  /// The references must outlive it.
  EnergyLedger(World<dim> &world, const Clock &clock, Statics<dim> &statics)
      : world_(world), clock_(clock), statics_(statics) {}

  /// Of the present state. Collective.
  EnergySums sums();
  /// A dynamic stage begins, in which the watch looks anew.
  void begin_stage() { watch_.begin(); }
  /// Looks at the present state of motion; a sentence the first time that energy is created. Collective.
  std::string look();
  const EnergyWatch &watch() const { return watch_; }
  void serialize(Archive &archive) {
    archive.serialize("energies", first_, work_before_);
    watch_.serialize(archive);
  }

 private:
  World<dim> &world_;
  const Clock &clock_;
  Statics<dim> &statics_;
  EnergyWatch watch_;
  double first_ = 0;                 ///< at the start [J]
  std::vector<double> work_before_;  ///< done before the run, where it starts at the state of another [J]
};

}  // namespace talus
