#include "output/hdf5_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cmath>
#include <stdexcept>
#include <type_traits>

#include "output/replace_file.h"

namespace talus {
namespace {

constexpr std::size_t growth = 1 << 20;  // of a file in memory [bytes]

/// The innermost of HDF5's stacked error messages: the one that names the cause.
std::string cause_in_hdf5() {
  std::string cause;
  const auto keep_last = [](unsigned, const H5E_error2_t *error, void *kept) -> herr_t {
    *static_cast<std::string *>(kept) = error->desc ? error->desc : "";
    return 0;
  };
  if (H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, keep_last, &cause) < 0 || cause.empty()) return "HDF5 gives no cause";
  return cause;
}

H5Type text_type() {
  H5Type type(H5Tcopy(H5T_C_S1), "describing text");
  check_hdf5(H5Tset_size(type, H5T_VARIABLE), "describing text");
  check_hdf5(H5Tset_cset(type, H5T_CSET_UTF8), "describing text");
  return type;
}

}  // namespace

void check_hdf5(long long status, const std::string &what) {
  if (status < 0) throw std::runtime_error(what + ": " + cause_in_hdf5());
}

template <herr_t (*close)(hid_t)>
H5Owned<close>::H5Owned(hid_t id, const std::string &what) : id_(id) {
  check_hdf5(id, what);
}
template class H5Owned<H5Fclose>;
template class H5Owned<H5Gclose>;
template class H5Owned<H5Dclose>;
template class H5Owned<H5Sclose>;
template class H5Owned<H5Aclose>;
template class H5Owned<H5Tclose>;
template class H5Owned<H5Pclose>;

QuietHdf5::QuietHdf5() {
  check_hdf5(H5Eget_auto2(H5E_DEFAULT, &print_, &to_), "reading HDF5's error handler");
  check_hdf5(H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr), "setting HDF5's error handler");
}
QuietHdf5::~QuietHdf5() { (void)H5Eset_auto2(H5E_DEFAULT, print_, to_); }

Hdf5Builder::Hdf5Builder(const std::string &path)
    : path_(path), in_memory_(H5Pcreate(H5P_FILE_ACCESS), "preparing " + path) {
  check_hdf5(H5Pset_fapl_core(in_memory_, growth, false), "preparing " + path);
  check_hdf5(H5Pset_libver_bounds(in_memory_, H5F_LIBVER_V18, H5F_LIBVER_LATEST), "preparing " + path);
  file_ = H5File(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, in_memory_), "preparing " + path);
}

void Hdf5Builder::group(const std::string &name) {
  H5Group(H5Gcreate2(file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), "creating group " + name);
}

void Hdf5Builder::rows(const std::string &name, hid_t stored_as, hid_t type, const void *values, std::size_t size,
                       int columns) {
  const hsize_t shape[] = {size / columns, static_cast<hsize_t>(columns)};
  const H5Space space(H5Screate_simple(2, shape, nullptr), "shaping " + name);
  const H5Dataset set(H5Dcreate2(file_, name.c_str(), stored_as, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                      "creating " + name);
  if (size) check_hdf5(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), "filling " + name);
}

void Hdf5Builder::dataset(const std::string &name, const std::vector<double> &values, int columns) {
  rows(name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data(), values.size(), columns);
}

void Hdf5Builder::dataset(const std::string &name, const std::vector<long long> &values, int columns) {
  rows(name, H5T_STD_I64LE, H5T_NATIVE_LLONG, values.data(), values.size(), columns);
}

void Hdf5Builder::dataset(const std::string &name, const std::vector<std::string> &texts) {
  const H5Type type = text_type();
  const hsize_t count = texts.size();
  const H5Space space(H5Screate_simple(1, &count, nullptr), "shaping " + name);
  const H5Dataset set(H5Dcreate2(file_, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                      "creating " + name);
  std::vector<const char *> pointers;
  for (const auto &text : texts) pointers.push_back(text.c_str());
  if (count) check_hdf5(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, pointers.data()), "filling " + name);
}

