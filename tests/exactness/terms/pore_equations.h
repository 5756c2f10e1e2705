#pragma once
/// The equations of docs/theory/pores.md as they stand there, summed up cell by cell and node by node: what the program
/// has to give on a few cells whose pores are full, hold gas at rest, or gas that moves. Numbers in brackets are those
/// of that page. On one rank, in soil of one body with averaged stress.
#include "equations.h"

namespace talus {

constexpr double porosity = 0.4, grain_density = 2500, water_density = 1000, water_bulk = 2e7;
constexpr double air_density = 1.2, air_bulk = 101325;  ///< what a scene has without a table [gas]
constexpr double full_conductivity = 1e-9 / 1e-3;       ///< k_0 / mu_l [m2/(Pa s)]

/// The box of equations.h with pores whose contents look drawn. Where they may hold gas, the pores of one patch in two
/// and of one cell in three of the others are full, and the rest hold liquid to between 0.4 and 0.8.
template <int dim, class Phases>
struct WetBox : Box<dim, Phases> {
  explicit WetBox(const std::string &more = "", double relaxation_time = 0)
      : Box<dim, Phases>(std::string("permeability = 1e-9\n") +
                             (Phases::suction ? "[body.soil.retention]\ncurve = \"van_genuchten\"\nreference_suction = "
                                                "1e4\nshape = 0.5\n[body.soil.relative_permeability]\ncurve = "
                                                "\"hillel\"\n"
                                              : ""),
                         more, relaxation_time) {
    ParticleArrays<dim> &p = this->soil.particles();
    for (int i = 0; i < p.count; ++i) {
      p.mass[i] *= 0.7;
      const double pores = p.volume[i] - p.mass[i] / grain_density;
      const bool full = !Phases::suction || this->soil.mesh.patch[p.cell[i]] % 2 == 0 || p.cell[i] % 3 == 0;
      const bool cavitates = !Phases::suction && p.cell[i] % 5 == 0;
      const double wet = cavitates ? 0.98 + 0.01 * drawn(i, 30) : full ? 1 : 0.6 + 0.2 * drawn(i, 30);
      p.fluid_mass[0][i] = wet * water_density * (full ? 1 + (2e4 + 1e4 * drawn(i, 30)) / water_bulk : 1) * pores;
      if constexpr (Phases::gas) {  // a little gas in full pores too; its pressure is a few kPa
        const double air = full ? 0.005 : 1 - wet;
        p.fluid_mass[0][i] *= full ? 1 - air : 1;
        p.fluid_mass[1][i] = air * air_density * (1 + 3e3 * (1 + drawn(i, 31)) / air_bulk) * pores;
      }
      for (int a = 0; a <= Phases::gas; ++a)
        for (int d = 0; d < dim; ++d) p.fluid_velocity[a][i][d] = drawn(i, 40 + 3 * a + d);
    }
    this->soil.motion->loading.gravity = Vec<dim>{1, -9.81};
  }
};

/// A scene's [water] of the bulk modulus above.
inline std::string water(const std::string &more = "") { return "[water]\nbulk_modulus = 2e7\n" + more; }

template <int dim, class Phases>
struct PoreEquations : Equations<dim, Phases> {
  using Base = Equations<dim, Phases>;
  using V = typename Base::V;
  using Nodes = typename Base::Nodes;
  using Fields = std::array<Nodes, velocity_fields<Phases>>;
  using Corners = Eigen::Matrix<double, dim + 1, 1>;
  static constexpr double curve_pressure = 1e4;

