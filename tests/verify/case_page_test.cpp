// The table of a verification page is in step with what its case computes, or the difference is named.
#include "tests/verify/case_page.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace talus {
namespace {

class CasePage : public testing::Test {
 protected:
  void SetUp() override {
    page_ = testing::TempDir() + "case_page_" + std::to_string(::getpid()) + ".md";
    std::ofstream(page_) << "# A case\n";
    write_case_page(page_, false, stated_);
  }
  void TearDown() override { std::filesystem::remove(page_); }

  /// What the page says where the case computes another error of the first or the second quantity.
  std::string with_errors(double of_stress, double of_mass) const {
    std::vector<Checked> computed = stated_;
    computed[0].relative_error = of_stress, computed[1].relative_error = of_mass;
    return difference_from_page(page_, false, computed);
  }

  std::string page_;
  std::vector<Checked> stated_{{"stress", 100, 100.2, 2e-3, 1e-2, 1}, {"mass", 1, 1, 1.6e-13, 1e-12, 1}};
};

TEST_F(CasePage, agrees_with_what_it_was_made_from) { EXPECT_EQ(difference_from_page(page_, false, stated_), ""); }

TEST_F(CasePage, may_differ_by_a_tenth_of_the_tolerance) {
  EXPECT_EQ(with_errors(2.9e-3, 1.6e-13), "");
  EXPECT_NE(with_errors(3.2e-3, 1.6e-13), "");
  EXPECT_NE(with_errors(0.8e-3, 1.6e-13), "");
}

TEST_F(CasePage, states_round_off_as_a_claim_not_as_digits) {
  EXPECT_EQ(with_errors(2e-3, 1e-15), "");
  EXPECT_EQ(with_errors(2e-3, 9e-13), "");
  EXPECT_NE(with_errors(2e-3, 2e-12), "");
}

TEST_F(CasePage, names_the_line_that_is_out_of_step) {
  EXPECT_NE(with_errors(9e-3, 1.6e-13).find("\"stress\""), std::string::npos);
  EXPECT_NE(difference_from_page(page_, false, {stated_[0]}).find("states 2 quantities, computed are 1"),
            std::string::npos);
}

}  // namespace
}  // namespace talus
