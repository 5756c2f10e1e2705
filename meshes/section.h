#pragma once
/// A surveyed cross-section, as read from a CSV file of rows `part,x,y`, in which `#` starts a comment, or from a
/// drawing (drawing.h). A header `part,x [ft],y [ft]` states the unit of all its numbers, which are in metres without
/// one. Parts:
///
///   outline           polygon, in order
///   interface0, 1...  polylines from top to bottom; layer0 lies above interface0, layer1 below it, and so on. Beyond
///   its ends
///                     an interface goes on horizontally; it may have vertical steps and may stick out of the outline
///   b_NAME            polyline along the boundary or inside; its facets form the group NAME
///   region_NAME       seed: the piece that holds it is named NAME instead of layerN
///   refine_SIZE       two opposite corners of a box with cells of SIZE
///   free_space,HEIGHT,EXTRA   for an outline of soil only: adds free space, region `air`, to HEIGHT above the highest
///   point, and
///                     EXTRA beyond the right end (beyond the left end where negative)
#include <optional>
#include <string>
#include <vector>

#include "base/vec.h"
#include "meshes/length_unit.h"

namespace talus {

/// Points nearer than this share of a section are one: a side as short would make cells as small.
inline constexpr double same_point = 1e-6;

/// A point of a part, in the order of the file.
struct SectionRow {
  std::string part;
  Vec<2> numbers;  ///< coordinates; of free_space its height and extra width
  int line;        ///< of the file; of a drawing where the entity begins
};
/// What a file says, in its own unit.
struct SectionRows {
  std::vector<SectionRow> rows;
  LengthUnit unit = metres;
  std::string stated;  ///< where the unit stands in the file, such as "line 2"; empty: nowhere
};
struct Polyline {
  std::string part;            ///< its name in the file
  std::vector<Vec<2>> points;  ///< [m]
  std::vector<int> lines;      ///< of the file, of each point; of a drawing where its entity begins
};
struct Seed {
  std::string name;
  Vec<2> point;  ///< [m]
  int line;
};
struct RefinedBox {
  Vec<2> from, to;  ///< lowest and highest corner [m]
  double size;      ///< of cells inside [m]
};

struct Section {
  std::string file;
  bool drawn = false;        ///< read from a drawing
  LengthUnit unit = metres;  ///< of the file
  std::string unit_stated;   ///< where in the file; empty: nowhere
  Polyline outline;
  std::vector<Polyline> interfaces;  ///< top to bottom
  std::vector<Polyline> boundaries;  ///< `part` without b_
  std::vector<Seed> seeds;
  std::vector<RefinedBox> boxes;
  bool has_free_space = false;
  double free_height = 0, free_extra = 0;  ///< [m]

  double largest_extent() const;  ///< of the outline, width or height [m]
  std::vector<Vec<2>> domain()
      const;            ///< polygon that is meshed: the outline, with free space above it where asked for
  double area() const;  ///< of the domain [m2]
  std::string layer_at(const Vec<2> &x) const;  ///< layerN or air; seeds are not looked at
  /// Sentences on what a section may have but hardly means: another unit than metres, a drawing without a unit, a steep
  /// face that the free space beside an end leaves free though no b_NAME names it, and interfaces that are listed from
  /// bottom to top.
  std::vector<std::string> doubts() const;
};

/// Reads and checks a section. Throws std::invalid_argument with file and line for rows that are malformed or unknown,
/// units that are no length, fewer than three points, repeated points, an outline that crosses itself, and parts that
/// lie outside.
Section read_section(const std::string &file);
/// The same from rows that have been read from a file. `drawn`: from a drawing.
Section section_of(const SectionRows &rows, const std::string &file, bool drawn);

/// Two interfaces that go through one another, so that counting those above a point says nothing about its layer.
struct Crossing {
  const Polyline *first, *second;
  Vec<2> place;                 ///< [m]
  int first_line, second_line;  ///< of the file, where the pieces that cross begin
};
/// Interfaces that only touch, or share a stretch, do not cross.
std::optional<Crossing> crossing_interfaces(const Section &section);

/// A point is within `tolerance` [m] of a polyline.
bool is_on(const Polyline &line, const Vec<2> &x, double tolerance);

}  // namespace talus
