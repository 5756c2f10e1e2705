#include "output/progress.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <ctime>
#include <stdexcept>

#include "output/together.h"

namespace talus {
namespace {

constexpr double first_line = 2;  // after the start, except on a terminal [s]
constexpr double terminal_interval = 0.5, plain_interval = 10, log_interval = 60;  // [s]
constexpr double look_interval = 0.1;                                              // between readings of the clock [s]
constexpr long long most_steps = 10000;  // between readings, in case steps become slow

std::string time_of_day() {
  const std::time_t now = std::time(nullptr);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", std::localtime(&now));
  return text;
}

/// 3.2 M, 870 k, 12.
std::string short_number(double value) {
  const char *prefix = "";
  for (const char *next : {" k", " M", " G"})
    if (value >= 1000) value /= 1000, prefix = next;
  char text[32];
  std::snprintf(text, sizeof text, value < 10 ? "%.1f%s" : "%.0f%s", value, prefix);
  return text;
}

/// Characters in a line of a terminal; 0 where that is not known.
int width_of(std::FILE *screen) {
  winsize size{};
  return ioctl(fileno(screen), TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

/// 42 s, 3 min 20 s, 5 h 12 min.
std::string duration(double seconds) {
  const auto s = std::llround(seconds);
  char text[48];
  if (s < 1)
    std::snprintf(text, sizeof text, "less than 1 s");
  else if (s < 60)
    std::snprintf(text, sizeof text, "%lld s", s);
  else if (s < 3600)
    std::snprintf(text, sizeof text, "%lld min %02lld s", s / 60, s % 60);
  else
    std::snprintf(text, sizeof text, "%lld h %02lld min", s / 3600, s / 60 % 60);
  return text;
}

}  // namespace

Progress::Progress(MPI_Comm comm, const std::string &log_path, double total, bool append, std::FILE *screen,
                   std::function<double()> clock)
    : comm_(comm),
      log_path_(log_path),
      prints_(rank_in(comm) == 0),
      total_(total),
      screen_(screen),
      clock_(std::move(clock)) {
  on_first_rank(comm, [&] {
    log_.open(log_path, append ? std::ios::app : std::ios::trunc);
    if (!log_) throw std::runtime_error("cannot write " + log_path + ": " + std::strerror(errno));
    terminal_ = isatty(fileno(screen_));
    looked_at_ = began_at_ = printed_at_ = clock_();
    next_print_ = printed_at_ + (terminal_ ? terminal_interval : first_line);
    next_log_ = printed_at_ + first_line;
  });
}

Progress::~Progress() {
  if (line_open_) std::fputc('\n', screen_);
}

void Progress::stage(const std::string &name, bool to_the_end) {
  if (!prints_) return;
  stage_ = name, estimates_ = to_the_end;
  printed_ = now_, printed_at_ = clock_();  // the rate of another stage says nothing about this one
  log("stage " + name);
}

void Progress::look_at_clock() {
  const double clock = clock_();
  const double per_step = (clock - looked_at_) / static_cast<double>(steps_between_looks_);
  // at most twice as many as before: a quick step says little of those that write
  const double steps =
      std::min(look_interval / std::max(per_step, 1e-9), 2 * static_cast<double>(steps_between_looks_));
  steps_between_looks_ = std::clamp(std::llround(steps), 1LL, most_steps);
  until_clock_ = steps_between_looks_;
  looked_at_ = clock;
  if (clock < next_print_ && clock < next_log_) return;
  tell(describe(clock), clock);
  printed_ = now_, printed_at_ = clock;
}

void Progress::seeking(const std::string &text) {
  if (prints_) tell(text, clock_());
}

void Progress::tell(const std::string &line, double clock) {
  if (clock >= next_print_) {
    print(line);
    next_print_ = clock + (terminal_ ? terminal_interval : plain_interval);
  }
  if (clock >= next_log_) {
    log(line);
    next_log_ = clock + log_interval;
  }
}

/// Rate and remaining time are those of the interval since the last line. The rest may take less, where a stage ends
/// before its duration, or more, where steps become shorter.
std::string Progress::describe(double clock) const {
  const double elapsed = clock - printed_at_, advanced = now_.time - printed_.time;
  std::string line = state();
  if (!estimates_ || elapsed <= 0 || advanced <= 0) return line;
  line += "  " + short_number((now_.particles - printed_.particles) / elapsed) + " particles/s, " +
          short_number((now_.cells - printed_.cells) / elapsed) + " cells/s";
  if (now_.time < total_) line += "  at this rate " + duration((total_ - now_.time) / advanced * elapsed) + " left";
  return line;
}

std::string Progress::state() const {
  char times[96];
  std::snprintf(times, sizeof times, "  t = %.4g of %.4g s  step %lld", now_.time, total_, now_.step);
  return stage_ + times;
}

void Progress::print(const std::string &line) {
  const int width = terminal_ ? width_of(screen_) : 0;
  if (terminal_)  // a line that wraps could not be overwritten
    std::fprintf(screen_, "\r%s\033[K", (width > 0 ? line.substr(0, width - 1) : line).c_str());
  else
    std::fprintf(screen_, "%s\n", line.c_str());
  std::fflush(screen_);
  line_open_ = terminal_;
}

void Progress::note(const std::string &text) {
  if (!prints_) return;
  if (line_open_) std::fputs("\r\033[K", screen_);
  std::fprintf(screen_, "%s\n", text.c_str());
  std::fflush(screen_);
  line_open_ = false;
  log(text);
}

void Progress::failure(const std::string &text) {
  if (prints_) log("the run broke off: " + text);
}

void Progress::finish() {
  on_first_rank(comm_, [&] {
    const std::string line = state() + "  done in " + duration(clock_() - began_at_);
    print(line);
    if (line_open_) std::fputc('\n', screen_);
    line_open_ = false;
    log(line);
    if (!lost_.empty())
      throw std::runtime_error("the results are complete, but " + log_path_ + " lacks lines: " + lost_);
  });
}

void Progress::log(const std::string &line) {
  log_ << time_of_day() << "  " << line << std::endl;
  if (log_) return;
  if (lost_.empty()) {
    lost_ = std::strerror(errno);
    std::fprintf(screen_, "warning: cannot write %s: %s; the run goes on\n", log_path_.c_str(), lost_.c_str());
  }
  log_.clear();  // the next line may find room again
}

}  // namespace talus
