#include "simulation/checkpoints.inl"
#include "simulation/checks.inl"
#include "simulation/nodal_fields.inl"
#include "simulation/pore_flow.inl"
#include "simulation/quasi_static.inl"
#include "simulation/report.inl"
#include "simulation/results.inl"
#include "simulation/setup.inl"
#include "simulation/stages.inl"
#include "simulation/stepping.inl"

namespace talus {
template class Simulation<2>;
}  // namespace talus
