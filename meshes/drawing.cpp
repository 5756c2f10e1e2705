#include "meshes/drawing.h"

#include <cpl_vsi.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <stdexcept>

#include "meshes/drawing_text.h"
#include "meshes/grid.h"

namespace talus {
namespace {

bool names_region(const std::string &layer) { return layer.starts_with("region_"); }
bool is_part(const std::string &layer) {
  return names_region(layer) || layer == "outline" || layer.starts_with("interface") || layer.starts_with("b_") ||
         layer.starts_with("refine_");
}

/// A text as a file that GDAL opens.
class FileInMemory {
 public:
  explicit FileInMemory(std::string &text) {
    VSIFCloseL(VSIFileFromMemBuffer(path, reinterpret_cast<GByte *>(text.data()), text.size(), FALSE));
  }
  FileInMemory(const FileInMemory &) = delete;
  ~FileInMemory() { VSIUnlink(path); }
  static constexpr const char *path = "/vsimem/drawing.dxf";
};

struct Piece {  // of a line that may consist of several
  std::vector<Vec<2>> points;
  int line;  ///< of the file, where its entity begins
};

std::string text_of(const Vec<2> &x) {
  std::ostringstream text;
  text << "(" << x[0] << ", " << x[1] << ")";
  return text.str();
}

double distance(const Vec<2> &a, const Vec<2> &b) { return std::hypot(a[0] - b[0], a[1] - b[1]); }

/// The same points, in one direction or the other.
bool same(const std::vector<Vec<2>> &a, const std::vector<Vec<2>> &b, double tolerance) {
  const auto near = [&](const Vec<2> &x, const Vec<2> &y) { return distance(x, y) <= tolerance; };
  return a.size() == b.size() &&
         (std::equal(a.begin(), a.end(), b.begin(), near) || std::equal(a.begin(), a.end(), b.rbegin(), near));
}

class Reader {
 public:
  explicit Reader(const std::string &file) : file_(file) {}

  Drawing read() {
    DrawingText text = read_drawing_text(file_, is_part);
    take_unit(text.unit);
    const std::set<int> drawn = take_entities(text);
    for (const auto &[line, entity] : text.entities) {
      if (!is_part(entity.layer) && entity.kind != "INSERT")  // what a block has may lie on other layers
        left_out_.insert(entity.layer);
      else if (is_part(entity.layer) && !drawn.count(line))
        complain(line, "the " + entity.kind + " on layer '" + entity.layer + "' cannot be read" +
                           (gdal_.empty() ? "" : " (GDAL: " + gdal_ + ")") + "; explode it into lines and polylines");
    }
    for (const auto &[part, pieces] : pieces_) extend(pieces);
    for (const auto &[part, pieces] : pieces_)
      part.rfind("refine_", 0) == 0 ? add_boxes(part, pieces) : add_line(part, pieces);
    if (!left_out_.empty()) {
      std::string names;
      for (const std::string &name : left_out_) names += (names.empty() ? "" : ", ") + name;
      drawing_.doubts.push_back(file_ + ": layers that are no parts of a section are left out: " + names);
    }
    return drawing_;
  }

 private:
  [[noreturn]] void complain(const std::string &text) const { throw std::invalid_argument(file_ + ": " + text); }
  [[noreturn]] void complain(int line, const std::string &text) const {
    throw std::invalid_argument(file_ + " line " + std::to_string(line) + ": " + text);
  }

  void take_unit(int number) {
    if (number == 0) return;
    const auto *unit =
        std::ranges::find_if(length_units, [=](const LengthUnit &one) { return one.in_drawings == number; });
    if (unit == std::end(length_units))
      complain("is drawn in unit " + std::to_string(number) +
               " of $INSUNITS, which is none that sections are drawn in; set it to metres (6), millimetres (4) or feet "
               "(2)");
    drawing_.rows.unit = *unit, drawing_.rows.stated = "$INSUNITS";
  }

