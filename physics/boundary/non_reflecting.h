#pragma once

namespace talus {

/// Dashpots that swallow waves arriving straight at the face: rho c_p across it, rho c_s along it (Lysmer & Kuhlemeyer 1969).
struct NonReflecting {
  static constexpr const char *name = "non_reflecting";
  template <class Visitor>
  void fields(Visitor &&) {}
};

}  // namespace talus