  /// `smooths`: pressures are smoothed through nodes; `bishop`: the pores act by the mean of their pressures;
  /// `pressed`: a group of facets beyond which the liquid has the pressure `beyond`, or none.
  PoreEquations(const Soil<dim, Phases> &soil, bool smooths, bool bishop, const char *pressed = nullptr,
                double beyond = 0)
      : Base(soil), smooths(smooths) {
    for (int d = 0; d < dim; ++d) g[d] = soil.motion->loading.gravity[d];
    std::vector<double> grains(this->cells, 0), pressure, air_pressure(this->cells, 0), weighed;
    liquid.assign(this->cells, 0), gas = liquid, air = liquid, row.assign(this->cells, Corners::Zero());
    for (int p = 0; p < this->particles.count; ++p) {
      const int c = this->particles.cell[p];
      grains[c] += this->particles.mass[p], liquid[c] += this->particles.fluid_mass[0][p];
      if constexpr (Phases::gas) gas[c] += this->particles.fluid_mass[1][p];
      row[c] += this->particles.mass[p] * this->N[p];
    }
    const auto acts = [&](double of_liquid, double of_gas, double wet) {  // (4.2)
      if (!Phases::suction) return of_liquid;
      return bishop ? wet * of_liquid + (1 - wet) * of_gas : std::max(of_gas, of_liquid);
    };
    for (int c = 0; c < this->cells; ++c) {
      const double pores = this->particle_volume[c] - grains[c] / grain_density, content = liquid[c] / pores;
      saturation.push_back(Phases::gas ? saturation_of(content, gas[c] / pores) : saturation_of(content));
      density.push_back(content / saturation[c]);                         // without its vapour
      pressure.push_back(water_bulk * (density[c] / water_density - 1));  // (3.1), (3.2)
      if constexpr (Phases::gas)
        air[c] = gas[c] / pores / (1 - saturation[c]),
        air_pressure[c] = air_bulk * (air[c] / air_density - 1);  // (3.3)
      const Corners mean = this->share[c] / this->particle_volume[c];
      reference.push_back(mean + this->blend[c] * (Corners::Constant(1. / (dim + 1)) - mean));
      const double way = g.dot(point(c, reference[c]) - point(c, mean)), at_mean = g.dot(point(c, mean));
      head.push_back(water_density * g.dot(point(c, reference[c])));
      air_smooth.push_back(air_pressure[c] + (Phases::gas ? air_density : 0) * way);
      acting.push_back(acts(pressure[c] + water_density * way, air_smooth[c], saturation[c]));
      smooth.push_back(pressure[c] - water_density * at_mean);
      weighed.push_back(acts(pressure[c], air_pressure[c], saturation[c]) - water_density * at_mean);
    }
    if (Phases::suction) average_over_open_patches(acting, bishop);  // (4.3a)
    const std::vector<double> before = smooth;
    if (Phases::suction) share_pressure(smooth);
    smooth = smoothed(smooth), weighed = smoothed(weighed);
    for (int c = 0; c < this->cells; ++c) {
      if (full(c)) air_smooth[c] += smooth[c] - before[c];  // suction stays
      smooth[c] += head[c];                                 // (4.3)
      if (full(c)) acting[c] = Phases::gas ? weighed[c] + head[c] : acts(smooth[c], 0, saturation[c]);
    }
    for (auto *x : {&volume, &mass, &whole, &conductivity, &saturated, &beside, &air_mass, &air_whole})
      x->assign(this->nodes, 0);
    for (auto *x : {&area, &push, &air_push, &thrust, &taken, &gap}) x->assign(this->nodes, V::Zero());
    for (int c = 0; c < this->cells; ++c)
      for (int k = 0; k <= dim; ++k) {
        const int i = this->mesh.cells[c].node[k];
        const double part = this->weight[c] * reference[c][k];
        const V gradient = this->weight[c] * this->shape[c].gradient.row(k).transpose();
        volume[i] += part, whole[i] += part * density[c];
        conductivity[i] += part * full_conductivity * (Phases::suction ? std::pow(saturation[c], 3) : 1);  // (2.1)
        saturated[i] += part * full_conductivity;
        mass[i] += liquid[c] / row[c].sum() * row[c][k];
        air_mass[i] += gas[c] / row[c].sum() * row[c][k], air_whole[i] += part * air[c];
        air_push[i] += air_smooth[c] * gradient;
        area[i] += gradient, push[i] += smooth[c] * gradient, thrust[i] += acting[c] * gradient;
      }
    if (pressed)
      for (const Facet<dim> &f : this->mesh.facets(pressed))
        for (int i : f.node)
          taken[i] +=
              std::min(1., this->weight[f.cell] / this->shape[f.cell].volume) * f.area / dim * map<dim>(f.normal);
    for (int i = 0; i < this->nodes; ++i) {
      conductivity[i] /= volume[i], saturated[i] /= volume[i], beside[i] = conductivity[i];
      const V rest = area[i] - taken[i];
      const double edge = this->mesh.mean_edge[i];
      if (rest.norm() < (dim == 2 ? 0.3 * edge : 0.09 * edge * edge)) gap[i] = rest;
      if (taken[i].norm() > 0) {  // the mean with the soil as it is beyond the face
        const double s = Phases::suction ? std::max(0., -beyond) : 0;
        beside[i] = (conductivity[i] + saturated[i] * std::pow(effective(s), 3)) / 2;
      }
    }
    this->beyond = beyond;
  }

