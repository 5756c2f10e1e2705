#include "simulation/fluid_books.h"

#include <gtest/gtest.h>

#include "simulation/output_fields.h"

namespace talus {
namespace {

/// A row of motion in which this much water is stored, has left, and was put in by prescribed pressures.
RunRow<2> row(double stored, double out, double prescribed) {
  RunRow<2> row;
  row.fluids = {{stored, out, prescribed}}, row.handed.resize(1);
  return row;
}

/// Masses since the start, through a hand-over that loses 2 kg of the 10 that entered.
TEST(FluidBooks, close_through_motion_and_elements) {
  FluidBooks books;
  RunRow<2> start = row(100, 7, 3);  // of the run whose state this one starts from
  books.show(0, start);
  EXPECT_EQ(start.fluids[0].out, 0);
  EXPECT_EQ(start.owned(0), 100);

  RunRow<2> moved = row(95, 13, 4);
  books.show(1, moved);
  EXPECT_EQ(moved.fluids[0].out, 6);
  EXPECT_EQ(moved.owned(0), 100);
  EXPECT_EQ(books.drawn(), -0.06);

  books.hand_over({{95, 13, 4}}, {{103, 13, 4}}, 10);
  RunRow<2> rained = row(103, 13, 4);
  books.show(2, rained);
  EXPECT_EQ(rained.fluids[0].stored, 103);
  EXPECT_EQ(rained.fluids[0].out, -4);
  EXPECT_EQ(rained.handed[0], -2);
  EXPECT_EQ(rained.owned(0), rained.first_fluid[0]);
  EXPECT_EQ(books.drawn(), -0.06) << "rain on elements is not what opening pores draw in";
}

}  // namespace
}  // namespace talus
