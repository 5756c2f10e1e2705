#pragma once
/// What a rung of the verification ladder sees of the program: its own scene, run with overrides by the reader and the
/// time loop of every user, and the numbers of the results that it compares with exact ones.
#include <cmath>
#include <string>
#include <vector>

#include "commands/slice.h"
#include "physics/laws/element_test.h"
#include "simulation.h"

namespace talus {

/// One run of a scene, the same on all ranks; particles are those of all ranks, sorted by number.
struct Run {
  HistoryTable history;
  std::vector<Event> events;
  Snapshot start, end;
  long long steps = 0, remaps = 0;
  double nodal_speed = 0;  ///< largest component of the velocity of a node at the end [m/s]
};

/// A number of the results beside the exact one.
struct Checked {
  std::string name;
  double exact, computed;
  double relative_error;  ///< |computed - exact| over |exact|, or over the scale that the rung names
  double tolerance;       ///< infinite: reported only, nothing is claimed
  double wall_seconds;    ///< of the runs it rests on

  bool holds() const { return std::isinf(tolerance) || relative_error <= tolerance; }
};

class Rung {
 public:
  /// `longer` asks for the finer studies.
  Rung(std::string scene, bool longer) : scene_(std::move(scene)), longer_(longer) {}

  bool longer() const { return longer_; }
  /// Runs the rung's scene with these overrides (key.path=value), without writing files.
  Run run(const std::vector<std::string> &overrides = {});
  /// Factor of safety of the rung's scene with these overrides.
  FactorOfSafety factor_of_safety(const std::vector<std::string> &overrides = {});
  /// An element test of the rung's scene, which is then a file of `talus soil`. Throws std::out_of_range for an unknown
  /// name.
  std::vector<ElementState> element_test(const std::string &name, const std::vector<std::string> &overrides = {});
  /// Claims that a number is right to within a tolerance relative to `scale`; 0 takes the exact value itself.
  void compare(const std::string &quantity, double exact, double computed, double tolerance, double scale = 0);
  /// States a number without a claim.
  void report(const std::string &quantity, double exact, double computed, double scale = 0);

  const std::vector<Checked> &quantities() const { return quantities_; }

 private:
  std::string scene_;
  bool longer_, compared_ = false;
  double wall_seconds_ = 0;
  std::vector<Checked> quantities_;
};

/// Overrides for either dimension, with more behind them.
inline std::vector<std::string> in_dimension(int dimension, const std::vector<std::string> &more = {}) {
  std::vector<std::string> all;
  if (dimension == 3) all = slice;
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

/// A number as it stands in an override or an expression, in the fewest digits that give it back.
std::string number(double x);

/// "2D" or "3D", for names of quantities.
inline std::string name_of(int dimension) { return std::to_string(dimension) + "D"; }

/// One component of a field of a snapshot, by particle. Throws std::out_of_range.
std::vector<double> component(const Snapshot &snapshot, const std::string &field, int k = 0);

/// Value of a history column at a time, linear between rows. Throws std::out_of_range.
double at_time(const HistoryTable &history, const std::string &column, double t);

}  // namespace talus
