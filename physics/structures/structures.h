#pragma once
/// The structures of a scene: bars cut into chains, docs/theory/structures.md. All ranks have all of them, so that each
/// solves the same small systems. Forces of plane strain are those per metre of width; reports are of one bar.
#include <array>
#include <string>
#include <vector>

#include "base/archive.h"
#include "meshes/background_mesh.h"
#include "physics/laws/law.h"
#include "physics/structures/bar_chain.h"
#include "scene/structure_source.h"

namespace talus {

struct Scene;
struct Stage;

template <int dim>
struct Bar {
  std::string name;
  BarKeys keys;                                  ///< of one bar
  double share = 1;                              ///< bars per metre of width of plane strain [1/m]; 1 in 3D
  std::vector<Vec<dim>> place;                   ///< of the points as they were drawn [m]
  std::vector<Vec<dim>> now;                     ///< where motion has brought them [m] ...
  std::vector<Vec<dim>> part_place;              ///< ... and where they were when its present Lagrangian part began [m]
  std::vector<double> at;                        ///< of the points, along the bar from its head [m]
  std::vector<Vec<dim>> direction;               ///< of the elements, unit vectors
  std::vector<std::array<double, 2>> bond_span;  ///< from where to where along the bar a point stands for its bond [m]
  std::vector<double> shear_modulus;             ///< of the soil at a point [Pa]
  std::vector<char> in_soil;                     ///< is there soil at the point?
  BarChain chain;                                ///< per metre of width
  bool present = false;
  bool fresh = false;   ///< it came with the stage that began last
  double softened = 1;  ///< least share of the stiffness of an element that motion has used [-]

  int points() const { return static_cast<int>(place.size()); }
  int elements() const { return points() - 1; }
  /// Direction of an element, and the mean of those at a point, where the points are at `places`.
  Vec<dim> along(int element, const std::vector<Vec<dim>> &places) const;
  Vec<dim> along_at(int point, const std::vector<Vec<dim>> &places) const;
  double length_now(int element) const { return (map<dim>(now[element + 1]) - map<dim>(now[element])).norm(); }
  /// Does the normal stress around decide what the bond bears?
  bool rubs() const { return keys.bond_strength == 0 && keys.bond_friction_angle > 0; }
  /// Effective normal stress on the bond where the bar goes `along` and the soil has this stress, tension positive
  /// [Pa].
  double normal_stress(const Vec<dim> &along, const Eigen::Matrix3d &stress, int up) const;
  double bonded(int point) const { return bond_span[point][1] - bond_span[point][0]; }  ///< length of that bond [m]
  /// Bond of a point under this normal stress [Pa], where `drawn` only of the part of the bar that slip has left there.
  void set_bond(int point, double normal_stress, bool drawn);
  /// Elements without soil at one of their ends bear nothing.
  void find_absent();
  double force(int element) const { return chain.committed_force(element) / share; }  ///< axial, of one bar [N]
  /// Force of the bond of a point, without its plate, on one bar [N].
  double bond_force(int point) const;
  /// Axial force over what an element bears [-].
  double utilisation(int element) const;
  /// What history.csv says of one bar; nothing while it is not there.
  struct Report {
    double head = 0, largest = 0;  ///< axial force at the head and the largest along the bar [N]
    double slip = 0;               ///< the largest [m]
    double slipping = 0;           ///< share of the bond that bears no more [-]
    double utilisation = 0;        ///< the largest axial force over what the bar bears [-]
  };
  Report report() const;
};

template <int dim>
class Structures {
 public:
  /// Cuts the bars into elements about as long as cells. Throws SceneError where a structure is not in soil. `laws` are
  /// those of the bodies. Collective.
  Structures(const BackgroundMesh<dim> &mesh, const Scene &scene, const std::vector<Law> &laws);

  bool any() const { return !bars_.empty(); }
  std::vector<Bar<dim>> &bars() { return bars_; }
  const std::vector<Bar<dim>> &bars() const { return bars_; }
  int up() const { return up_; }
  int changes() const { return changes_; }  ///< how often structures have come or gone
  /// Structures come and go with the stage; jacks pull the anchors that come, and let go of those that are there.
  void begin_stage(const Stage &stage);
  void serialize(Archive &archive);

 private:
  void find_soil(const BackgroundMesh<dim> &mesh, const Scene &scene, const std::vector<Law> &laws);

  std::vector<Bar<dim>> bars_;
  int up_ = 1;
  bool begun_ = false;  ///< a stage has
  int changes_ = 0;
};

}  // namespace talus
