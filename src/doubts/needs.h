#pragma once
/// What a scene costs and what it needs, found without running it (`talus check`).
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
  Softening softening = {};
  bool there() const { return body.particles > 0; }  ///< at the start; else a stage adds it
};

/// All bodies taken for one layer, as deep as their soil is below its surface: a stack in which each is as thick as its
/// share of the volume.
struct LayerNeeds {
  double height = 0;   ///< depth where gravity points down, else extent along it or, without it, largest [m]
  double modulus = 0;  ///< M = K + 4/3 G of the stack [Pa]
  double transit = 0;  ///< of a compression wave of the skeleton through the stack [s]
};

struct StageNeeds {
  std::string name;
  double duration;              ///< longest [s]
  double steps;                 ///< in that time
  double run_time;              ///< estimated [s]
  double transits;              ///< of the layer by a wave
  double damped_critical_step;  ///< under its Rayleigh damping [s]; 0: it has none
};

/// Conductivities at which Terzaghi's T = c_v t / L^2, with c_v = k_h M / gamma_w, has the values 10 and 0.01: pore
/// pressure of a layer that drains over L is gone at T of about 1 and has not begun to go at 0.01. Terzaghi (1943),
/// Theoretical soil mechanics, ch. 13.
struct Drainage {
  double time = 0;                                ///< of all motion under gravity [s]
  double drained_above = 0, undrained_below = 0;  ///< [m/s]
};
inline constexpr double drained_factor = 10, undrained_factor = 0.01;

struct Needs {
  std::string model;  ///< what the scene models, for its picture; on the first rank, if asked for
  MeshReport mesh;
  std::vector<BodyNeeds> bodies;
  LayerNeeds layer;
  std::vector<StageNeeds> stages;
  std::vector<std::string> advice;  ///< sentences: remarks of the mesh, faults of functions, doubts (doubts.h)
  Drainage drainage;                ///< time = 0 without gravity
  double gravity;                   ///< [m/s2]
  int slowest;                      ///< body that sets the critical step
  double critical_step;             ///< without Rayleigh damping [s]
  std::string step_bound;           ///< what it is taken from, as a sentence
  double altitude_rule;             ///< smallest altitude over the largest wave speed [s]
  double step;                      ///< taken without Rayleigh damping [s]
  bool fixed_step;                  ///< given by the scene
  int burst_steps = 0;              ///< timed
  double seconds_per_step = 0;      ///< of wall time, of soil at rest
  double seconds_per_remap = 0;     ///< of a step that ends with a remap, as each one does in the fastest soil
  std::string burst_failure;        ///< why the burst broke off; empty if it did not
  double memory;                    ///< resident after the burst, over all ranks [B]
  double results;                   ///< snapshots on disk [B]
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

/// A duration as one says it: "40 ms", "12 min", "3.1 h".
std::string spoken(double seconds);

}  // namespace talus
