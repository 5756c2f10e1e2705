// Energy that is created is told once, and a run that has created more than there was is to end.
#include "simulation/energy_watch.h"

#include <gtest/gtest.h>

namespace talus {
namespace {

TEST(EnergyWatch, is_silent_while_energy_is_lost) {
  EnergyWatch watch;
  for (const double dissipated : {0., 10., 40., 39.5, 80., 79.}) EXPECT_EQ(watch.look(dissipated, 100), "");
  EXPECT_FALSE(watch.beyond_all());
}

TEST(EnergyWatch, tells_once_what_is_created) {
  EnergyWatch watch;
  EXPECT_EQ(watch.look(40, 100), "");
  const std::string told = watch.look(34, 100);
  EXPECT_NE(told.find("energy is created: 6 J, of 100 J"), std::string::npos) << told;
  EXPECT_EQ(watch.look(20, 100), "");
  EXPECT_FALSE(watch.beyond_all());
  EXPECT_EQ(watch.look(-61, 100), "");
  EXPECT_TRUE(watch.beyond_all()) << watch.verdict();
}

TEST(EnergyWatch, begins_anew_where_energy_does) {
  EnergyWatch watch;
  EXPECT_EQ(watch.look(40, 100), "");
  watch.begin();
  EXPECT_EQ(watch.look(-300, 100), "");
  EXPECT_EQ(watch.look(-304, 100), "");
  EXPECT_NE(watch.look(-306, 100), "");
}

/// The sums lack the energy of pore fluids, which may stretch soil and lift it: what counts is motion.
TEST(EnergyWatch, looks_at_motion_where_pore_fluids_move) {
  EnergyWatch watch;
  EXPECT_EQ(watch.look(40, 100, 10), "");
  EXPECT_EQ(watch.look(-200, 100, 49), "") << "lifted";
  EXPECT_EQ(watch.look(-5, 100, 200), "") << "motion that work has brought";
  const std::string told = watch.look(-11, 100, 52);
  EXPECT_NE(told.find("energy is created: 51 J, of 100 J"), std::string::npos) << told;
  EXPECT_NE(told.find("it lacks the energy of pore fluids"), std::string::npos) << told;
  EXPECT_EQ(watch.look(-200, 100, 99), "");
  EXPECT_FALSE(watch.beyond_all());
  EXPECT_EQ(watch.look(-200, 100, 101), "");
  EXPECT_TRUE(watch.beyond_all());
}

TEST(EnergyWatch, ends_where_energy_is_no_number) {
  EnergyWatch watch;
  EXPECT_EQ(watch.look(40, 100), "");
  EXPECT_NE(watch.look(NAN, 100), "");
  EXPECT_TRUE(watch.beyond_all());
}

TEST(EnergyWatch, looks_on_where_a_run_goes_on) {
  EnergyWatch stopped, resumed;
  EXPECT_EQ(stopped.look(40, 100), "");
  EXPECT_EQ(stopped.look(36, 100), "");
  Archive written;
  stopped.serialize(written);
  Archive read(std::move(written).bytes());
  resumed.serialize(read);
  EXPECT_NE(resumed.look(34, 100), "") << "measured from 40, which it had before it was stopped";
}

TEST(EnergyWatch, takes_no_offence_at_nothing) {
  EnergyWatch watch;
  EXPECT_EQ(watch.look(0, 0), "");
  EXPECT_FALSE(watch.beyond_all());
}

}  // namespace
}  // namespace talus
