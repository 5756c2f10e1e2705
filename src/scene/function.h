#pragma once
/// A function of place and time given by a scene: a number, a table of [t, value] points, or an expression.
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace talus {

class Function;
using NamedFunctions = std::map<std::string, Function>;  ///< the scene's [functions] of t

/// Value of a function at x, y, z [m], t [s]; `table` is the elevation of the water table at x where a scene key offers
/// it. Copies share one parsed expression; evaluation allocates nothing. Not for use by several threads at once.
class Function {
 public:
  Function() = default;    ///< not set
  Function(double value);  // NOLINT: a number is a function
  /// Linear between points, constant outside. Throws std::invalid_argument unless the times rise and each has its
  /// value.
  Function(std::vector<double> times, std::vector<double> values);
  /// `scale` times the expression. Throws std::invalid_argument with muParser's message when the text is no expression
  /// of x, y, z, t, table, pi and the named functions, each of which is called with one argument.
  Function(const std::string &expression, double scale, const NamedFunctions &functions = {});

  bool given() const { return given_; }
  bool constant() const { return given_ && !expression_ && times_.empty(); }
  bool depends_on_time() const { return !times_.empty() || uses("t"); }
  /// Does the expression name this variable: x, y, z, t or table?
  bool uses(const std::string &variable) const;

  double operator()(double x, double y, double z, double t, double table = 0) const;
  double operator()(double t) const { return (*this)(0, 0, 0, t); }

 private:
  struct Expression;
  double interpolate(double t) const;

  bool given_ = false;
  double value_ = 0;
  std::vector<double> times_, values_;
  std::shared_ptr<Expression> expression_;
};

}  // namespace talus
