#pragma once
/// The scene as plain structs: SI units, radians, defaults; no PETSc, no TOML. Each table has a header of its own,
/// which a unit that reads the table includes. `fields` of a table names every key once; the reader, `talus describe`,
/// the header of results and the test that every key is documented all visit it (docs/reference/values.md).
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/boxed.h"
#include "scene/deferred.h"
#include "scene/phase_model.h"

namespace talus {

struct BodySource;
struct BoundarySource;
struct ContactSource;
struct EarthquakeSource;
struct FactorSource;
struct Gas;
struct MeshSource;
struct Output;
struct QuasiStaticSource;
struct RigidSource;
struct Stage;
struct StartFrom;
struct StructureSource;
struct Transfer;
struct Water;

/// The axis along which elevations are counted; gravity acts against it.
enum class Up { y = 1, z = 2 };

struct Scene {
  Scene();
  Scene(const Scene &);
  Scene &operator=(const Scene &);
  ~Scene();

  std::string title;
  std::string file;                         ///< path of the scene, for messages and relative paths; not a key
  std::string source;                       ///< the text as read, overrides applied; not a key
  std::shared_ptr<const TableReader> root;  ///< the file's root table, for complaints after reading; not a key
  PhaseModel phases = PhaseModel::dry;
  int dimension = 2;
  Up up = Up::y;
  std::vector<double> gravity;  ///< components [m/s2]; one number points down; empty: no gravity
  Boxed<StartFrom> start_from;
  Boxed<MeshSource> mesh;
  std::vector<BodySource> body;
  std::vector<BoundarySource> boundary;
  std::vector<RigidSource> rigid;
  std::vector<ContactSource> contact;
  std::vector<StructureSource> structure;
  Boxed<Water> water;
  Boxed<Gas> gas;
  std::vector<Stage> stage;
  std::vector<EarthquakeSource> earthquake;  ///< components of the motion of the ground
  DeferredTable integrator;                  ///< [integrator], read by solvers/
  Boxed<Transfer> transfer;
  Boxed<QuasiStaticSource> quasi_static;
  Boxed<FactorSource> factor_of_safety;
  Boxed<Output> output;
  std::vector<std::string> acknowledge;  ///< names of doubts that are meant
  template <class Visitor>
  void fields(Visitor &&v);  // tables.h

  /// Does the scene acknowledge doubts of this name?
  bool acknowledges(std::string_view doubt) const { return std::ranges::count(acknowledge, doubt) > 0; }
  double gravity_size() const;  ///< magnitude of gravity [m/s2]
  /// Number of the component of a place that is its elevation: the one place that says which way is up.
  int vertical() const { return static_cast<int>(up); }
  /// Unit vector against gravity, without gravity along `up`; zero beyond the dimension.
  std::array<double, 3> upward() const;
  /// Adds a stage that looks for the factor of safety, unless the last one does.
  void add_factor_stage();
  /// Does a stage look for the factor of safety?
  bool finds_factor() const;
  /// The first value of a function that its key does not admit, on this rank; empty if there was none.
  std::string function_fault() const;
  /// Takes faults for never made: those of a trial beyond the end of the run.
  void forget_function_faults() const;
  /// Gravity and the pseudo-static acceleration of a stage, zero beyond the dimension [m/s2].
  std::array<double, 3> acceleration_in(const Stage &one) const;

  /// For what only mesh or soil can tell is wrong: throws the SceneError of TableReader::complain, with the key's place
  /// in the file.
  [[noreturn]] void complain(const std::string &key_path, const std::string &sentence) const;
};

}  // namespace talus
