#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "physics/laws/history.h"
#include "physics/laws/isotropic_elastic.h"
#include "physics/laws/law.h"

namespace talus {

/// The user's own law: a subroutine UMAT in a shared library, with the argument list that Abaqus gives it (Abaqus User
/// Subroutines Reference, UMAT) and Fortran's calling convention. docs/theory/laws/umat.md says which arguments carry
/// what. Stress order of Abaqus, 11, 22, 33, 12, 13, 23, shear strain as the angle, stress and strain positive in
/// tension.
///
/// It is called point by point, not in the blocks of the other laws.
struct Umat : IsotropicElastic {
  static constexpr const char *name = "umat";
  static constexpr const char *meaning = "law of your own: an Abaqus-style UMAT in a shared library";
  static constexpr bool stiffens = true;  // as far as its moduli can tell
  static constexpr const char *no_reduction = "keeps its strength in PROPS, which only the UMAT understands";

  std::string library;                ///< path
  std::string subroutine = "umat_";   ///< symbol; gfortran's name of UMAT
  std::vector<double> props;          ///< PROPS, SI and radians
  int nstatv = -1;                    ///< NSTATV; -1: the number of names in `state`
  std::vector<std::string> state;     ///< names of the first state variables
  std::vector<HistoryField> history;  ///< one per state variable; set by problem()

  template <class Visitor>
  void fields(Visitor &&v) {
    IsotropicElastic::fields(v);
    v.path("library", library, "shared library with the UMAT, relative to this file");
    v.text("subroutine", subroutine,
           "symbol of the subroutine in the library; gfortran gives SUBROUTINE UMAT the symbol umat_");
    v.quantities("props", props, "PROPS: numbers, or quantities, which the UMAT receives in SI units and radians");
    v.integer("nstatv", nstatv, Range{-1, 1000},
              "NSTATV, number of state variables; -1: the number of names in `state`");
    v.texts("state", state,
            "names of the state variables in results; plastic_strain is drawn as for other laws; variables without a "
            "name are called state_N");
  }

  /// Loads the library.
  std::string problem();
  /// Calls the UMAT with stress and strain of the order of kPa and per mille; what is wrong with what it does, or "".
  std::string problem_in(int dim) const;

  bool comes_apart() const { return false; }
  bool strength_varies() const { return nstatv > 0; }

  /// One point. `stress` and `strain` (tensor components) in the order of stress.h, already turned to the end of the
  /// step; `rotation` row-major [9]; `state` [nstatv] in and out; `tangent` [size][size] gets DDSDDE in that order for
  /// shear as the angle, unless null.
  struct Point {
    int size;  ///< 4 or 6
    double *stress;
    const double *strain;
    double *state;
    const double *rotation;
    int cell;
    double element_size, time, time_step;
    double *tangent;
  };
  void call(const Point &point) const;

  /// The first thing that went wrong in a call.
  const LawTrouble &trouble() const;

 private:
  struct Loaded;
  std::shared_ptr<Loaded> loaded_;  ///< shared by the copies of a law
};

}  // namespace talus
