#pragma once
/// [[stage]]: what happens one after another.
#include <string>
#include <vector>

#include "base/units.h"
#include "scene/required.h"

namespace talus {

enum class StageKind { dynamic, quasi_static, seepage, consolidation };
enum class InitialStress { kept, k0 };
enum class WhenLost { stop, go_on };
enum class StopWhen { duration, equilibrium, rest, failure };

/// Is it solved by finite elements?
inline bool is_static(StageKind kind) { return kind != StageKind::dynamic; }
/// Does pore water flow in it by finite elements?
inline bool water_flows(StageKind kind) { return kind == StageKind::seepage || kind == StageKind::consolidation; }

struct Stage {
  std::string name;
  StageKind kind = StageKind::dynamic;
  double duration = required;  ///< longest duration [s]
  StopWhen until = StopWhen::duration;
  double damping = 0;           ///< local (Cundall) damping factor alpha [-]
  double gravity_ramp = 0;      ///< gravity and pore pressure grow linearly over this time [s]
  double force_ratio = 1e-3;    ///< equilibrium: unbalanced over applied force [-]
  double energy_ratio = 1e-6;   ///< equilibrium: kinetic over strain energy [-]
  double rest_speed = 1e-3;     ///< rest: the root mean square speed of all soil stays below this [m/s]
  std::string failure_point;    ///< failure: named output point that is watched
  double failure_speed = 0.01;  ///< failure: its mean speed passes this [m/s] ...
  double failure_time = 1;      ///< ... over this time [s]
  bool earthquake = false;      ///< the ground moves as [[earthquake]] says, from the begin of the stage
  bool pore_flow = true;        ///< pore fluids move; false: pore pressures are those of [water], as in a drained scene
  bool softening = true;        ///< soil remembers plastic strain; false: it keeps the strength it has
  bool hold_loads = false;      ///< functions of time stand still: their t counts only stages that do not hold loads
  bool reset_displacement = false;  ///< displacements, velocities and plastic strain are zeroed when the stage ends
  // quasi-static stages
  int load_steps = 5;  ///< in which loads come; fewer or more as Newton's iterations ask for
  InitialStress initial_stress = InitialStress::kept;
  std::vector<std::string> add, remove;  ///< bodies that come and go with the stage
  WhenLost when_lost = WhenLost::stop;
  bool steady = false;                      ///< seepage: the flow that the loads at the stage's end keep up
  std::vector<double> seismic_coefficient;  ///< pseudo-static inertia over weight, by axis [-]; empty: none
  /// Is the soil brought to rest, so that damping does no harm?
  bool settles() const { return until == StopWhen::equilibrium || gravity_ramp > 0; }
  template <class Visitor>
  void fields(Visitor &&v) {
    v.text("name", name, "name of the stage in logs and results; default: its number, from 0");
    v.choice("kind", kind,
             {{"dynamic", StageKind::dynamic},
              {"quasi_static", StageKind::quasi_static},
              {"seepage", StageKind::seepage},
              {"consolidation", StageKind::consolidation}},
             "motion by the material point method, or by finite elements: static equilibrium, flow of pore water "
             "through soil at rest, or consolidation (both in time)");
    v.choice("until", until,
             {{"duration", StopWhen::duration},
              {"equilibrium", StopWhen::equilibrium},
              {"rest", StopWhen::rest},
              {"failure", StopWhen::failure}},
             "criterion that ends the stage before its duration");
    v.number("duration", duration, second, Range{0, 1e12, is_static(kind) ? Usual{} : Usual{0, 86400}},
             "longest duration of the stage. Motion takes steps shorter than a wave through a cell, and slides take "
             "seconds to minutes: what goes on for days belongs to stages of another kind");
    v.number("gravity_ramp", gravity_ramp, second, Range{0, 1e9},
             "time in which gravity and pore pressure increase linearly from 0");
    v.number("damping", damping, one, Range{0, 0.99, settles() ? Usual{0, 0.8} : Usual{0, 0.1}},
             "local (Cundall) damping factor; soil that slides is slowed by it, soil that settles (until = "
             "\"equilibrium\" or a gravity_ramp) comes to rest fastest with 0.7");
    v.point("seismic_coefficient", seismic_coefficient, one, Usual{0, 0.6},
            "pseudo-static earthquake: inertia force over weight, one component per dimension, positive along the "
            "axes, such as [0.15, 0]; it acts on soil and pore water, and the water table stays where it is");
    v.number("force_ratio", force_ratio, one, Range{0, 1, {1e-6, 0.05}},
             "equilibrium: largest ratio of unbalanced to applied nodal forces");
    v.number("energy_ratio", energy_ratio, one, Range{0, 1, {1e-12, 1e-2}},
             "equilibrium: largest ratio of kinetic to elastic strain energy");
    v.number("rest_speed", rest_speed, metre_per_second, Range{0, 1e6, {1e-5, 0.1}},
             "rest: the root mean square speed of all soil remains below this value and does not rise; a stage "
             "does not end while what acts has still to change within its duration, or pore fluids move, unless "
             "hold_loads = true");
    v.flag("earthquake", earthquake,
           "the ground moves as [[earthquake]] says, from the begin of the stage on: as a wave where a boundary has "
           "incoming_wave = true, else with the whole base, and displacements are then relative to it");
    v.text("failure_point", failure_point, "failure: name of the output point whose velocity is tested");
    v.number("failure_speed", failure_speed, metre_per_second, Range{0, 1e6, {1e-4, 1}},
             "failure: speed that the mean velocity of the point over failure_time must exceed");
    v.number("failure_time", failure_time, second, Range{0, 1e9, {0.01, 60}},
             "failure: time of this mean, no shorter than the period of the slowest vibration; from half of it on, the "
             "soil must "
             "store less than a fifth of the energy that it receives");
    v.flag(
        "pore_flow", pore_flow,
        "pore fluids move; if false, pore pressures are those of [water], scaled by the ramp, as for initial stress");
    v.flag(
        "softening", softening,
        "plastic strain is recorded and softens the soil; if false, strength does not change, as for initial stress; "
        "dilation is recorded in any case");
    v.flag("hold_loads", hold_loads,
           "functions of time stand still: their t advances only in stages with hold_loads = false");
    v.flag("reset_displacement", reset_displacement,
           "set displacement, velocity and plastic strain to zero at the end of the stage");
    v.integer(
        "load_steps", load_steps, Range{1, 10000, {1, 200}},
        "quasi-static: number of steps in which loads are applied; a step is halved where Newton's iterations fail");
    v.choice("initial_stress", initial_stress, {{"kept", InitialStress::kept}, {"k0", InitialStress::k0}},
             "quasi-static: stress at the start of the stage: the present stress, or vertical stress from the weight "
             "above and k0 times it laterally");
    v.texts("add", add, "quasi-static: bodies that this stage adds; they are absent before it");
    v.texts("remove", remove, "quasi-static: bodies that this stage removes");
    v.choice(
        "when_lost", when_lost, {{"stop", WhenLost::stop}, {"next_stage", WhenLost::go_on}},
        "quasi-static: if there is no equilibrium under the loads, end with status 1 or continue with the next stage");
    v.flag("steady", steady, "seepage: compute the steady flow under the loads at the end of the stage");
  }
};

}  // namespace talus
