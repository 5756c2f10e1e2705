#pragma once
/// What a scene costs and what it needs, found without running it, and the advice that follows (`talus check`).
#include <string>
#include <vector>

#include "physics/laws/law.h"
#include "simulation.h"
#include "simulation/softening.h"
#include "solvers/integrators.h"

namespace talus {

struct BodyNeeds {
  BodyReport body;
  Law law;
  double density = 0;                      ///< mean [kg/m3]
  double wave_speed = 0, shear_speed = 0;  ///< elastic, c_p and c_s [m/s]
  double averaging_length = 0;             ///< of the plastic strain that softens [m]; 0: none
  Softening softening = {};
  bool there() const { return body.particles > 0; }  ///< at the start; else a stage adds it
};

/// All bodies taken for one layer, as deep as their soil is below its surface: a stack in which each is as thick as its
/// share of the volume.
struct LayerNeeds {
  double height = 0;          ///< depth where gravity points down, else extent along it or, without it, largest [m]
  double modulus = 0;         ///< M = K + 4/3 G of the stack [Pa]
  double transit = 0;         ///< of a compression wave of the skeleton through the stack [s]
  double wave_speed = 0;      ///< mean of that wave [m/s]
  double gravity_stress = 0;  ///< mean density g height, with the water in full pores that the scene computes [Pa]
  double gravity_strain = 0;  ///< largest of a body, under such weight above its foot [-]
  double settlement = 0;      ///< of its top under its weight [m]
};

/// A base that sliding heats.
struct HeatedBaseNeeds {
  std::string name;
  double weakening_slip;       ///< over which friction falls to 1/e, undrained and without conduction [m]
  double heat_way, water_way;  ///< sqrt(4 a t) of temperature and pressure in all motion [m]
  double time;                 ///< of all motion [s]
};

struct StageNeeds {
  std::string name;
  double duration;  ///< longest [s]
  double steps;     ///< in that time
  double run_time;  ///< estimated [s]
  double transits;  ///< of the layer by a wave
};

/// Conductivities [m/s] that bound drained, partly drained and undrained behaviour over all stages.
struct Drainage {
  double time = 0, undrained_below = 0, drained_above = 0;
  double drag_relaxation = 0;  ///< at the upper bound [s]; 0 where no porosity is known
  bool computed = false;       ///< stages of seepage find the pore pressure
};

struct Needs {
  std::string model;  ///< what the scene models, for its picture; on the first rank, if asked for
  MeshReport mesh;
  std::vector<BodyNeeds> bodies;
  LayerNeeds layer;
  std::vector<StageNeeds> stages;
  std::string downhill_fault;       ///< the same, of ground that a slide may reach
  std::string function_fault;       ///< a value of a function that its key does not admit, as a sentence
  std::vector<std::string> doubts;  ///< sentences, see doubts.h
  std::vector<HeatedBaseNeeds> heated_bases;
  Drainage drainage;             ///< time = 0 without gravity
  double gravity;                ///< [m/s2]
  int slowest;                   ///< body that sets the critical step
  double critical_step;          ///< [s]
  std::string step_bound;        ///< what it is taken from, as a sentence
  double altitude_rule;          ///< smallest altitude over the largest wave speed [s]
  double step;                   ///< taken [s]
  double usual_step;             ///< largest without integrator.step [s]
  bool fixed_step;               ///< given by the scene
  int burst_steps = 0;           ///< timed
  double seconds_per_step = 0;   ///< of wall time, of soil at rest
  double seconds_per_remap = 0;  ///< of a step that ends with a remap, as each one does in the fastest soil
  std::string burst_failure;     ///< why the burst broke off; empty if it did not
  double memory;                 ///< resident after the burst, over all ranks [B]
  double results;                ///< snapshots on disk [B]
  long long snapshots;
  int ranks;

  double run_time() const;          ///< of all stages at their longest, without remaps [s]
  double longest_run_time() const;  ///< the same with a remap in each step [s]
  long long particles() const;
  const BodyNeeds &slowest_body() const { return bodies[slowest]; }
};

/// Makes the simulation of a scene and takes a burst of steps with it; `with_model` also asks for what its picture
/// shows. Collective. Throws as make_simulation does.
Needs find_needs(Scene &scene, bool with_model);

/// Plain sentences, the most important first.
std::vector<std::string> advise(const Scene &scene, const Needs &needs);

/// A duration as one says it: "40 ms", "12 min", "3.1 h".
std::string spoken(double seconds);

}  // namespace talus
