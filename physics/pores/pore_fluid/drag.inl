// Drag, and the action of boundaries on velocities; theory of pores, (4.6), section 5; included only where PoreFluid is
// instantiated.
#include <algorithm>
#include <cmath>

#include "physics/pores/pore_fluid.h"

namespace talus {

/// Mass, M and resistance Q = phi V / k of a fluid at a node: the flux of a steady state is then the mean conductivity
/// times the gradient.
template <int dim, class Phases>
NodalFluid PoreFluid<dim, Phases>::at_node(int i, int a, double beyond) const {
  const NodePores &node = nodes_[i];
  const double mass = node.mass(a), whole = node.whole(a);
  if (!(whole > 0)) return {0, 0, 0};
  constexpr double closed = 1e30;  // [1/s]: where pressures are prescribed, fluids move with the grains
  double conductivity = node.conductivity(a) / node.volume();
  if (beyond > 0) conductivity = (conductivity + beyond) / 2;  // the mean with one more cell, beyond the face
  const double resistance = prescribed ? closed * whole : mass / whole * node.volume() / std::max(conductivity, 1e-300);
  return {mass, whole, resistance};
}

/// The same for implicit drag over a step: no resistance where drag is explicit, since it is one of the forces then.
template <int dim, class Phases>
NodalFluid PoreFluid<dim, Phases>::over_step(int i, int a) const {
  const NodalFluid at = at_node(i, a);
  return explicit_drag_ && !prescribed ? NodalFluid{at.mass, at.whole_mass, 0} : at;
}

/// Sum of the rates of each fluid against the skeleton, which bounds the rate of all together. Soil beyond a face may
/// be dry: half the conductivity counts there.
template <int dim, class Phases>
double PoreFluid<dim, Phases>::drag_rate(const FilledGrid<dim> &grid) const {
  double largest = 0;
  for (int i = 0; i < grid.node_count() && !prescribed; ++i) {
    double rate = 0;
    for (int a = 0; a < fluids; ++a) {
      const NodalFluid at = at_node(i, a, 0);
      rate += (Phases::suction && a == 0 ? 2 : 1) * drag_number(1, at) * (1 + at.mass / grid.mass[i]);
    }
    largest = std::max(largest, rate);
  }
  return largest;
}

/// A face or wall that stops a fluid acts on the skeleton too: fluid and skeleton share their momentum along its
/// normal. In this way a surface that lets no water in bears the suction, and a wall that supports the skeleton bears
/// the weight of the water, theory (4.6a).
template <int dim, class Phases>
void PoreFluid<dim, Phases>::apply_drag_to_solid(double step, const Frame &frame, const PoreConditions<dim> &conditions,
                                                 Vec<dim> *solid, const Vec<dim> *fluid) const {
  const FilledGrid<dim> &grid = frame.grid;
  const int nodes = grid.node_count();
  for (int i = 0; i < nodes; ++i) {
    NodalFluid at[fluids];
    for (int a = 0; a < fluids; ++a) at[a] = over_step(i, a);
    const DragOverStep<fluids> drag(step, grid.mass[i], at);
    for (int d = 0; d < dim; ++d) {
      double v[fluids];
      for (int a = 0; a < fluids; ++a) v[a] = fluid[a * nodes + i][d];
      drag.resolve(solid[i][d], v);
    }
  }
  limits(frame, conditions, [&](int i, FlowLimits<dim> &all) {
    NodalFluid at[fluids];
    double mass = grid.mass[i];  // of those that a wall stops
    for (int a = 0; a < fluids; ++a) at[a] = over_step(i, a), mass += at[a].mass;
    const Vec<dim> before = solid[i];
    const auto against = [&](int a) {
      Vec<dim> v;
      for (int d = 0; d < dim; ++d) v[d] = (fluid[a * nodes + i][d] - before[d]) / (1 + drag_number(step, at[a]));
      return v;
    };
    hold_within<dim>(all, against(0));
    for (int k = 0; k < all.count; ++k) {
      const FlowLimit<dim> &one = all.all[k];
      double momentum = at[0].mass * one.taken;
      for (int a = 1; a < fluids && one.wall; ++a) momentum -= at[a].mass * dot<dim>(against(a), one.n);
      add_scaled<dim>(solid[i], -momentum / (one.wall ? mass : grid.mass[i] + at[0].mass), one.n);
    }
  });
}

/// A support stops the skeleton, all of a fluid along the normals of walls and of faces with a flux, and in other
/// directions the part of a fluid that drag takes along in a step [kg].
template <int dim, class Phases>
Square<dim> PoreFluid<dim, Phases>::inertia(double step, const FilledGrid<dim> &grid,
                                            const PoreConditions<dim> &conditions, int i) const {
  double dragged = grid.mass[i], liquid = 0, rest = 0;
  for (int a = 0; a < fluids; ++a) {
    const NodalFluid at = over_step(i, a);
    const double free = at.mass / (1 + drag_number(step, at));
    dragged += at.mass - free, rest += free;
    if (a == 0) liquid = free;
  }
  Square<dim> inertia = dragged * Square<dim>::Identity();
  conditions.fixed_at(grid, i, [&](const Vec<dim> &n, bool all) {
    inertia += (all ? rest : liquid) * map<dim>(n) * map<dim>(n).transpose();
  });
  return inertia;
}

/// The sum of w p grad N extrapolates the pressure of the cells to the wall without its gradient. Along the normal of a
/// wall that gradient is the weight of the liquid, which is added. It is left out where the pressure is negative
/// (suction).
template <int dim, class Phases>
double PoreFluid<dim, Phases>::thrust(const Vec<dim> &gravity, int i, const Vec<dim> &n) const {
  double push = 0, weight = 0;
  for (int d = 0; d < dim; ++d)
    push += nodes_[i].push[mixture][d] * n[d], weight += liquid_.density * nodes_[i].volume() * gravity[d] * n[d];
  return Phases::suction && push <= 0 ? push : push + weight;
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::apply_drag_to_fluids(double step, const Frame &frame,
                                                  const PoreConditions<dim> &conditions, const Vec<dim> *solid,
                                                  Vec<dim> *fluid) const {
  const int nodes = frame.grid.node_count();
  for (int i = 0; i < nodes; ++i) {
    NodalFluid at[fluids];
    for (int a = 0; a < fluids; ++a) at[a] = over_step(i, a);
    const DragOverStep<fluids> drag(step, frame.grid.mass[i], at);
    for (int d = 0; d < dim; ++d) {
      double v[fluids], supported = solid[i][d];
      for (int a = 0; a < fluids; ++a) v[a] = fluid[a * nodes + i][d];
      drag.resolve(supported, v, true);
      for (int a = 0; a < fluids; ++a) fluid[a * nodes + i][d] = v[a];
    }
  }
  constrain(frame, conditions, solid, fluid);
}

template <int dim, class Phases>
template <class Hold>
void PoreFluid<dim, Phases>::limits(const Frame &frame, const PoreConditions<dim> &conditions, Hold &&hold) const {
  conditions.limits(
      frame.time, frame.grid, liquid_.density, unit_weight(frame),
      [&](int i) {
        return LiquidAtNode{nodes_[i].mass(0), nodes_[i].volume()};
      },
      [&](int i, FlowLimits<dim> &all) {
        for (int k = 0; k < all.count && prescribed; ++k) {  // a flux does nothing to a fluid that does not move
          FlowLimit<dim> &one = all.all[k];
          one.low = std::min(one.low, 0.), one.high = std::max(one.high, 0.);
        }
        hold(i, all);
      });
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::constrain(const Frame &frame, const PoreConditions<dim> &conditions, const Vec<dim> *solid,
                                       Vec<dim> *fluid) const {
  const int nodes = frame.grid.node_count();
  limits(frame, conditions, [&](int i, FlowLimits<dim> &all) {
    const auto against = [&](int a) {
      Vec<dim> v;
      for (int d = 0; d < dim; ++d) v[d] = fluid[a * nodes + i][d] - solid[i][d];
      return v;
    };
    hold_within<dim>(all, against(0));
    for (int k = 0; k < all.count; ++k) {
      const FlowLimit<dim> &one = all.all[k];
      add_scaled<dim>(fluid[i], one.taken, one.n);
      for (int a = 1; a < fluids && one.wall; ++a)
        add_scaled<dim>(fluid[a * nodes + i], -dot<dim>(against(a), one.n), one.n);
    }
  });
}

}  // namespace talus
