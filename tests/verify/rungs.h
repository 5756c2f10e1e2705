#pragma once
/// The verification ladder: one line a case. Each has a folder tests/LABEL/NAME with its scene, its exact answer and a
/// README.
#include "tests/convergence/fem_manufactured/exact.h"
#include "tests/convergence/manufactured/exact.h"
#include "tests/verification/at_rest/exact.h"
#include "tests/verification/cam_clay_paths/exact.h"
#include "tests/verification/celia/exact.h"
#include "tests/verification/closed_box/exact.h"
#include "tests/verification/contact/exact.h"
#include "tests/verification/curved_chute/exact.h"
#include "tests/verification/damped_layer/exact.h"
#include "tests/verification/dynamic_oedometer/exact.h"
#include "tests/verification/elastic_bar/exact.h"
#include "tests/verification/fem_at_rest/exact.h"
#include "tests/verification/fem_bar/exact.h"
#include "tests/verification/fem_consolidation/exact.h"
#include "tests/verification/fem_cylinder/exact.h"
#include "tests/verification/fem_dam/exact.h"
#include "tests/verification/fem_elastic_slope/exact.h"
#include "tests/verification/fem_footing/exact.h"
#include "tests/verification/fem_geogrid/exact.h"
#include "tests/verification/fem_hoek_brown/exact.h"
#include "tests/verification/fem_infiltration/exact.h"
#include "tests/verification/fem_infinite_slope/exact.h"
#include "tests/verification/fem_mandel_cryer/exact.h"
#include "tests/verification/fem_nailed_wall/exact.h"
#include "tests/verification/fem_slope/exact.h"
#include "tests/verification/fem_tension_crack/exact.h"
#include "tests/verification/fem_vertical_cut/exact.h"
#include "tests/verification/footing/exact.h"
#include "tests/verification/gas_column/exact.h"
#include "tests/verification/gravity_column/exact.h"
#include "tests/verification/green_ampt/exact.h"
#include "tests/verification/hydrostatic/exact.h"
#include "tests/verification/hysteretic_column/exact.h"
#include "tests/verification/incline_block/exact.h"
#include "tests/verification/incoming_wave/exact.h"
#include "tests/verification/k0_column/exact.h"
#include "tests/verification/laboratory/exact.h"
#include "tests/verification/large_strain_consolidation/exact.h"
#include "tests/verification/leaving_waves/exact.h"
#include "tests/verification/loaded_face/exact.h"
#include "tests/verification/mohr_coulomb_triaxial/exact.h"
#include "tests/verification/phase_reduction/exact.h"
#include "tests/verification/pore_boundaries/exact.h"
#include "tests/verification/rigid_bodies/exact.h"
#include "tests/verification/rigid_rotation/exact.h"
#include "tests/verification/rigid_translation/exact.h"
#include "tests/verification/shaken_block/exact.h"
#include "tests/verification/shaken_slope/exact.h"
#include "tests/verification/site_response/exact.h"
#include "tests/verification/spinning_block/exact.h"
#include "tests/verification/srivastava_yeh/exact.h"
#include "tests/verification/submerged_slope/exact.h"
#include "tests/verification/terzaghi/exact.h"
#include "tests/verification/two_waves/exact.h"
#include "tests/verification/undrained/exact.h"
#include "tests/verification/water_table/exact.h"
#include "tests/verification/wet_flight/exact.h"
#include "tests/verification/wet_hand_over/exact.h"
#include "tests/verification/wet_incline/exact.h"
#include "tests/verify/rung.h"