  /// What GDAL makes of the entities; returns the lines of those that are parts of the section.
  std::set<int> take_entities(DrawingText &text) {
    GDALAllRegister();
    const QuietGdal quiet;
    const FileInMemory file(text.marked);
    CPLSetConfigOption("DXF_MERGE_BLOCK_GEOMETRIES", "FALSE");  // a block may have parts on several layers
    const std::unique_ptr<GDALDataset> data(GDALDataset::Open(file.path, GDAL_OF_VECTOR | GDAL_OF_READONLY));
    if (!data || data->GetLayerCount() == 0)
      complain(std::string("cannot be read (GDAL: ") + CPLGetLastErrorMsg() + ")");
    std::set<int> lines;
    CPLErrorReset();
    for (const auto &feature : *data->GetLayer(0)) {
      const std::string part = layer_name(feature->GetFieldAsString("Layer"));
      const int line = static_cast<int>(std::strtol(feature->GetFieldAsString("EntityHandle"), nullptr, 16));
      const OGRGeometry *shape = feature->GetGeometryRef();
      if (shape && !shape->IsEmpty()) lines.insert(line);
      if (!is_part(part) || !shape || shape->IsEmpty())
        left_out_.insert(part);
      else
        add(part, *shape, names_region(part), line);
    }
    gdal_ = CPLGetLastErrorMsg();
    return lines;
  }

  void add(const std::string &part, const OGRGeometry &shape, bool region, int line) {
    const OGRwkbGeometryType kind = wkbFlatten(shape.getGeometryType());
    if (kind == wkbPoint && region) {
      const OGRPoint &point = *shape.toPoint();
      drawing_.rows.rows.push_back({part, place(point.getX(), point.getY(), point.getZ(), part, line), line});
    } else if (kind == wkbLineString && !region) {
      const OGRLineString &points = *shape.toLineString();
      Piece piece{{}, line};
      for (int i = 0; i < points.getNumPoints(); ++i) {
        const Vec<2> x = place(points.getX(i), points.getY(i), points.getZ(i), part, line);
        if (piece.points.empty() || distance(piece.points.back(), x) > 0) piece.points.push_back(x);
      }
      if (piece.points.size() < 2)
        complain(line,
                 "layer '" + part + "' has a line without length at " + text_of(piece.points.at(0)) + "; delete it");
      pieces_[part].push_back(piece);
    } else if (kind == wkbPolygon && !region) {
      add(part, *shape.toPolygon()->getExteriorRing(), region, line);
    } else if (OGR_GT_IsSubClassOf(kind, wkbGeometryCollection) && !region) {
      for (const OGRGeometry *one : *shape.toGeometryCollection()) add(part, *one, region, line);
    } else {
      complain(line, "layer '" + part + "' has " + OGRGeometryTypeToName(shape.getGeometryType()) + "; " +
                         (region ? "a region is named by a point or a text inside it"
                                 : "it takes lines and polylines, so move this to another layer"));
    }
  }

  Vec<2> place(double x, double y, double z, const std::string &part, int line) const {
    if (!std::isfinite(x) || !std::isfinite(y)) complain(line, "layer '" + part + "' has a point that is no number");
    if (z != 0 && std::isfinite(z))
      complain(line, "layer '" + part + "' has a point with z = " + std::to_string(z) +
                         "; draw the section in the plane of x (along it) and y (up), at z = 0");
    return {x, y};
  }

  void extend(const std::vector<Piece> &pieces) {
    for (const Piece &piece : pieces)
      for (const Vec<2> &x : piece.points)
        for (int d = 0; d < 2; ++d) low_[d] = std::min(low_[d], x[d]), high_[d] = std::max(high_[d], x[d]);
  }

