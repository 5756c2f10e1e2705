#pragma once
/// A function of place and time given by a scene: a number, a table of [t, value] points, or an expression.
#include <memory>
#include <string>
#include <vector>

namespace talus {

/// Value of a function at x, y, z [m], t [s]; `table` is the elevation of the water table at x where a scene key offers it.
/// Copies share one parsed expression; evaluation allocates nothing. Not for use by several threads at once.
class Function {
 public:
  Function() = default;                                             ///< not set
  Function(double value);                                           // NOLINT: a number is a function
  Function(std::vector<double> times, std::vector<double> values);  ///< linear between points, constant outside
  /// Throws std::invalid_argument with muParser's message when the text is no expression of x, y, z, t, table and the scene's [functions].
  Function(const std::string &expression, double scale);

  bool given() const { return given_; }
  bool constant() const { return given_ && !expression_ && times_.empty(); }
  double operator()(double x, double y, double z, double t, double table = 0) const;
  double operator()(double t) const { return (*this)(0, 0, 0, t); }

 private:
  struct Expression;
  bool given_ = false;
  double value_ = 0;
  std::vector<double> times_, values_;
  std::shared_ptr<Expression> expression_;
};

}  // namespace talus