namespace talus {

struct LadderEntry {
  const char *name, *label, *meaning;
  void (*check)(Rung &);
};

inline constexpr LadderEntry ladder[] = {
    {"dynamic_oedometer", "verification", "settlement and stress behind a load applied at once",
     rungs::dynamic_oedometer},
    {"gravity_column", "verification", "column under its own weight, stiff and with cells crossed",
     rungs::gravity_column},
    {"at_rest", "verification", "column that comes to rest at nodes, at particles and in its energy", rungs::at_rest},
    {"k0_column", "verification", "lateral stress at rest, by gravity and as an initial state that stays",
     rungs::k0_column},
    {"elastic_bar", "verification", "period, amplitude and energy of an elastic bar over ten periods",
     rungs::elastic_bar},
    {"incline_block", "verification", "block on a rough plane: sliding, sticking, adhesion, friction that drops",
     rungs::incline_block},
    {"curved_chute", "verification", "block that slides through a circular valley: friction by weight and curvature",
     rungs::curved_chute},
    {"wet_incline", "verification", "saturated block on a rough plane: friction by the effective normal force",
     rungs::wet_incline},
    {"loaded_face", "verification", "loads on faces that move through several cells", rungs::loaded_face},
    {"leaving_waves", "verification", "pulses that leave through non-reflecting faces", rungs::leaving_waves},
    {"damped_layer", "verification", "transfer function of a layer with Rayleigh damping, on rigid and elastic base",
     rungs::damped_layer},
    {"hysteretic_column", "verification", "response spectrum of a column of hysteretic soil under a record",
     rungs::hysteretic_column},
    {"incoming_wave", "verification", "wave that comes in through dashpots, from the same and from harder rock",
     rungs::incoming_wave},
    {"shaken_block", "verification", "block on a shaken plane beside Newmark's sliding block", rungs::shaken_block},
    {"shaken_slope", "verification", "slopes that keep their strength beside Newmark's sliding block",
     rungs::shaken_slope},
    {"site_response", "verification", "layer on a half-space between tied and free-field sides", rungs::site_response},
    {"water_table", "verification", "column below open water, and below a water table that falls", rungs::water_table},
    {"rigid_translation", "verification", "block in free flight: no stress, momentum to round-off",
     rungs::rigid_translation},
    {"manufactured", "convergence", "observed order against a manufactured motion, cells frozen and crossed",
     rungs::manufactured},
    {"fem_manufactured", "convergence", "observed order of the finite elements against a manufactured equilibrium",
     rungs::fem_manufactured},
    {"mohr_coulomb_triaxial", "verification", "strength in compression through the whole program",
     rungs::mohr_coulomb_triaxial},
    {"laboratory", "verification", "element tests of elastic and Mohr-Coulomb soils", rungs::laboratory},
    {"cam_clay_paths", "verification", "drained and undrained paths of Cam-clay in triaxial compression",
     rungs::cam_clay_paths},
    {"rigid_rotation", "verification", "stress of a body that rotates ten times", rungs::rigid_rotation},
    {"spinning_block", "verification", "momentum of a block that spins freely", rungs::spinning_block},
    {"contact", "verification", "groups of bodies in contact: a block on a slope, bars that collide", rungs::contact},
    {"rigid_bodies", "verification",
     "rigid bodies on soil: fall, rest, sliding, toppling, earth pressure, bearing capacity", rungs::rigid_bodies},
    {"footing", "verification", "bearing capacity of Tresca soil, where cells could lock", rungs::footing},
    {"fem_elastic_slope", "verification", "settlement of an elastic slope, on finer meshes and in a slice",
     rungs::fem_elastic_slope},
    {"fem_bar", "verification", "load transfer between a bar and elastic soil by finite elements", rungs::fem_bar},
    {"fem_nailed_wall", "verification", "factor of safety of a nailed wall by finite elements", rungs::fem_nailed_wall},
    {"fem_geogrid", "verification", "factor of safety of an embankment on a geogrid by finite elements",
     rungs::fem_geogrid},
    {"fem_footing", "verification", "bearing capacity of Tresca soil by finite elements", rungs::fem_footing},
    {"fem_vertical_cut", "verification", "height at which a vertical cut fails, by strength reduction",
     rungs::fem_vertical_cut},
    {"fem_cylinder", "verification", "thick cylinder that yields from its bore", rungs::fem_cylinder},
    {"fem_slope", "verification", "factor of safety of a published slope", rungs::fem_slope},
    {"fem_hoek_brown", "verification", "factor of safety of a published slope in Hoek-Brown rock",
     rungs::fem_hoek_brown},
    {"fem_tension_crack", "verification", "factor of safety of a published slope with a crack full of water",
     rungs::fem_tension_crack},
    {"fem_infinite_slope", "verification", "factor of safety of a thin layer on a long slope",
     rungs::fem_infinite_slope},
    {"fem_at_rest", "verification", "slope handed from finite elements to particles remains at rest",
     rungs::fem_at_rest},
    {"fem_consolidation", "verification", "consolidation of a clay layer in days, by finite elements",
     rungs::fem_consolidation},
    {"fem_mandel_cryer", "verification", "pressure that rises in a cylinder squeezed from outside",
     rungs::fem_mandel_cryer},
    {"fem_dam", "verification", "steady seepage through a dam, with its seepage face", rungs::fem_dam},
    {"fem_infiltration", "verification", "water that enters dry sand", rungs::fem_infiltration},
    {"terzaghi", "verification", "consolidation of a saturated layer, and the water it sheds", rungs::terzaghi},
    {"large_strain_consolidation", "verification", "consolidation by a fifth and more of the height",
     rungs::large_strain_consolidation},
    {"two_waves", "verification", "two waves in a saturated column, drained and under water", rungs::two_waves},
    {"undrained", "verification", "B of undrained compression", rungs::undrained},
    {"hydrostatic", "verification", "still water in a column that fits its mesh", rungs::hydrostatic},
    {"submerged_slope", "verification", "slope under still water", rungs::submerged_slope},
    {"wet_hand_over", "verification", "slope with seepage handed from finite elements to particles",
     rungs::wet_hand_over},
    {"closed_box", "verification", "masses of water and gas in a closed box", rungs::closed_box},
    {"srivastava_yeh", "verification", "rain on a column of soil above a water table", rungs::srivastava_yeh},
    {"gas_column", "verification", "damped wave and steady flow of the gas in a column", rungs::gas_column},
    {"pore_boundaries", "verification", "one column under every boundary of the pore water", rungs::pore_boundaries},
    {"wet_flight", "verification", "wet soil in free flight: nothing passes its surface", rungs::wet_flight},
    {"green_ampt", "verification", "ponded infiltration with a sharp front, started by finite elements",
     rungs::green_ampt},
    {"celia", "verification", "infiltration into dry soil", rungs::celia},
    {"phase_reduction", "verification", "phase models without what they add", rungs::phase_reduction},
};

}  // namespace talus
