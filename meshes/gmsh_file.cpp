#include "meshes/gmsh_file.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "base/read_file.h"
#include "meshes/plex.h"

namespace talus {
namespace {

constexpr const char *save_again = "; save it again from Gmsh as format 2.2 or 4.1";

const char *kind_of_dimension(int dimension) {
  static const char *const kinds[] = {"points", "curves", "surfaces", "volumes"};
  return 0 <= dimension && dimension <= 3 ? kinds[dimension] : "entities of unknown dimension";
}

/// Element types of Gmsh; corners come first among the nodes of an element.
struct ElementType {
  int number, dimension, corners, nodes;
  const char *name;
  bool is_simplex() const { return corners == dimension + 1; }
  /// Nodes on each edge of a simplex: they follow the corners, edge by edge.
  int nodes_of_edge() const { return (nodes - corners) / (corners * (corners - 1) / 2); }
};
constexpr ElementType element_types[] = {
    {1, 1, 2, 2, "line"},           {2, 2, 3, 3, "triangle"},      {3, 2, 4, 4, "quadrilateral"},
    {4, 3, 4, 4, "tetrahedron"},    {5, 3, 8, 8, "hexahedron"},    {6, 3, 6, 6, "prism"},
    {7, 3, 5, 5, "pyramid"},        {8, 1, 2, 3, "line"},          {9, 2, 3, 6, "triangle"},
    {10, 2, 4, 9, "quadrilateral"}, {11, 3, 4, 10, "tetrahedron"}, {12, 3, 8, 27, "hexahedron"},
    {13, 3, 6, 18, "prism"},        {14, 3, 5, 14, "pyramid"},     {15, 0, 1, 1, "point"},
    {16, 2, 4, 8, "quadrilateral"}, {17, 3, 8, 20, "hexahedron"},  {18, 3, 6, 15, "prism"},
    {19, 3, 5, 13, "pyramid"},      {21, 2, 3, 10, "triangle"},    {26, 1, 2, 4, "line"},
    {29, 3, 4, 20, "tetrahedron"}};
constexpr int most_nodes = 27;  // of an element

/// Edges of a triangle (the first three) and of a tetrahedron in the order of Gmsh: corners.
constexpr int edges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {3, 0}, {3, 2}, {3, 1}};

/// Edges of cells become straight. A node that is further from the straight edge than this part of its length is
/// refused: an arc that rises by a twentieth cuts off (2/3) / 20 of the edge squared, a thirteenth of a regular
/// triangle. The straight mesh would be another one than the file describes; with less it is as good as any straight
/// mesh.
constexpr double largest_rise = 0.05;

/// The bytes of a file, read number by number; whatever is not there as it should be is a complaint with its place.
class Source {
 public:
  explicit Source(const std::string &file) : file_(file) {
    try {
      text_ = read_file(file);
    } catch (const std::system_error &error) {
      complain_at_large("cannot be read (" + error.code().message() + "); check the path and its permissions");
    }
    if (text_.empty()) complain_at_large("is empty" + std::string(save_again));
  }

  bool binary = false;  ///< numbers between `set_form` and the end of a section are not text

  [[noreturn]] void complain_at_large(const std::string &text) const {
    throw std::invalid_argument(file_ + ": " + text);
  }
  [[noreturn]] void complain(const std::string &text) const {
    const auto line = std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(place_), '\n') + 1;
    throw std::invalid_argument(file_ + (binary ? " byte " + std::to_string(place_) : " line " + std::to_string(line)) +
                                ": " + text);
  }

