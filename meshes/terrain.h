#pragma once
/// Terrain as it is to be meshed: a window of a grid, and what lies above a slip surface. x points east, y north, z up;
/// x and y of the mesh are those of the grid less a local origin, so that large coordinates cost no digits.
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "meshes/ellipsoid.h"
#include "meshes/grid.h"
#include "meshes/outline.h"

namespace talus {

struct TerrainOptions {
  std::string file;
  double size = 0;                     ///< of cells in and around the slide, at the ground [m]
  double far_size = 0;                 ///< of cells far away [m]; 0: the same
  int halvings = 0;                    ///< of their edges in the run, which the mesh does not have
  std::vector<double> window;          ///< west, south, east, north in the coordinates of the grid [m]; empty: all
  int step = 1;                        ///< every so many-th row and column of the grid is used
  std::optional<double> base;          ///< elevation of a flat base; none: the mesh begins at the bed
  double air = 0;                      ///< height of the free space above the ground [m]
  std::string slip_surface;            ///< a grid of elevations; empty: none
  std::optional<Ellipsoid> ellipsoid;  ///< in place of it
  std::string outline;                 ///< polygons, in place of both; empty: none
  double depth = 0;                    ///< of the slip surface in the outline, the largest [m] ...
  bool bowl = true;                    ///< ... from 0 at the outline on, or else everywhere
  std::vector<std::array<std::string, 2>> layers;  ///< name and grid of the upper surface, from top to bottom
  std::vector<double> way;                         ///< x, y, x, y, ... of a line in the coordinates of the grid [m]
  double way_width = 0;                            ///< of the strip along it in which cells measure `size` [m]
};

class Terrain {
 public:
  /// Reads and checks. Throws std::invalid_argument for what cannot be meshed, with what to do.
  explicit Terrain(const TerrainOptions &options);

  const TerrainOptions &options() const { return options_; }
  int columns() const { return ground_.columns; }
  int rows() const { return ground_.rows; }
  /// Of the mesh [m].
  double x(int column) const { return ground_.x(column); }
  double y(int row) const { return ground_.y(row); }
  double width() const { return x(columns() - 1); }
  double depth() const { return y(rows() - 1); }
  /// [rows][columns] [m]
  const std::vector<double> &ground() const { return ground_.values; }
  /// The ground, lowered to the slip surface where there is one below it.
  const std::vector<double> &bed() const { return bed_.values; }
  /// Is the ground at a place not known, and interpolated? Nothing is meshed there.
  bool is_void(double x, double y) const;
  bool has_voids() const { return !void_.empty(); }
  double ground_at(double x, double y) const { return ground_.at(x, y); }
  double bed_at(double x, double y) const {
    const double z = near_slide_.values.empty() ? bed_.at(x, y) : near_slide_.at(x, y);
    return std::isnan(z) ? bed_.at(x, y) : z;
  }
  /// The bed around the slide, at places between those of the terrain too, as near as cells need them; empty: none.
  struct Refined {
    int column = 0, row = 0;    ///< of the terrain, where it begins
    int columns = 0, rows = 0;  ///< of the terrain, that it covers
    int parts = 1;              ///< into which it parts their spacing
  };
  const Grid &near_slide() const { return near_slide_; }
  const Refined &refined() const { return refined_; }
  bool slides() const { return slide_area_ > 0; }
  double slide_area() const { return slide_area_; }                ///< seen from above [m2]
  double slide_volume() const { return slide_volume_; }            ///< [m3]
  double slip_surface_area() const { return slip_surface_area_; }  ///< under the slide, as the surface lies [m2]
  /// A polygon of the outline.
  struct Part {
    Outline outline;
    double volume = 0;  ///< that slides in it, as the bed has it [m3]
    int places = 0;     ///< of the bed that lie in it, where it is lower than the ground
  };
  const std::vector<Part> &parts() const { return parts_; }
  /// The part in which a place of the mesh lies, or beside which it does.
  int part_at(double x, double y) const;
  /// The part in a sentence.
  std::string name_of(const Part &part) const;
  /// The layer to which ground at a place belongs; empty: none.
  std::string layer_at(double x, double y, double z) const;
  /// The next layer whose surface lies above that of layer `index` wherever this is above the base, so that it has no
  /// cells; empty: none.
  std::string layer_above(int index) const;
  /// Cell size at a place [m].
  double size_at(double x, double y, double z) const;
  /// Sentences about what may be meant but rarely is.
  std::vector<std::string> doubts() const;
  /// What leads back from the mesh to the map, as JSON.
  std::string origin_document() const;