template <class T>
void Hdf5Builder::dataset_of_parts(const std::string &name, int columns, const std::vector<Part> &parts) {
  constexpr bool real = std::is_same_v<T, double>;
  const hid_t stored_as = real ? H5T_IEEE_F64LE : H5T_STD_I64LE, type = real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_LLONG;
  const T missing = real ? static_cast<T>(std::nan("")) : static_cast<T>(-1);
  hsize_t shape[] = {0, static_cast<hsize_t>(columns)};
  for (const Part &part : parts) shape[0] += part.rows;
  const H5Space space(H5Screate_simple(2, shape, nullptr), "shaping " + name);
  const H5Properties virtually(H5Pcreate(H5P_DATASET_CREATE), "preparing " + name);
  check_hdf5(H5Pset_fill_value(virtually, type, &missing), "preparing " + name);
  hsize_t start[] = {0, 0};
  for (const Part &part : parts) {
    const hsize_t rows[] = {static_cast<hsize_t>(part.rows), shape[1]};
    if (part.rows == 0) continue;
    const H5Space there(H5Screate_simple(2, rows, nullptr), "shaping " + name);
    check_hdf5(H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, rows, nullptr), "shaping " + name);
    check_hdf5(H5Pset_virtual(virtually, space, part.file.c_str(), ("/" + name).c_str(), there), "joining " + name);
    start[0] += rows[0];
  }
  check_hdf5(H5Sselect_all(space), "shaping " + name);
  H5Dataset(H5Dcreate2(file_, name.c_str(), stored_as, space, H5P_DEFAULT, virtually, H5P_DEFAULT), "joining " + name);
}
template void Hdf5Builder::dataset_of_parts<double>(const std::string &, int, const std::vector<Part> &);
template void Hdf5Builder::dataset_of_parts<long long>(const std::string &, int, const std::vector<Part> &);

