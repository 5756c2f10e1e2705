#pragma once

namespace talus {

/// No fluid passes. Faces that hold the soil (fixed, roller, velocity, friction) are impermeable without being told so.
struct Impermeable {
  static constexpr const char *name = "impermeable";
  static constexpr const char *meaning = "no fluid passes";
  static constexpr bool water = true;
  template <class Visitor>
  void fields(Visitor &&) {}
};

}  // namespace talus