 private:
  void take_window(const Grid &grid);
  /// Notes places without data and interpolates the ground there.
  void take_voids();
  /// Refuses a place without data that soil is in, or comes to.
  [[noreturn]] void refuse_void(int index, const std::string &where) const;
  std::string voids_in_words() const;
  void check_scale();  ///< notes a projection whose lengths are not those of the ground
  void take_slip_surface(const Grid &grid);
  /// Elevations of the slip surface at the places of a grid of the ground; not a number where there is none.
  using SlipSurface = std::function<std::vector<double>(const Grid &ground)>;
  SlipSurface slip_surface(const Grid &grid);
  /// The same of one in an outline.
  std::vector<double> slip_surface(const Outline &outline, const Grid &ground) const;
  void refine_bed(const SlipSurface &surface);
  void measure_parts();
  bool in_window(const Part &part) const;
  /// Notes parts that are smaller than what the bed or the cells can show.
  void check_parts();
  /// Area of a slip surface below the ground, and of the bed under the slide [m2].
  double area_of(const std::vector<double> &slip) const;
  double area_of_bed() const;
  void take_layers(const Grid &grid);
  void check_base() const;
  /// Refuses a slip surface whose elevations stand to those of the ground as feet and metres do.
  void check_feet(const std::vector<double> &slip, const std::string &name) const;
  /// Refuses places without data of the terrain in the slide or beside it.
  void check_voids() const;
  /// Are the values of a slip surface, which lies `least` below the ground or more, depths in place of elevations? As
  /// elevations they would make a slide that is `thick` for its width.
  bool seem_depths(const std::vector<double> &slip, double least, bool thick) const;
  /// Refuses a slip surface with places without data amid the slide.
  void check_holes(const std::vector<double> &slip, const std::string &name) const;
  /// By how much more than allowed a place, and the few that it stands with, is above (`sign` 1) or below (-1) all
  /// those around them; 0 where it is not.
  double stands_out(const std::vector<double> &z, int at, double sign, double allowed) const;
  /// Refuses elevations that no ground has: single places, or edges of areas, far above or below those around them.
  void check_steps(const std::vector<double> &z, const std::string &file) const;
  /// Refuses a slip surface that does not come up to the ground, and notes where it ends below it. `slip` is not a
  /// number where there is none.
  void check_slip_surface(const std::vector<double> &slip, const std::string &name);
  void find_distances();
  std::string place(int index) const;  ///< in the coordinates of the grid
  /// Where the slide as a whole falls or dips to: level components of the mean of -grad z over it.
  std::array<double, 2> downhill(const std::vector<double> &z) const;

  TerrainOptions options_;
  std::array<double, 2> origin_{};  ///< of the mesh in the coordinates of the grid [m]
  std::string projection_;
  std::vector<std::string> remarks_;  ///< on how files were read
  Grid ground_, bed_, near_slide_;
  std::vector<char> void_;  ///< [rows][columns]: no data; empty: there are none
  Refined refined_;
  Grid distance_;                                         ///< from the slide and its way, seen from above [m]
  bool way_in_window_ = false, way_meets_slide_ = false;  ///< the strip along --way
  std::vector<Grid> layer_;
  std::vector<Part> parts_;
  double slide_area_ = 0, slide_volume_ = 0, slip_surface_area_ = 0;
};

}  // namespace talus
