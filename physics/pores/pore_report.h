#pragma once
/// Reports about the fluids in the pores, the same for all phase models.

namespace talus {

/// Fluid masses of all ranks, for the ledger [kg].
struct FluidLedger {
  double stored = 0;      ///< now
  double out = 0;         ///< left through boundaries since the start, less what entered
  double prescribed = 0;  ///< put in where pressures are prescribed, less what was taken out
};

/// State of the pores of a particle.
struct PoreReport {
  double liquid = 0, gas = 0;  ///< pressures, smoothed where soil is nearly saturated [Pa]
  double suction = 0;          ///< [Pa]
  double saturation = 0;       ///< S_l [-]
  bool surface = false;        ///< its cell has a side through which fluids may pass
};

}  // namespace talus