  static double effective(double suction) { return 1 / std::sqrt(1 + std::pow(suction / curve_pressure, 2)); }
  /// S of S rho(-s(S)) = content (3.2); 1 in full pores, less the share of vapour (3.1).
  static double saturation_of(double content) {
    constexpr double thinnest = water_density * (1 - 100e3 / water_bulk);
    if (!Phases::suction) return std::min(1., content / thinnest);
    if (content >= water_density) return 1;
    double low = 0, high = 1e6;
    for (int i = 0; i < 200; ++i) {
      const double s = (low + high) / 2;
      (effective(s) * water_density * (1 - s / water_bulk) > content ? low : high) = s;
    }
    return effective(low);
  }
  /// S = 1 - y of P_g(c_g / y) - P_l(c_l / (1 - y)) = s(y) (3.3).
  static double saturation_of(double content, double of_gas) {
    double low = 0, high = 1;
    for (int i = 0; i < 200; ++i) {
      const double y = (low + high) / 2, wet = 1 - y, s = curve_pressure * std::sqrt(1 / (wet * wet) - 1);
      const double over =
          air_bulk * (of_gas / y / air_density - 1) - water_bulk * (content / wet / water_density - 1) - s;
      (over > 0 ? low : high) = y;
    }
    return 1 - low;
  }
  /// Are the pores of all cells of its patch full, so that (4.3) smooths there?
  bool full(int c) const {
    if (!Phases::suction) return true;  // of liquid, or of it and its vapour
    for (int other = 0; other < this->cells; ++other)
      if (this->mesh.patch[other] == this->mesh.patch[c] && saturation[other] < 0.99) return false;
    return true;
  }
  V point(int c, const Corners &n) const {
    V x = V::Zero();
    for (int k = 0; k <= dim; ++k) x += n[k] * this->place[this->mesh.cells[c].node[k]];
    return x;
  }
  /// A f of (4.3): means over the full cells of a node, then over the nodes of a full cell.
  std::vector<double> smoothed(std::vector<double> f) const {
    if (!smooths) return f;
    std::vector<double> sum(this->nodes, 0), all(this->nodes, 0);
    for (int c = 0; c < this->cells; ++c)
      for (int i : this->mesh.cells[c].node)
        if (full(c)) sum[i] += this->weight[c] * f[c], all[i] += this->weight[c];
    for (int c = 0; c < this->cells; ++c) {
      if (!full(c)) continue;
      f[c] = 0;
      for (int i : this->mesh.cells[c].node) f[c] += sum[i] / all[i] / (dim + 1);
    }
    return f;
  }
  /// (4.3a): pressures that act on the skeleton, and the weight of the liquid, as means over patches that are not full.
  void average_over_open_patches(std::vector<double> &p, bool bishop) const {
    std::vector<double> wet;
    for (int c = 0; c < this->cells; ++c) wet.push_back(bishop ? saturation[c] : saturation[c] >= 0.99 && p[c] > 0);
    const auto mean = this->over_patches(p, this->weight), share = this->over_patches(wet, this->weight),
               middle = this->over_patches(head, this->weight);
    for (int c = 0; c < this->cells; ++c)
      if (!full(c)) p[c] = mean[c] + share[c] * (head[c] - middle[c]);
  }
  /// Volume strain of the pores (4.7): smoothed where they are full, elsewhere that of the skeleton.
  std::vector<double> of_pores(const std::vector<double> &strain) const {
    std::vector<double> pores = smoothed(strain);
    const auto skeleton = this->over_patches(strain, this->weight);
    for (int c = 0; c < this->cells; ++c)
      if (!full(c)) pores[c] = skeleton[c];
    return pores;
  }
  /// W - V of (4.8a), in cells that are not full.
  double beyond_particles(int c) const {
    return !Phases::suction || saturation[c] >= 0.99 ? 0 : this->weight[c] - this->particle_volume[c];
  }
  /// The adjoint of (4.8a), on pressures.
  void share_pressure(std::vector<double> &p) const {
    std::vector<double> sum(this->nodes, 0), all(this->nodes, 0);
    for (int c = 0; c < this->cells; ++c)
      for (int i : this->mesh.cells[c].node)
        sum[i] += this->particle_volume[c] * p[c], all[i] += this->particle_volume[c];
    for (int c = 0; c < this->cells; ++c) {
      double around = 0;
      for (int i : this->mesh.cells[c].node) around += sum[i] / all[i] / (dim + 1);
      p[c] += beyond_particles(c) / this->weight[c] * (around - p[c]);
    }
  }
  /// Q / M of (4.6), the rate of drag [1/s].
  double drag(int i) const { return drag(i, beside[i]); }
  double drag(int i, double conductivity) const { return mass[i] * volume[i] / (whole[i] * conductivity) / whole[i]; }

