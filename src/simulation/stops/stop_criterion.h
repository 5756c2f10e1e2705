#pragma once
/// What ends a dynamic stage before its duration. A criterion is one file and one line in stop_criteria.cpp.
#include <memory>

#include "base/archive.h"

namespace talus {

struct Stage;
template <int dim>
struct Run;
struct Verdict;

template <int dim>
class StopCriterion {
 public:
  virtual ~StopCriterion() = default;
  /// Asked after each step: has the stage reached it? Says so in the run's log. Collective.
  virtual bool met(Run<dim> &run, const Verdict &verdict) = 0;
  /// Name of the output point whose speed it needs after each step; empty: none.
  virtual std::string watched_point() const { return ""; }
  /// Why it did not end the stage, as a clause about the root mean square speed of all soil at its end [m/s]; empty:
  /// the numbers say it.
  virtual std::string unmet(double /*speed*/) const { return ""; }
  /// What it has seen of the stage.
  virtual void serialize(Archive &) {}
};

/// The criterion that a stage asks for by its key `until`; null if its kind has none.
template <int dim>
std::unique_ptr<StopCriterion<dim>> make_stop_criterion(const Stage &stage);

}  // namespace talus
