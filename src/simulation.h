#pragma once
/// A scene in motion: seeds the bodies, runs the stages, writes the results. This header is free of templates; the
/// kernel behind it is compiled once per dimension and phase model (src/variants).
#include <petscdmplex.h>

#include <array>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "meshes/mesh_report.h"
#include "output/events.h"
#include "output/results.h"
#include "physics/laws/strength_range.h"
#include "solvers/quasi_static/factor_of_safety.h"

namespace talus {

struct Scene;

/// The run cannot go on: the program ends with status 1 and this text; what was written before stays.
class RunError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The same, of a run that has left snapshots from which pictures and a report can be drawn.
class BrokenOff : public RunError {
 public:
  BrokenOff(const std::string &cause, std::string folder, std::vector<std::string> wanted)
      : RunError(cause), results(std::move(folder)), fields(std::move(wanted)) {}
  std::string results;              ///< their folder
  std::vector<std::string> fields;  ///< that the scene wants drawn; empty: the usual ones
};

/// What talus-mesh has told of the mesh that it made for the scene; on the first rank.
struct MadeMesh {
  std::vector<std::string> remarks;  ///< sentences about what may be meant but rarely is
  std::string origin;                ///< of terrain: what leads back from the mesh to the map, as JSON
  std::array<double, 2> corner{};    ///< from which x and y of the mesh count on the map, on all ranks [m]
};

class AnySimulation;
/// Sentences for the log of a run, without their full stop. Collective.
using Remarks = std::function<std::vector<std::string>(AnySimulation &)>;

struct RunOptions {
  std::string directory;    ///< of the results; empty: nothing is written
  bool resume = false;      ///< go on from the checkpoint in the directory
  bool replace = false;     ///< results of another run in the directory are given up
  bool checkpoints = true;  ///< write them, so that the run can be resumed
  bool pictures = true;     ///< draw them when the run ends; if it breaks off, who catches BrokenOff draws them
  bool screen = true;       ///< progress line
  bool gauss_points =
      false;          ///< snapshots of quasi-static stages hold Gauss points, not the particles they are handed to
  DM plex = nullptr;  ///< mesh of a host program, instead of the scene's
  MadeMesh mesh;      ///< filled by make_simulation
  Remarks doubts_at_start, doubts_at_end;  ///< the program's are in src/doubts; a host program may have none
};

/// Values over time, as in history.csv.
struct HistoryTable {
  std::vector<std::string> names;  ///< "time_s" first
  std::vector<std::vector<double>> rows;
  /// Column by name; throws std::out_of_range.
  std::vector<double> column(const std::string &name) const;
};

/// Where the time of the steps went [s], summed over steps.
struct Breakdown {
  double gather = 0, step = 0, release = 0, relocate = 0, sort = 0;
};

/// One body as it is now, over all ranks; in 2D per metre of thickness.
struct BodyReport {
  std::string name;
  long long particles = 0, cells = 0;                ///< cells with particles of this body
  int fewest_per_cell = 0;                           ///< particles of this body in one of these cells
  double mass = 0, volume = 0;                       ///< [kg], [m3]
  std::array<double, 3> low{}, high{};               ///< corners of the box around its cells [m]
  double cell_size = 0;                              ///< side of the regular simplex of the mean size of its cells [m]
  double critical_step = 0, mean_critical_step = 0;  ///< least and mean over its cells [s]
  std::array<double, 3> slowest_cell{};              ///< centroid of the cell with the least [m]
  bool one_element_across = false;                   ///< no node inside, and the mesh is no slice of one element
  StrengthRange strength;                            ///< over the places of the body at the start
};

/// A face of the soil at the start: beyond it is no soil.
struct SoilFace {
  std::array<std::array<double, 3>, 3> corner{};  ///< one per dimension [m]
  std::array<double, 3> normal{};                 ///< unit vector, out of the soil
  double area = 0;                                ///< [m2], in 2D per metre of thickness [m]
  int body = 0;                                   ///< number of the body behind it
  bool ends_mesh = false;                         ///< no cell beyond either
  bool held = false;                              ///< by a support, a rigid base or a dashpot
  bool conditioned = false;                       ///< held or loaded, by water too: a boundary says what is there
  bool bounded = false;                           ///< held or loaded by a boundary of the soil itself
  int water = -1;                                 ///< boundary of the scene that decides on its water, -1: none
};

class AnySimulation {
 public:
  virtual ~AnySimulation() = default;
  /// Runs all stages, or what is left of them. Throws RunError, and std::invalid_argument where there is nothing to
  /// resume.
  virtual void run() = 0;
  /// Advances by steps of the scene's integrator until simulated time `t`; for host programs. Loads of the first stage
  /// apply.
  virtual void advance_to(double t) = 0;
  /// Takes one step and returns it [s]; for benchmarks.
  virtual double single_step() = 0;

  virtual double time() const = 0;
  virtual long long steps() const = 0;
  virtual long long remaps() const = 0;
  virtual long long particles() const = 0;  ///< over all ranks
  virtual double mass() const = 0;          ///< over all ranks [kg]
  /// Of the present state, over all ranks; under Rayleigh damping with these frequencies [Hz], if there is any [s].
  /// Collective.
  virtual double critical_step(const std::array<double, 2> &damping_frequencies = {}) = 0;
  virtual std::string step_bound() const = 0;    ///< what the critical step is taken from, and why, as a sentence
  virtual MeshReport mesh_report() const = 0;    ///< collective
  virtual std::vector<BodyReport> bodies() = 0;  ///< collective
  /// Surface of the soil at the start, of all ranks. Collective.
  virtual std::vector<SoilFace> surface() const = 0;
  /// Middles of the facets of these groups that lie downhill of the soil, which a slide may reach, in the order in
  /// which it would, the same on all ranks. Collective.
  virtual std::vector<std::array<double, 3>> downhill(const std::vector<std::string> &groups) const = 0;
  /// What the scene models, for pictures (simulation/model.h); on the first rank. Collective.
  virtual std::string model() const = 0;
  virtual Snapshot snapshot() = 0;  ///< particles of this rank
  virtual const HistoryTable &history() const = 0;
  virtual const std::vector<Event> &events() const = 0;
  virtual const Breakdown &breakdown() const = 0;
  /// What the last stage of kind = "factor_of_safety" has found; runs the stages first if they have not been run.
  /// Throws RunError if the soil stands or fails at any strength.
  virtual FactorOfSafety factor_of_safety() = 0;
  /// Hands over the nodal field "velocity" [m/s] or "displacement" [m] (since the start or the last reset) of each
  /// vertex of the DMPlex, by its point number, that has soil in a cell around it on any rank; ranks that share a
  /// vertex get the same bits. Collective; for host programs.
  virtual void nodal_field(const std::string &name,
                           const std::function<void(PetscInt point, const double *value)> &put) = 0;
};

/// Builds a simulation; collective over `comm`. The scene must outlive it. Throws std::invalid_argument for bad input,
/// the same on all ranks.
std::unique_ptr<AnySimulation> make_simulation(MPI_Comm comm, const Scene &scene, const RunOptions &options);

/// Set by signal handlers: the run writes a checkpoint and a snapshot and ends with RunError.
extern volatile int interrupted;

}  // namespace talus
