#include "meshes/drawing.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace talus {
namespace {

/// A DXF file in text form, whose entities follow one another as they are called; a file of R12 without a header where
/// `unit` is 0.
class Dxf {
 public:
  explicit Dxf(int unit = 0) {
    if (unit) group(0, "SECTION"), group(2, "HEADER"), group(9, "$INSUNITS"), group(70, unit), group(0, "ENDSEC");
    group(0, "SECTION"), group(2, "ENTITIES");
  }
  Dxf &line(const std::string &layer, Vec<2> a, Vec<2> b, double z = 0) {
    group(0, "LINE"), group(8, layer), group(10, a[0]), group(20, a[1]), group(30, z), group(11, b[0]), group(21, b[1]),
        group(31, z);
    return *this;
  }
  Dxf &polyline(const std::string &layer, const std::vector<Vec<2>> &points, bool closed) {
    group(0, "POLYLINE"), group(8, layer), group(66, 1), group(70, closed ? 1 : 0);
    for (const Vec<2> &x : points) group(0, "VERTEX"), group(8, layer), group(10, x[0]), group(20, x[1]);
    group(0, "SEQEND");
    return *this;
  }
  Dxf &light_polyline(const std::string &layer, const std::vector<Vec<2>> &points, bool closed) {
    group(0, "LWPOLYLINE"), group(100, "AcDbEntity"), group(8, layer), group(100, "AcDbPolyline"),
        group(90, points.size()), group(70, closed ? 1 : 0);
    for (const Vec<2> &x : points) group(10, x[0]), group(20, x[1]);
    return *this;
  }
  Dxf &point(const std::string &layer, Vec<2> x) {
    group(0, "POINT"), group(8, layer), group(10, x[0]), group(20, x[1]);
    return *this;
  }
  Dxf &text(const std::string &layer, Vec<2> x) {
    group(0, "TEXT"), group(8, layer), group(10, x[0]), group(20, x[1]), group(40, 1), group(1, "clay");
    return *this;
  }
  Dxf &circle(const std::string &layer, Vec<2> x, double radius) {
    group(0, "CIRCLE"), group(8, layer), group(10, x[0]), group(20, x[1]), group(40, radius);
    return *this;
  }
  std::string content() const { return text_ + "  0\nENDSEC\n  0\nEOF\n"; }