  /// The rest of the line, without its end.
  std::string_view rest_of_line() {
    const std::size_t end = std::min(text_.find('\n', place_), text_.size());
    std::string_view line(text_.data() + place_, end - place_);
    place_ = std::min(end + 1, text_.size());
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) line.remove_suffix(1);
    return line;
  }
  /// Goes to the next line that starts with $ and reads it; empty at the end of the file.
  std::string next_section() {
    while (place_ < text_.size())
      if (const std::string_view line = rest_of_line(); line.starts_with('$')) return std::string(line);
    return "";
  }
  /// Behind the line that ends a section.
  void skip(const std::string &section) {
    const std::size_t end = text_.find("\n$End" + section.substr(1), place_ ? place_ - 1 : 0);
    if (end == std::string::npos) complain("ends early (no $End" + section.substr(1) + ")" + save_again);
    place_ = end + 1;
    rest_of_line();
  }
  void expect_end(const std::string &section) {
    skip_spaces();
    if (text_.compare(place_, section.size() + 3, "$End" + section.substr(1)) != 0)
      complain((place_ == text_.size() ? "ends early: " : "") + std::string("$End") + section.substr(1) +
               " is missing here" + save_again);
    rest_of_line();
  }

  /// The numbers of binary sections have this size and order of bytes.
  void set_form(int size_bytes) {
    size_bytes_ = size_bytes;
    std::int32_t one;
    if (!binary) return;
    copy(&one, sizeof one);
    swap_ = one != 1;
    if (swap_ && swapped(one) != 1) complain("its binary form is damaged" + std::string(save_again));
  }
  int integer() {
    if (!binary) return static_cast<int>(in_range(parsed<long long>(), INT32_MIN, INT32_MAX));
    return raw<std::int32_t>();
  }
  /// A tag without its sign.
  int unsigned_tag() { return static_cast<int>(in_range(std::abs(static_cast<long long>(integer())), 0, INT32_MAX)); }
  /// An integer of format 4.1 that counts or numbers.
  long long size() {
    if (!binary) return in_range(parsed<long long>(), 0, INT64_MAX);
    return in_range(size_bytes_ == 8 ? raw<std::int64_t>() : raw<std::int32_t>(), 0, INT64_MAX);
  }
  double any_real() { return binary ? raw<double>() : parsed<double>(); }  ///< also an infinite one
  double real() {
    const double x = any_real();
    if (!std::isfinite(x)) complain("a coordinate is not finite" + std::string(save_again));
    return x;
  }
  /// A count of things of which each takes at least `bytes`; a file that is too short for them is damaged.
  std::size_t count(long long stated, std::size_t bytes) const {
    if (stated < 0 || static_cast<unsigned long long>(stated) > (text_.size() - place_) / bytes)
      complain("ends early: " + std::to_string(stated) +
               " entries are announced, more than the rest of the file holds" + save_again);
    return static_cast<std::size_t>(stated);
  }
  std::size_t in_text(std::size_t bytes) const { return binary ? bytes : 2; }

 private:
  void skip_spaces() {
    while (place_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[place_]))) ++place_;
  }
  long long in_range(long long value, long long low, long long high) const {
    if (value < low || value > high)
      complain("the number " + std::to_string(value) + " is out of its range" + save_again);
    return value;
  }
  template <class T>
  T parsed() {
    skip_spaces();
    T value{};
    const char *begin = text_.data() + place_, *end = text_.data() + text_.size();
    const auto [at, error] = std::from_chars(begin + (begin < end && *begin == '+'), end, value);
    if (error != std::errc() || (at < end && !std::isspace(static_cast<unsigned char>(*at)))) {
      const char *stop =
          std::find_if(begin, std::min(end, begin + 30), [](unsigned char c) { return std::isspace(c); });
      complain(begin == end ? "ends early: a number is missing" + std::string(save_again)
                            : "'" + std::string(begin, stop) + "' stands where a number belongs" + save_again);
    }
    place_ = static_cast<std::size_t>(at - text_.data());
    return value;
  }
  void copy(void *to, std::size_t bytes) {
    if (text_.size() - place_ < bytes) complain("ends early: a number is missing" + std::string(save_again));
    std::memcpy(to, text_.data() + place_, bytes);
    place_ += bytes;
  }
  template <class T>
  static T swapped(T value) {
    auto bytes = std::bit_cast<std::array<unsigned char, sizeof(T)>>(value);
    std::reverse(bytes.begin(), bytes.end());
    return std::bit_cast<T>(bytes);
  }
  template <class T>
  T raw() {
    T value;
    copy(&value, sizeof value);
    return swap_ ? swapped(value) : value;
  }

  std::string file_, text_;
  std::size_t place_ = 0;
  int size_bytes_ = 8;
  bool swap_ = false;
};

struct PhysicalName {
  int dimension, tag;
  std::string name;
};

/// Simplices of one dimension as they stand in the file.
struct Elements {
  std::vector<long long> number;
  std::vector<std::array<long long, 4>> node;  ///< numbers of the file
  std::vector<int> groups;                     ///< which list of physical groups
};

