#pragma once
/// One point of a law in the laboratory: the tests of `talus soil`. The point sees neither inertia nor a mesh. Each
/// component of its deformation is prescribed, or else its total stress is; the rest follows by Newton's method.
/// Without drainage the pore fluid adds its own equation, docs/theory/laws/element_tests.md.
#include <array>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "physics/laws/law.h"
#include "scene/function.h"

namespace talus {

enum class TestType {
  triaxial_compression,
  triaxial_extension,
  biaxial,
  oedometer,
  simple_shear,
  isotropic_compression,
  controlled
};

/// What a test of type `controlled` prescribes of each component: strain, total stress, or nothing, which is no strain.
struct Control {
  static constexpr const char *strain_keys[6] = {"strain_xx", "strain_yy", "strain_zz",
                                                 "strain_xy", "strain_yz", "strain_xz"};
  static constexpr const char *stress_keys[6] = {"stress_xx", "stress_yy", "stress_zz",
                                                 "stress_xy", "stress_yz", "stress_xz"};
  std::array<Function, 6>
      strain;  ///< natural, since the start, shear as the angle gamma; function of t from 0 to 1 [-]
  std::array<Function, 6> stress;  ///< total, positive in tension; function of t from 0 to 1 [Pa]
  template <class Visitor>
  void fields(Visitor &&v) {
    for (int i = 0; i < 6; ++i)
      v.function(strain_keys[i], strain[i], one, Range{-10, 10}, of::time,
                 i < 3 ? "natural strain since the start; t runs from 0 to 1"
                       : "angle of shear since the start; t runs from 0 to 1");
    for (int i = 0; i < 6; ++i)
      v.function(stress_keys[i], stress[i], pascal, Range{-1e12, 1e12}, of::time,
                 "total stress, positive in tension, instead of the strain");
  }
  std::string problem() const;
  bool given() const;
};

/// The axis of a sample is y. x and z are its sides; in plane strain z does not strain.
struct ElementTest {
  std::string name;  ///< the table's own name, [test.NAME]
  TestType type = TestType::triaxial_compression;
  double cell_pressure = 100e3;  ///< effective, at the start; constant on the sides (simple shear: on the top) [Pa]
  std::vector<double> stress;    ///< effective, at the start, instead: xx, yy, zz, xy, yz, xz, positive in tension [Pa]
  std::vector<double> strain = {0.1};  ///< prescribed in the direction of the test: the end of each leg [-]
  int steps = 200;                     ///< of each leg
  bool undrained = false;
  double skempton_b = 1;      ///< undrained: pressure rise over rise of the mean total stress, elastic [-]
  double pore_stiffness = 0;  ///< undrained: K_l / n instead of skempton_b [Pa]
  double pore_pressure = 0;   ///< at the start [Pa]
  double void_ratio = 0;      ///< at the start; 0: not known [-]
  double element_size = 0;    ///< h of a softening law; 0: its shape_factor holds as it is [m]
  Function suction;           ///< of the law's surroundings, over t from 0 to 1 in the whole test [Pa]
  double duration = 0;        ///< of each leg, for laws that flow with time [s]
  Control control;

  template <class Visitor>
  void fields(Visitor &&v) {
    v.choice(
        "type", type,
        {{"triaxial_compression", TestType::triaxial_compression},
         {"triaxial_extension", TestType::triaxial_extension},
         {"biaxial", TestType::biaxial},
         {"oedometer", TestType::oedometer},
         {"simple_shear", TestType::simple_shear},
         {"isotropic_compression", TestType::isotropic_compression},
         {"controlled", TestType::controlled}},
        "kind of test; y is the axis of the sample; biaxial has no strain along z; controlled uses the table control");
    v.number("cell_pressure", cell_pressure, pascal, Range{0, 1e10},
             "effective pressure at the start, which remains constant on the sides (simple shear: on the top)");
    v.point("stress", stress, pascal,
            "effective stress at the start, instead of cell_pressure: xx, yy, zz, and xy, yz, xz if they are not 0; "
            "positive in tension");
    v.point("strain", strain, one,
            "prescribed natural strain, positive in the direction of the test: shortening, lengthening (extension), "
            "gamma, loss of volume (isotropic); with a list the strain goes from each value to the next");
    v.integer("steps", steps, Range{1, 1000000}, "steps to each value of strain");
    v.flag("undrained", undrained, "water cannot leave the sample");
    v.number("skempton_b", skempton_b, one, Range{1e-6, 1},
             "undrained: ratio of the increments of pore pressure and mean total stress while the soil is elastic; 1: "
             "the volume of the sample is constant");
    v.number("pore_stiffness", pore_stiffness, pascal, Range{0, 1e15},
             "undrained: K_l / n, instead of skempton_b; 0: not used");
    v.number("pore_pressure", pore_pressure, pascal, Range{-1e10, 1e10}, "pore pressure at the start");
    v.number("void_ratio", void_ratio, one, Range{0, 100}, "void ratio at the start; 0: unknown");
    v.number("element_size", element_size, metre, Range{0, 1e5},
             "element size h for a softening law with a reference_size; 0: shape_factor is not scaled");
    v.function("suction", suction, pascal, Range{0, 1e10}, of::time,
               "suction for a law with suction_cohesion or suction_friction_rate, as a function of t, which runs from "
               "0 to 1 in the test; default: 0");
    v.number("duration", duration, second, Range{0, 1e12},
             "time in which the strain goes from each of its values to the next; fluids and mu_i need it");
    v.table("control", control,
            "controlled: prescribed components; the strain of a component that is not named is constant");
  }
  std::string problem() const;
};

/// A file of `talus soil`: a material, as a body of a scene has it, and its tests.
struct SoilFile {
  struct Material {
    DeferredTable law;
    template <class Visitor>
    void fields(Visitor &&v) {
      v.deferred("law", law, "soil law; its parameters are keys of the same table, as in [body.NAME]");
    }
  };
  std::string title;
  Material material;
  std::vector<ElementTest> test;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.text("title", title, "one line that says what the file shows");
    v.table("material", material, "soil that is tested by `talus soil`");
    v.named("test", test, "tests of the soil, [test.NAME]; for the soil of a scene, define them by --set");
  }
};

/// A point after a step. Order of components: xx, yy, zz, xy, yz, xz.
struct ElementState {
  std::array<double, 6> strain{};  ///< natural, since the start; shear as the angle gamma [-]
  std::array<double, 6> stress{};  ///< effective [Pa]
  double pore_pressure = 0;        ///< [Pa]
  double suction = 0;              ///< [Pa]
  double time = 0;                 ///< [s]
  std::vector<double> history;

  double mean_pressure() const {
    return -(stress[0] + stress[1] + stress[2]) / 3;
  }                                                                            ///< p', positive in compression [Pa]
  double deviator() const;                                                     ///< q = sqrt(3 J2) [Pa]
  double compression() const { return -(strain[0] + strain[1] + strain[2]); }  ///< loss of volume, natural [-]
};

/// Throws std::invalid_argument for a test with a suction that the law does not read, or without the duration that the
/// law needs.
void refuse_unsuitable(const Law &law, const ElementTest &test);

/// Takes the point through the test; the first state is the start. Throws ElementTestError where no stress fits the
/// prescribed deformation, and std::invalid_argument like refuse_unsuitable.
std::vector<ElementState> drive(const Law &law, const ElementTest &test);

class ElementTestError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace talus