  /// Accelerations of skeleton, liquid and gas (4.4), (4.5), with explicit drag (4.6b) of the velocities given.
  Fields accelerations(const Fields *velocity = nullptr) const {
    Fields a;
    a[0] = this->internal_force(this->stress, true);
    a[1].resize(this->nodes), a.back().resize(this->nodes);
    for (int i = 0; i < this->nodes; ++i) {
      const double heavier = water_density * volume[i] / whole[i];  // omega
      if (Phases::gas) a.back()[i] = air_push[i] / air_whole[i] + g;
      a[1][i] = push[i] / whole[i] + heavier * g - beyond * taken[i] / whole[i];
      a[0][i] += thrust[i] + (this->Base::mass[i] + heavier * mass[i] + air_mass[i]) * g;
    }
    for (int c = 0; c < this->cells; ++c)  // (5.1): no force of a gap
      for (int k = 0; k <= dim; ++k) {
        const int i = this->mesh.cells[c].node[k];
        const double rise = g.dot(this->place[i] - point(c, reference[c]));
        const V through = this->weight[c] * reference[c][k] / volume[i] * gap[i];
        a[1][i] -= (smooth[c] + water_density * rise) / whole[i] * through;
        if (Phases::gas) a.back()[i] -= (air_smooth[c] + air_density * rise) / air_whole[i] * through;
      }
    for (int i = 0; i < this->nodes; ++i) {
      if (velocity) a[1][i] -= drag(i) * ((*velocity)[1][i] - (*velocity)[0][i]);
      a[0][i] -= mass[i] * a[1][i];
      if (Phases::gas) a[0][i] -= air_mass[i] * a.back()[i];
      a[0][i] /= this->Base::mass[i];
    }
    return a;
  }

  bool smooths;
  double beyond = 0;
  V g = V::Zero();
  // of cells: masses, S_l, densities, weight of the liquid up to x_c, pressures in the forces of the phases and of all
  std::vector<double> liquid, gas, saturation, density, air, head, smooth, air_smooth, acting;
  std::vector<Corners> reference, row;
  // of nodes: V, m, M, conductivities (of full pores, and with what is beyond a face), G and its parts, forces of the
  // pressures
  std::vector<double> volume, mass, whole, air_mass, air_whole, conductivity, saturated, beside;
  Nodes area, push, air_push, thrust, taken, gap;
};

/// Velocities of all phases as the motion numbers nodes, and back.
template <int dim, class Phases>
std::vector<double> to_motion(const Box<dim, Phases> &box, const typename PoreEquations<dim, Phases>::Fields &x) {
  const int nodes = box.soil.mesh.node_count();
  std::vector<double> all(box.soil.motion->size());
  for (std::size_t a = 0; a < x.size(); ++a)
    for (int i = 0; i < nodes; ++i)
      for (int d = 0; d < dim; ++d) all[(a * nodes + box.soil.motion->grid().find_node(i)) * dim + d] = x[a][i][d];
  return all;
}
template <int dim, class Phases>
typename PoreEquations<dim, Phases>::Fields all_from_motion(const Box<dim, Phases> &box, const double *x) {
  const int nodes = box.soil.mesh.node_count();
  typename PoreEquations<dim, Phases>::Fields all;
  for (std::size_t a = 0; a < all.size(); ++a) {
    all[a].resize(nodes);
    for (int i = 0; i < nodes; ++i)
      for (int d = 0; d < dim; ++d) all[a][i][d] = x[(a * nodes + box.soil.motion->grid().find_node(i)) * dim + d];
  }
  return all;
}

}  // namespace talus