/// A node on an edge of a cell of higher order, and the ends of the edge: numbers of the file.
struct EdgeNode {
  long long cell, node, ends[2];
};

class Reader {
 public:
  Reader(const std::string &file, int dimension) : in_(file), dimension_(dimension) {}

  GmshMesh read() {
    read_format();
    for (std::string section; !(section = in_.next_section()).empty();) {
      if (section.starts_with("$End")) continue;
      read_section(section);
    }
    if (!has_names_ || names_.empty())
      in_.complain_at_large(
          "has no named groups ($PhysicalNames); add physical groups with names in Gmsh (talus-mesh writes them)");
    check_names();
    if (!has_nodes_ || !has_elements_)
      in_.complain_at_large("ends early (no $EndNodes or no $EndElements)" + std::string(save_again));
    check_dimension();
    connect();
    name_groups();
    return std::move(mesh_);
  }

 private:
  void read_format() {
    std::string section;
    while (!(section = in_.next_section()).empty() && section != "$MeshFormat") {
    }
    if (section.empty())
      in_.complain_at_large("is not a Gmsh mesh (no $MeshFormat); give a .msh file, format 2.2 or 4.1");
    std::istringstream line{std::string(in_.rest_of_line())};
    std::string version;
    int type = -1, bytes = 0;
    line >> version >> type >> bytes;
    if (version != "2.2" && version != "4.1")
      in_.complain_at_large("is of Gmsh format " + version + "; save it as format 2.2 or 4.1");
    if ((type != 0 && type != 1) || (bytes != 8 && !(version == "4.1" && bytes == 4)))
      in_.complain("the line behind $MeshFormat is damaged" + std::string(save_again));
    new_format_ = version == "4.1";
    is_binary_ = in_.binary = type == 1;
    in_.set_form(bytes);
    in_.expect_end("$MeshFormat");
  }

  void read_section(const std::string &section) {
    in_.binary = false;
    if (section == "$PhysicalNames") {
      read_names();
      return in_.expect_end(section);
    }
    in_.binary = is_binary_;
    if (section == "$Entities" && new_format_)
      read_entities();
    else if (section == "$Nodes")
      new_format_ ? read_nodes() : read_old_nodes(), has_nodes_ = true;
    else if (section == "$Elements")
      new_format_ ? read_elements() : read_old_elements(), has_elements_ = true;
    else
      return in_.skip(section);
    in_.expect_end(section);
  }

  void read_names() {
    has_names_ = true;
    const long long count = in_.integer();
    in_.rest_of_line();
    for (long long i = 0; i < count; ++i) {
      const std::string line(in_.rest_of_line());
      PhysicalName one;
      const auto open = line.find('"'), close = line.rfind('"');
      if (!(std::istringstream(line) >> one.dimension >> one.tag) || open == close)
        in_.complain("the section $PhysicalNames is damaged" + std::string(save_again));
      one.name = line.substr(open + 1, close - open - 1);
      names_.push_back(one);
    }
  }

  void read_entities() {
    std::array<std::size_t, 4> counts;
    for (auto &count : counts) count = in_.count(in_.size(), in_.in_text(20));
    for (int dimension = 0; dimension < 4; ++dimension)
      for (std::size_t i = 0; i < counts[dimension]; ++i) {
        const int tag = in_.integer();
        for (int k = 0; k < (dimension ? 6 : 3); ++k) (void)in_.any_real();
        std::vector<int> groups(in_.count(in_.size(), in_.in_text(4)));
        for (int &group : groups) group = in_.unsigned_tag();  // the sign is an orientation
        entities_[{dimension, tag}] = list_of(groups);
        if (dimension == 0) continue;
        for (std::size_t parts = in_.count(in_.size(), in_.in_text(4)); parts > 0; --parts) (void)in_.integer();
      }
  }

  void read_old_nodes() {
    const std::size_t count = in_.count(in_.binary ? line_number() : in_.integer(), in_.in_text(28));
    for (std::size_t i = 0; i < count; ++i) {
      node_number_.emplace_back(in_.integer(), static_cast<int>(node_number_.size()));
      for (int d = 0; d < 3; ++d) place_.push_back(in_.real());
    }
  }

