#pragma once
/// What happened to the fluids of the pores since the start of a run, in motion and in stages of finite elements.
#include <cstddef>
#include <vector>

#include "base/archive.h"
#include "physics/pores/pore_report.h"

namespace talus {

class FluidBooks {
 public:
  /// Particles held `had`, took over a state of finite elements and hold `have`, while `entered` [kg] of water flowed
  /// in through the boundaries of the elements.
  void hand_over(const std::vector<FluidLedger> &had, const std::vector<FluidLedger> &have, double entered) {
    handed_.resize(had.size());
    seeped_ += entered;
    for (std::size_t a = 0; a < had.size(); ++a) handed_[a] += have[a].stored - had[a].stored - (a == 0 ? entered : 0);
  }

  /// Water that entered in stages of finite elements [kg].
  double seeped() const { return seeped_; }
  /// Masses that particles hold more, since they took states over, than the elements' balance gives [kg].
  double handed(std::size_t fluid) const { return fluid < handed_.size() ? handed_[fluid] : 0; }
  /// Water that came in during motion up to the last row, as a share of what there was at the start [-].
  double drawn() const { return first_.empty() || first_[0] == 0 ? 0 : drawn_ / first_[0]; }

  /// Makes `row` (a RunRow) count since the start of the run; its fluids are those that motion has counted.
  template <class Row>
  void show(double time, Row &row) {
    if (time == 0) before_ = row.fluids;
    before_.resize(row.fluids.size());
    for (std::size_t a = 0; a < row.fluids.size(); ++a)
      row.fluids[a].out -= before_[a].out, row.fluids[a].prescribed -= before_[a].prescribed;
    if (!row.fluids.empty()) drawn_ = -row.fluids[0].out, row.fluids[0].out -= seeped_;
    for (std::size_t a = 0; a < row.handed.size(); ++a) row.handed[a] = handed(a);
    if (first_.empty())
      for (std::size_t a = 0; a < row.fluids.size(); ++a) first_.push_back(row.owned(a));
    row.first_fluid = first_;
  }

  void serialize(Archive &archive) { archive.serialize("fluid books", before_, first_, handed_, seeped_, drawn_); }

 private:
  std::vector<FluidLedger> before_;  ///< before the run, where it starts at the state of another
  std::vector<double> first_;        ///< masses at the start [kg]
  std::vector<double> handed_;       ///< [kg]
  double seeped_ = 0, drawn_ = 0;    ///< [kg]
};

}  // namespace talus
