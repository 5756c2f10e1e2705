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

void expect_words(const std::string &text, const std::vector<std::string> &words) {
  for (const std::string &word : words) EXPECT_NE(text.find(word), std::string::npos) << word << " is not in: " << text;
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

TEST(Section, RefinedBoxesTakeTwoRows) {
  const Section s = section_of(square + "refine_0.25,3,2\nrefine_0.25,1,1\n");
  ASSERT_EQ(s.boxes.size(), 1u);
  EXPECT_EQ(s.boxes[0].size, 0.25);
  EXPECT_EQ(s.boxes[0].from, (Vec<2>{1, 1}));
  EXPECT_EQ(s.boxes[0].to, (Vec<2>{3, 2}));
}

TEST(BadSection, NamesTheLine) {
  expect_words(complaint(square + "outline,1\n"), {"line 6", "part,x,y"});
  expect_words(complaint(square + "outline,1,two\n"), {"line 6", "two numbers"});
  expect_words(complaint(square + "watertable,1,1\n"), {"line 6", "'watertable'", "b_NAME"});
  expect_words(complaint(square + "refine_fine,1,1\n"), {"line 6", "refine_SIZE"});
  expect_words(complaint(square + "refine_1,1,1\n"), {"line 6", "second row"});
  expect_words(complaint(square + "free_space,0,1\n"), {"line 6", "height"});
  expect_words(complaint(square + "region_soil,5,1\n"), {"line 6", "'soil'", "outside"});
  expect_words(complaint(square + "outline,4,3\n"), {"line 6", "repeats", "line 4"});
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
