#pragma once
/// What a scene is made of once it is built: mesh, bodies, laws, boundaries and the motion of the soil. It has no clock
/// and no files: times are handed in.
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "particles/escaped_particles.h"
#include "physics/any_soil_motion.h"
#include "physics/cell_pressure.h"
#include "physics/laws/strength_by_place.h"
#include "physics/phase_models.h"
#include "physics/prescribed_pressure.h"
#include "physics/structures/structures.h"
#include "scene/scene.h"
#include "simulation.h"
#include "simulation/clock.h"
#include "simulation/failure.h"
#include "simulation/overburden.h"
#include "simulation/pore_integration.h"
#include "simulation/work.h"
#include "solvers/critical_step.h"
#include "transfer/transfer.h"

namespace talus {

struct Stage;

template <int dim>
class World {
 public:
  using Source = NamedBoundary;

  /// Reads the mesh from `mesh_file`, or takes that of a host program. Throws SceneError where the scene does not fit
  /// it. The scene must outlive the world. The mesh is divided by `cuts` if these are for as many ranks, otherwise so
  /// that all ranks get as many particles. Collective.
  World(MPI_Comm world, const Scene &of, DM plex, const std::string &mesh_file, const Cuts &cuts = {});
  World(const World &) = delete;  // its parts know each other's place

  /// Bodies that no stage adds.
  std::vector<char> present_at_start() const;
  /// Bodies that a stage adds are seeded, and so checked, but not there at the start: takes them out.
  void take_out_later_bodies();
  /// What acts on the soil from now on, `stage_time` after the begin of the stage.
  void set_loading(const Stage &stage, double stage_time, const Clock &clock);
  /// Density of the soil as a body at a place; where fluids move on their own, that of the grains alone [kg/m3].
  double soil_density(const BodySource &source, const Vec<dim> &x, double load_time) const;

  /// A cell of a body with its unit weight; `water` is the density of pore water that the body's own does not contain.
  typename Overburden<dim>::Block block_of(const BodySource &source, int cell, double water, double load_time) const;

  /// Hands the nodal update to the particles and walks them to their cells; with `to_next` the grid is filled again at
  /// once. Particles that leave the mesh are taken out, or a RunFailure says where, as the scene asks. Collective.
  PetscErrorCode release(double time, bool to_next = false);
  /// How often particles were released: who keeps something that holds until then compares.
  long long releases() const { return releases_; }
  /// Orders particles by cell.
  PetscErrorCode sort();
  /// Throws RunFailure where particles or mass were lost. Also sums up a number of each rank, at no cost. Collective.
  PetscErrorCode check_conservation(double mine, double *sum) const;
  /// Changes between dashpots and the supports that stand in for them; what these bear stays on as a dead load.
  PetscErrorCode fix_dashpots(bool fixed, double time);
  /// Bodies come and go, and their particles with them.
  void choose_bodies(const Stage &stage, const Clock &clock);
  /// Displacements, velocities and plastic strain are zero from now on.
  void reset_displacement(double time);

  /// The least over the filled cells, by the elastic waves in each cell alone and the Rayleigh damping that acts [s].
  /// Collective.
  double critical_step_of_cells(double time);
  /// By which the Rayleigh damping that acts slows motion of an angular frequency [1/s], at most [1/s].
  double damping_rate(double omega) const;
  /// One report per body. Collective.
  std::vector<BodyReport> report();
  /// Faces of the bodies that are there at the start beyond which there is no soil, of all ranks. Collective.
  std::vector<SoilFace> surface() const;  // soil_surface.cpp
  /// Middles of facets downhill of the soil, see AnySimulation. Collective.
  std::vector<std::array<double, 3>> downhill(const std::vector<std::string> &groups) const;  // soil_surface.cpp
  /// The first value of a function that its key does not admit, as a sentence; empty if there was none. Collective.
  std::string function_fault() const;
  /// Of each body: do its particles on any rank have shares of a strength that varies with place? Collective.
  std::vector<char> strength_varies() const;
  /// Of particles [m]. Collective.
  double largest_displacement() const;
  /// Position of a particle of this rank and its number, the nearest to a place, in words.
  std::string nearest_particle(const Vec<dim> &where) const;
  /// Of mesh nodes [m]; only nodes of the filled grid have one. Collective.
  std::vector<Vec<dim>> nodal_displacement();
  /// Bodies, motion and boundaries. Collective.
  PetscErrorCode serialize(Archive &archive);
  /// Work that this rank has in a step (simulation/work.h), of `steps` since the last remap; 0: the usual number.
  double work_of_rank(long long steps) const;
  void count_cells();  ///< those that hold soil now; collective
  /// The filled cells of this rank with their work, after a remap that followed on `steps` steps of `step` seconds.
  std::vector<FilledCell<dim>> work_of_cells(double step, long long steps) const;
  /// Divides the mesh among the ranks in another way. Particles, and all that nodes and cells hold, are gone:
  /// `serialize` brings them back from a state that was dealt out to the new partition. Collective.
  void divide(const Cuts &cuts);

