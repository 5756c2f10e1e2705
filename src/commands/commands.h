#pragma once
/// The program's commands, one file each. A command adds itself to the command line and returns what it does when
/// chosen; its result is the exit status (0 success, 2 bad input, 1 anything else).
#include <CLI/CLI.hpp>
#include <functional>

namespace talus {

using Action = std::function<int()>;

/// Of an option: a number above 0. CLI::PositiveNumber says the same with the largest number there is, in 309 digits.
inline const CLI::Validator above_zero(
    [](const std::string &text) {
      double value = 0;
      const bool number = CLI::detail::lexical_cast(text, value);
      return number && value > 0 ? std::string() : text + " must be a number above 0";
    },
    "NUMBER ABOVE 0");

/// Exit status of solve where a trial within the bracket of a factor of safety was undecided, so that the bracket is
/// wider than was asked for.
inline constexpr int undecided_status = 3;

Action add_run(CLI::App &app);
Action add_solve(CLI::App &app);
Action add_mesh(CLI::App &app);
Action add_check(CLI::App &app);
Action add_soil(CLI::App &app);
Action add_record(CLI::App &app);
Action add_newmark(CLI::App &app);
Action add_plot(CLI::App &app);
Action add_maps(CLI::App &app);
Action add_bench(CLI::App &app);
Action add_compare(CLI::App &app);
Action add_converge(CLI::App &app);
Action add_study(CLI::App &app);
Action add_describe(CLI::App &app);

}  // namespace talus
