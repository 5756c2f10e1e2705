#pragma once
/// From `main` to the commands of a program: starts PETSc and MPI, reads the command line, performs the command, and
/// turns errors into exit statuses (0 success, 2 bad input, 1 anything else).
#include <initializer_list>

#include "commands/commands.h"

namespace talus {

using AddCommand = Action (*)(CLI::App &);

/// Returns the exit status.
int run_program(int argc, char **argv, std::initializer_list<AddCommand> commands);

}  // namespace talus
