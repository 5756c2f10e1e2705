// What is rarely meant of terrain and the slide on it.
#include <algorithm>
#include <cmath>

#include "meshes/terrain.h"
#include "meshes/terrain_words.h"

namespace talus {

using namespace terrain_words;

namespace {

constexpr double degrees = 180 / 3.14159265358979323846;

/// Clockwise from north, 0 to 360 degrees.
double azimuth(const std::array<double, 2> &v) {
  const double angle = std::atan2(v[0], v[1]) * degrees;
  return angle < 0 ? angle + 360 : angle;
}

}  // namespace

std::array<double, 2> Terrain::downhill(const std::vector<double> &z) const {
  std::array<double, 2> sum{};
  for (int j = 1; j + 1 < rows(); ++j)
    for (int i = 1; i + 1 < columns(); ++i) {
      const int k = j * columns() + i;
      if (!(ground()[k] > bed()[k])) continue;
      sum[0] -= z[k + 1] - z[k - 1], sum[1] -= z[k + columns()] - z[k - columns()];
    }
  return sum;
}

std::vector<std::string> Terrain::doubts() const {
  std::vector<std::string> sentences = remarks_;
  if (ground_.spacing > 2 * options_.size)
    sentences.push_back(text_of("the cells at the ground (--size ", options_.size,
                                " m) are smaller than the spacing of the elevations, ", ground_.spacing,
                                " m, and show no more than these do"));
  if (!slides()) return sentences;
  const std::array<double, 2> slope = downhill(ground());
  std::array<double, 2> dip = downhill(bed());
  if (options_.ellipsoid)
    dip = {std::sin(options_.ellipsoid->dip_direction), std::cos(options_.ellipsoid->dip_direction)};
  const double level = 0.02 * 2 * slide_area_ / ground_.spacing;  // sums over slopes that fall nowhere in particular
  double off = std::abs(azimuth(dip) - azimuth(slope));           // [degrees]
  off = std::min(off, 360 - off);
  const bool falls = std::hypot(slope[0], slope[1]) > level,
             dips = options_.ellipsoid ? options_.ellipsoid->dip > 0 : std::hypot(dip[0], dip[1]) > level;
  if (falls && dips && off > 60) {
    const bool into = off > 120;
    sentences.push_back(text_of("the slip surface dips towards ", std::lround(azimuth(dip)), " degrees from north, ",
                                into ? "into" : "across", " the slope, which falls towards ",
                                std::lround(azimuth(slope)),
                                " degrees: ", into ? "" : "soil on it sets out sideways. The ",
                                "dip direction is the azimuth (clockwise from north) towards which the surface dips. ",
                                into ? "Is it meant to dip the other way?"
                                     : "Is it meant to dip down the slope, and this is the azimuth of the strike?"));
  }
  const double deep = slide_volume_ / slide_area_;
  double deepest = 0;
  for (std::size_t k = 0; k < ground().size(); ++k) deepest = std::max(deepest, ground()[k] - bed()[k]);
  if (options_.air > 0 && options_.air < deepest)
    sentences.push_back(text_of(
        "the mesh reaches ", length(options_.air), " above the ground (--air), and the slide is up to ",
        length(deepest), " thick: soil that runs over steep ground leaves it by the top; more air costs little"));
  const double meshed = way_meets_slide_ ? options_.size : options_.far_size,
               on_way = std::ldexp(meshed, -options_.halvings);
  if (on_way > deep)
    sentences.push_back(text_of(
        way_meets_slide_ ? "cells measure " : "cells grow to ", length(on_way),
        options_.halvings > 0 ? text_of(" (", length(meshed), " with edges halved ",
                                        options_.halvings == 1 ? "once" : text_of(options_.halvings, " times"), ")")
                              : "",
        " on the way of the slide, which is ", length(deep),
        " thick on average and thinner as it spreads: a flow that is not as deep as a cell is not resolved. Take "
        "cells of a third of its depth or less there, by --far-size and --size, or by --size along a line --way"));
  for (int k = 0; k < static_cast<int>(bed().size()); ++k) {
    const int i = k % columns(), j = k / columns();
    if (ground()[k] > bed()[k] && (i == 0 || j == 0 || i == columns() - 1 || j == rows() - 1)) {
      sentences.push_back("the slide reaches the edge of the window at " + place(k) +
                          ", where it is cut off; take a larger window");
      break;
    }
  }
  return sentences;
}

}  // namespace talus
