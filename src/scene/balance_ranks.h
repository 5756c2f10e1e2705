#pragma once
/// Choices of mesh.balance_ranks.
namespace talus {

/// When the mesh is divided among the ranks in another way.
enum class BalanceRanks { when_it_pays, never, always };

}  // namespace talus
