#pragma once
/// A run of a sweep (sweep.h) is a process of its own. It knows the process that has started it, its starter.
#include <string>

namespace talus {

/// Exit status of a run of a sweep that a signal has ended.
inline constexpr int stopped_status = 4;

/// The variable NAME=VALUE of the environment by which a run finds this process as its starter.
std::string this_starter();

/// To be called first by every program: a run of a sweep ends by SIGTERM when the program that started it is gone, even
/// killed. Programs that the run starts itself are not concerned.
void end_with_starter();
/// To be called by what handles SIGTERM: a run whose starter is gone has some seconds to end in order, also in the
/// midst of a mesh or an equilibrium, and is ended then. Safe in a signal handler.
void end_soon_without_starter();
/// To be called with the exit status of every program: a run of a sweep says by another status that a signal has ended
/// it.
int status_for_starter(int status);

}  // namespace talus
