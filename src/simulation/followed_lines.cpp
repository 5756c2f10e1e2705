#include "simulation/followed_lines.h"

#include <algorithm>
#include <cmath>

#include "output/output_field.h"
#include "scene/output_source.h"
#include "scene/scene.h"
#include "scene/stage.h"

namespace talus {
namespace {

template <int dim>
struct Along {
  Vec<dim> place;
  double distance;  ///< from the beginning of the line [m]
};

/// Places along a line at equal distances, its two ends among them.
template <int dim>
std::vector<Along<dim>> places_along(const OutputLine &line) {
  std::vector<double> lengths;
  double whole = 0;
  for (std::size_t i = 1; i < line.points.size(); ++i) {
    double square = 0;
    for (int d = 0; d < dim; ++d) square += std::pow(line.points[i][d] - line.points[i - 1][d], 2);
    lengths.push_back(std::sqrt(square)), whole += lengths.back();
  }
  constexpr int usual = 40;
  const int intervals = line.spacing > 0 ? std::max(1, static_cast<int>(std::round(whole / line.spacing))) : usual - 1;
  std::vector<Along<dim>> along;
  for (int k = 0; k <= intervals; ++k) {
    const double distance = whole * k / intervals;
    double left = distance;
    std::size_t piece = 0;
    while (piece + 1 < lengths.size() && left > lengths[piece]) left -= lengths[piece++];
    const double share = lengths[piece] > 0 ? std::min(1., left / lengths[piece]) : 0;
    Vec<dim> place;
    for (int d = 0; d < dim; ++d)
      place[d] = line.points[piece][d] + share * (line.points[piece + 1][d] - line.points[piece][d]);
    along.push_back({place, distance});
  }
  return along;
}

template <int dim>
std::vector<Vec<dim>> places_of(const std::vector<Along<dim>> &along) {
  std::vector<Vec<dim>> places;
  for (const Along<dim> &one : along) places.push_back(one.place);
  return places;
}

}  // namespace

template <int dim>
FollowedLines<dim>::Line::Line(const World<dim> &world, const OutputLine &of)
    : name(of.name), places(world, places_of(places_along<dim>(of))), rows(world, places) {
  const auto along = places_along<dim>(of);
  wanted = along.size();
  const auto &in_soil = places.all();
  if (in_soil.size() < 2)
    world.scene.complain("output.line." + name + ".points", "must be a line in the soil; of " +
                                                                std::to_string(along.size()) + " places along it " +
                                                                (in_soil.empty() ? "none is" : "only one is"));
  for (const Along<dim> &one : along)
    if (distance.size() < in_soil.size() && one.place == in_soil[distance.size()].place)
      distance.push_back(one.distance);
}

template <int dim>
std::vector<std::string> FollowedLines<dim>::Line::columns() const {
  std::vector<std::string> names{history_column("distance", "m")};
  for (const auto &[quantity, unit] : rows.columns()) names.push_back(history_column(quantity, unit));
  return names;
}

template <int dim>
FollowedLines<dim>::FollowedLines(const World<dim> &world) : comm_(world.comm) {
  for (const OutputLine &line : world.scene.output->line) lines_.emplace_back(world, line);
}

template <int dim>
void FollowedLines<dim>::open(const std::string &directory) {
  for (Line &line : lines_) line.file = std::make_unique<History>(comm_, line.path(directory), line.columns());
}

template <int dim>
void FollowedLines<dim>::append(const std::string &directory, double time) {
  for (Line &line : lines_)
    line.file = std::make_unique<History>(History::append(comm_, line.path(directory), line.columns(), time));
}

template <int dim>
void FollowedLines<dim>::write(const Clock &clock, const Statics<dim> &statics) {
  for (Line &line : lines_) {
    if (!line.file) continue;
    const std::vector<double> values = line.rows.at(clock.time, statics);
    const std::size_t count = line.distance.size(), width = values.size() / count;
    std::vector<std::vector<double>> rows;
    for (std::size_t i = 0; i < count; ++i) {
      rows.push_back({line.distance[i]});
      rows.back().insert(rows.back().end(), &values[i * width], &values[i * width] + width);
    }
    line.file->rows(clock.time, clock.steps, clock.stage.empty() ? "start" : clock.stage, rows);
  }
}

template <int dim>
std::vector<std::string> FollowedLines<dim>::left_out() const {
  std::vector<std::string> sentences;
  for (const Line &line : lines_) {
    const auto &in_soil = line.places.all();
    std::size_t shared = 0;
    for (std::size_t i = 1; i < in_soil.size(); ++i) shared += in_soil[i].id == in_soil[i - 1].id;
    const std::string name = "output.line." + line.name + ": ", all = std::to_string(line.wanted);
    if (in_soil.size() < line.wanted)
      sentences.push_back(name + std::to_string(in_soil.size()) + " of " + all +
                          " places along it are in soil and are followed");
    if (shared > 0)
      sentences.push_back(name + std::to_string(shared) + " of " + all +
                          " places have the same particle as their neighbour: a larger spacing loses nothing");
  }
  return sentences;
}

template <int dim>
std::vector<std::string> FollowedLines<dim>::with_gaps() const {
  std::vector<std::string> names;
  for (const Line &line : lines_)
    if (line.file && line.file->has_gap()) names.push_back(line.name);
  return names;
}

template <int dim>
void FollowedLines<dim>::serialize(Archive &archive) {
  for (Line &line : lines_) line.rows.serialize(archive);
}

template class FollowedLines<2>;
template class FollowedLines<3>;

}  // namespace talus
