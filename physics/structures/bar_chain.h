#pragma once
/// A bar as a chain of axial elements between points that slip along the soil, docs/theory/structures.md section 2. The
/// soil stretches the line of each element; the chain finds the slips by which the forces at each point balance: the
/// least of a convex energy, so that the answer is unique and the force on the soil is its derivative. It knows neither
/// dimension nor mesh.
#include <vector>

namespace talus {

struct BarElement {
  double stiffness = 0;    ///< E A / L [N/m]
  double tension = 0;      ///< force at which it yields [N]
  double compression = 0;  ///< likewise; 0: it becomes slack [N]
  double length = 0;       ///< [m]
  double pull = 0;     ///< force that its elastic stretch would give; below zero where it is slack [N], committed ...
  double yielded = 0;  ///< plastic stretch [m], committed
  char held = 0;       ///< its force stays `pull` whatever its stretch, as while a jack pulls it
  char torn = 0;       ///< it bears nothing any more
  char absent = 0;     ///< there is no soil at one of its ends: it bears nothing
};

/// Bond at a point, and the plate at a head.
struct BondPoint {
  double stiffness = 0;  ///< force per slip [N/m]
  double limit = 0;      ///< largest force [N]
  double force = 0;      ///< on the soil along the bar, towards its end [N], committed
  double slip = 0;       ///< of the bar against the soil, towards its end [m], committed
};

class BarChain {
 public:
  std::vector<BarElement> element;  ///< between the points k and k + 1
  std::vector<BondPoint> point;     ///< one more
  double divisor = 1;               ///< of all limits, in trials of a factor of safety

  /// Trial state after the soil has stretched the lines of the elements by `stretch` [m] since the committed state.
  /// False if the iterations did not end, which round-off alone can cause.
  bool deform(const std::vector<double> &stretch);
  double force(int e) const { return force_of(e, trial_pull(e)); }  ///< of an element, tension positive [N], trial
  double committed_force(int e) const { return force_of(e, element[e].pull); }
  /// d force / d stretch at the trial state by rows, times `plastic`, plus `elastic` times that of a bar which neither
  /// yields nor slips nor slackens [N/m].
  void tangent(double plastic, double elastic, std::vector<double> &rows) const;
  /// Accepts the trial state.
  void commit();
  /// Elements whose plastic strain at the trial state exceeds `strain`, counted from 0; -1: none.
  int to_tear(double strain) const;

 private:
  int elements() const { return static_cast<int>(element.size()); }
  bool bears(int e) const { return !element[e].torn && !element[e].absent; }
  double elongation(int e) const { return stretch_[e] + slip_[e + 1] - slip_[e]; }
  double trial_pull(int e) const {
    return element[e].pull + (element[e].held || stretch_.empty() ? 0 : element[e].stiffness * elongation(e));
  }
  double force_of(int e, double pull) const;
  double bond_of(int i) const;
  double stiffness_of(int e, bool elastic) const;
  double stiffness_at(int i, bool elastic) const;
  void unbalanced(std::vector<double> &force) const;
  void solve(const std::vector<double> &along, const std::vector<double> &at, std::vector<double> &x) const;
  double share_of_step(const std::vector<double> &step);

  std::vector<double> stretch_, slip_;  ///< of the trial state, since the committed one [m]
};

}  // namespace talus
