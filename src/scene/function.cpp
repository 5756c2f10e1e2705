#include "scene/function.h"

#include <muParser.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>

#include "scene/place_grid.h"
#include "scene/words.h"

namespace talus {

/// muParser reads its variables where they were bound: here, so it can be neither copied nor moved.
struct Function::Expression {
  Expression(const std::string &text, double factor, const NamedFunctions &named, const NamedGrids &of_places)
      : functions(named), grids(of_places), scale(factor) {
    parser.DefineVar("x", &x);
    parser.DefineVar("y", &y);
    parser.DefineVar("z", &z);
    parser.DefineVar("t", &t);
    parser.DefineVar("table", &table);
    parser.DefineVar("slip", &slip);
    parser.DefineConst("pi", std::numbers::pi);
    for (auto &[name, function] : functions) parser.DefineFunUserData(name, call, &function);
    for (auto &[name, grid] : grids) parser.DefineFunUserData(name, look_up, grid.get(), false);
    parser.SetExpr(text);
    for (const auto &[name, address] : parser.GetUsedVar()) used.insert(name);
    for (auto &[name, grid] : grids)
      if (std::regex_search(text, std::regex("\\b" + name + "\\s*\\("))) reads = grid;
    (void)parser.Eval();  // translates the text, so that later calls only run it
    if (parser.GetNumResults() != 1) throw std::invalid_argument("two values; decimals are written with a point");
  }
  Expression(const Expression &) = delete;
  Expression &operator=(const Expression &) = delete;

  static double call(void *function, double t) { return (*static_cast<const Function *>(function))(t); }
  static double look_up(void *grid, double x, double y) { return static_cast<const PlaceGrid *>(grid)->at(x, y); }

  /// Value before `scale`; not a number where a grid has none, also where the expression went on without it.
  double value() {
    for (auto &[name, grid] : grids) grid->missed = false;
    if (reads) {
      const auto &[low, high] = reads->mesh;
      x = std::clamp(x, low[0], high[0]), y = std::clamp(y, low[1], high[1]), z = std::clamp(z, low[2], high[2]);
    }
    const double found = parser.Eval();
    return missed() ? std::numeric_limits<double>::quiet_NaN() : found;
  }
  /// The grid that had no value at the last place; null: none.
  const PlaceGrid *missed() const {
    for (auto &[name, grid] : grids)
      if (grid->missed) return grid.get();
    return nullptr;
  }

  /// Keeps the first value that its key does not admit.
  void report(double value) const;
  void add_changes(std::vector<TimeSpan> &spans) const;

  mu::Parser parser;
  NamedFunctions functions;
  NamedGrids grids;
  std::shared_ptr<const PlaceGrid> reads;  ///< one of the grids that the expression calls, all of which know the mesh
  std::set<std::string> used;
  std::shared_ptr<const FunctionLimits> limits;
  double scale;
  double x = 0, y = 0, z = 0, t = 0, table = 0, slip = 0;
};

namespace {

/// `x = 3` would be an assignment to muParser; `==`, `<=`, `>=` and `!=` are comparisons.
bool assigns(const std::string &text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '=') continue;
    if (i + 1 < text.size() && text[i + 1] == '=') {
      ++i;
    } else if (i == 0 || std::string("<>!").find(text[i - 1]) == std::string::npos) {
      return true;
    }
  }
  return false;
}

/// A name that the text calls and that nothing has; empty where there is none.
std::string unknown_call(const std::string &text, const NamedFunctions &functions, const NamedGrids &grids) {
  const mu::Parser parser;
  const std::regex call("([A-Za-z_][A-Za-z_0-9]*)\\s*\\(");
  for (auto found = std::sregex_iterator(text.begin(), text.end(), call); found != std::sregex_iterator(); ++found)
    if (const std::string name = (*found)[1];
        !parser.GetFunDef().contains(name) && !functions.contains(name) && !grids.contains(name))
      return name;
  return "";
}

/// muParser's message; for what it did not recognise, the names that it would have beside the variables, which the key
/// decides on.
std::string message(const mu::Parser::exception_type &error, const std::string &text, const NamedFunctions &functions,
                    const NamedGrids &grids) {
  std::string names = "pi";
  std::vector<std::string> calls;
  for (const auto &[name, function] : functions) names += ", " + name + "()", calls.push_back(name);
  for (const auto &[name, grid] : grids) names += ", " + name + "(x, y)", calls.push_back(name);
  const bool unknown = error.GetCode() == mu::ecUNASSIGNABLE_TOKEN || error.GetCode() == mu::ecUNEXPECTED_PARENS;
  if (const std::string name = unknown_call(text, functions, grids); unknown && !name.empty()) {
    const std::string near = nearest(name, calls);
    return "there is no function or grid `" + name + "`" + (near.empty() ? "." : "; did you mean `" + near + "`?") +
           " It may name " + names;
  }
  return error.GetMsg() + (unknown ? " It may also name " + names : "");
}

}  // namespace