  void read_nodes() {
    const std::size_t blocks = in_.count(in_.size(), in_.in_text(20));
    for (int k = 0; k < 3; ++k) (void)in_.size();
    for (std::size_t block = 0; block < blocks; ++block) {
      const int dimension = in_.integer();
      (void)in_.integer();
      const bool parametric = in_.integer() != 0;
      const std::size_t count = in_.count(in_.size(), in_.in_text(32));
      for (std::size_t i = 0; i < count; ++i)
        node_number_.emplace_back(in_.size(), static_cast<int>(node_number_.size()));
      for (std::size_t i = 0; i < count; ++i) {
        for (int d = 0; d < 3; ++d) place_.push_back(in_.real());
        for (int d = 0; parametric && d < std::min(dimension, 3); ++d) (void)in_.any_real();
      }
    }
  }

  void read_old_elements() {
    const std::size_t count = in_.count(in_.binary ? line_number() : in_.integer(), in_.in_text(8));
    for (std::size_t i = 0; i < count;) {
      const long long number = in_.binary ? 0 : in_.integer();
      const ElementType &type = type_of(in_.integer());
      const std::size_t following = in_.binary ? in_.count(in_.integer(), 4) : 1;
      if (following == 0) in_.complain("a block of elements is empty" + std::string(save_again));
      const std::size_t tags = in_.count(in_.integer(), in_.in_text(4));
      for (std::size_t k = 0; k < following; ++k, ++i) {
        const long long own = in_.binary ? in_.integer() : number;
        std::vector<int> groups;  // the first tag; the others number its entity and partitions
        for (std::size_t t = 0; t < tags; ++t)
          if (const int tag = in_.integer(); t == 0) groups.push_back(tag);
        add(type, own, list_of(groups), [&] { return in_.integer(); });
      }
    }
  }

  void read_elements() {
    const std::size_t blocks = in_.count(in_.size(), in_.in_text(20));
    for (int k = 0; k < 3; ++k) (void)in_.size();
    for (std::size_t block = 0; block < blocks; ++block) {
      const int dimension = in_.integer(), entity = in_.integer();
      const ElementType &type = type_of(in_.integer());
      const auto groups = entities_.find({dimension, entity});
      if (groups == entities_.end())
        in_.complain("elements of the entity " + std::to_string(entity) + " of dimension " + std::to_string(dimension) +
                     ", which $Entities does not list; save it from Gmsh without partitions, as format 2.2 or 4.1");
      for (std::size_t count = in_.count(in_.size(), in_.in_text(16)); count > 0; --count) {
        const long long number = in_.size();
        add(type, number, groups->second, [&] { return in_.size(); });
      }
    }
  }

  /// A number that stands in a line of its own also in binary files.
  long long line_number() {
    long long value = -1;
    std::istringstream(std::string(in_.rest_of_line())) >> value;
    return value;
  }

  const ElementType &type_of(int number) const {
    for (const ElementType &type : element_types)
      if (type.number == number) return type;
    in_.complain("element type " + std::to_string(number) + " is none that Talus knows" + save_again);
  }

  template <class NextNode>
  void add(const ElementType &type, long long number, int groups, const NextNode &next_node) {
    highest_ = std::max(highest_, type.dimension);
    if (type.dimension == dimension_ && !type.is_simplex())
      in_.complain("element " + std::to_string(number) + " is a " + type.name + ", but Talus takes " +
                   (dimension_ == 2 ? "triangles" : "tetrahedra") + " only; mesh without recombination");
    std::array<long long, most_nodes> all;
    for (int k = 0; k < type.nodes; ++k) all[k] = next_node();
    if (type.dimension != dimension_ && type.dimension != dimension_ - 1) return;
    if (!type.is_simplex()) return;
    std::array<long long, 4> node{};
    std::copy_n(all.begin(), type.corners, node.begin());
    if (type.dimension == dimension_ && type.nodes > type.corners) {
      ++curvable_;
      for (int k = 0; k < type.corners * (type.corners - 1) / 2 * type.nodes_of_edge(); ++k) {
        const auto &[a, b] = edges[k / type.nodes_of_edge()];
        edge_nodes_.push_back({number, all[type.corners + k], {node[a], node[b]}});
      }
    }
    Elements &to = type.dimension == dimension_ ? cells_ : facets_;
    to.number.push_back(number), to.node.push_back(node), to.groups.push_back(groups);
  }

  /// Number of a list of physical groups; equal lists have one number.
  int list_of(const std::vector<int> &groups) {
    const auto [at, is_new] = list_number_.try_emplace(groups, static_cast<int>(lists_.size()));
    if (is_new) lists_.push_back(groups);
    return at->second;
  }

