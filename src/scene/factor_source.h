#pragma once
/// [factor_of_safety]: the search for it.
#include <vector>

#include "base/units.h"

namespace talus {

/// Where stages of kind = "factor_of_safety", and `talus solve --factor-of-safety`, divide strength, and how many
/// mechanisms they search for.
struct FactorSource {
  std::vector<std::vector<double>> within;         ///< polygon x, elevation [m]; empty: everywhere
  std::vector<std::vector<double>> along;          ///< line x, elevation [m]; empty: everywhere
  double width = 0;                                ///< of the band along the line [m]; 0: two cells
  std::vector<std::vector<double>> tension_crack;  ///< line x, elevation: lower end of cracks [m]; empty: none
  double crack_water = no_water;                   ///< elevation to which water stands in them [m]
  static constexpr double no_water = -1e5;
  int mechanisms = 1;
  bool by_damped_motion = true;  ///< no key: trials that iterations leave undecided go by damped motion, which takes
                                 ///< minutes; otherwise soil with psi < phi fails there
  template <class Visitor>
  void fields(Visitor &&v) {
    v.points(
        "within", within, metre,
        "polygon of points [x, elevation] to which the search is confined: strength is divided inside it, elsewhere "
        "soil keeps its strength; in 3D across its whole width");
    v.points(
        "along", along, metre,
        "line of points [x, elevation] along which soil may slip: strength is divided in a band on it, elsewhere soil "
        "keeps its strength; in 3D across its whole width");
    v.number("width", width, metre, Range{0, 1e5}, "width of the band on the line `along`; 0: two cells");
    v.points("tension_crack", tension_crack, metre,
             "line of points [x, elevation] down to which cracks reach: soil above it bears no tension; between its "
             "ends; in "
             "3D across the whole width");
    v.number(
        "crack_water", crack_water, metre, Range{no_water, 1e5},
        "elevation to which water stands in the cracks above the line tension_crack; its pressure pushes the soil on "
        "both sides; default: dry");
    v.integer("mechanisms", mechanisms, Range{1, 10},
              "number of mechanisms that are searched for: the one with the least factor, then those with the next "
              "larger factors that move other soil");
  }
};

}  // namespace talus
