#pragma once
/// The results of a run, for ParaView and for scripts:
///
///     DIR/run.h5        index: scene, program version, body names, and links `/mesh` and `/snapshots/000012`
///     DIR/run/*.h5      what the links lead to: `mesh.h5` and one file per snapshot
///     DIR/run.xdmf      what ParaView opens: the particles over time; numbers of cells for it are in run/points.h5
///     DIR/mesh.xdmf     the background mesh, for ParaView
///     DIR/run.py        a state of ParaView that shows both
///
/// Through the links run.h5 reads like one file (`h5py.File("run.h5")["snapshots/000012/stress"]`). A snapshot has the
/// attributes time [s], step and stage, and what the integrator did up to then (evaluations, rejections, inversions,
/// steps_bounded_by_error, steps_bounded_by_stability, steps_bounded_by_outputs, shortest_step_s, longest_step_s); `id`
/// [particles][1] in increasing order; `body` [particles][1], an index into
/// `/bodies`; and one [particles][components] dataset per column, with the attributes unit, meaning and components ("xx
/// yy zz xy"). All numbers are doubles or 64-bit integers. What a reader gets does not depend on the number of ranks.
///
/// Every file appears by renaming a complete one, so a run that dies, or a full disk, leaves all earlier snapshots
/// readable (hdf5_file.h says why HDF5 alone does not give that). So a writer holds in memory what it writes. Of more
/// rows than one writer should hold several ranks write a file each, `000012.part0.h5` and so on by increasing id, and
/// `000012.h5` joins them into datasets that read like one; `mesh.h5` alike.
#include <mpi.h>

#include <functional>
#include <string>
#include <vector>

#include "output/results.h"

namespace talus {

/// Attributes of the whole run.
struct RunHeader {
  std::string title;
  std::string program;              ///< name and version of the program
  std::string scene;                ///< text of the scene as read, with a line for each override
  std::string values;               ///< the scene with its overrides applied, as TOML
  std::vector<std::string> bodies;  ///< names; Snapshot::body counts in this list
};

/// Writes the snapshots of a run. Every function is collective over `comm`; a failure throws std::runtime_error with
/// path and cause, the same on all ranks, and leaves what was written before as it is.
class RunFile {
 public:
  static constexpr long long rows_of_a_writer = 4'000'000;  ///< at most; of particles with 40 numbers 1.3 GB

  /// Starts the results in folder `dir`, which is made where it is missing; snapshots of an older run in it are
  /// removed.
  RunFile(MPI_Comm comm, const std::string &dir, const RunHeader &header, MeshPicture local_mesh,
          long long rows = rows_of_a_writer);

  /// Continues the results of an earlier run of the same scene behind its first `count` snapshots: index and mesh are
  /// written anew, later snapshots are removed. Of snapshots that cannot be read no file is lost: one of the first
  /// `count` stays where it is, without an entry in the index; the file of a later one, which the run writes again, is
  /// renamed to `run/NUMBER.unreadable.h5`.
  static RunFile append(MPI_Comm comm, const std::string &dir, const RunHeader &header, MeshPicture local_mesh,
                        long long count, long long rows = rows_of_a_writer);

  /// Adds a snapshot. Ranks without particles pass columns without values.
  void write(Snapshot local);

  /// Step of the last snapshot; -1 if there is none.
  long long last_step() const { return last_step_; }
  /// Number of snapshots of the run so far, with those that cannot be read: the number of the next one.
  long long count() const { return count_; }
  /// Which snapshots `append` could not read, why, and what became of their files; a sentence each, on rank 0.
  const std::vector<std::string> &damaged() const { return damaged_; }

 private:
  struct Shape {
    std::string name, unit;
    int components;
  };
  struct Entry {  ///< of the index and of the XDMF file: one snapshot
    std::string number;
    double time;
    long long step;
    unsigned long long particles;
    std::vector<Shape> columns;
  };

  RunFile(MPI_Comm comm, const std::string &dir, long long rows) : comm_(comm), dir_(dir), most_rows_(rows) {}
  void write_mesh(MeshPicture local_mesh);
  void begin(const RunHeader &header, MeshPicture local_mesh, const std::function<void()> &rest);
  std::string snapshot_file(const std::string &number) const { return "run/" + number + ".h5"; }
  std::string path_of(const std::string &file) const { return dir_ + "/" + file; }
  Entry read_entry(const std::string &number) const;
  void write_points();
  void write_index();
  std::string xdmf() const;
  std::string xdmf_mesh() const;
  std::string xdmf_particles(const Entry &entry) const;
  void share_last_step();

  MPI_Comm comm_;
  std::string dir_;
  long long most_rows_;
  long long last_step_ = -1, count_ = 0;
  int dimension_ = 2;
  unsigned long long nodes_ = 0, cells_ = 0;
  // on rank 0 only:
  RunHeader header_;
  unsigned long long points_ = 0;  ///< how many numbers of points are written
  std::vector<Entry> entries_;
  std::vector<std::string> damaged_;
};

}  // namespace talus
