#include "physics/laws/update_stress.inl"

namespace talus {

template void update_stress<3>(const Law &, const StressPoints<3> &);
template void update_stress_with_tangent<3>(const Law &, const StressPoints<3> &, double *);
template void admit_stress<3>(const Law &, const StressPoints<3> &);

}  // namespace talus
