#include "commands/starter.h"

#include <sys/prctl.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

#include "simulation.h"

namespace talus {
namespace {

constexpr const char *variable = "TALUS_STARTER";
pid_t starter = 0;  // 0: this is no run of a sweep

}  // namespace

std::string this_starter() { return std::string(variable) + "=" + std::to_string(getpid()); }

void end_with_starter() {
  const char *given = std::getenv(variable);
  if (!given) return;
  starter = static_cast<pid_t>(std::atol(given));
  unsetenv(variable);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != starter) raise(SIGTERM);  // it was gone before that
}

void end_soon_without_starter() {
  constexpr unsigned grace = 5;                           // [s]
  if (starter > 0 && getppid() != starter) alarm(grace);  // SIGALRM ends a process
}

int status_for_starter(int status) { return status && interrupted && starter > 0 ? stopped_status : status; }

}  // namespace talus
