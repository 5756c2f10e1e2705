#pragma once
/// A function of place and time given by a scene: a number, a table of [t, value] points, or an expression.
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace talus {

class Function;
struct PlaceGrid;
using NamedFunctions = std::map<std::string, Function>;                ///< the scene's [functions] of t
using NamedGrids = std::map<std::string, std::shared_ptr<PlaceGrid>>;  ///< the scene's [grids]

/// Variables that a key gives its function.
namespace of {
inline constexpr const char *time = "t", *place = "x, y, z", *place_and_time = "x, y, z, t",
                            *place_time_and_table = "x, y, z, t, table", *place_time_and_slip = "x, y, z, t, slip";
}  // namespace of

/// What a key admits as values of its function, and the first value that it did not. A function is evaluated deep
/// inside a step and on single ranks, where nothing can be thrown; the run asks for `fault` where all ranks can agree.
struct FunctionLimits {
  std::string key;              ///< place in the file, key and text, as complaints begin
  std::string expected;         ///< "a number from 0 to 70 deg"
  std::string unit;             ///< of the key, for messages
  double low = 0, high = 0;     ///< SI
  double si = 1;                ///< SI value of the unit
  mutable std::string fault{};  ///< a sentence; empty: every value so far was admissible
};

struct TimeSpan {
  double begin, end;  ///< [s]
};

/// Value of a function at x, y, z [m], t [s]; where a scene key offers them, `table` is the elevation of the water
/// table at x and `slip` the accumulated slip of a base [m]. Copies share one parsed expression; evaluation allocates
/// nothing. Not for use by several threads at once.
class Function {
 public:
  Function() = default;    ///< not set
  Function(double value);  // NOLINT: a number is a function
  /// Linear between points, constant outside. Throws std::invalid_argument unless the times rise and each has its
  /// value.
  Function(std::vector<double> times, std::vector<double> values);
  /// `scale` times the expression. Throws std::invalid_argument with muParser's message when the text is no expression
  /// of x, y, z, t, table, slip, pi, the named functions, each of which is called with one argument, and the grids,
  /// called with two. Where a grid has no value the expression has none.
  Function(const std::string &expression, double scale, const NamedFunctions &functions = {},
           const NamedGrids &grids = {});

  bool given() const { return given_; }
  bool constant() const { return given_ && !expression_ && times_.empty(); }
  bool depends_on_time() const { return !times_.empty() || uses("t"); }
  /// When it changes: between the points of a table that have different values, and where an expression calls such
  /// tables at t; an expression that has t in another place too does not tell, and may change at any time.
  std::vector<TimeSpan> changes() const;
  /// Does the expression name this variable: x, y, z, t, table or slip?
  bool uses(const std::string &variable) const;

  /// Times at which a table has its points [s]; none of another function.
  const std::vector<double> &times() const { return times_; }

  double operator()(double x, double y, double z, double t, double table = 0, double slip = 0) const;
  double operator()(double t) const { return (*this)(0, 0, 0, t); }
  /// The value, whether or not the limits admit it, without a fault: for places and times that nobody may ask for.
  double unlimited(double x, double y, double z, double t, double table = 0, double slip = 0) const;

  /// From now on values are held against these limits; numbers and tables, whose values the reader has checked, need
  /// none.
  void limit(std::shared_ptr<const FunctionLimits> limits);

 private:
  struct Expression;
  double interpolate(double t) const;

  bool given_ = false;
  double value_ = 0;
  std::vector<double> times_, values_;
  std::shared_ptr<Expression> expression_;
};

}  // namespace talus