void Function::Expression::add_changes(std::vector<TimeSpan> &spans) const {
  std::string rest = parser.GetExpr();
  for (const auto &[name, function] : functions) {
    const std::regex call("\\b" + name + "\\s*\\(\\s*t\\s*\\)");
    if (!std::regex_search(rest, call)) continue;
    const std::vector<TimeSpan> its = function.changes();
    spans.insert(spans.end(), its.begin(), its.end());
    rest = std::regex_replace(rest, call, "0");
  }
  constexpr double ever = std::numeric_limits<double>::infinity();
  if (std::regex_search(rest, std::regex("\\bt\\b"))) spans.push_back({-ever, ever});
}

void Function::Expression::report(double value) const {
  if (!limits->fault.empty()) return;
  std::ostringstream text;
  text.precision(6);
  text << limits->key << " must be " << limits->expected << "; it is ";
  if (std::isnan(value))
    text << "no number at ";
  else
    text << value / limits->si << limits->unit << " at ";
  const char *comma = "";
  for (const auto &[name, at] : {std::pair{"x", x}, {"y", y}, {"z", z}, {"table", table}, {"slip", slip}})
    if (used.contains(name)) text << comma << name << " = " << at << " m", comma = ", ";
  text << comma << "t = " << t << " s";
  if (const PlaceGrid *grid = missed()) {
    const Grid &g = grid->grid;
    const auto [east, north] = grid->missed_at;
    const bool outside = east < g.west || east > g.east() || north < g.south || north > g.north();
    text.precision(12);
    text << ": " << grid->file << " has no value at (" << east << ", " << north << ") m, ";
    if (outside)
      text << "since it reaches from (" << g.west << ", " << g.south << ") to (" << g.east() << ", " << g.north()
           << "); give a grid that covers the soil, in the coordinates of "
           << (grid->origin == std::array<double, 2>{} ? "the mesh" : "the terrain");
    else
      text << "beside a place without data; fill it, such as by gdal_fillnodata.py";
  }
  limits->fault = text.str();
}

Function::Function(double value) : given_(true), value_(value) {}

Function::Function(std::vector<double> times, std::vector<double> values)
    : given_(true), times_(std::move(times)), values_(std::move(values)) {
  if (times_.empty() || times_.size() != values_.size())
    throw std::invalid_argument("a table needs at least one point, each with a time and a value");
  const bool rising = std::adjacent_find(times_.begin(), times_.end(), std::greater_equal<>()) == times_.end();
  if (!rising) throw std::invalid_argument("the times of a table must rise from point to point");
}

Function::Function(const std::string &expression, double scale, const NamedFunctions &functions,
                   const NamedGrids &grids)
    : given_(true) {
  if (assigns(expression)) throw std::invalid_argument("`=` assigns; equality is `==`");
  try {
    expression_ = std::make_shared<Expression>(expression, scale, functions, grids);
  } catch (const mu::Parser::exception_type &error) {
    throw std::invalid_argument(message(error, expression, functions, grids));
  }
}

std::vector<TimeSpan> Function::changes() const {
  std::vector<TimeSpan> spans;
  for (std::size_t i = 1; i < times_.size(); ++i)
    if (values_[i] != values_[i - 1]) spans.push_back({times_[i - 1], times_[i]});
  if (uses("t")) expression_->add_changes(spans);
  return spans;
}

bool Function::uses(const std::string &variable) const { return expression_ && expression_->used.contains(variable); }

double Function::unlimited(double x, double y, double z, double t, double table, double slip) const {
  if (!times_.empty()) return interpolate(t);
  if (!expression_) return value_;
  Expression &e = *expression_;
  e.x = x, e.y = y, e.z = z, e.t = t, e.table = table, e.slip = slip;
  return e.scale * e.value();
}

double Function::operator()(double x, double y, double z, double t, double table, double slip) const {
  const double value = unlimited(x, y, z, t, table, slip);
  if (!expression_) return value;
  Expression &e = *expression_;
  const bool admissible = !e.limits || (value >= e.limits->low && value <= e.limits->high);  // false also for NaN
  if (!admissible) e.report(value);
  return value;
}

void Function::limit(std::shared_ptr<const FunctionLimits> limits) {
  if (expression_) expression_->limits = std::move(limits);
}

double Function::interpolate(double t) const {
  if (std::isnan(t)) return t;  // an expression may call a table with 0/0
  if (t <= times_.front()) return values_.front();
  if (t >= times_.back()) return values_.back();
  const auto after = std::upper_bound(times_.begin(), times_.end(), t) - times_.begin();
  const double share = (t - times_[after - 1]) / (times_[after] - times_[after - 1]);
  return (1 - share) * values_[after - 1] + share * values_[after];
}

}  // namespace talus
