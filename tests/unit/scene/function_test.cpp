#include "scene/function.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <new>
#include <numbers>

#include "complaint.h"
#include "scene/place_grid.h"

namespace {
std::atomic<long> allocations = 0;
}
[[gnu::noinline]] void *operator new(std::size_t size) {
  ++allocations;
  if (void *memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void *operator new(std::size_t size, const std::nothrow_t &) noexcept {
  ++allocations;
  return std::malloc(size);
}
[[gnu::noinline]] void operator delete(void *memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void *memory, std::size_t) noexcept { std::free(memory); }

namespace talus {
namespace {

using Numbers = std::vector<double>;

TEST(Function, IsNotGivenByDefault) {
  EXPECT_FALSE(Function().given());
  EXPECT_FALSE(Function().constant());
}

TEST(Function, OfANumberIsConstant) {
  const Function function = 3.;
  EXPECT_TRUE(function.constant());
  EXPECT_FALSE(function.depends_on_time());
  EXPECT_EQ(function(1, 2, 3, 4), 3);
}

TEST(Function, OfATableIsLinearBetweenItsPointsAndConstantOutside) {
  const Function function(Numbers{0, 10, 20}, Numbers{1, 3, 0});
  EXPECT_TRUE(function.depends_on_time());
  EXPECT_EQ(function(-5), 1);
  EXPECT_EQ(function(0), 1);
  EXPECT_DOUBLE_EQ(function(5), 2);
  EXPECT_DOUBLE_EQ(function(10), 3);
  EXPECT_DOUBLE_EQ(function(15), 1.5);
  EXPECT_EQ(function(25), 0);
  EXPECT_EQ(Function(Numbers{2}, Numbers{7})(1), 7);
}

TEST(Function, OfATableHandsOnWhatIsNoNumber) {
  EXPECT_TRUE(std::isnan(Function(Numbers{0, 1}, Numbers{2, 3})(std::nan(""))));
}

TEST(Function, RefusesATableWhoseTimesDoNotRise) {
  EXPECT_TRUE(contains(complaint([] { Function(Numbers{0, 2, 1}, Numbers{0, 0, 0}); }), "must rise"));
  EXPECT_TRUE(contains(complaint([] { Function(Numbers{0, 0}, Numbers{0, 1}); }), "must rise"));
  EXPECT_TRUE(contains(complaint([] { Function(Numbers{0, 1}, Numbers{0}); }), "each with a time and a value"));
  EXPECT_TRUE(contains(complaint([] { Function(Numbers{}, Numbers{}); }), "at least one point"));
}

TEST(Function, OfAnExpressionKnowsPlaceTimeTableAndPi) {
  const Function function("x + 10*y + 100*z + 1000*t + 1e4*table + sin(pi/2)", 2);
  EXPECT_FALSE(function.constant());
  EXPECT_DOUBLE_EQ(function(1, 2, 3, 4, 5), 2 * 54322);
}

TEST(Function, SaysWhatItsExpressionUses) {
  const Function function("x*t", 1);
  EXPECT_TRUE(function.uses("x"));
  EXPECT_FALSE(function.uses("y"));
  EXPECT_TRUE(function.depends_on_time());
  EXPECT_FALSE(Function("x", 1).depends_on_time());
}

TEST(Function, CallsNamedFunctions) {
  const NamedFunctions named = {{"rain", Function(Numbers{0, 10}, Numbers{0, 5})}};
  const Function function("(x < 24) * rain(t) + rain(10)", 1, named);
  EXPECT_DOUBLE_EQ(function(0, 0, 0, 5), 7.5);
  EXPECT_DOUBLE_EQ(function(30, 0, 0, 5), 5);
}

/// The outermost values of a grid hold for half a spacing, and what an expression asks of it is asked inside the mesh.
TEST(Function, ReadsGridsAsFarAsTheirCellsReach) {
  const auto grid = std::make_shared<PlaceGrid>();
  grid->grid.columns = grid->grid.rows = 2;
  grid->grid.spacing = 4;
  grid->grid.values = {1, 2, 3, 4};
  const Function function("bed(x, y) + 0 * z", 1, {}, {{"bed", grid}}), other("x", 1, {}, {{"bed", grid}});
  EXPECT_DOUBLE_EQ(function(2, 2, 0, 0), 2.5);
  EXPECT_DOUBLE_EQ(function(-1.9, 5.9, 0, 0), 3) << "half a spacing";
  EXPECT_TRUE(std::isnan(function(-2.1, 0, 0, 0)));
  EXPECT_TRUE(std::isnan(function(0, 6.1, 0, 0)));
  grid->mesh = {std::array{-1., -1., 0.}, std::array{4., 4., 9.}};
  EXPECT_DOUBLE_EQ(function(-7, 0, 0, 0), 1) << "a node that has left the mesh";
  EXPECT_DOUBLE_EQ(function(11, 4.5, 20, 0), 4);
  EXPECT_DOUBLE_EQ(other(-7, 0, 0, 0), -7) << "an expression without grids is asked anywhere";
}

TEST(Function, KnowsWhenItChanges) {
  using Spans = std::vector<std::pair<double, double>>;
  const auto spans = [](const Function &function) {
    Spans found;
    for (const TimeSpan &span : function.changes()) found.emplace_back(span.begin, span.end);
    return found;
  };
  const double ever = std::numeric_limits<double>::infinity();
  EXPECT_EQ(spans(Function(3.)), Spans{});
  EXPECT_EQ(spans(Function(Numbers{0, 10}, Numbers{2, 2})), Spans{});
  EXPECT_EQ(spans(Function(Numbers{0, 10, 20, 30}, Numbers{2, 3, 3, 1})), (Spans{{0, 10}, {20, 30}}));
  EXPECT_EQ(spans(Function("x + 1", 1)), Spans{});
  EXPECT_EQ(spans(Function("min(t, 3)", 1)), (Spans{{-ever, ever}}));
  const NamedFunctions named = {{"rain", Function(Numbers{0, 10}, Numbers{0, 5})},
                                {"more_rain", Function(Numbers{0, 20, 30}, Numbers{0, 5, 5})},
                                {"still", Function(7.)}};
  const auto of = [&](const char *text) { return spans(Function(text, 1, named)); };
  EXPECT_EQ(of("(x < 24) * rain( t ) + still(t)"), (Spans{{0, 10}}));
  EXPECT_EQ(of("rain(t) + more_rain(t )").size(), 2u);
  EXPECT_EQ(of("still(t)"), Spans{});
  EXPECT_EQ(of("rain(3)"), Spans{});
  EXPECT_EQ(of("rain(t - 1)"), (Spans{{-ever, ever}}));
  EXPECT_EQ(of("rain(t) + t").size(), 2u);
}

TEST(Function, RefusesABadExpressionWithTheParsersMessage) {
  EXPECT_TRUE(contains(complaint([] { Function("1 +* x", 1); }), "Unexpected operator \"*\""));
  EXPECT_TRUE(contains(complaint([] { Function("2 * q", 1); }), "q"));
  EXPECT_TRUE(contains(complaint([] { Function("rain(t)", 1); }), "no function or grid `rain`"));
  EXPECT_TRUE(contains(complaint([] { Function("x = 3", 1); }), "equality is `==`"));
  EXPECT_EQ(complaint([] { Function("(x == 3) + (x >= 3) + (x != 3)", 1); }), "");
  EXPECT_TRUE(contains(complaint([] { Function("0,5", 1); }), "written with a point"));
  EXPECT_NE(complaint([] { Function("", 1); }), "");
}

TEST(Function, CopiesOutliveTheOriginal) {
  Function copy;
  {
    const Function original("x + 1", 1);
    copy = original;
  }
  EXPECT_EQ(copy(2, 0, 0, 0), 3);
}

TEST(Function, AllocatesNothingWhenEvaluated) {
  const NamedFunctions named = {{"rain", Function(Numbers{0, 10}, Numbers{0, 5})}, {"wave", Function("sin(t)", 1)}};
  const Function functions[] = {Function(2.), Function(Numbers{0, 1}, Numbers{2, 3}),
                                Function("x * rain(t) + max(y, wave(t), z)", 1, named)};
  double sum = 0;
  const long before = allocations;
  for (int i = 0; i < 100; ++i)
    for (const Function &function : functions) sum += function(i, 1, 2, 0.01 * i);
  EXPECT_EQ(allocations - before, 0);
  EXPECT_GT(sum, 0);
}

}  // namespace
}  // namespace talus
