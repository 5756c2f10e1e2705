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
  /// What it waits for though the soil is as it asks; empty: nothing.
  virtual std::string waits_for() const { return ""; }
  /// May it end the stage before its duration?
  virtual bool early() const { return true; }
  /// What it has seen of the stage.
  virtual void serialize(Archive &) {}
};

/// The criterion that a stage asks for by its key `until`.
template <int dim>
std::unique_ptr<StopCriterion<dim>> make_stop_criterion(const Stage &stage);

}  // namespace talus