 private:
  template <class T>
  void group(int code, const T &value) {
    std::ostringstream lines;
    lines << "  " << code << "\n" << value << "\n";
    text_ += lines.str();
  }
  std::string text_;
};

/// The drawing as a section; the file is removed.
Section section_in(const std::string &content, std::vector<std::string> *doubts = nullptr) {
  const std::string file = std::string(P_tmpdir) + "/talus_drawing_" + std::to_string(getpid()) + ".dxf";
  std::ofstream(file) << content;
  try {
    const Drawing drawing = read_drawing(file);
    std::remove(file.c_str());
    if (doubts) *doubts = drawing.doubts;
    return section_of(drawing.rows, file, true);
  } catch (...) {
    std::remove(file.c_str());
    throw;
  }
}

void expect_refused(const std::string &content, const std::string &words) {
  try {
    section_in(content);
    ADD_FAILURE() << "taken, not refused with: " << words;
  } catch (const std::invalid_argument &error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what() << "\nlacks: " << words;
  }
}

void expect_refused(const Dxf &dxf, const std::string &words) { expect_refused(dxf.content(), words); }

/// The text with other lines in place of those that it has once.
std::string changed(std::string text, const std::string &from, const std::string &to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

const std::vector<Vec<2>> box{{0, 0}, {25, 0}, {25, 8}, {0, 8}}, ground{{0, 7}, {10, 7}, {15, 2}, {25, 2}};
Dxf slope(int unit = 0) {
  return Dxf(unit)
      .polyline("outline", box, true)
      .polyline("interface0", ground, false)
      .point("region_air", {20, 6})
      .text("region_clay", {5, 3});
}

/// Polylines in the order of the rows give the very section of the guide's CSV file, and so does the guide's drawing.
void expect_slope(const Section &drawn) {
  const Section read = read_section(TALUS_GUIDE "/slope.csv");
  EXPECT_EQ(drawn.outline.points, read.outline.points);
  ASSERT_EQ(drawn.interfaces.size(), 1u);
  EXPECT_EQ(drawn.interfaces[0].points, read.interfaces[0].points);
  ASSERT_EQ(drawn.seeds.size(), 2u);
  EXPECT_EQ(drawn.seeds[0].name, "air");
  EXPECT_EQ(drawn.seeds[1].name, "clay");
  EXPECT_EQ(drawn.seeds[1].point, read.seeds[1].point);
}
TEST(Drawing, IsTheSectionOfTheSameRows) {
  expect_slope(section_in(slope().content()));
  expect_slope(section_in(Dxf()
                              .light_polyline("outline", box, true)
                              .light_polyline("interface0", ground, false)
                              .point("region_air", {20, 6})
                              .point("region_clay", {5, 3})
                              .content()));
  expect_slope(section_of(read_drawing(TALUS_GUIDE "/slope.dxf").rows, "slope.dxf", true));
}

/// Lines in any order and direction, in capitals and millimetres.
TEST(Drawing, JoinsPiecesAndConvertsUnits) {
  Dxf dxf(4);
  const auto mm = [](const Vec<2> &x) { return Vec<2>{1e3 * x[0], 1e3 * x[1]}; };
  for (const int i : {2, 0, 3, 1}) dxf.line("OUTLINE", mm(box[(i + i % 2) % 4]), mm(box[(i + 1 - i % 2) % 4]));
  for (const int i : {1, 2, 0}) dxf.line("INTERFACE0", mm(ground[i + i % 2]), mm(ground[i + 1 - i % 2]));
  dxf.point("REGION_CLAY", {5e3, 3e3}).line("DIMENSIONS", {0, 0}, {1, 1});
  dxf.polyline("REFINE_200", {{8e3, 1e3}, {12e3, 1e3}, {12e3, 4e3}, {8e3, 4e3}}, true);
  std::vector<std::string> doubts;
  const Section section = section_in(dxf.content(), &doubts);
  EXPECT_DOUBLE_EQ(section.area(), 200);
  EXPECT_EQ(section.outline.points.size(), 4u);
  ASSERT_EQ(section.interfaces[0].points.size(), 4u);
  EXPECT_EQ(section.layer_at({12, 4.9}), "layer1");
  EXPECT_EQ(section.layer_at({12, 5.1}), "layer0");
  EXPECT_EQ(section.seeds[0].name, "clay");
  ASSERT_EQ(section.boxes.size(), 1u);
  EXPECT_DOUBLE_EQ(section.boxes[0].size, 0.2) << "in the unit of the drawing, like all its numbers";
  EXPECT_DOUBLE_EQ(section.boxes[0].to[1], 4);
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_NE(doubts[0].find("left out: dimensions"), std::string::npos) << doubts[0];
  ASSERT_EQ(section.doubts().size(), 1u);
  EXPECT_NE(section.doubts()[0].find("all numbers are in millimetres ($INSUNITS)"), std::string::npos);
}

TEST(Drawing, SaysWhichUnitItsNumbersHave) {
  const Section feet = section_in(slope(2).content()), survey = section_in(slope(21).content());
  EXPECT_DOUBLE_EQ(feet.outline.points[1][0], 25 * 0.3048);
  EXPECT_DOUBLE_EQ(survey.outline.points[1][0], 25 * 1200. / 3937);
  EXPECT_EQ(section_in(slope(6).content()).doubts().size(), 0u);
  const std::vector<std::string> none = section_in(slope(0).content()).doubts();
  ASSERT_EQ(none.size(), 1u);
  EXPECT_NE(none[0].find("names no unit ($INSUNITS), and its coordinates are taken as metres"), std::string::npos);
}

/// A circle becomes chords of 4 degrees, within 0.1 % of its area.
TEST(Drawing, TurnsArcsIntoChords) {
  const Section section = section_in(Dxf().circle("outline", {10, 10}, 5).content());
  EXPECT_NEAR(section.area() / (25 * M_PI), 1, 1e-3);
  EXPECT_NEAR(static_cast<double>(section.outline.points.size()), 90, 1);
}

TEST(Drawing, RefusesWhatIsNoSection) {
  expect_refused(Dxf().polyline("outline", box, false), "line 6: the outline is open between (0, 8) and (0, 0) m");
  expect_refused(
      Dxf().line("outline", {0, 0}, {5, 0}).line("outline", {5.1, 0}, {5, 5}),
      "line 22: layer 'outline' does not join into one line: between (5, 0) and (5.1, 0) m its pieces are 0.1 m");
  expect_refused(slope().line("b_wall", {0, 0}, {0, 3}).line("b_wall", {0, 3}, {0, 0}),
                 "layer 'b_wall' has this line twice, also in line ");
  expect_refused(slope().line("b_wall", {0, 0}, {0, 3}, 2.5), ": layer 'b_wall' has a point with z = 2.5");
  expect_refused(slope().polyline("region_sand", box, false), "a region is named by a point or a text inside it");
  expect_refused(slope().point("b_wall", {0, 1}), "it takes lines and polylines");
  expect_refused(slope(8), "unit 8 of $INSUNITS");
  expect_refused(Dxf().polyline("interface0", ground, false), "has no outline");
  expect_refused(slope().line("b_wall", {50, 0}, {60, 0}), ": the boundary 'b_wall' lies outside the outline");
  expect_refused(slope().line("interface_x", {0, 1}, {25, 1}), "'interface_x' is no part of a section");
}

TEST(Drawing, RefusesWhatIsNoDrawing) {
  EXPECT_THROW(section_in("outline,0,0\n"), std::invalid_argument);
  EXPECT_THROW(read_drawing("/nowhere/slope.dxf"), std::invalid_argument);
}

TEST(Drawing, ReadsNumbersWholeOrRefusesThem) {
  const std::string good = slope(6).content();
  expect_refused(changed(good, "\n10\n  20\n7\n", "\n10\n  20\n7,25\n"),
                 "group 20 of the VERTEX on layer 'interface0' must be a number, not '7,25'; a DXF file has decimal "
                 "points");
  expect_refused(changed(good, "  10\n15\n", "  10\n15 m\n"),
                 "line 86: group 10 of the VERTEX on layer 'interface0' must");
  expect_refused(changed(good, "  10\n15\n", "  10\nnan\n"), "must be a number, not 'nan'");
  expect_refused(changed(good, "  10\n15\n", "  1O\n15\n"), "line 85: '  1O' stands where a DXF file has the code");
  expect_refused(changed(good, "  20\n2\n", ""), "the VERTEX on layer 'interface0' lacks a number, group 20 (y)");
  expect_refused(changed(good, "  70\n6\n", "  70\nmetres\n"), "line 8: $INSUNITS must be followed by group 70");
  expect_slope(section_in(changed(good, "  10\n15\n", "  10\n   1.5e+1  \n")));
  const std::string light = Dxf().light_polyline("outline", box, true).light_polyline("b_x", ground, false).content();
  expect_refused(changed(light, "  20\n8\n", ""), "lacks a number, group 20 (y)");
  expect_refused(changed(light, "  10\n25\n  20\n8\n", ""), "says that it has 4 points, and it has 3");
  expect_refused(changed(light, "  90\n4\n", ""), "the LWPOLYLINE on layer 'outline' lacks a number, group 90");
}

/// A file that is cut anywhere is refused, until its last word is whole.
TEST(Drawing, RefusesWhatIsCutOff) {
  std::ifstream file(TALUS_GUIDE "/slope.dxf");
  const std::string whole{std::istreambuf_iterator<char>(file), {}};
  for (std::size_t length = 0; length + 1 < whole.size(); length += length + 20 < whole.size() ? 10 : 1)
    EXPECT_THROW(section_in(whole.substr(0, length)), std::invalid_argument) << "the first " << length << " bytes";
  expect_slope(section_in(whole.substr(0, whole.size() - 1)));
  expect_refused(whole.substr(0, 400), "the drawing ends here without the group EOF");
  expect_refused(changed(whole, "  0\nENDSEC\n  0\nEOF", "  0\nEOF"), "which no ENDSEC ends");
  expect_refused(changed(whole, "  0\nSEQEND\n", ""), "has no SEQEND before this");
  expect_refused("AutoCAD Binary DXF\r\n" + std::string(1, '\x1a') + std::string(9, '\0'), "DXF in text form (ASCII)");
  std::string lines = whole;
  for (std::size_t at = 0; (at = lines.find('\n', at)) != std::string::npos; at += 2) lines.replace(at, 1, "\r\n");
  expect_slope(section_in(lines));
}

TEST(Drawing, RefusesEntitiesThatGdalLeavesOut) {
  expect_refused(slope().polyline("b_wall", {}, false), "line 110: the POLYLINE on layer 'b_wall' has no vertices");
  expect_refused(slope().light_polyline("b_wall", {{0, 0}}, false), "the LWPOLYLINE on layer 'b_wall' has 1 vertex");
  expect_refused(slope().line("b_wall", {0, 3}, {0, 3}), "layer 'b_wall' has a line without length at (0, 3)");
  const std::string wall = slope().line("b_wall", {0, 0}, {0, 3}).content();
  for (const char *kind : {"HATCH", "SOLID", "XLINE", "ACAD_PROXY_ENTITY"})
    expect_refused(changed(wall, "LINE\n  8\nb_wall", kind + std::string("\n  8\nb_wall")),
                   "the " + std::string(kind) + " on layer 'b_wall' is neither a line nor a point that is read");
  expect_slope(section_in(changed(wall, "LINE\n  8\nb_wall", "SOLID\n  8\ndetails")));
}

/// A bulge of 1 is half a circle; the parts of a block keep their layers, and those on layer 0 take that of the insert.
TEST(Drawing, ReadsBulgesAndBlocks) {
  const std::string light = Dxf().light_polyline("outline", {{0, 0}, {10, 0}, {10, 5}, {0, 5}}, true).content();
  EXPECT_NEAR(section_in(changed(light, "  10\n10\n  20\n5\n", "  10\n10\n  20\n5\n  42\n1\n")).area(),
              50 + M_PI * 12.5, 0.1);
  std::string block = slope(6).content();
  block = changed(block, "  0\nSECTION\n  2\nENTITIES\n",
                  "  0\nSECTION\n  2\nBLOCKS\n  0\nBLOCK\n  8\n0\n  2\nSlope\n  10\n0\n  20\n0\n");
  block = changed(block, "  0\nENDSEC\n  0\nEOF",
                  "  0\nLINE\n  8\n0\n  10\n0\n  20\n0\n  11\n0\n  21\n3\n  0\nENDBLK\n  0\nENDSEC\n  0\nSECTION\n  2\n"
                  "ENTITIES\n  0\nINSERT\n  8\nb_wall\n  2\nSLOPE\n  10\n0\n  20\n0\n  0\nENDSEC\n  0\nEOF");
  const Section section = section_in(block);
  expect_slope(section);
  ASSERT_EQ(section.boundaries.size(), 1u);
  EXPECT_EQ(section.boundaries[0].points[1], (Vec<2>{0, 3}));
  expect_refused(changed(block, "SLOPE", "other"), "inserts the block 'other', which the drawing does not have");
}

}  // namespace
}  // namespace talus
