#pragma once
/// What fills the pores, as a scene says it.
namespace talus {

enum class PhaseModel { dry, drained, saturated, unsaturated, three_phase };
/// As scenes name it.
inline const char *name_of(PhaseModel phases) {
  constexpr const char *names[] = {"dry", "drained", "saturated", "unsaturated", "three-phase"};
  return names[static_cast<int>(phases)];
}
/// Do pore fluids move on their own?
inline bool fluids_move(PhaseModel phases) { return phases != PhaseModel::dry && phases != PhaseModel::drained; }

}  // namespace talus
