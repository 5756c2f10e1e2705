#pragma once
/// When the mesh is divided among the ranks in another way because soil has moved from some ranks to others,
/// docs/scaling.md. What balancing costs is counted in the unit of the work of steps (simulation/work.h), by rates that
/// were measured once and not by the clock of this run: so a run does the same whenever it is repeated or resumed.
#include <algorithm>

#include "base/archive.h"
#include "scene/scene.h"

namespace talus {

class Balancing {
 public:
  /// `cells` that one rank has to handle to divide the mesh; `divisible`: the mesh can be divided in another way.
  Balancing(BalanceRanks when, int ranks, long long cells, bool divisible)
      : when_(divisible ? when : BalanceRanks::never), ranks_(ranks), cells_(static_cast<double>(cells)) {}

  /// A step has been done, with this work on the rank that had most.
  void step(double largest) { largest_ = largest, ++steps_; }
  /// A remap follows: `all` is the work of all ranks in those steps.
  void remap(double all) {
    const double mean = all / ranks_;
    imbalance_ = mean > 0 ? largest_ / mean : 1;
    if (started_ < 1) started_ = imbalance_;
    highest_ = std::max(highest_, imbalance_);
    lost_ += static_cast<double>(steps_) * (largest_ - mean);
    if (before_ > 0) saved_ += static_cast<double>(steps_) * (before_ - imbalance_) * mean;
    done_ += static_cast<double>(steps_) * largest_;
    steps_ = 0;
    cost_ = per_cell * cells_ + per_work * largest_;
  }
  /// Is it time to look for another partition? After a remap.
  bool due() const {
    // Soil that moves on loses more with each step: the sum of losses and costs is least when both are equal.
    constexpr double limit = 1.05;  // below it no partition is much better, since patches stay whole
    if (when_ == BalanceRanks::always) return true;
    return when_ == BalanceRanks::when_it_pays && imbalance_ > limit && lost_ > cost_;
  }
  /// Is a partition that is known to have this imbalance worth it? If not, it is time again after as much loss.
  bool worth(double expected) {
    constexpr double least_gain = 0.03;
    if (when_ == BalanceRanks::always) return true;
    if (imbalance_ - expected > least_gain) return true;
    lost_ = 0;
    return false;
  }
  /// It was done, in this time of the clock [s].
  void done(double seconds) {
    before_ = std::max(before_, imbalance_), lost_ = 0, ++count_;
    seconds_ += seconds;
  }

  double cost() const { return cost_; }            ///< of a new partition, in work
  double imbalance() const { return imbalance_; }  ///< up to the last remap
  double at_start() const { return started_; }     ///< since this program began or resumed the run; 0: not known
  double highest() const { return highest_; }      ///< likewise
  long long count() const { return count_; }       ///< of balancings in the whole run
  double seconds() const { return seconds_; }      ///< that they took since this program began or resumed the run [s]
  /// Work that the steps would have had in addition without them, over the work that they had: an estimate, as if the
  /// imbalance before the first balancing, or a larger one later, had lasted.
  double saved() const { return done_ > 0 ? saved_ / done_ : 0; }

  void serialize(Archive &archive) { archive.serialize("balancing", lost_, largest_, steps_, count_, before_); }

 private:
  // Measured, docs/scaling.md, in the unit of work: to divide the mesh anew takes this much for each of its cells, and
  // to move the state this much for the work of the rank that has most.
  static constexpr double per_cell = 270, per_work = 6;

  BalanceRanks when_;
  int ranks_;
  double cells_;
  double lost_ = 0;      ///< work that ranks have waited for since the last balancing
  double largest_ = 0;   ///< work of the rank that had most in the last step
  double before_ = 0;    ///< largest imbalance at a balancing
  long long steps_ = 0;  ///< since the last remap
  long long count_ = 0;
  double imbalance_ = 1, cost_ = 0, started_ = 0, highest_ = 0, saved_ = 0, done_ = 0, seconds_ = 0;
};

}  // namespace talus
