#pragma once
/// history.csv: quantities over time, one line per time. The file can be read while the run goes on.
#include <mpi.h>

#include <fstream>
#include <string>
#include <vector>

namespace talus {

/// The columns are time_s, step, stage and those of the caller, whose names end in their units
/// ("crest_displacement_m"). Every function is collective over `comm`; rank 0 writes. Failures throw std::runtime_error
/// with path and cause on all ranks.
class History {
 public:
  /// Starts the file anew.
  History(MPI_Comm comm, const std::string &path, const std::vector<std::string> &names);

  /// Continues the file of an earlier run. Lines later than `time` [s] and a last line that was cut off are dropped. A
  /// missing file is started; a file with other columns than `names` is refused.
  static History append(MPI_Comm comm, const std::string &path, const std::vector<std::string> &names, double time);

  /// Does the file that `append` found lack the line of `time`, on rank 0? Lines before it may be missing then.
  bool has_gap() const { return gap_; }

  /// Adds a line and brings it to the file; `values` are rank 0's, one per name, in their order.
  void row(double time, long long step, const std::string &stage, const std::vector<double> &values) {
    rows(time, step, stage, {values});
  }
  /// Several lines of the same time.
  void rows(double time, long long step, const std::string &stage, const std::vector<std::vector<double>> &lines);

 private:
  History(MPI_Comm comm, const std::string &path) : comm_(comm), path_(path) {}
  void open_with(const std::string &content);

  MPI_Comm comm_;
  std::string path_;
  std::size_t columns_ = 0;  ///< after time, step and stage
  std::ofstream file_;       ///< open on rank 0
  bool gap_ = false;
};

}  // namespace talus