H5Attribute Hdf5Builder::new_attribute(const std::string &object, const char *name, hid_t type) {
  const H5Space space(H5Screate(H5S_SCALAR), "shaping an attribute");
  return {H5Acreate_by_name(file_, object.c_str(), name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
          "creating attribute " + std::string(name) + " of " + object};
}

void Hdf5Builder::attribute(const std::string &object, const char *name, double value) {
  check_hdf5(H5Awrite(new_attribute(object, name, H5T_IEEE_F64LE), H5T_NATIVE_DOUBLE, &value), "filling an attribute");
}

void Hdf5Builder::attribute(const std::string &object, const char *name, long long value) {
  check_hdf5(H5Awrite(new_attribute(object, name, H5T_STD_I64LE), H5T_NATIVE_LLONG, &value), "filling an attribute");
}

void Hdf5Builder::attribute(const std::string &object, const char *name, const std::string &text) {
  const H5Type type = text_type();
  const char *pointer = text.c_str();
  check_hdf5(H5Awrite(new_attribute(object, name, type), type, &pointer), "filling an attribute");
}

void Hdf5Builder::link(const std::string &name, const std::string &file) {
  check_hdf5(H5Lcreate_external(file.c_str(), "/", file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT), "linking " + file);
}

void Hdf5Builder::save() const {
  check_hdf5(H5Fflush(file_, H5F_SCOPE_GLOBAL), "completing " + path_);
  const ssize_t size = H5Fget_file_image(file_, nullptr, 0);
  check_hdf5(size, "measuring " + path_);
  void **memory;  // the driver's own buffer: H5Fget_file_image would copy it
  check_hdf5(H5Fget_vfd_handle(file_, in_memory_, reinterpret_cast<void **>(&memory)),
             "reaching the memory of " + path_);
  replace_file(path_, {static_cast<const char *>(*memory), static_cast<std::size_t>(size)});
}

Hdf5Reader::Hdf5Reader(const std::string &path)
    : path_(path), file_(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "cannot open " + path) {}

/// Where the system cannot close a file, H5Fclose fails and keeps the identifier of memory that it has freed, through
/// which HDF5 crashes the program when MPI ends. So what HDF5 closes is a descriptor of /dev/null: dup2 has closed the
/// file, and drops its error.
Hdf5Reader::~Hdf5Reader() {
  int *descriptor = nullptr;
  if (H5Fget_vfd_handle(file_, H5P_DEFAULT, reinterpret_cast<void **>(&descriptor)) < 0) return;
  const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (nothing < 0) return;
  (void)::dup2(nothing, *descriptor);
  ::close(nothing);
}

std::vector<std::string> Hdf5Reader::names(const std::string &group) const {
  std::vector<std::string> found;
  const auto keep = [](hid_t, const char *name, const H5L_info_t *, void *list) -> herr_t {
    static_cast<std::vector<std::string> *>(list)->push_back(name);
    return 0;
  };
  check_hdf5(H5Literate_by_name(file_, group.c_str(), H5_INDEX_NAME, H5_ITER_INC, nullptr, keep, &found, H5P_DEFAULT),
             "cannot list " + group + " of " + path_);
  return found;
}

std::vector<hsize_t> Hdf5Reader::shape(const std::string &dataset) const {
  const std::string what = "cannot read the shape of " + dataset + " in " + path_;
  const H5Dataset set(H5Dopen2(file_, dataset.c_str(), H5P_DEFAULT), what);
  const H5Space space(H5Dget_space(set), what);
  const int rank = H5Sget_simple_extent_ndims(space);
  check_hdf5(rank, what);
  std::vector<hsize_t> shape(rank);
  check_hdf5(H5Sget_simple_extent_dims(space, shape.data(), nullptr), what);
  return shape;
}

std::vector<std::string> Hdf5Reader::parts(const std::string &dataset) const {
  const std::string what = "cannot read how " + dataset + " in " + path_ + " is stored";
  const H5Dataset set(H5Dopen2(file_, dataset.c_str(), H5P_DEFAULT), what);
  const H5Properties created(H5Dget_create_plist(set), what);
  const H5D_layout_t layout = H5Pget_layout(created);
  check_hdf5(layout, what);
  std::size_t count = 0;
  if (layout == H5D_VIRTUAL) check_hdf5(H5Pget_virtual_count(created, &count), what);
  std::vector<std::string> files(count);
  for (std::size_t k = 0; k < count; ++k) {
    const ssize_t length = H5Pget_virtual_filename(created, k, nullptr, 0);
    check_hdf5(length, what);
    files[k].resize(length);
    check_hdf5(H5Pget_virtual_filename(created, k, files[k].data(), length + 1), what);
  }
  return files;
}

std::vector<std::string> Hdf5Reader::texts(const std::string &dataset) const {
  const std::string what = "cannot read " + dataset + " in " + path_;
  const H5Dataset set(H5Dopen2(file_, dataset.c_str(), H5P_DEFAULT), what);
  const H5Space space(H5Dget_space(set), what);
  const H5Type type = text_type();
  std::vector<char *> pointers(shape(dataset).at(0));
  if (pointers.empty()) return {};
  check_hdf5(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, pointers.data()), what);
  std::vector<std::string> texts(pointers.begin(), pointers.end());
  check_hdf5(H5Dvlen_reclaim(type, space, H5P_DEFAULT, pointers.data()), what);
  return texts;
}

std::vector<double> Hdf5Reader::numbers(const std::string &dataset) const {
  const std::string what = "cannot read " + dataset + " in " + path_;
  const H5Dataset set(H5Dopen2(file_, dataset.c_str(), H5P_DEFAULT), what);
  hsize_t count = 1;
  for (const hsize_t extent : shape(dataset)) count *= extent;
  std::vector<double> values(count);
  if (count) check_hdf5(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), what);
  return values;
}

H5Attribute Hdf5Reader::attribute(const std::string &object, const char *name) const {
  return {H5Aopen_by_name(file_, object.c_str(), name, H5P_DEFAULT, H5P_DEFAULT),
          "cannot read attribute " + std::string(name) + " in " + path_};
}

double Hdf5Reader::number(const std::string &object, const char *name) const {
  double value;
  check_hdf5(H5Aread(attribute(object, name), H5T_NATIVE_DOUBLE, &value), "cannot read " + path_);
  return value;
}

long long Hdf5Reader::integer(const std::string &object, const char *name) const {
  long long value;
  check_hdf5(H5Aread(attribute(object, name), H5T_NATIVE_LLONG, &value), "cannot read " + path_);
  return value;
}

std::string Hdf5Reader::text(const std::string &object, const char *name) const {
  const H5Type type = text_type();
  char *pointer;
  check_hdf5(H5Aread(attribute(object, name), type, &pointer), "cannot read " + path_);
  const std::string text = pointer;
  check_hdf5(H5free_memory(pointer), "cannot read " + path_);
  return text;
}

}  // namespace talus
