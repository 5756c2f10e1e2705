#include "output/snapshots.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <numeric>
#include <sstream>
#include <stdexcept>

#include "base/freed_memory.h"
#include "output/hdf5_file.h"
#include "output/replace_file.h"
#include "output/shared_tables.h"
#include "output/together.h"
#include "output/writers.h"
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

std::vector<long long> widened(const std::vector<int> &values) { return {values.begin(), values.end()}; }

unsigned long long sum(const std::vector<long long> &counts) {
  return std::accumulate(counts.begin(), counts.end(), 0ull);
}

/// Numbers of rows that the ranks have one after the other.
std::vector<long long> numbered_over_ranks(MPI_Comm comm, std::size_t rows) {
  long long count = static_cast<long long>(rows), before = 0;
  check_mpi(MPI_Exscan(&count, &before, 1, MPI_LONG_LONG, MPI_SUM, comm), "numbering rows");
  if (rank_in(comm) == 0) before = 0;
  std::vector<long long> number(rows);
  std::iota(number.begin(), number.end(), before);
  return number;
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
  for (const std::string &number : numbers_of_snapshots(folder)) remove_tables(folder + "/" + number + ".h5");
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
  rename_tables(folder + "/" + number + ".h5", folder + "/" + name);
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

RunFile::RunFile(MPI_Comm comm, const std::string &dir, const RunHeader &header, MeshPicture local_mesh, long long rows)
    : RunFile(comm, dir, rows) {
  begin(header, std::move(local_mesh), [&] {
    write_index();  // before the old snapshots are removed, so that no link ever leads nowhere
    remove_snapshots(dir_ + "/run");
  });
}

RunFile RunFile::append(MPI_Comm comm, const std::string &dir, const RunHeader &header, MeshPicture local_mesh,
                        long long count, long long rows) {
  RunFile run(comm, dir, rows);
  run.count_ = count;
  run.begin(header, std::move(local_mesh), [&] {
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
    for (const auto &number : later) remove_tables(run.path_of(run.snapshot_file(number)));
    for (const auto &[number, cause] : unreadable)
      run.damaged_.push_back("a damaged snapshot, which the run now writes again, is kept as run/" +
                             set_aside(dir + "/run", number) + ": " + cause);
  });
  run.share_last_step();
  return run;
}

/// Nodes that ranks share appear once per rank, which does no harm in a picture.
void RunFile::write_mesh(MeshPicture local_mesh) {
  const int dim = local_mesh.dimension;
  std::vector<Table> tables;
  int writer;
  {  // what is not written itself is gone before the writing, which takes the most memory
    const std::size_t nodes = local_mesh.position.size() / dim, cells = local_mesh.cell_node.size() / (dim + 1);
    const int count = Writers::needed(comm_, {nodes, cells}, most_rows_);
    const std::vector<long long> node = numbered_over_ranks(comm_, nodes);
    for (auto &corner : local_mesh.cell_node) corner = node[corner];
    const Writers of_nodes(comm_, node, count), of_cells(comm_, numbered_over_ranks(comm_, cells), count);
    writer = of_cells.mine();
    tables.push_back({"node_position", dim, of_nodes.collect(std::move(local_mesh.position), dim), of_nodes.rows()});
    tables.push_back(
        {"cell_node", dim + 1, of_cells.collect(std::move(local_mesh.cell_node), dim + 1), of_cells.rows()});
  }
  hand_back_freed_memory();
  on_first_rank(comm_, [&] { make_folder(dir_ + "/run"); });
  dimension_ = dim, nodes_ = sum(tables[0].rows), cells_ = sum(tables[1].rows);
  write_tables(comm_, path_of(mesh_file), writer, std::move(tables), [&](Hdf5Builder &file) {
    file.attribute("/", "dimension", static_cast<long long>(dim));
    file.attribute("node_position", "unit", std::string("m"));
  });
}

/// Writes the mesh, then does what `rest` says on the first rank.
void RunFile::begin(const RunHeader &header, MeshPicture local_mesh, const std::function<void()> &rest) {
  write_mesh(std::move(local_mesh));
  hand_back_freed_memory();
  on_first_rank(comm_, [&] {
    header_ = header;
    replace_file(path_of("mesh.xdmf"), xdmf_mesh());
    replace_file(path_of("run.py"), paraview_state);
    rest();
  });
}

void RunFile::write(Snapshot local) {
  together(comm_, [&] { check_lengths(local); });
  const std::string number = numbered(count_);
  const Writers writers(comm_, local.id, Writers::needed(comm_, {local.id.size()}, most_rows_));
  Entry entry{number, local.time, local.step, sum(writers.rows()), {}};
  std::vector<Table> tables = {{"id", 1, writers.collect(std::move(local.id)), writers.rows()},
                               {"body", 1, writers.collect(widened(local.body)), writers.rows()}};
  for (auto &column : local.columns) {  // in place of another copy of all numbers
    tables.push_back(
        {column.name, column.components, writers.collect(std::move(column.values), column.components), writers.rows()});
    entry.columns.push_back({column.name, column.unit, column.components});
  }
  write_tables(comm_, path_of(snapshot_file(number)), writers.mine(), std::move(tables), [&](Hdf5Builder &file) {
    file.attribute("/", "time", local.time);
    file.attribute("/", "step", local.step);
    file.attribute("/", "stage", local.stage);
    for (const auto &[name, value] : local.numbers) file.attribute("/", name.c_str(), value);
    for (const auto &column : local.columns) {
      file.attribute(column.name, "unit", column.unit);
      file.attribute(column.name, "meaning", column.meaning);
      file.attribute(column.name, "components", join(component_names(column.components)));
    }
  });
  on_first_rank(comm_, [&] {
    entries_.push_back(entry);
    try {
      write_index();
    } catch (...) {
      entries_.pop_back();
      throw;
    }
  });
  last_step_ = local.step, ++count_;
}

RunFile::Entry RunFile::read_entry(const std::string &number) const {
  check_parts(path_of(snapshot_file(number)), "id");
  const Hdf5Reader file(path_of(snapshot_file(number)));
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
  std::stable_partition(columns.begin(), columns.end(), [](const Shape &column) {
    return column.name == "plastic_strain" || column.name == "shear_strain";
  });
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
