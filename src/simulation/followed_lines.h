#pragma once
/// Lines that are followed with the soil, [output.line.NAME]: line_NAME.csv has a row for each place along the line at
/// the times of history.csv.
#include <list>
#include <memory>
#include <string>
#include <vector>

#include "output/history.h"
#include "simulation/point_rows.h"

namespace talus {

struct OutputLine;

template <int dim>
class FollowedLines {
 public:
  /// Throws SceneError for a line of which fewer than two places are in soil. Collective.
  explicit FollowedLines(const World<dim> &world);

  /// Starts the files in a folder, or goes on with those that a run up to `time` [s] has left there. Collective.
  void open(const std::string &directory);
  void append(const std::string &directory, double time);
  /// A row for each place, if the files are open. Collective.
  void write(const Clock &clock, const Statics<dim> &statics);
  void serialize(Archive &archive);

  /// A sentence for each line of which places are not in soil, or share a particle.
  std::vector<std::string> left_out() const;
  /// Names of the lines whose files `append` did not find whole; on rank 0.
  std::vector<std::string> with_gaps() const;

 private:
  struct Line {
    Line(const World<dim> &world, const OutputLine &of);
    std::string path(const std::string &directory) const { return directory + "/line_" + name + ".csv"; }
    std::vector<std::string> columns() const;

    std::string name;
    TrackedPoints<dim> places;
    PointRows<dim> rows;
    std::size_t wanted;             ///< places along the line, in soil and beside it
    std::vector<double> distance;   ///< of each place from the beginning of the line, at the start [m]
    std::unique_ptr<History> file;  ///< null: not written
  };

  MPI_Comm comm_;
  std::list<Line> lines_;  // which stay where they are: rows refer to places
};

}  // namespace talus
