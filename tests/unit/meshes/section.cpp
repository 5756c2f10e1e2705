#include "meshes/section.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <stdexcept>

namespace talus {
namespace {

Section section_of(const std::string &content) {
  const std::string file = std::string(P_tmpdir) + "/talus_section_" + std::to_string(getpid()) + ".csv";
  std::ofstream(file) << content;
  try {
    Section section = read_section(file);
    std::remove(file.c_str());
    return section;
  } catch (...) {
    std::remove(file.c_str());
    throw;
  }
}

std::string complaint(const std::string &content) {
  try {
    section_of(content);
  } catch (const std::invalid_argument &error) {
    return error.what();
  }
  return "";
}

/// The one doubt about a section; empty if there is none.
std::string doubt(const std::string &content) {
  const std::vector<std::string> doubts = section_of(content).doubts();
  return doubts.empty() ? "" : doubts[0];
}

void expect_words(const std::string &text, const std::vector<std::string> &words) {
  for (const std::string &word : words) EXPECT_NE(text.find(word), std::string::npos) << word << " is not in: " << text;
}

TEST(Section, SaysThatReadingFailedHalfWay) {
  std::string text;
  try {
    (void)read_section("/proc/self/mem");  // can be opened, but not read at address 0
  } catch (const std::invalid_argument &error) {
    text = error.what();
  }
  expect_words(text, {"/proc/self/mem: cannot be read (Input/output error)", "check the path"});
}

const std::string square = "part,x,y\noutline,0,0\noutline,4,0 # right\noutline,4,3\noutline,0,3\n";

TEST(Section, LayersCountInterfacesAbove) {
  const Section s = section_of(square + "interface0,0,2\ninterface0,4,2\ninterface1,0,1\ninterface1,2,1\n");
  EXPECT_EQ(s.layer_at({1, 2.5}), "layer0");
  EXPECT_EQ(s.layer_at({1, 1.5}), "layer1");
  EXPECT_EQ(s.layer_at({1, 0.5}), "layer2");
  EXPECT_EQ(s.layer_at({3, 0.5}), "layer2");  // the interface goes on beyond its end
  EXPECT_DOUBLE_EQ(s.area(), 12);
}

TEST(Section, InterfacesMayHaveVerticalSteps) {
  for (const std::string points : {"interface0,1,0\ninterface0,1,2\ninterface0,2,2\ninterface0,2,0\n",
                                   "interface0,2,0\ninterface0,2,2\ninterface0,1,2\ninterface0,1,0\n"}) {
    const Section s = section_of(square + points);
    EXPECT_EQ(s.layer_at({1.5, 1}), "layer1");
    EXPECT_EQ(s.layer_at({1.5, 2.5}), "layer0");
    EXPECT_EQ(s.layer_at({0.5, 1}), "layer0");
    EXPECT_EQ(s.layer_at({3, 1}), "layer0");
  }
}

TEST(Section, FreeSpaceExtendsTheDomainUpwardAndAside) {
  const std::string slope = "outline,0,0\noutline,10,0\noutline,10,2\noutline,6,2\noutline,3,5\noutline,0,5\n";
  const Section right = section_of(slope + "free_space,2,3\n"), left = section_of(slope + "free_space,2,-3\n");
  EXPECT_DOUBLE_EQ(right.area(), 13 * 7);
  EXPECT_DOUBLE_EQ(left.area(), 13 * 7);
  EXPECT_EQ(right.layer_at({12, 1}), "air");
  EXPECT_EQ(right.layer_at({8, 4}), "air");
  EXPECT_EQ(right.layer_at({8, 1}), "layer0");
}

TEST(Section, FreeSpaceBesideASteepEndOfTheSoilIsDoubted) {
  const std::string slope = "outline,0,0\noutline,10,0\noutline,10,2\noutline,6,2\noutline,3,5\noutline,0,5\n";
  const std::string right = doubt(slope + "free_space,2,3\n"), left = doubt(slope + "free_space,2,-3\n");
  EXPECT_NE(right.find("the right end of the soil free: its steep face at x = 10 m, y = 0 to 2 m"), std::string::npos)
      << right;
  EXPECT_NE(left.find("the left end of the soil free: its steep face at x = 0 m, y = 0 to 5 m"), std::string::npos)
      << left;
  EXPECT_EQ(doubt(slope + "free_space,2,0\n"), "") << "the end of the soil is that of the mesh";
  EXPECT_EQ(doubt(slope + "free_space,2,3\nb_cut,10,0\nb_cut,10,2\n"), "") << "named";
  const std::string wedge = "outline,0,0\noutline,10,0\noutline,6,2\noutline,3,5\noutline,0,5\n";
  EXPECT_EQ(doubt(wedge + "free_space,2,3\n"), "") << "runs out";
}

TEST(Section, InterfacesFromBottomToTopAreDoubted) {
  const std::string low = "interface0,0,1\ninterface0,4,1\n", high = "interface1,0,2\ninterface1,4,2\n";
  expect_words(doubt(square + low + high), {"'interface1' (line ", ") lies above 'interface0' (line ",
                                            "layer0 lies above all interfaces, layer2 below all of them"});
  EXPECT_EQ(doubt(square + "interface0,0,2\ninterface0,4,2\ninterface1,0,1\ninterface1,4,1\n"), "");
  EXPECT_EQ(doubt(square + "interface0,0,2\ninterface0,4,2\ninterface1,0,2\ninterface1,4,1\n"), "") << "a wedge";
  EXPECT_EQ(doubt(square + low + high + "region_a,1,0.5\nregion_b,1,1.5\nregion_c,1,2.5\n"), "") << "all named";
  EXPECT_NE(doubt(square + low + high + "region_a,1,0.5\n"), "") << "one named";
}

TEST(Section, RefinedBoxesTakeTwoRows) {
  const Section s = section_of(square + "refine_0.25,3,2\nrefine_0.25,1,1\n");
  ASSERT_EQ(s.boxes.size(), 1u);
  EXPECT_EQ(s.boxes[0].size, 0.25);
  EXPECT_EQ(s.boxes[0].from, (Vec<2>{1, 1}));
  EXPECT_EQ(s.boxes[0].to, (Vec<2>{3, 2}));
}

TEST(Section, IsReadAsSpreadsheetsSaveIt) {
  const Section plain = section_of(square + "interface0,0,1.5\ninterface0,4,1.5\nrefine_0.25,1,1\nrefine_0.25,3,2\n");
  const std::string forms[] = {
      "\xef\xbb\xbfPart,X,Y\r\noutline,0,0\r\noutline,4,0\r\noutline,4,3\r\noutline,0,3\r\ninterface0,0,1.5\r\n"
      "interface0,4,1.5\r\nrefine_0.25,1,1\r\nrefine_0.25,3,2\r\n,,\r\n",
      "PART;X;Y\noutline;0;0\noutline;4,0;0\noutline;4;3\noutline;0;3,0\ninterface0;0;1,5\ninterface0;4;1.5\n"
      "refine_0,25;1;1\nrefine_0,25;3;2\n;;\n",
      "\"part\",\"x\",\"y\"\n\"outline\",\"0\",\"0\"\noutline,4,0,,\n outline , 4 , 3 # corner, right\noutline,0,+3\n"
      "interface0,0,15e-1\n\ninterface0,4,1.5\nrefine_0.25,1,1\nrefine_0.25,3,2",
      "part\tx\ty\routline\t0\t0\routline\t4\t0\routline\t4\t3\routline\t0\t3\rinterface0\t0\t1,5\rinterface0\t4\t1,5\r"
      "refine_0,25\t1\t1\rrefine_0,25\t3\t2\r"};
  for (const std::string &form : forms) {
    const Section s = section_of(form);
    EXPECT_EQ(s.outline.points, plain.outline.points) << form;
    ASSERT_EQ(s.interfaces.size(), 1u) << form;
    EXPECT_EQ(s.interfaces[0].points, plain.interfaces[0].points) << form;
    ASSERT_EQ(s.boxes.size(), 1u) << form;
    EXPECT_EQ(s.boxes[0].size, 0.25) << form;
  }
}

/// All numbers, also the size of cells and the free space, are in the unit of the header, in each form of it.
TEST(Section, HeaderStatesTheUnit) {
  const std::string rows =
      "outline,0,0\noutline,40,0\noutline,40,30\noutline,0,30\nfree_space,10,20\nrefine_2,1,1\n"
      "refine_2,3,2\nregion_soil,5,5\n";
  const double foot = 0.3048;
  for (const std::string header : {"part,x [ft],y [ft]\n", "# a survey\nPART , X (FT) , Y(FT)\npart,x,y\n",
                                   "part,x[ feet ],y [Feet]\npart,x [feet],y [feet]\n"}) {
    const Section s = section_of(header + rows);
    EXPECT_EQ(s.outline.points[2], (Vec<2>{40 * foot, 30 * foot})) << header;
    EXPECT_EQ(s.free_height, 10 * foot);
    EXPECT_EQ(s.free_extra, 20 * foot);
    EXPECT_EQ(s.boxes[0].size, 2 * foot);
    EXPECT_EQ(s.boxes[0].to[0], 3 * foot);
    EXPECT_EQ(s.seeds[0].point, (Vec<2>{5 * foot, 5 * foot}));
    expect_words(s.doubts().at(0), {"all numbers are in feet (line ", ") and turned into metres"});
  }
  EXPECT_EQ(section_of("part,x [m],y [m]\n" + square).doubts().size(), 0u);
  EXPECT_EQ(section_of("part,x [in],y [in]\noutline,0,0\noutline,100,0\noutline,0,50\n").outline.points[1][0], 2.54);
  EXPECT_EQ(section_of("part,x [mm],y [mm]\noutline,0,0\noutline,500,0\noutline,0,50\n").outline.points[1][0], 0.5);
}

TEST(BadSection, UnitsAreCheckedAtTheirLine) {
  const std::string form = "must be a header part,x,y or, with a unit, part,x [ft],y [ft]";
  expect_words(complaint("part,x [kN],y [kN]\n" + square),
               {"line 1", "states no unit that sections are drawn in", "m, mm, cm, dm, km, ft, in, ftUS"});
  expect_words(complaint("part,x [ft],y [m]\n" + square), {"line 1", "the same unit for x and y"});
  expect_words(complaint("part,x [ft],y\n" + square), {"line 1", "the same unit for x and y"});
  for (const std::string header : {"part,x ft,y ft\n", "part,x [ft,y [ft\n", "part,y,x\n", "part,x []\n",
                                   "part,x [],y []\n", "part,x [ft],y [ft],z [ft]\n", "part,xft,yft\n"})
    expect_words(complaint("# survey\n" + header + square), {"line 2", form});
  expect_words(complaint(square + "part,x [ft],y [ft]\n"),
               {"line 6", "another unit than the rows above it have, metres"});
  expect_words(complaint("part,x [ft],y [ft]\noutline,0,0\npart,x [m],y [m]\n"),
               {"line 3", "rows above it have, feet"});
  expect_words(complaint("part,x [ft],y [ft]\noutline,4 ft,0\n"),
               {"line 2", "in the unit of a header part,x [ft],y [ft]"});
}

TEST(BadSection, NumbersAreNotGuessed) {
  expect_words(complaint("outline,0,0\noutline,\"4,5\",0\n"), {"line 2", "two numbers"});  // thousands, or a fraction
  expect_words(complaint("outline;0;0\noutline;1.234,5;0\n"), {"line 2", "two numbers"});
  expect_words(complaint(square + "outline,nan,1\n"), {"line 6", "two numbers"});
  expect_words(complaint(square + "outline,1,2,3\n"), {"line 6", "part,x,y"});
  expect_words(complaint(std::string("\xff\xfep\0a\0r\0t\0", 10)), {"UTF-8"});
}

TEST(BadSection, ALongListOfPointsIsRefusedAtOnce) {
  std::string rows;
  for (int i = 0; i < 100000; ++i) rows += "outline," + std::to_string(i) + ",0\n";
  expect_words(complaint(rows), {"has 100000 points", "5000", "leave out points"});
}

TEST(Section, CrossingInterfacesAreFound) {
  const std::string level = square + "interface0,0,2\ninterface0,4,2\n";
  const auto crossing = [](const std::string &content) { return crossing_interfaces(section_of(content)).has_value(); };
  EXPECT_FALSE(crossing(level + "interface1,0,1\ninterface1,4,1\n"));
  EXPECT_FALSE(crossing(level + "interface1,0,1\ninterface1,2,2\ninterface1,4,1\n"));                  // touches
  EXPECT_FALSE(crossing(level + "interface1,0,1\ninterface1,1,2\ninterface1,3,2\ninterface1,4,1\n"));  // runs along
  EXPECT_FALSE(crossing(level + "interface1,2,1\ninterface1,2,2\n"));                                  // ends there
  EXPECT_FALSE(
      crossing(square + "interface0,0,2\ninterface0,2,2\ninterface1,2,0.5\ninterface1,2,2\ninterface1,2,2.5\n"));
  EXPECT_TRUE(crossing(level + "interface1,0,1\ninterface1,2,2\ninterface1,4,2.5\n"));  // at its own point
  EXPECT_TRUE(crossing(level + "interface1,0,1\ninterface1,1,2\ninterface1,3,2\ninterface1,4,2.5\n"));
  const std::string bent = square + "interface0,0,2\ninterface0,2,2\ninterface0,4,2.2\n";
  EXPECT_TRUE(crossing(bent + "interface1,0,1\ninterface1,4,3\n"));  // at a point of the other
  const Section s = section_of(level + "interface1,0,1\ninterface1,4,3\n");
  const auto found = crossing_interfaces(s);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->place, (Vec<2>{2, 2}));
  EXPECT_EQ(found->first_line, 6);
  EXPECT_EQ(found->second_line, 8);
}

TEST(BadSection, NamesTheLine) {
  expect_words(complaint(square + "outline,1\n"), {"line 6", "part,x,y"});
  expect_words(complaint(square + "outline,1,two\n"), {"line 6", "two numbers"});
  expect_words(complaint(square + "watertable,1,1\n"), {"line 6", "'watertable'", "b_NAME"});
  expect_words(complaint(square + "refine_fine,1,1\n"), {"line 6", "refine_SIZE"});
  expect_words(complaint(square + "refine_1,1,1\n"), {"line 6", "second row"});
  expect_words(complaint(square + "free_space,0,1\n"), {"line 6", "height"});
  expect_words(complaint(square + "region_soil,5,1\n"), {"line 6", "region_soil", "outside"});
  expect_words(complaint(square + "outline,4,3\n"), {"line 6", "repeats", "line 4"});
  expect_words(complaint(square + "outline,0.000001,3\n"), {"line 6", "repeats", "line 5"});
}

TEST(BadSection, TheOutlineMustBeAPolygon) {
  expect_words(complaint(""), {"empty"});
  expect_words(complaint("part,x,y\n"), {"no outline"});
  expect_words(complaint("outline,0,0\noutline,1,0\n"), {"at least 3 points"});
}

TEST(BadSection, AnOutlineThatCrossesItselfNamesBothSegments) {
  expect_words(complaint("outline,0,0\noutline,4,2\noutline,4,0\noutline,0,2\n"),
               {"crosses itself", "(0, 0)-(4, 2)", "(4, 0)-(0, 2)", "line 1", "line 3"});
  expect_words(complaint("outline,0,0\noutline,4,0\noutline,2,0\noutline,2,2\n"), {"crosses itself"});  // folds back
}

TEST(BadSection, PartsOutsideAreRefused) {
  expect_words(complaint(square + "interface0,0,4\ninterface0,4,4\n"), {"line 6", "'interface0'", "outside"});
  expect_words(complaint(square + "interface0,0,3\ninterface0,4,3\n"), {"only on it"});
  expect_words(complaint(square + "b_load,5,0\nb_load,5,3\n"), {"'b_load'", "outside"});
  expect_words(complaint(square + "b_load,0,3\n"), {"'b_load'", "2 points"});
  EXPECT_EQ(complaint(square + "b_load,1,3\nb_load,2,3\n"), "");
}

}  // namespace
}  // namespace talus
