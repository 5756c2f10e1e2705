#include "meshes/drawing.h"

#include <ogrsf_frmts.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <stdexcept>

namespace talus {
namespace {

constexpr double join_share = 1e-6;  // ends nearer than this share of the drawing join

struct Piece {  // of a line that may consist of several
  std::vector<Vec<2>> points;
  int entity;
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
    if (!std::filesystem::exists(file_)) complain("cannot be opened; check the path");
    GDALAllRegister();
    CPLPushErrorHandler(CPLQuietErrorHandler);
    const std::unique_ptr<GDALDataset> data(GDALDataset::Open(file_.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY));
    CPLPopErrorHandler();
    if (!data || data->GetLayerCount() == 0)
      complain("is no drawing that can be read; save it as DXF in text form (ASCII)");
    read_unit();
    int entity = 0;
    for (const auto &feature : *data->GetLayer(0)) take(*feature, ++entity);
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
  [[noreturn]] void complain(int entity, const std::string &text) const {
    throw std::invalid_argument(file_ + " entity " + std::to_string(entity) + ": " + text);
  }

  /// GDAL does not hand on the header, whose variable of the unit is a line $INSUNITS, one 70 and one with the number.
  void read_unit() {
    std::ifstream text(file_);
    int number = 0;
    for (std::string line; std::getline(text, line);) {
      if (line.find("ENTITIES") != std::string::npos) break;
      if (line.find("$INSUNITS") == std::string::npos) continue;
      if (std::getline(text, line) && std::getline(text, line)) number = std::atoi(line.c_str());
      break;
    }
    if (number == 0) return;
    const auto *unit =
        std::ranges::find_if(length_units, [=](const LengthUnit &one) { return one.in_drawings == number; });
    if (unit == std::end(length_units))
      complain("is drawn in unit " + std::to_string(number) +
               " of $INSUNITS, which is none that sections are drawn in; set it to metres (6), millimetres (4) or feet "
               "(2)");
    drawing_.rows.unit = *unit, drawing_.rows.stated = "$INSUNITS";
  }

  void take(OGRFeature &feature, int entity) {
    std::string part = feature.GetFieldAsString("Layer");
    std::transform(part.begin(), part.end(), part.begin(), [](unsigned char c) { return std::tolower(c); });
    const auto begins = [&](const char *start) { return part.rfind(start, 0) == 0; };
    const bool region = begins("region_"),
               line = part == "outline" || begins("interface") || begins("b_") || begins("refine_");
    const OGRGeometry *shape = feature.GetGeometryRef();
    if ((!region && !line) || !shape) {
      left_out_.insert(part);
      return;
    }
    add(part, *shape, region, entity);
  }

  void add(const std::string &part, const OGRGeometry &shape, bool region, int entity) {
    const OGRwkbGeometryType kind = wkbFlatten(shape.getGeometryType());
    if (kind == wkbPoint && region) {
      const OGRPoint &point = *shape.toPoint();
      drawing_.rows.rows.push_back({part, place(point.getX(), point.getY(), point.getZ(), part, entity), entity});
    } else if (kind == wkbLineString && !region) {
      const OGRLineString &line = *shape.toLineString();
      Piece piece{{}, entity};
      for (int i = 0; i < line.getNumPoints(); ++i) {
        const Vec<2> x = place(line.getX(i), line.getY(i), line.getZ(i), part, entity);
        if (piece.points.empty() || distance(piece.points.back(), x) > 0) piece.points.push_back(x);
      }
      if (piece.points.size() > 1) pieces_[part].push_back(piece);
    } else if (kind == wkbPolygon && !region) {
      add(part, *shape.toPolygon()->getExteriorRing(), region, entity);
    } else if (OGR_GT_IsSubClassOf(kind, wkbGeometryCollection) && !region) {
      for (const OGRGeometry *one : *shape.toGeometryCollection()) add(part, *one, region, entity);
    } else {
      complain(entity, "layer '" + part + "' has " + OGRGeometryTypeToName(shape.getGeometryType()) + "; " +
                           (region ? "a region is named by a point or a text inside it"
                                   : "it takes lines and polylines, so move this to another layer"));
    }
  }

  Vec<2> place(double x, double y, double z, const std::string &part, int entity) const {
    if (!std::isfinite(x) || !std::isfinite(y)) complain(entity, "layer '" + part + "' has a point that is no number");
    if (z != 0 && std::isfinite(z))
      complain(entity, "layer '" + part + "' has a point with z = " + std::to_string(z) +
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
    const double tolerance = join_share * distance(low_, high_);
    const auto join = [&](const Vec<2> &a, const Vec<2> &b) { return distance(a, b) <= tolerance; };
    for (std::size_t i = 0; i < pieces.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (same(pieces[i].points, pieces[j].points, tolerance))
          complain(pieces[i].entity, "layer '" + part + "' has this line twice, also as entity " +
                                         std::to_string(pieces[j].entity) + "; delete one of them");
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
        if (rows.empty() || !join(rows.back().numbers, x)) rows.push_back({part, x, piece.entity});
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
    complain(other.entity, text.str());
  }

  void add_boxes(const std::string &part, const std::vector<Piece> &pieces) {
    for (const Piece &piece : pieces) {
      Vec<2> low = piece.points[0], high = low;
      for (const Vec<2> &x : piece.points)
        for (int d = 0; d < 2; ++d) low[d] = std::min(low[d], x[d]), high[d] = std::max(high[d], x[d]);
      drawing_.rows.rows.push_back({part, low, piece.entity}), drawing_.rows.rows.push_back({part, high, piece.entity});
    }
  }

  std::string file_;
  Drawing drawing_;
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
