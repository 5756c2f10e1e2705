#pragma once
/// HDF5 files, written whole and read back. A file is built in memory and written by replace_file, because HDF5 1.10 is
/// not safe on a full disk: it updates group tables in place; a failed H5Fclose leaves an identifier behind that
/// crashes the program when MPI ends; and on four ranks Open MPI's collective writes reported success for data that
/// were lost (measured with RLIMIT_FSIZE and a full tmpfs).
#include <hdf5.h>

#include <string>
#include <utility>
#include <vector>

namespace talus {

/// Owns one HDF5 identifier; closed at scope exit.
template <herr_t (*close)(hid_t)>
class H5Owned {
 public:
  H5Owned() = default;
  /// Throws std::runtime_error with `what` and HDF5's message if `id` is that of a failed call.
  H5Owned(hid_t id, const std::string &what);
  H5Owned(H5Owned &&other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  H5Owned &operator=(H5Owned &&other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~H5Owned() {
    if (id_ >= 0) (void)close(id_);
  }
  operator hid_t() const { return id_; }

 private:
  hid_t id_ = H5I_INVALID_HID;
};
using H5File = H5Owned<H5Fclose>;
using H5Group = H5Owned<H5Gclose>;
using H5Dataset = H5Owned<H5Dclose>;
using H5Space = H5Owned<H5Sclose>;
using H5Attribute = H5Owned<H5Aclose>;
using H5Type = H5Owned<H5Tclose>;
using H5Properties = H5Owned<H5Pclose>;

/// Throws std::runtime_error with `what` and HDF5's message if `status` is that of a failed call.
void check_hdf5(long long status, const std::string &what);

/// Silences HDF5's printing of errors in a scope: they are reported as exceptions.
class QuietHdf5 {
 public:
  QuietHdf5();
  QuietHdf5(const QuietHdf5 &) = delete;
  QuietHdf5 &operator=(const QuietHdf5 &) = delete;
  ~QuietHdf5();

 private:
  H5E_auto2_t print_ = nullptr;
  void *to_ = nullptr;
};

/// A file that is filled in memory and then saved. Names are paths inside the file; `object` is "/" or the path of a
/// group or dataset.
class Hdf5Builder {
 public:
  explicit Hdf5Builder(const std::string &path);
  void group(const std::string &name);
  void dataset(const std::string &name, const std::vector<double> &values, int columns);
  void dataset(const std::string &name, const std::vector<long long> &values, int columns);
  void dataset(const std::string &name, const std::vector<std::string> &texts);
  void attribute(const std::string &object, const char *name, double value);
  void attribute(const std::string &object, const char *name, long long value);
  void attribute(const std::string &object, const char *name, const std::string &text);
  /// Makes `name` a dataset whose rows are those of the datasets of this name in other files, one file after the other.
  /// Where a file is missing readers see NaN, or -1 in whole numbers.
  struct Part {
    std::string file;  ///< relative to this one
    long long rows;
  };
  template <class T>  // double or long long
  void dataset_of_parts(const std::string &name, int columns, const std::vector<Part> &parts);
  /// Makes `name` a link to the content of another file, whose path is relative to this one.
  void link(const std::string &name, const std::string &file);
  /// Writes the file to the disk, whole or not at all. Throws std::runtime_error with path and cause.
  void save() const;

 private:
  void rows(const std::string &name, hid_t stored_as, hid_t type, const void *values, std::size_t size, int columns);
  H5Attribute new_attribute(const std::string &object, const char *name, hid_t type);
  QuietHdf5 quiet_;
  std::string path_;
  H5Properties in_memory_;
  H5File file_;
};

/// A file on disk, read only. Every failure is std::runtime_error with the path.
class Hdf5Reader {
 public:
  explicit Hdf5Reader(const std::string &path);
  Hdf5Reader(const Hdf5Reader &) = delete;
  Hdf5Reader &operator=(const Hdf5Reader &) = delete;
  /// Closes the file; an error of the system is passed over, since nothing is lost of a file that was only read.
  ~Hdf5Reader();
  std::vector<std::string> names(const std::string &group) const;  ///< of the links in a group, in alphabetical order
  std::vector<hsize_t> shape(const std::string &dataset) const;
  /// Files that hold the rows of a dataset_of_parts, as they are named in it; none of another dataset.
  std::vector<std::string> parts(const std::string &dataset) const;
  std::vector<std::string> texts(const std::string &dataset) const;
  std::vector<double> numbers(const std::string &dataset) const;  ///< row by row
  double number(const std::string &object, const char *attribute) const;
  long long integer(const std::string &object, const char *attribute) const;
  std::string text(const std::string &object, const char *attribute) const;

 private:
  H5Attribute attribute(const std::string &object, const char *name) const;
  QuietHdf5 quiet_;
  std::string path_;
  H5File file_;
};

}  // namespace talus