  void check_names() const {
    int highest = 0;
    for (const PhysicalName &one : names_) {
      highest = std::max(highest, one.dimension);
      if (is_reserved_label(one.name))
        in_.complain_at_large("the group name '" + one.name + "' is taken by DMPlex; rename the physical group");
      if (one.name.empty()) in_.complain_at_large("a physical group has an empty name; name it in Gmsh");
    }
    if (highest == dimension_) return;
    const std::string text = std::string("its named groups are ") + kind_of_dimension(highest) +
                             " at most, but a mesh of dimension " + std::to_string(dimension_) +
                             " needs named groups of " + kind_of_dimension(dimension_) + "; ";
    if (highest > dimension_) in_.complain_at_large(text + "mesh it in 2D, or set dimension = 3 in the scene");
    in_.complain_at_large(text +
                          "add the physical groups in Gmsh (talus-mesh writes them), or change the scene's dimension");
  }

  void check_dimension() const {
    if (highest_ == dimension_) return;
    const std::string needed = std::to_string(dimension_);
    in_.complain_at_large("its cells are " + std::string(kind_of_dimension(highest_)) + ", but a mesh of dimension " +
                          needed + " needs " + kind_of_dimension(dimension_) + "; mesh it in " + needed +
                          "D, or change the scene's dimension");
  }

  /// The place of a node among those of the file, or -1.
  int find(long long number) const {
    const std::size_t offset = static_cast<std::size_t>(number - node_number_.front().first);
    if (offset < node_number_.size() && node_number_[offset].first == number) return node_number_[offset].second;
    const auto at = std::lower_bound(node_number_.begin(), node_number_.end(), std::pair(number, 0));
    return at != node_number_.end() && at->first == number ? at->second : -1;
  }

  /// Turns the node numbers of the file into places in the list of nodes of cells.
  void connect() {
    if (node_number_.empty()) in_.complain_at_large("has no nodes" + std::string(save_again));
    std::sort(node_number_.begin(), node_number_.end());
    for (std::size_t i = 1; i < node_number_.size(); ++i)
      if (node_number_[i].first == node_number_[i - 1].first)
        in_.complain_at_large("node " + std::to_string(node_number_[i].first) + " is there twice" + save_again);
    mesh_.dimension = dimension_;
    const auto places = [&](const Elements &elements, int nodes, std::vector<int> &into) {
      into.reserve(elements.node.size() * nodes);
      for (std::size_t e = 0; e < elements.node.size(); ++e) {
        const auto begin = elements.node[e].begin();
        for (int k = 0; k < nodes; ++k) {
          const long long node = begin[k];
          into.push_back(find(node));
          const bool again = std::find(begin, begin + k, node) != begin + k;
          if (into.back() < 0 || again)
            in_.complain_at_large("element " + std::to_string(elements.number[e]) + " names the node " +
                                  std::to_string(node) + (again ? " twice" : ", which is not in the file") +
                                  save_again);
        }
      }
    };
    places(cells_, dimension_ + 1, mesh_.cells);
    places(facets_, dimension_, mesh_.facets);
    mesh_.facet_number = facets_.number;
    check_edges();
    keep_nodes_of_cells();
  }

  /// Cells of higher order are taken by their corners, which loses nothing where their edges are straight.
  void check_edges() {
    if (curvable_ == 0) return;
    double largest = 0;
    for (const EdgeNode &one : edge_nodes_) {
      const int at = find(one.node);
      if (at < 0)
        in_.complain_at_large("element " + std::to_string(one.cell) + " names the node " + std::to_string(one.node) +
                              ", which is not in the file" + save_again);
      double along = 0, length = 0, square = 0;
      for (int d = 0; d < 3; ++d) {
        const double start = place_[3 * find(one.ends[0]) + d], edge = place_[3 * find(one.ends[1]) + d] - start,
                     x = place_[3 * at + d] - start;
        along += x * edge, length += edge * edge, square += x * x;
      }
      const double rise = std::sqrt(std::max(0., square - along * along / length) / length);
      largest = std::max(largest, rise);
      if (rise > largest_rise) complain_about_edge(one, place_.data() + 3 * at, rise);
    }
    std::ostringstream text;
    text.precision(2);
    text << curvable_ << (curvable_ == 1 ? " cell is" : " cells are")
         << " of second or higher order and taken by the corners, since cells of Talus have straight sides; ";
    if (largest > 1e-6)
      text << "nodes lie up to " << largest << " of the edge beside it, which is lost.";
    else
      text << "all edges are straight, so nothing is lost.";
    mesh_.remark = text.str();
  }

