// Claims of earthquake/record_file.h: each format as agencies write it, and what is refused.
#include "earthquake/record_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "scene/reader.h"

namespace talus {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double g = 9.80665;

class Records : public testing::Test {
 protected:
  Records() {
    std::string path = (std::filesystem::temp_directory_path() / "records-XXXXXX").string();
    folder_ = mkdtemp(path.data());
  }
  ~Records() override { std::filesystem::remove_all(folder_); }
  GroundMotion read(const std::string &text, const std::string &component = "") {
    const std::string file = (folder_ / "record").string();
    std::ofstream(file) << text;
    return read_record(file, component);
  }
  std::string refusal(const std::string &text, const std::string &component = "") {
    try {
      read(text, component);
    } catch (const SceneError &error) {
      return error.what();
    }
    return "";
  }

 private:
  std::filesystem::path folder_;
};

const std::string peer = R"(PEER NGA STRONG MOTION DATABASE RECORD
Somewhere, 1/1/1999, Station, 90
ACCELERATION TIME SERIES IN UNITS OF G
NPTS=      7, DT=   .0050 SEC,
  -.1000000E-02   .2000000E-02  -.3000000E-02   .4000000E-02  -.5000000E-02
   .6000000E-02   .7000000E-02
)";
/// The same record in another unit.
std::string peer_in(const std::string &unit) {
  std::string text = peer;
  return text.replace(text.find("UNITS OF G") + 9, 1, unit);
}
const std::string csmip = R"(Corrected accelerogram   Chan  1:  90 Deg     Station No. 00000
     6 points of accel data equally spaced at  .010 sec, in cm/sec2. (8f10.3)
     1.000    -2.000     3.000    -4.000
     5.000    -6.000
     6 points of veloc data equally spaced at  .010 sec, in cm/sec.  (8f10.3)
      .010      .020      .030      .040      .050      .060
/&  ----------  End of data for channel  1  ----------
Corrected accelerogram   Chan  2: 360 Deg     Station No. 00000
     3 points of accel data equally spaced at  .020 sec, in g.    (8f10.3)
      .100     -.200      .300
/&  ----------  End of data for channel  2  ----------
)";
std::string cosmos() {
  std::string reals;
  for (int k = 1; k <= 40; ++k)
    reals += (k == 34 ? "       5.000000" : "    -999.000000") + std::string(k % 5 ? "" : "\n");
  return "Corrected acceleration   (Format v01.20 with 13 text lines)\n"
         "  40 Real-header values follow on   8 lines, Format= (5F15.6)\n" +
         reals +
         "   1 Comment line(s) follow, each starting with a \"|\":\n|\n"
         "       4 acceleration pts, approx   0 secs, units=cm/s^2 (4),Format=(10F8.5)\n"
         "-0.50003-0.25004 1.00000-0.75004\nEnd-of-data for Chan  1 acceleration\n";
}
const std::string esm = R"(EVENT_NAME: SOMEWHERE
SAMPLING_INTERVAL_S: 0.005000
NDATA: 3
UNITS: cm/s^2
DATA_TYPE: ACCELERATION
HEADER_FORMAT: DYNA 1.2
1.5
-2.5
0.5
)";
const std::string table = "# a remark\ntime [s], NS [g], EW [cm/s2]\n0, 0.1, 10\n0.01, -0.2, -20\n0.02, 0.3, 30\n";

TEST_F(Records, OfEachFormatAreRead) {
  const GroundMotion nga = read(peer);
  EXPECT_DOUBLE_EQ(nga.step, 0.005);
  EXPECT_EQ(nga.acceleration.size(), 7U);
  EXPECT_NEAR(nga.acceleration[6], 0.007 * g, 1e-12);
  EXPECT_NEAR(nga.peak(), 0.007 * g, 1e-12);
  EXPECT_NEAR(read(peer_in("CM/S2")).peak(), 7e-5, 1e-12);
  const GroundMotion first = read(csmip, "1"), second = read(csmip, "2");
  EXPECT_DOUBLE_EQ(first.step, 0.01);
  EXPECT_THAT(first.acceleration, ElementsAre(0.01, -0.02, 0.03, -0.04, 0.05, -0.06));
  EXPECT_THAT(second.acceleration,
              ElementsAre(DoubleNear(0.1 * g, 1e-12), DoubleNear(-0.2 * g, 1e-12), DoubleNear(0.3 * g, 1e-12)));
  const GroundMotion usgs = read(cosmos());
  EXPECT_DOUBLE_EQ(usgs.step, 0.005);
  EXPECT_NEAR(usgs.acceleration[2], 0.01, 1e-12);
  EXPECT_NEAR(usgs.acceleration[3], -0.0075004, 1e-12);
  const GroundMotion european = read(esm);
  EXPECT_DOUBLE_EQ(european.step, 0.005);
  EXPECT_THAT(european.acceleration, ElementsAre(0.015, -0.025, 0.005));
  const GroundMotion east = read(table, "EW");
  EXPECT_DOUBLE_EQ(east.step, 0.01);
  EXPECT_THAT(east.acceleration, ElementsAre(DoubleNear(0.1, 1e-12), DoubleNear(-0.2, 1e-12), DoubleNear(0.3, 1e-12)));
  EXPECT_NEAR(read("time_s;acceleration_m_s2\r\n0;1\r\n0.5;-1\r\n").acceleration[1], -1, 1e-12);
}

