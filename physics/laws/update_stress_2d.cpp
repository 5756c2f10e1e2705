#include "physics/laws/update_stress.inl"

namespace talus {

template void update_stress<2>(const Law &, const StressPoints<2> &);
template void admit_stress<2>(const Law &, const StressPoints<2> &);

}  // namespace talus
