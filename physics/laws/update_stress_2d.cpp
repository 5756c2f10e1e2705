#include "physics/laws/update_stress.inl"

namespace talus {

template void update_stress<2>(const Law &, const StressPoints<2> &);
template void update_stress_with_tangent<2>(const Law &, const StressPoints<2> &, double *);
template void admit_stress<2>(const Law &, const StressPoints<2> &);

}  // namespace talus
