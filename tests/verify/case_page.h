#pragma once
/// The table of computed numbers in the README of a verification case. It is made from what the case computes, so that
/// exact values and tolerances stand in the case's exact.h alone. It lies between the lines `<!-- verify -->` and
/// `<!-- end -->`, the table of the longer studies between `<!-- verify --long -->` and `<!-- end -->`.
#include <string>
#include <vector>

#include "tests/verify/rung.h"

namespace talus {

/// Writes the table into the page; a page without one gets it at its end. Throws std::runtime_error if the page cannot
/// be written.
void write_case_page(const std::string &readme, bool longer, const std::vector<Checked> &quantities);

/// What of the page's table is not what the case computes, or an empty text. Quantities, exact values and tolerances
/// have to be the same. A computed number may differ from the page's by a tenth of its tolerance, or by a quarter of
/// its stated error where nothing is claimed: another machine rounds differently.
std::string difference_from_page(const std::string &readme, bool longer, const std::vector<Checked> &quantities);

}  // namespace talus
