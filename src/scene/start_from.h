#pragma once
/// [start_from]: a run that starts at the state of another.
#include <string>

namespace talus {

/// The run at whose state this one starts.
struct StartFrom {
  std::string folder;               ///< of its results; empty: the run starts at the initial state of the scene
  bool reset_displacement = false;  ///< displacements, velocities and plastic strain are zeroed first
  template <class Visitor>
  void fields(Visitor &&v) {
    v.path("folder", folder,
           "results of another run of the same mesh, bodies and phases, relative to the scene: this run starts at the "
           "state of its last checkpoint, which is its end if it has ended, at time 0 and with stages of its own");
    v.flag("reset_displacement", reset_displacement,
           "set displacement, velocity and plastic strain to zero at the start, as reset_displacement of a stage does "
           "at its end");
  }
};

}  // namespace talus
