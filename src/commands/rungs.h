#pragma once
/// The verification ladder: one line a case. Each has a folder tests/LABEL/NAME with its scene, its exact answer and a
/// README.
#include "commands/rung.h"
#include "tests/verification/dynamic_oedometer/exact.h"
#include "tests/verification/gravity_column/exact.h"
#include "tests/verification/k0_column/exact.h"

namespace talus {

struct LadderEntry {
  const char *name, *label, *meaning;
  void (*check)(Rung &);
};

inline constexpr LadderEntry ladder[] = {
    {"dynamic_oedometer", "verification", "settlement and stress behind a load applied at once",
     rungs::dynamic_oedometer},
    {"gravity_column", "verification", "column under its own weight, stiff and with cells crossed",
     rungs::gravity_column},
    {"k0_column", "verification", "lateral stress at rest, by gravity and as an initial state that stays",
     rungs::k0_column},
};

}  // namespace talus
