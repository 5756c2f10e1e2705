#pragma once
/// The program's commands, one file each. A command adds itself to the command line and returns what it does when
/// chosen; its result is the exit status (0 success, 2 bad input, 1 anything else).
#include <CLI/CLI.hpp>
#include <functional>

namespace talus {

using Action = std::function<int()>;

/// Exit status of solve where the factor of safety is known no better than a wide bracket.
inline constexpr int undecided_status = 3;

Action add_run(CLI::App &app);
Action add_solve(CLI::App &app);
Action add_mesh(CLI::App &app);
Action add_check(CLI::App &app);
Action add_soil(CLI::App &app);
Action add_plot(CLI::App &app);
Action add_maps(CLI::App &app);
Action add_bench(CLI::App &app);
Action add_compare(CLI::App &app);
Action add_converge(CLI::App &app);
Action add_study(CLI::App &app);
Action add_verify(CLI::App &app);
Action add_describe(CLI::App &app);

}  // namespace talus