  [[noreturn]] void complain_about_edge(const EdgeNode &one, const double *x, double rise) const {
    std::ostringstream text;
    text.precision(4);
    text << "element " << one.cell << " has a curved edge: node " << one.node << " at (" << x[0] << ", " << x[1];
    if (dimension_ == 3) text << ", " << x[2];
    text << ") m lies " << rise << " of the edge beside it, and cells of Talus have straight sides; mesh it in first "
         << "order (Mesh.ElementOrder = 1), with smaller cells where the side is curved (up to " << largest_rise
         << " of the edge is taken as straight)";
    in_.complain_at_large(text.str());
  }

  void keep_nodes_of_cells() {
    std::vector<int> number(node_number_.size(), -1);
    for (int node : mesh_.cells) number[node] = 0;
    std::array<double, 3> low{1e308, 1e308, 1e308}, high{-1e308, -1e308, -1e308};
    std::array<std::size_t, 2> extreme{};  // nodes of lowest and highest z
    int count = 0;
    for (std::size_t i = 0; i < number.size(); ++i) {
      if (number[i] < 0) continue;
      number[i] = count++;
      const double *x = &place_[3 * i];
      if (x[2] < low[2]) extreme[0] = i;
      if (x[2] > high[2]) extreme[1] = i;
      for (int d = 0; d < 3; ++d) low[d] = std::min(low[d], x[d]), high[d] = std::max(high[d], x[d]);
      mesh_.position.insert(mesh_.position.end(), x, x + dimension_);
    }
    if (dimension_ == 2 && high[2] - low[2] > 1e-6 * std::max(high[0] - low[0], high[1] - low[1]))
      complain_about_z(extreme);
    for (std::vector<int> *of : {&mesh_.cells, &mesh_.facets})
      for (int &node : *of) node = number[node];
  }

  [[noreturn]] void complain_about_z(const std::array<std::size_t, 2> &extreme) const {
    std::ostringstream text;
    text << "is not plane: ";
    for (int k = 0; k < 2; ++k) {
      const double *x = &place_[3 * extreme[k]];
      text << (k ? " and " : "") << "z = " << x[2] << " m at (" << x[0] << ", " << x[1] << ")";
    }
    text << "; a mesh of dimension 2 lies in the plane z = 0 with y upward";
    in_.complain_at_large(text.str());
  }

  void name_groups() {
    for (const PhysicalName &name : names_) {
      if (name.dimension != dimension_ && name.dimension != dimension_ - 1) continue;
      const bool of_cells = name.dimension == dimension_;
      const Elements &elements = of_cells ? cells_ : facets_;
      std::vector<int> members;
      for (std::size_t e = 0; e < elements.groups.size(); ++e) {
        const std::vector<int> &groups = lists_[elements.groups[e]];
        if (std::find(groups.begin(), groups.end(), name.tag) != groups.end()) members.push_back(static_cast<int>(e));
      }
      (of_cells ? mesh_.regions : mesh_.groups).emplace_back(name.name, std::move(members));
    }
  }

  Source in_;
  const int dimension_;
  bool new_format_ = false, is_binary_ = false, has_names_ = false, has_nodes_ = false, has_elements_ = false;
  int highest_ = 0;  // dimension of elements
  std::vector<PhysicalName> names_;
  std::map<std::pair<int, int>, int> entities_;  // dimension and tag: list of groups
  std::map<std::vector<int>, int> list_number_;
  std::vector<std::vector<int>> lists_;
  std::vector<std::pair<long long, int>> node_number_;  // number in the file, place in `place_`; ascending in the end
  std::vector<double> place_;                           // 3 coordinates of each node [m]
  Elements cells_, facets_;
  std::vector<EdgeNode> edge_nodes_;
  long long curvable_ = 0;  // cells of higher order
  GmshMesh mesh_;
};

}  // namespace

GmshMesh read_gmsh(const std::string &file, int dimension) { return Reader(file, dimension).read(); }

}  // namespace talus
