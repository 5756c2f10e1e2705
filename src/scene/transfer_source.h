#pragma once
/// [transfer]: exchange between particles and nodes.
#include "base/units.h"

namespace talus {

enum class Velocity { flip, pic };
enum class Integration { blended, particle, mixed, cell };
enum class Locking { patches, none, nodal };
enum class PoreSmoothing { nodal, none };

/// How particles and nodes exchange what they know (docs/theory section 4).
struct Transfer {
  Velocity velocity = Velocity::flip;
  double relaxation =
      400;  ///< FLIP relaxes to PIC with this time constant, in units of smallest altitude over wave speed; 0: never
  double pic_fraction = 0;  ///< PIC share per remap, beside the relaxation [-]
  Integration integration = Integration::blended;
  bool average_stress = true;  ///< one stress per cell and body, averaged at each remap
  Locking locking = Locking::patches;
  PoreSmoothing pore_smoothing = PoreSmoothing::nodal;  ///< against the noise of equal-order elements in saturated soil
  double remap_interval = 0.1;  ///< remap when a node has moved this share of its mean edge; 0: every step
  template <class Visitor>
  void fields(Visitor &&v) {
    v.choice("velocity", velocity, {{"flip", Velocity::flip}, {"pic", Velocity::pic}},
             "how particles take their velocity from the nodes");
    v.number(
        "relaxation", relaxation, one, Range{0, 1e9, {20, 1e4}},
        "time constant of the relaxation of FLIP to PIC, in units of smallest altitude / wave speed; 0: no relaxation");
    v.number("pic_fraction", pic_fraction, one, Range{0, 1, {0, 0.1}},
             "PIC share at each remap, in addition to the relaxation");
    v.choice("integration", integration,
             {{"blended", Integration::blended},
              {"particle", Integration::particle},
              {"mixed", Integration::mixed},
              {"cell", Integration::cell}},
             "integration volume of a cell");
    v.flag("average_stress", average_stress, "one stress per cell and body, averaged at each remap");
    v.choice("locking", locking, {{"patches", Locking::patches}, {"none", Locking::none}, {"nodal", Locking::nodal}},
             "cure of volumetric locking; nodal smooths strain alone, and creates energy in soil that dilates");
    v.choice("pore_smoothing", pore_smoothing, {{"nodal", PoreSmoothing::nodal}, {"none", PoreSmoothing::none}},
             "smoothing of pore pressures and fluid volumes of saturated cells through their nodes");
    v.number("remap_interval", remap_interval, one, Range{0, 0.3},
             "remap when a node of a filled cell has moved by this share of its mean edge; 0: remap in every step");
  }
};

}  // namespace talus
