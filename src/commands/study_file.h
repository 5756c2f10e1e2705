#pragma once
/// The file of `talus study`: a scene, the keys that vary and how, and what counts as failure. Numbers of a variable
/// are in its `unit`.
#include <algorithm>
#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "commands/sampling.h"
#include "scene/quantity.h"
#include "scene/reader.h"
#include "scene/required.h"

namespace talus {

inline constexpr Range any_number{-1e300, 1e300};

/// A normal distribution, or one whose logarithm is normal, that is cut off at its bounds and scaled to a total
/// probability of 1. Mean and standard deviation are those of the variable itself before that.
template <bool logarithmic>
struct OfMoments {
  static constexpr const char *name = logarithmic ? "lognormal" : "normal";
  double low = any_number.low, high = any_number.high;
  double mean = required, standard_deviation = 0, coefficient_of_variation = 0;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("mean", mean, one, any_number, "mean, in the unit of the variable");
    v.number("standard_deviation", standard_deviation, one, Range{0, 1e300},
             "standard deviation, in the unit of the variable; or coefficient_of_variation");
    v.number("coefficient_of_variation", coefficient_of_variation, one, Range{0, 100}, "standard deviation over mean");
    v.number("low", low, one, any_number, "the distribution is cut off below this value");
    v.number("high", high, one, any_number, "the distribution is cut off above this value");
  }
  double deviation() const {
    return standard_deviation > 0 ? standard_deviation : coefficient_of_variation * std::abs(mean);
  }
  /// Of the normal score, which is standard normal before the cut.
  double spread() const { return logarithmic ? std::sqrt(std::log1p(std::pow(deviation() / mean, 2))) : deviation(); }
  double score(double x) const {
    if (logarithmic) return x <= 0 ? -INFINITY : std::log(x / mean) / spread() + 0.5 * spread();
    return (x - mean) / spread();
  }
  double at(double score) const {
    return logarithmic ? mean * std::exp(spread() * (score - 0.5 * spread())) : mean + spread() * score;
  }
  double share(double x) const { return normal_distribution(score(x)); }
  double quantile(double u) const {
    const double below = share(low);
    return std::clamp(at(normal_quantile(below + u * (share(high) - below))), low, high);
  }
  std::string problem() const {
    if (logarithmic && !(mean > 0)) return "mean must be above 0 for a lognormal distribution";
    if ((standard_deviation > 0) == (coefficient_of_variation > 0))
      return "needs one of standard_deviation and coefficient_of_variation, above 0";
    if (!(deviation() > 0)) return "mean must differ from 0 where coefficient_of_variation gives the deviation";
    if (!(low < high)) return "low must be less than high = " + shortest(high);
    return share(high) - share(low) > 1e-6 ? "" : "low and high leave almost nothing of the distribution: take others";
  }
};
using Normal = OfMoments<false>;
using Lognormal = OfMoments<true>;

struct Uniform {
  static constexpr const char *name = "uniform";
  double low = required, high = required;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("low", low, one, any_number, "smallest value, in the unit of the variable");
    v.number("high", high, one, any_number, "largest value");
  }
  double quantile(double u) const { return low + u * (high - low); }
  std::string problem() const { return low < high ? "" : "low must be less than high = " + shortest(high); }
};

/// Numbers that are taken in turn; several such variables form a grid.
struct NumberList {
  static constexpr const char *name = "list";
  std::vector<double> values;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.point("values", values, one, "numbers in the unit of the variable; several variables with lists form a grid");
  }
  std::string problem() const { return values.empty() ? "needs values, a list of numbers" : ""; }
};

/// Words or other values of a scene, taken in turn.
struct Choices {
  static constexpr const char *name = "choice";
  std::vector<std::string> choices;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.texts("choices", choices, "values in quotes, each written as after --set key=");
  }
  std::string problem() const { return choices.empty() ? "needs choices, a list of values in quotes" : ""; }
};

using Variation = std::variant<Normal, Lognormal, Uniform, NumberList, Choices>;

struct StudyVariable {
  std::string name;
  std::vector<std::string> key;
  std::string unit;
  DeferredTable kind;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.texts("key", key, "key of the scene, as after --set: body.clay.cohesion; several keys take the same value");
    v.text("unit", unit,
           "unit of the numbers of this variable, such as kPa; without it they are in the unit of the key");
    v.deferred("kind", kind, "how the variable varies; further keys of the table belong to the kind");
  }
};

struct StudyCorrelation {
  std::vector<std::string> between;
  double coefficient = required;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.texts("between", between, "names of two variables with a distribution");
    v.number(
        "coefficient", coefficient, one, Range{-0.999, 0.999},
        "entry of the correlation matrix: the correlation of the normal scores of the two variables, for two normal "
        "ones their correlation");
  }
};

struct StudyCriterion {
  std::string name, outcome;
  double below = any_number.low, above = any_number.high;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.text("outcome", outcome, "column of study.csv, such as factor_of_safety or travel_distance_m; fails is 1 or 0");
    v.number("below", below, one, any_number, "the criterion is met where the outcome is below this number");
    v.number("above", above, one, any_number, "the criterion is met where the outcome is above this number");
  }
  std::string problem() const {
    if (outcome.empty()) return "needs outcome, the name of a column of study.csv";
    return (below > any_number.low) != (above < any_number.high) ? "" : "needs one of below and above";
  }
};

enum class StudyRuns { motion, factor_of_safety };

struct StudyFile {
  std::string title, scene;
  StudyRuns runs = StudyRuns::motion;
  int samples = 0, seed = 1;
  double confidence = 0.95;
  std::vector<std::string> set, measures;
  std::vector<StudyVariable> variable;
  std::vector<StudyCorrelation> correlation;
  std::vector<StudyCriterion> criterion;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.text("title", title, "one line that says what the study asks");
    v.text("scene", scene, "scene file, relative to the study, or the name of a gallery scene");
    v.choice("runs", runs, {{"motion", StudyRuns::motion}, {"factor_of_safety", StudyRuns::factor_of_safety}},
             "what is computed of each variant: all stages, as `talus run` does, or the factor of safety after the "
             "quasi-static stages, as `talus solve --factor-of-safety` does");
    v.integer("samples", samples, Range{0, 1e6},
              "number of samples of the distributions; more samples continue a study, since the first ones repeat");
    v.integer("seed", seed, Range{0, 2147483647}, "another seed gives other samples");
    v.number("confidence", confidence, one, Range{0.5, 0.9999}, "confidence of the interval of a probability");
    v.texts("set", set, "overrides of the scene in all runs, key.path=value");
    v.texts("measures", measures,
            "further outcomes, read off history.csv: COLUMN (at the end), COLUMN@TIME (at rest before: the last row) "
            "or max:COLUMN");
    v.named("variable", variable, "what varies, [variable.NAME]");
    v.list("correlation", correlation, "correlation of two variables; the others are independent");
    v.named("criterion", criterion, "what counts as failure, [criterion.NAME]: its probability is estimated");
  }
};

}  // namespace talus
