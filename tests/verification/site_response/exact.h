#pragma once
/// Transfer function of a layer on an elastic half-space from the outcrop of the half-space to the surface of the layer
/// (Kramer 1996, eq. 7.30): 1 / |cos kH + i alpha sin kH|, where k = 2 pi f / V_s and alpha is the impedance of the
/// layer over that of the half-space.
#include <algorithm>
#include <cmath>
#include <complex>

#include "earthquake/sources.h"
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void site_response(Rung &rung) {
  constexpr double H = 20, speed = 200, alpha = 0.2, step = 0.02;  // [m], [m/s], [-], of frequencies [Hz]
  const GroundMotion outcrop =
      read_motion(read_components("earthquake = [{kind = 'ricker', amplitude = 0.01, frequency = 4}]")[0]);
  const std::vector<double> way = outcrop.displacement();
  const auto at = [&](double t) {
    const double place = std::clamp(t / outcrop.step, 0., static_cast<double>(way.size()) - 1.001);
    const auto k = static_cast<std::size_t>(place);
    return way[k] + (place - static_cast<double>(k)) * (way[k + 1] - way[k]);
  };
  // of the motion of a point over that of the outcrop; both begin and end at rest
  const auto transfer = [&](const std::vector<double> &time, const std::vector<double> &u, double f) {
    std::complex<double> top = 0, below = 0;
    for (std::size_t k = 1; k < time.size(); ++k) {
      const double t = (time[k] + time[k - 1]) / 2, h = time[k] - time[k - 1];
      const auto wave = std::polar(h, -2 * M_PI * f * t);
      top += wave * (u[k] + u[k - 1]) / 2., below += wave * (at(time[k]) + at(time[k - 1])) / 2.;
    }
    return std::abs(top / below);
  };
  const auto exact = [&](double f) {
    const double kH = 2 * M_PI * f / speed * H;
    return 1 / std::hypot(std::cos(kH), alpha * std::sin(kH));
  };
  const auto compare = [&](const std::string &name, const Run &run, const std::string &point) {
    const auto time = run.history.column("time_s"), u = run.history.column(point + "_displacement_x_m");
    double height[2] = {0, 0}, place[2] = {0, 0}, error = 0;
    for (int k = 10; k <= 500; ++k) {
      const double f = k * step, found = transfer(time, u, f);
      const int peak = f > 5;  // the first and the second mode of the layer: 2.5 and 7.5 Hz
      if (found > height[peak]) height[peak] = found, place[peak] = f;
      error = std::max(error, std::abs(found - exact(f)));
    }
    const auto worst = [](double one, double other) { return std::max(std::abs(one), std::abs(other)); };
    rung.compare(name + ": error of the heights of the peaks", 0, worst(height[0] * alpha - 1, height[1] * alpha - 1),
                 0.02, 1);
    rung.compare(name + ": error of their frequencies", 0, worst(place[0] / 2.5 - 1, place[1] / 7.5 - 1), 0.02, 1);
    rung.report(name + ": largest error from 0.2 to 10 Hz, of the peaks", 0, error * alpha, 1);
  };
  const std::vector<std::string> column{"mesh.section=column.csv", "output.point.middle.position=[1, 20]"},
      free{"boundary.sides.kind=free_field"},
      block{"dimension=3",
            "mesh.section=block.csv",
            "mesh.thickness=4",
            "mesh.layers=4",
            "output.point.middle.position=[2, 20, 2]",
            "output.point.side.position=[0.5, 20, 0.5]"};
  const auto with = [](std::vector<std::string> one, const std::vector<std::string> &more) {
    one.insert(one.end(), more.begin(), more.end());
    return one;
  };
  compare("column, tied sides", rung.run(column), "middle");
  for (const bool is_free : {false, true}) {
    const std::string sides = is_free ? "free-field sides" : "tied sides";
    const std::vector<std::string> more = is_free ? free : std::vector<std::string>{};
    const Run layer = rung.run(more);
    compare("layer of 4 heights, " + sides + ", in its middle", layer, "middle");
    compare("layer of 4 heights, " + sides + ", at its side", layer, "side");
    auto ends = with(block, more);
    ends.insert(ends.end(), {"boundary.ends.group=[\"front\", \"back\"]",
                             std::string("boundary.ends.kind=") + (is_free ? "free_field" : "tied")});
    const Run in_3d = rung.run(ends);
    compare("3D, " + sides + ", in its middle", in_3d, "middle");
    compare("3D, " + sides + ", at its corner", in_3d, "side");
    if (!rung.longer()) continue;
    const Run far = rung.run(with(more, {"mesh.section=long.csv", "output.point.middle.position=[400, 20]"}));
    compare("layer of 40 heights, " + sides + ", in its middle", far, "middle");
    compare("layer of 40 heights, " + sides + ", at its side", far, "side");
  }
  compare("slice of tetrahedra, tied sides",
          rung.run(in_dimension(3, {"mesh.section=block.csv", "output.point.middle.position=[2, 20, 0.5]",
                                    "output.point.side.position=[0.5, 20, 0.5]"})),
          "middle");
}

}  // namespace talus::rungs
