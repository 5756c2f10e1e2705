#pragma once
/// A factor of safety as the JSON document of factor_of_safety.json.
#include <string>

#include "solvers/quasi_static/factor_of_safety.h"

namespace talus {

std::string document_of(const FactorOfSafety &factor);

}  // namespace talus