  const Scene &scene;
  const PhaseTraits phases;
  std::vector<Law> laws;                ///< of the bodies
  std::vector<StrengthRange> strength;  ///< of the bodies, at their places
  std::vector<Source> seepage_sources;  ///< boundaries of pore water in a drained scene: its seepage stages know them,
                                        ///< the motion does not
  BackgroundMesh<dim> mesh;
  std::array<std::array<double, 3>, 2> mesh_box{};  ///< corners of the box around it, of all ranks [m]
  MPI_Comm comm;
  PrescribedPressure<dim> pressure;  ///< of drained scenes
  const GroundShaking shaking;       ///< of stages in which the base moves
  std::vector<std::unique_ptr<Body<dim>>> bodies;
  std::vector<char> present;  ///< bodies that are there now
  Conditions<dim> conditions;
  std::unique_ptr<Structures<dim>> structures;  ///< null where the scene has none
  std::unique_ptr<AnySoilMotion<dim>> motion;
  long long particle_count = 0;            ///< of all ranks
  long long cell_count = 0;                ///< of all ranks, that held soil when they were last counted
  double total_mass = 0;                   ///< of all ranks [kg]
  EscapedParticles<dim> escaped;           ///< particles that were taken out because they left the mesh
  PoreIntegrationChoice pore_integration;  ///< how pore pressure goes in time
  Breakdown breakdown;                     ///< where the time of steps and remaps went

 private:
  void read_laws();
  void find_strengths();
  std::vector<Source> read_sources();
  void read_mesh(DM plex, const std::string &mesh_file, const Cuts &cuts, const std::vector<Source> &sources);
  void take_rigid_bodies();
  void separate_groups();
  void take_soil_contact();
  void take_structures();
  void tie_sides(const std::vector<Source> &sources, bool complains);
  void find_mesh_box();
  void check_bodies() const;                                        // world_checks.cpp
  void check_boundaries(const std::vector<Source> &) const;         // world_checks.cpp
  void check_quasi_static_base(const std::string &path) const;      // world_checks.cpp
  void check_fresh_base(const std::string &path) const;             // world_checks.cpp
  void check_something_acts(const std::vector<Source> &) const;     // world_checks.cpp
  void check_earthquake() const;                                    // world_checks.cpp
  void check_sides(const std::vector<Source> &) const;              // world_checks.cpp
  void check_boxes() const;                                         // world_checks.cpp
  void check_one_of_two(const std::vector<Source> &) const;         // world_checks.cpp
  void check_seeded(const Body<dim> &, const std::string &) const;  // world_checks.cpp
  int id_stride() const;
  bool comes_or_goes(const BodySource &) const;
  void set_pore_pressure_ratios();
  std::vector<char> cells_of_bodies(const std::function<bool(size_t body)> &which) const;
  void seed_bodies();
  void find_fastest_fall();
  void settle_bodies();
  void choose_pore_pressure();
  void close_bases();
  void make_motion();
  void set_friction_delay();
  void count_particles();
  void count_runs();    ///< where particles have another cell or place in memory
  void count_movers();  ///< after a release
  PetscErrorCode take_out(double time);
  std::string thrown(double speed) const;
  /// The first group of a face of a local cell; -1: none.
  int group_of(int cell, int face);

  std::vector<CriticalStep<dim>> critical_;
  double wave_speed_ = 0;         ///< the largest of the bodies [m/s]
  double smallest_altitude_ = 0;  ///< of the cells of the mesh [m]
  double fastest_fall_ = 0;       ///< through the mesh, with the largest velocity at the start [m/s]
  double depth_on_bases_ = 0;     ///< of elastic soil at the start [m]
  const WorkRates rates_;
  WorkCounts counts_;                     ///< runs and movers of this rank; the rest is counted where it is asked for
  std::vector<int> cells_of_movers_;      ///< into which they went at the last release
  double seeded_mass_ = 0;                ///< of all ranks [kg]
  long long seeded_particles_ = 0;        ///< of all ranks
  std::vector<std::vector<int>> movers_;  ///< [body] particles that left their cells at the last release ...
  std::vector<std::vector<LeftMesh>> outside_;      ///< ... and those of them that left the mesh
  std::map<std::pair<int, int>, int> face_groups_;  ///< by cell and face; found when particles leave the mesh
  long long releases_ = 0;
};

/// Do seepage or consolidation stages let pore water flow?
bool has_flow_stages(const Scene &scene);

}  // namespace talus