  /// The pieces of a part as one line. Of pieces that meet end to end, the one that was drawn first gives the
  /// direction.
  void add_line(const std::string &part, std::vector<Piece> pieces) {
    const double tolerance = same_point * distance(low_, high_);
    const auto join = [&](const Vec<2> &a, const Vec<2> &b) { return distance(a, b) <= tolerance; };
    for (std::size_t i = 0; i < pieces.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (same(pieces[i].points, pieces[j].points, tolerance))
          complain(pieces[i].line, "layer '" + part + "' has this line twice, also in line " +
                                       std::to_string(pieces[j].line) + "; delete one of them");
    std::vector<Piece> chain{pieces.front()};
    pieces.erase(pieces.begin());
    for (bool found = true; found && !pieces.empty();) {
      found = false;
      for (std::size_t i = 0; i < pieces.size() && !found; ++i) {
        const Vec<2> &begin = chain.front().points.front(), &end = chain.back().points.back();
        std::vector<Vec<2>> &x = pieces[i].points;
        if (join(x.back(), end) || join(x.front(), begin)) std::reverse(x.begin(), x.end());
        const bool behind = join(x.front(), end), before = !behind && join(x.back(), begin);
        if (!(found = behind || before)) continue;
        chain.insert(behind ? chain.end() : chain.begin(), pieces[i]);
        pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(i));
      }
    }
    if (!pieces.empty()) complain_of_gap(part, chain, pieces.front());
    std::vector<SectionRow> rows;
    for (const Piece &piece : chain)
      for (const Vec<2> &x : piece.points)
        if (rows.empty() || !join(rows.back().numbers, x)) rows.push_back({part, x, piece.line});
    const bool closed = rows.size() > 2 && join(rows.front().numbers, rows.back().numbers);
    if (part == "outline") {
      if (!closed)
        complain(rows.back().line, "the outline is open between " + text_of(rows.back().numbers) + " and " +
                                       text_of(rows.front().numbers) + " " + sign() +
                                       "; close it, with ends that meet");
      rows.pop_back();
    }
    drawing_.rows.rows.insert(drawing_.rows.rows.end(), rows.begin(), rows.end());
  }

  std::string sign() const { return drawing_.rows.unit.sign; }

  [[noreturn]] void complain_of_gap(const std::string &part, const std::vector<Piece> &chain,
                                    const Piece &other) const {
    Vec<2> from{}, to{};
    double least = std::numeric_limits<double>::infinity();
    for (const Vec<2> &a : {chain.front().points.front(), chain.back().points.back()})
      for (const Vec<2> &b : {other.points.front(), other.points.back()})
        if (distance(a, b) < least) least = distance(a, b), from = a, to = b;
    std::ostringstream text;
    text << "layer '" << part << "' does not join into one line: between " << text_of(from) << " and " << text_of(to)
         << " " << sign() << " its pieces are " << least << " " << sign()
         << " apart. Let ends meet (snap), or leave out a line that is drawn twice";
    complain(other.line, text.str());
  }

  void add_boxes(const std::string &part, const std::vector<Piece> &pieces) {
    for (const Piece &piece : pieces) {
      Vec<2> low = piece.points[0], high = low;
      for (const Vec<2> &x : piece.points)
        for (int d = 0; d < 2; ++d) low[d] = std::min(low[d], x[d]), high[d] = std::max(high[d], x[d]);
      drawing_.rows.rows.push_back({part, low, piece.line}), drawing_.rows.rows.push_back({part, high, piece.line});
    }
  }

  std::string file_;
  Drawing drawing_;
  std::string gdal_;  ///< its last complaint
  std::map<std::string, std::vector<Piece>> pieces_;
  std::set<std::string> left_out_;
  Vec<2> low_{1e300, 1e300}, high_{-1e300, -1e300};  ///< of all lines
};

}  // namespace

bool is_drawing(const std::string &file) {
  const std::string kind = std::filesystem::path(file).extension();
  return kind == ".dxf" || kind == ".DXF";
}

Drawing read_drawing(const std::string &file) { return Reader(file).read(); }

}  // namespace talus