/// Semicolons separate numbers with decimal commas; units come with signs of their own.
TEST_F(Records, OfSpreadsheetsAreRead) {
  const GroundMotion commas = read("t [s];a [cm/s\u00b2]\n0,00;1,5\n0,01;-2,5\n");
  EXPECT_DOUBLE_EQ(commas.step, 0.01);
  EXPECT_NEAR(commas.acceleration[1], -0.025, 1e-15);
  EXPECT_NEAR(read("t [s],a [%g]\n0,1\n1,5\n").acceleration[1], 0.05 * g, 1e-12);
  EXPECT_NEAR(read("t [s],a [cm/s^2]\n0,1\n1,5\n").acceleration[1], 0.05, 1e-12);
  EXPECT_THAT(refusal("t [s],a [g]\n0,00,0,1\n0,01,0,2\n"),
              HasSubstr("line 2: has 4 columns, and the header names 2: are there decimal commas?"));
  EXPECT_THAT(refusal("NPTS= 3, DT= .01 SEC\n0,1 0,2 0,3\n"), HasSubstr("numbers need decimal points, not commas"));
}

TEST_F(Records, WithRoundedTimesAreEven) {
  EXPECT_NEAR(read("t [s],a [m/s2]\n0,1\n0.033,2\n0.067,3\n0.1,4\n").step, 1. / 30, 1e-12);
}

TEST_F(Records, ThatAreBadAreRefused) {
  EXPECT_THAT(refusal(peer_in("FURLONGS")), HasSubstr("has accelerations in FURLONGS"));
  EXPECT_THAT(refusal(peer.substr(0, peer.size() - 20)), HasSubstr("says that it has 7 values, and has "));
  EXPECT_THAT(refusal(csmip), HasSubstr("2 channels of acceleration: choose one by component = \"1\" to \"2\""));
  EXPECT_THAT(refusal(csmip, "3"), HasSubstr("choose one"));
  EXPECT_THAT(refusal(table), HasSubstr("choose one by component"));
  EXPECT_THAT(refusal("time, acceleration\n0,1\n1,2\n"),
              HasSubstr("line 1: must name the columns of time and acceleration with their units"));
  EXPECT_THAT(refusal("time [s], a [g]\n0,0.1\n0.01,0.1\n0.03,0.1\n0.04,0.2\n"),
              HasSubstr("line 4: comes 0.02 s after"));
  std::string gap = "time [s], a [g]\n";
  for (const int k : {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 15, 16, 17, 18}) gap += std::to_string(0.01 * k) + ",0.1\n";
  EXPECT_THAT(refusal(gap), HasSubstr("line 12: comes 0.06 s after"));
  EXPECT_THAT(refusal("time [s], a [g]\n0,0.1\n0.01,\n"), HasSubstr("line 3: has no number in column 2"));
  EXPECT_THAT(refusal("time [s], a [g]\n0,0.1\n0.01,nan\n"), HasSubstr("line 3: has no number in column 2"));
  EXPECT_THAT(refusal("time [s], a [g]\n0,5\n0.01,50\n"), HasSubstr("a peak of 50 g"));
  EXPECT_THAT(refusal("time [s], a [g]\n0,0\n0.01,0\n"), HasSubstr("no motion"));
  EXPECT_THAT(refusal("time [s], a [g]\n"), HasSubstr("fewer than two values"));
  EXPECT_THAT(refusal(""), HasSubstr("has no record"));
}

}  // namespace
}  // namespace talus
