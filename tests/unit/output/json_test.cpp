// Claims of output/json.h.
#include "output/json.h"

#include <gtest/gtest.h>

namespace talus::json {
namespace {

TEST(Json, KnowsNoInfiniteNumbers) {
  EXPECT_EQ(number(0.5), "0.5");
  EXPECT_EQ(number(NAN), "null");
  EXPECT_EQ(number(INFINITY), "null");
}

TEST(Json, QuotesText) { EXPECT_EQ(text("a \"b\" \\ c\n"), R"("a \"b\" \\ c ")"); }

TEST(Json, BuildsObjectsAndArrays) {
  EXPECT_EQ(Object().str(), "{}");
  const auto as_object = [](double x) { return Object().add("x", x).str(); };
  EXPECT_EQ(array(std::vector<double>{1, 2}, as_object), "[{\"x\": 1},\n  {\"x\": 2}]");
}

}  // namespace
}  // namespace talus::json
