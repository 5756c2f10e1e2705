#include "physics/laws/update_stress.inl"

namespace talus {

template void update_stress<3>(const Law &, const StressPoints<3> &);
template void admit_stress<3>(const Law &, const StressPoints<3> &);

}  // namespace talus
