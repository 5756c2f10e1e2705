#pragma once
/// When the mesh is divided among the ranks in another way because soil has moved from some ranks to others,
/// docs/scaling.md. What balancing costs is counted in the unit of the work of steps (simulation/work.h), by rates that
/// were measured once and not by the clock of this run: so a run does the same whenever it is repeated or resumed.
#include <algorithm>

#include "base/archive.h"
#include "meshes/partition.h"
#include "scene/balance_ranks.h"

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
    constexpr double newest = 1. / 20;  // runs grow with the remaps since the last sort (simulation/work.h)
    mean_ = all / ranks_;
    imbalance_ = mean_ > 0 ? largest_ / mean_ : 1;
    highest_ = std::max(highest_, imbalance_);
    const double loss = largest_ - mean_;
    loss_ += newest * (loss - loss_);
    lost_ += static_cast<double>(steps_) * loss;
    if (before_ > 0) saved_ += static_cast<double>(steps_) * (before_ - imbalance_) * mean_;
    done_ += static_cast<double>(steps_) * largest_;
    before_remap_ = std::max(1LL, steps_), steps_ = 0;
    cost_ = per_cell * cells_ + per_work * largest_;
  }
  /// Is it time to look for another partition? After a remap.
  bool due() const {
    constexpr double limit = 0.05;   // below this imbalance no partition is much better, since patches stay whole
    constexpr double share = 0.125;  // of the cost, which ranks lose before it is asked again
    if (when_ == BalanceRanks::always) return true;
    return when_ == BalanceRanks::when_it_pays && loss_ > limit * mean_ && lost_ > share * cost_;
  }
  /// Is this partition worth it, where about `steps` follow? If not, it is time again after as much loss. What ranks
  /// lose in a step now has to be more than the partitions that follow and the losses between them will cost in each.
  bool worth(const PartitionForecast &forecast, double steps) {
    constexpr double least_gain = 0.03;
    constexpr double margin = 2;  // soil may come to rest before the end of its stage
    if (when_ == BalanceRanks::always) return true;
    const double gain = loss_ - (forecast.imbalance - 1) * mean_;
    if (gain > least_gain * mean_ && gain > cost_of_crossing(forecast.crossing, cost_) && gain * steps > margin * cost_)
      return true;
    lost_ = 0;
    return false;
  }
  /// It was done, in this time of the clock [s].
  void done(double seconds) {
    before_ = std::max(before_, smoothed()), lost_ = 0, loss_ = 0, ++count_, ++here_;
    seconds_ += seconds;
  }

  long long steps() const { return steps_; }                             ///< since the last remap
  long long steps_before() const { return before_remap_; }               ///< that the last remap followed on
  double cost() const { return cost_; }                                  ///< of a new partition, in work
  double smoothed() const { return mean_ > 0 ? 1 + loss_ / mean_ : 1; }  ///< imbalance, over some remaps
  double highest() const { return highest_; }     ///< imbalance since this program began or resumed the run
  long long count() const { return count_; }      ///< of balancings in the whole run
  long long count_here() const { return here_; }  ///< of those since this program began or resumed the run
  double seconds() const { return seconds_; }     ///< that these took [s]
  /// Work that the steps would have had in addition without them, over the work that they had: an estimate, as if the
  /// imbalance before the first balancing, or a larger one later, had lasted.
  double saved() const { return done_ > 0 ? saved_ / done_ : 0; }

  void serialize(Archive &archive) { archive.serialize("balancing", lost_, loss_, largest_, steps_, count_, before_); }

 private:
  // Measured, docs/scaling.md, in the unit of work: to divide the mesh anew takes this much for each of its cells, and
  // to move the state this much for the work of the rank that has most.
  static constexpr double per_cell = 200, per_work = 6;

  BalanceRanks when_;
  int ranks_;
  double cells_;
  double lost_ = 0;      ///< work that ranks have waited for since the last balancing, or since one was not worth it
  double loss_ = 0;      ///< the same in a step, smoothed
  double largest_ = 0;   ///< work of the rank that had most in the last step
  double before_ = 0;    ///< largest imbalance at a balancing
  long long steps_ = 0;  ///< since the last remap
  long long before_remap_ = 1;
  long long count_ = 0, here_ = 0;
  double mean_ = 0, imbalance_ = 1, cost_ = 0, highest_ = 0, saved_ = 0, done_ = 0, seconds_ = 0;
};

}  // namespace talus
