#include "output/snapshots.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <numeric>
#include <sstream>
#include <stdexcept>

#include "output/hdf5_file.h"
#include "output/replace_file.h"
#include "output/together.h"
#include "paraview_state.h"

namespace talus {
namespace {

constexpr const char *mesh_file = "run/mesh.h5", *points_file = "run/points.h5";

std::string join(const std::vector<std::string> &words, const std::string &between = " ") {
  std::string text;
  for (const auto &word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

void check_lengths(const Snapshot &s) {
  if (s.body.size() != s.id.size()) throw std::runtime_error("snapshot: body and id differ in length");
  for (const auto &column : s.columns)
    if (column.values.size() != s.id.size() * column.components)
      throw std::runtime_error("snapshot: column " + column.name + " has " + std::to_string(column.values.size()) +
                               " values for " + std::to_string(s.id.size()) + " particles of " +
                               std::to_string(column.components) + " components");
}

/// `values`, rows of `row`, in the order in which `order` names the rows.
template <class T>
std::vector<T> reordered(const std::vector<T> &values, const std::vector<std::size_t> &order, int row = 1) {
  std::vector<T> sorted;
  sorted.reserve(values.size());
  for (const std::size_t r : order) std::copy_n(values.begin() + r * row, row, std::back_inserter(sorted));
  return sorted;
}

/// All particles on rank 0, by increasing id; elsewhere none.
Snapshot gathered(MPI_Comm comm, const Snapshot &local) {
  Snapshot all{local.time, local.step,   local.stage, gather(comm, local.id), gather(comm, local.body),
               {},         local.numbers};
  std::vector<std::size_t> order(all.id.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return all.id[a] < all.id[b]; });
  for (const auto &column : local.columns) {
    const auto values = gather(comm, column.values, column.components);
    all.columns.push_back(
        {column.name, column.unit, column.meaning, column.components, reordered(values, order, column.components)});
  }
  all.id = reordered(all.id, order);
  all.body = reordered(all.body, order);
  return all;
}

/// All cells on rank 0. Nodes that ranks share appear once per rank, which does no harm in a picture.
MeshPicture gathered(MPI_Comm comm, const MeshPicture &local) {
  long long nodes = static_cast<long long>(local.position.size()) / local.dimension, before = 0;
  check_mpi(MPI_Exscan(&nodes, &before, 1, MPI_LONG_LONG, MPI_SUM, comm), "numbering nodes");
  if (rank_in(comm) == 0) before = 0;
  std::vector<long long> cell_node = local.cell_node;
  for (auto &node : cell_node) node += before;
  return {local.dimension, gather(comm, local.position, local.dimension), gather(comm, cell_node, local.dimension + 1)};
}

bool is_snapshot(const std::filesystem::path &file) {
  const std::string name = file.stem();
  return file.extension() == ".h5" && name.find_first_not_of("0123456789") == std::string::npos;
}

/// Of the snapshots in a folder, ascending.
std::vector<std::string> numbers_of_snapshots(const std::string &folder) {
  std::vector<std::string> numbers;
  for (const auto &file : std::filesystem::directory_iterator(folder))
    if (is_snapshot(file.path())) numbers.push_back(file.path().stem());
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

void remove_snapshots(const std::string &folder) {
  for (const std::string &number : numbers_of_snapshots(folder)) std::filesystem::remove(folder + "/" + number + ".h5");
}

std::string numbered(long long count) {
  char text[24];
  std::snprintf(text, sizeof text, "%06lld", count);
  return text;
}

/// Gives the file of a snapshot a name that says that it cannot be read, and returns that name.
std::string set_aside(const std::string &folder, const std::string &number) {
  std::string name = number + ".unreadable.h5";
  for (int k = 2; std::filesystem::exists(folder + "/" + name); ++k)
    name = number + ".unreadable." + std::to_string(k) + ".h5";
  std::filesystem::rename(folder + "/" + number + ".h5", folder + "/" + name);
  return name;
}

/// An XDMF reference to a dataset of rows.
std::string data_item(const std::string &file, const std::string &name, unsigned long long rows, int columns,
                      const char *type = "Float") {
  std::ostringstream text;
  text << "<DataItem Dimensions=\"" << rows << " " << columns << "\" NumberType=\"" << type
       << "\" Precision=\"8\" Format=\"HDF\">" << file << ":/" << name << "</DataItem>";
  return text.str();
}

std::string in_xml(const std::string &text) {
  std::string escaped;
  for (const char c : text) escaped += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
  return escaped;
}

/// What ParaView shows as the name of a field: with the unit, and with the components where ParaView does not name them
/// itself, as it does with six, in the order xx, yy, zz, xy, yz, xz.
std::string paraview_name(const std::string &name, const std::string &unit, int components) {
  std::vector<std::string> details;
  if (unit != "-") details.push_back(unit);
  if (components == 4) details.push_back("xx yy zz xy");
  return details.empty() ? name : name + " (" + join(details, ", ") + ")";
}

/// Numbers stand for bodies in the files; the name of the field says which: "body (0 sand, 1 clay)".
std::string name_of_bodies(const std::vector<std::string> &bodies) {
  std::vector<std::string> numbered;
  for (std::size_t b = 0; b < bodies.size(); ++b) numbered.push_back(std::to_string(b) + " " + bodies[b]);
  return "body (" + join(numbered, ", ") + ")";
}

std::string xdmf_attribute(const std::string &name, const char *type, const std::string &data) {
  return "      <Attribute Name=\"" + in_xml(name) + "\" AttributeType=\"" + type + "\" Center=\"Node\">" + data +
         "</Attribute>\n";
}

std::string xdmf_geometry(int dimension, const std::string &data) {
  return "      <Geometry GeometryType=\"" + std::string(dimension == 2 ? "XY" : "XYZ") + "\">" + data +
         "</Geometry>\n";
}

std::string xdmf_file(const std::string &grids) {
  return "<?xml version=\"1.0\" ?>\n<Xdmf Version=\"3.0\">\n<Domain>\n" + grids + "</Domain>\n</Xdmf>\n";
}

}  // namespace

RunFile::RunFile(MPI_Comm comm, const std::string &dir, const RunHeader &header, const MeshPicture &local_mesh)
    : RunFile(comm, dir) {
  begin(header, local_mesh, [&] {
    write_index();  // before the old snapshots are removed, so that no link ever leads nowhere
    remove_snapshots(dir_ + "/run");
  });
}

RunFile RunFile::append(MPI_Comm comm, const std::string &dir, const RunHeader &header, const MeshPicture &local_mesh,
                        long long count) {
  RunFile run(comm, dir);
  run.count_ = count;
  run.begin(header, local_mesh, [&] {
    std::vector<std::string> later;
    std::vector<std::pair<std::string, std::string>> unreadable;  // of the later ones, with the cause
    for (const std::string &number : numbers_of_snapshots(dir + "/run")) {
      const bool is_later = std::stoll(number) >= count;
      try {
        const Entry entry = run.read_entry(number);
        if (is_later)
          later.push_back(number);
        else
          run.entries_.push_back(entry);
      } catch (const std::runtime_error &error) {
        if (is_later)
          unreadable.emplace_back(number, error.what());
        else
          run.damaged_.push_back(std::string("a damaged snapshot is left out of run.h5 and run.xdmf: ") + error.what());
      }
    }
    run.write_index();
    for (const auto &number : later) std::filesystem::remove(dir + "/" + run.snapshot_file(number));
    for (const auto &[number, cause] : unreadable)
      run.damaged_.push_back("a damaged snapshot, which the run now writes again, is kept as run/" +
                             set_aside(dir + "/run", number) + ": " + cause);
  });
  run.share_last_step();
  return run;
}

/// Writes the mesh, then does what `rest` says on the first rank.
void RunFile::begin(const RunHeader &header, const MeshPicture &local_mesh, const std::function<void()> &rest) {
  const MeshPicture mesh = gathered(comm_, local_mesh);
  on_first_rank(comm_, [&] {
    header_ = header;
    dimension_ = mesh.dimension;
    nodes_ = mesh.position.size() / mesh.dimension;
    cells_ = mesh.cell_node.size() / (mesh.dimension + 1);
    make_folder(dir_ + "/run");
    Hdf5Builder file(dir_ + "/" + mesh_file);
    file.attribute("/", "dimension", static_cast<long long>(mesh.dimension));
    file.dataset("node_position", mesh.position, mesh.dimension);
    file.attribute("node_position", "unit", std::string("m"));
    file.dataset("cell_node", mesh.cell_node, mesh.dimension + 1);
    file.save();
    replace_file(dir_ + "/mesh.xdmf", xdmf_mesh());
    replace_file(dir_ + "/run.py", paraview_state);
    rest();
  });
}

void RunFile::write(const Snapshot &local) {
  together(comm_, [&] { check_lengths(local); });
  const Snapshot all = gathered(comm_, local);
  on_first_rank(comm_, [&] {
    entries_.push_back(write_file(all, numbered(count_)));
    try {
      write_index();
    } catch (...) {
      entries_.pop_back();
      throw;
    }
  });
  last_step_ = local.step, ++count_;
}

RunFile::Entry RunFile::write_file(const Snapshot &all, const std::string &number) const {
  Entry entry{number, all.time, all.step, all.id.size(), {}};
  Hdf5Builder file(dir_ + "/" + snapshot_file(number));
  file.attribute("/", "time", all.time);
  file.attribute("/", "step", all.step);
  file.attribute("/", "stage", all.stage);
  for (const auto &[name, value] : all.numbers) file.attribute("/", name.c_str(), value);
  file.dataset("id", all.id, 1);
  file.dataset("body", std::vector<long long>(all.body.begin(), all.body.end()), 1);
  for (const auto &column : all.columns) {
    file.dataset(column.name, column.values, column.components);
    file.attribute(column.name, "unit", column.unit);
    file.attribute(column.name, "meaning", column.meaning);
    file.attribute(column.name, "components", join(component_names(column.components)));
    entry.columns.push_back({column.name, column.unit, column.components});
  }
  file.save();
  return entry;
}

RunFile::Entry RunFile::read_entry(const std::string &number) const {
  const Hdf5Reader file(dir_ + "/" + snapshot_file(number));
  Entry entry{number, file.number("/", "time"), file.integer("/", "step"), file.shape("id").at(0), {}};
  for (const auto &name : file.names("/"))
    if (name != "id" && name != "body")
      entry.columns.push_back({name, file.text(name, "unit"), static_cast<int>(file.shape(name).at(1))});
  return entry;
}

void RunFile::share_last_step() {
  if (!entries_.empty()) last_step_ = entries_.back().step;
  check_mpi(MPI_Bcast(&last_step_, 1, MPI_LONG_LONG, 0, comm_), "sharing the last step");
}

/// Writes the numbers of the points, from which ParaView's default reader makes cells of one point each: it draws no
/// particle without. Every snapshot reads as many of them as it has particles, so they are written only when there are
/// more particles than ever before.
void RunFile::write_points() {
  unsigned long long most = 1;
  for (const auto &entry : entries_) most = std::max(most, entry.particles);
  if (most <= points_) return;
  std::vector<long long> number(most);
  std::iota(number.begin(), number.end(), 0);
  Hdf5Builder file(dir_ + "/" + points_file);
  file.dataset("point", number, 1);
  file.save();
  points_ = most;
}

/// Writes run.h5 and run.xdmf anew. They hold no particle data, so this is cheap.
void RunFile::write_index() {
  write_points();
  Hdf5Builder file(dir_ + "/run.h5");
  file.attribute("/", "title", header_.title);
  file.attribute("/", "program", header_.program);
  file.dataset("scene", {header_.scene});
  file.dataset("values", {header_.values});
  file.dataset("bodies", header_.bodies);
  file.link("mesh", mesh_file);
  file.group("snapshots");
  for (const auto &entry : entries_) file.link("snapshots/" + entry.number, snapshot_file(entry.number));
  file.save();
  replace_file(dir_ + "/run.xdmf", xdmf());
}

/// Particles over time and nothing else: of a collection of particles and mesh ParaView's default reader shows all
/// times at once, coloured by nothing.
std::string RunFile::xdmf() const {
  std::ostringstream text;
  text.precision(17);
  text << "  <Grid Name=\"run\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  for (const auto &entry : entries_)
    text << "    <Grid Name=\"" << entry.number << "\">\n      <Time Value=\"" << entry.time << "\"/>\n"
         << xdmf_particles(entry) << "    </Grid>\n";
  text << "  </Grid>\n";
  return xdmf_file(text.str());
}

/// ParaView colours by the first scalar: by plastic or shear strain where the soil has it.
std::string RunFile::xdmf_particles(const Entry &entry) const {
  const std::string file = snapshot_file(entry.number), rows = std::to_string(entry.particles);
  std::string text = "      <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"" + rows +
                     "\" NodesPerElement=\"1\">" + data_item(points_file, "point", entry.particles, 1, "Int") +
                     "</Topology>\n";
  std::vector<Shape> columns = entry.columns;
  std::ranges::stable_partition(
      columns, [](const Shape &column) { return column.name == "plastic_strain" || column.name == "shear_strain"; });
  for (const auto &[name, unit, components] : columns) {
    const std::string data = data_item(file, name, entry.particles, components);
    // a tensor is a matrix, because ParaView's readers interpret the type Tensor6 differently
    const char *type = components == 1 ? "Scalar" : components <= 3 ? "Vector" : "Matrix";
    text += name == "position" ? xdmf_geometry(components, data)
                               : xdmf_attribute(paraview_name(name, unit, components), type, data);
  }
  text += xdmf_attribute(name_of_bodies(header_.bodies), "Scalar", data_item(file, "body", entry.particles, 1, "Int"));
  return text + xdmf_attribute("id", "Scalar", data_item(file, "id", entry.particles, 1, "Int"));
}

std::string RunFile::xdmf_mesh() const {
  return xdmf_file(
      "    <Grid Name=\"mesh\">\n      <Topology TopologyType=\"" +
      std::string(dimension_ == 2 ? "Triangle" : "Tetrahedron") + "\" NumberOfElements=\"" + std::to_string(cells_) +
      "\">" + data_item(mesh_file, "cell_node", cells_, dimension_ + 1, "Int") + "</Topology>\n" +
      xdmf_geometry(dimension_, data_item(mesh_file, "node_position", nodes_, dimension_)) + "    </Grid>\n");
}

}  // namespace talus
