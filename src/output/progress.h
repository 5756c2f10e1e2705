#pragma once
/// Progress of a run on the screen and in run.log. Only rank 0 prints; on other ranks every call returns at once.
#include <mpi.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <functional>
#include <string>

namespace talus {

/// On a terminal: one line that overwrites itself twice a second, cut to the width of the terminal. Elsewhere (a pipe,
/// a batch job): a line after 2 s and then every 10 s. run.log: a line after 2 s, then one a minute, with the time of
/// day. It may be called every step: the clock is read about ten times a second only. A line of run.log that cannot be
/// written does not end the run: the screen shows a warning, and `finish` fails.
class Progress {
 public:
  /// Collective. `total` is the simulated time at which the run ends at the latest [s]; `append`
  /// continues an existing log. Throws std::runtime_error on all ranks if `log_path` cannot be written. `screen` and
  /// `clock` [s] are for tests.
  Progress(MPI_Comm comm, const std::string &log_path, double total, bool append = false, std::FILE *screen = stderr,
           std::function<double()> clock = MPI_Wtime);
  Progress(const Progress &) = delete;
  Progress &operator=(const Progress &) = delete;
  ~Progress();

  /// A stage begins. `to_the_end`: from here on the run moves as time goes on, so that its rate says how long the rest
  /// takes; finite elements take no longer for a longer stage.
  void stage(const std::string &name, bool to_the_end = true);

  /// A step is done: simulated time [s], number of the step, and the numbers (of all ranks) of particles that it moved
  /// and of cells that hold them.
  void step(double time, long long number, long long particles, long long cells) {
    if (!prints_) return;
    now_ = {time, number, now_.particles + static_cast<double>(particles), now_.cells + static_cast<double>(cells)};
    if (--until_clock_ <= 0) look_at_clock();
  }

  /// Between two steps, while iterations of finite elements go on: a line of what they have come to.
  void seeking(const std::string &text);

  /// The run goes on from here, which lies beyond its end where its stages have become shorter.
  void resume(double time, long long number) {
    now_ = printed_ = {time, number};
    total_ = std::max(total_, time);
  }

  /// A line of its own, on the screen and in the log.
  void note(const std::string &text);

  /// The last line of a run that failed, in the log alone: whoever catches the error prints it on the screen.
  void failure(const std::string &text);

  /// Prints the last state. Collective. Throws std::runtime_error on all ranks if lines are missing in run.log.
  void finish();

 private:
  struct State {
    double time = 0;  ///< simulated [s]
    long long step = 0;
    double particles = 0, cells = 0;  ///< updated so far
  };
  void look_at_clock();
  void tell(const std::string &line, double clock);  ///< where a line is due
  std::string state() const;                         ///< time and step
  std::string describe(double clock) const;
  void print(const std::string &line);
  void log(const std::string &line);

  MPI_Comm comm_;
  std::string log_path_, lost_;  ///< `lost_`: why the first of the lines that run.log lacks was not written, or ""
  bool prints_, terminal_ = false, estimates_ = true;
  double total_;
  std::FILE *screen_;
  std::function<double()> clock_;
  std::ofstream log_;
  std::string stage_;
  State now_, printed_;                   ///< at the last step, at the last line printed
  double began_at_ = 0, printed_at_ = 0;  ///< clock at the start, at the last line printed [s]
  double next_print_ = 0, next_log_ = 0;
  double looked_at_ = 0;  ///< clock when it was last read [s]
  long long steps_between_looks_ = 1, until_clock_ = 1;
  bool line_open_ = false;  ///< the terminal's cursor is in a progress line
};

}  // namespace talus
