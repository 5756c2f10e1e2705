#pragma once
/// Whether the soil that slid has come to rest. Report and maps decide it in the same way (`still_moving` of
/// src/output/plots/talus_sliding.py): the tests `picture_choices` and `outcomes` compare the limits and what is said.
#include <mpi.h>

#include <optional>
#include <string>

#include "output/results.h"

namespace talus {

inline constexpr double slides_share = 0.1;  ///< of the largest displacement, beyond which soil slides
inline constexpr double slides_least = 0.1;  ///< of the spacing of particles, below which no soil has slid
inline constexpr double slow = 0.1;          ///< speed that soil at rest does not have [m/s]
inline constexpr double restless = 0.01;     ///< share of the mass that slid: if more is faster than `slow`, it moves
inline constexpr double nearly_all = 0.999;  ///< share that counts for largest values: single particles do not ...
inline constexpr double of_moved = 0.05;  ///< ... but no more than this share of what moved by more than its own size
inline constexpr double several = 50;     ///< particles that make this a small slide, and not single particles

struct MotionLeft {
  double share;  ///< of the mass that slid, faster than `slow`
  double speed;  ///< that 99.9 % of what slid have at most [m/s]
  /// "62 % of what slid is faster than 0.1 m/s, at up to 3.2 m/s"
  std::string sentence() const;
};

/// The motion that is left in the soil that slid; nothing where it has come to rest or none slid. `state` has the
/// particles of this rank. Collective; all ranks have the same answer.
std::optional<MotionLeft> still_moving(MPI_Comm comm, const Snapshot &state);

}  // namespace talus
