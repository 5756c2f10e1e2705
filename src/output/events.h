#pragma once
/// What happens in a run, for programs: events.jsonl in the folder of results has one JSON object in a line per event.
/// People read the sentences of the events in run.log; no program does.
#include <mpi.h>

#include <cmath>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace talus {

/// All kinds of events. Those with numbers name them beside.
namespace event {
inline constexpr const char *remark = "remark", *warning = "warning";    // of no kind of their own
inline constexpr const char *resumed = "resumed";                        // step
inline constexpr const char *body = "body";                              // volume_m3, mass_kg, particles
inline constexpr const char *waits_for_loads = "waits_for_loads";        // a stage goes on though its soil is quiet
inline constexpr const char *failure = "failure";                        // failure_speed_m_s
inline constexpr const char *rest = "rest";                              // all soil has come to rest
inline constexpr const char *slow = "slow";                              // most of it has: rest_speed_m_s
inline constexpr const char *equilibrium = "equilibrium";                // unbalanced_force_ratio, iterations
inline constexpr const char *equilibrium_lost = "equilibrium_lost";      // share_of_loads
inline constexpr const char *flow_lost = "flow_lost";                    // share_of_duration
inline constexpr const char *stage_end = "stage_end";                    // of flow by finite elements
inline constexpr const char *duration_over = "duration_over";            // before the stop criterion was met
inline constexpr const char *still_moving = "still_moving";              // at the end of the run
inline constexpr const char *reset = "reset";                            // largest_displacement_m
inline constexpr const char *moved_before_reset = "moved_before_reset";  // largest_displacement_m
inline constexpr const char *escaped = "escaped";                        // particles, mass_kg
inline constexpr const char *lost_soil = "lost_soil";                    // share, mass_kg
inline constexpr const char *cut_off = "cut_off";                        // an end of the mesh cuts a slide off
inline constexpr const char *created_energy = "created_energy";
inline constexpr const char *came_apart = "came_apart";              // share_of_gaps, largest_ratio
inline constexpr const char *water_drawn = "water_drawn";            // share
inline constexpr const char *dilated = "dilated";                    // ratio, largest_ratio
inline constexpr const char *strength_trial = "strength_trial";      // factor, displacement_m
inline constexpr const char *factor_of_safety = "factor_of_safety";  // mechanism, factor, equilibrium_at, mechanism_at
inline constexpr const char *ranks = "ranks";                        // how they share the work
inline constexpr const char *steps = "steps";                        // steps, evaluations, rejections, ...
inline constexpr const char *pressure_solves = "pressure_solves";    // mean_iterations, most_iterations, unsolved
inline constexpr const char *end = "end", *broke_off = "broke_off";
}  // namespace event

/// Numbers by names that end in their units, as columns of history.csv do.
using EventValues = std::vector<std::pair<std::string, double>>;

struct Event {
  std::string kind, text;
  EventValues values = {};
  bool warning = false;              ///< of what may be wrong
  double time = NAN, load_time = 0;  ///< [s]; load_time is what functions of the scene see as t
  std::string stage = {};
};

/// One line per event.
std::string to_lines(const std::vector<Event> &events);
/// The events in lines; a last line that was cut off is none.
std::vector<Event> events_in(const std::string &lines);
/// Those of the run with these results, none without a file.
std::vector<Event> read_events(const std::string &folder);

/// events.jsonl. It can be read while the run goes on.
class EventFile {
 public:
  /// Starts the file with these events. Collective; throws std::runtime_error with path and cause on all ranks.
  EventFile(MPI_Comm comm, const std::string &folder, const std::vector<Event> &events);
  /// The first rank writes it at once; what cannot be written is left to `complete`.
  void add(const Event &event);
  /// Writes all events anew if one of them could not be written. Collective; throws as the constructor.
  void complete(const std::vector<Event> &events);

 private:
  MPI_Comm comm_;
  std::string path_;
  std::ofstream file_;  ///< open on the first rank
};

}  // namespace talus
