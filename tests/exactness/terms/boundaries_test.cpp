// What boundaries do to the velocity and the forces of a node, and the work that they do: docs/theory (3.7), (6.1) to
// (6.3), (6.6).
#include "equations.h"

namespace talus {
namespace {

template <int dim>
using Nodes = typename Equations<dim>::Nodes;

/// What boundaries and drag make of nodal velocities in a step.
template <int dim>
Nodes<dim> after_boundaries(Box<dim> &box, double step, const Nodes<dim> &v) {
  std::vector<double> x = box.to_motion(v);
  EXPECT_EQ(box.soil.motion->apply_boundaries_and_drag(0, step, x.data()), 0);
  return box.from_motion(x);
}

template <int dim>
Nodes<dim> acceleration(Box<dim> &box, const Nodes<dim> &v) {
  std::vector<double> a(box.soil.motion->size());
  const std::vector<double> velocity = box.to_motion(v);
  EXPECT_EQ(box.soil.motion->acceleration(0, nullptr, velocity.data(), a.data()), 0);
  return box.from_motion(a);
}

/// Shares of the nodes in the area of the base or the top, each facet in the proportion to which its cell is filled if
/// asked for.
template <int dim>
std::vector<double> areas(const Box<dim> &box, const Equations<dim> &exact, const char *side, bool filled) {
  std::vector<double> area(exact.nodes, 0);
  for (const Facet<dim> &f : box.soil.mesh.facets(side))
    for (int i : f.node)
      area[i] += f.area / dim * (filled ? std::min(1., exact.weight[f.cell] / exact.shape[f.cell].volume) : 1);
  return area;
}

/// Damping resists what is left of the force after supports and dashpots took their part.
template <int dim>
void damping_leaves_supports_and_dashpots_alone() {
  Box<dim> box("",
               "[boundary.base]\nkind = \"roller\"\n[boundary.top]\nkind = \"non_reflecting\"\nsupport = \"none\"\n");
  Equations<dim> exact(box.soil);
  SoilMotion<dim, Dry> &motion = *box.soil.motion;
  ASSERT_EQ(motion.begin(0), 0);
  motion.loading.damping = 0.3;
  const Nodes<dim> v = box.field(1, 1), force = exact.internal_force(exact.stress, true);
  Nodes<dim> left = force, wanted = force;
  for (const Facet<dim> &f : box.soil.mesh.facets("top")) {
    double mass = 0;
    for (int p = 0; p < exact.particles.count; ++p)
      if (exact.particles.cell[p] == f.cell) mass += exact.particles.mass[p];
    const double rho = mass / exact.particle_volume[f.cell], across = std::sqrt(rho * (bulk + 4 * shear / 3)),
                 along = std::sqrt(rho * shear);
    for (int i : f.node)
      for (int d = 0; d < dim; ++d) left[i][d] -= f.area / dim * (d == 1 ? across : along) * v[i][d];
  }
  for (int i = 0; i < exact.nodes; ++i) {
    if (box.on("base", i)) left[i][1] = 0;
    for (int d = 0; d < dim; ++d)
      wanted[i][d] = (force[i][d] - 0.3 * std::abs(left[i][d]) * (v[i][d] > 0 ? 1 : -1)) / exact.mass[i];
  }
  expect_equal<dim>(acceleration(box, v), wanted, 100, "damped");
}
TALUS_IN_2D_AND_3D(Boundaries, damping_leaves_supports_and_dashpots_alone)

/// Dashpots: rho c_p across the face and rho c_s along it, implicit in the step (6.3).
template <int dim>
void dashpots_are_implicit() {
  Box<dim> box("", "[boundary.top]\nkind = \"non_reflecting\"\nsupport = \"none\"\n");
  Equations<dim> exact(box.soil);
  ASSERT_EQ(box.soil.motion->begin(0), 0);
  const Nodes<dim> v = box.field(1, 2);
  std::vector<std::array<double, 2>> dashpot(exact.nodes, {0, 0});
  for (const Facet<dim> &f : box.soil.mesh.facets("top")) {
    double mass = 0;
    for (int p = 0; p < exact.particles.count; ++p)
      if (exact.particles.cell[p] == f.cell) mass += exact.particles.mass[p];
    const double rho = mass / exact.particle_volume[f.cell];
    for (int i : f.node)
      dashpot[i][0] += f.area / dim * std::sqrt(rho * (bulk + 4 * shear / 3)),
          dashpot[i][1] += f.area / dim * std::sqrt(rho * shear);
  }
  const double step = 2e-3;  // of the size that m / C has
  Nodes<dim> wanted = v;
  for (int i = 0; i < exact.nodes; ++i)
    for (int d = 0; d < dim; ++d) wanted[i][d] *= exact.mass[i] / (exact.mass[i] + step * dashpot[i][d != 1]);
  expect_equal<dim>(after_boundaries(box, step, v), wanted, 1, "behind dashpots");
}
TALUS_IN_2D_AND_3D(Boundaries, dashpots_are_implicit)

/// What supports bore when loads were held stays on as a dead load across the face, so that nothing is out of balance
/// there.
template <int dim>
void reactions_of_supports_stay_on() {
  Box<dim> box("", "[boundary.base]\nkind = \"non_reflecting\"\n");
  SoilMotion<dim, Dry> &motion = *box.soil.motion;
  Conditions<dim> &conditions = box.soil.conditions;
  conditions.use_stand_ins(true);
  ASSERT_EQ(motion.freeze_reactions(0), 0);
  conditions.use_stand_ins(false);
  std::vector<std::vector<int>> movers(1);
  ASSERT_EQ(motion.update_particles(0, movers), 0);
  Equations<dim> exact(box.soil);
  ASSERT_EQ(motion.begin(0), 0);
  Nodes<dim> wanted = exact.internal_force(exact.stress, true);
  for (int i = 0; i < exact.nodes; ++i) {
    if (box.on("base", i)) wanted[i][1] = 0;
    wanted[i] /= exact.mass[i];
  }
  expect_equal<dim>(acceleration(box, box.field(1, 0)), wanted, 100, "frozen");
}
TALUS_IN_2D_AND_3D(Boundaries, reactions_of_supports_stay_on)

/// Friction of a base: owed to the impulses of the last moments (6.1), (6.2), in the beginning to their mean since the
/// start, with adhesion while a node presses and for a while after.
template <int dim>
void friction_follows_the_normal_impulses_of_the_last_moments() {
  constexpr double delay = 0.017, step = 0.005, angle = 0.4, adhesion = 40;
  Box<dim> box("", "[boundary.base]\nkind = \"friction\"\nfriction_angle = \"0.4 rad\"\nadhesion = 40\n");
  box.soil.conditions.bases().set_friction_delay(delay);
  Equations<dim> exact(box.soil);
  ASSERT_EQ(box.soil.motion->begin(0), 0);
  const auto area = areas(box, exact, "base", true);
  std::vector<double> owed(exact.nodes, 0);
  Nodes<dim> v = box.field(2, 3);
  for (auto &x : v) x[0] += 4;  // slides all along
  double since_pressed = 0;
  int steps = 0;
  for (const double into : {0.5, -0.1, 0.8, 0.4, -0.1, -0.2, -0.1, -0.3, -0.4, 0.2}) {
    since_pressed = into > 0 ? 0 : since_pressed + step;
    const bool gathers = step * steps < delay;
    ++steps;
    Nodes<dim> wanted = v;
    for (int i = 0; i < exact.nodes; ++i) {
      if (!box.on("base", i)) continue;
      v[i][1] = -into;  // the base lies below
      owed[i] += exact.mass[i] * std::max(0., into) * std::tan(angle);
      const double J = (gathers ? 1. / steps : 1 - std::exp(-step / delay)) * owed[i] +
                       (since_pressed <= delay ? adhesion * area[i] * step : 0);
      if (!gathers) owed[i] *= std::exp(-step / delay);
      ColumnVector<dim> slip = v[i];
      slip[1] = 0;
      EXPECT_GT(exact.mass[i] * slip.norm(), J) << "slides";
      wanted[i] = (1 - J / (exact.mass[i] * slip.norm())) * slip;
      wanted[i][1] = std::max(0., -into);
    }
    v = after_boundaries(box, step, v);
    expect_equal<dim>(v, wanted, 1, "into the base at " + std::to_string(into));
  }
  // one that sticks stands still; local damping does not resist friction, nor the force of a node that presses
  for (int i = 0; i < exact.nodes; ++i)
    if (box.on("base", i)) v[i] *= 1e-4, v[i][1] = -3;
  const Nodes<dim> stuck = after_boundaries(box, step, v);
  for (int i = 0; i < exact.nodes; ++i)
    if (box.on("base", i)) {
      EXPECT_LT(stuck[i].norm(), 1e-14);
    }
}
TALUS_IN_2D_AND_3D(Boundaries, friction_follows_the_normal_impulses_of_the_last_moments)

/// A node that presses takes no part of the damping across the base; one that slides none by its friction, and one that
/// sticks none at all.
template <int dim>
void damping_leaves_contact_alone() {
  constexpr double step = 0.005;
  for (const bool sticks : {false, true}) {
    Box<dim> box("", "[boundary.base]\nkind = \"friction\"\nfriction_angle = \"0.4 rad\"\n");
    Equations<dim> exact(box.soil);
    SoilMotion<dim, Dry> &motion = *box.soil.motion;
    ASSERT_EQ(motion.begin(0), 0);
    Nodes<dim> v = box.field(1, 4);
    for (int i = 0; i < exact.nodes; ++i)
      if (box.on("base", i)) v[i] *= sticks ? 1e-3 : 1., v[i][0] += sticks ? 0 : 3., v[i][1] = -1;
    const Nodes<dim> after = after_boundaries(box, step, v);  // friction without delay
    motion.loading.damping = 0.3;
    const Nodes<dim> force = exact.internal_force(exact.stress, true);
    Nodes<dim> wanted = force;
    for (int i = 0; i < exact.nodes; ++i) {
      ColumnVector<dim> left = force[i];
      if (box.on("base", i)) {
        const double rubbing = exact.mass[i] * std::tan(0.4) / step;
        ColumnVector<dim> slip = after[i];
        slip[1] = 0;
        if (sticks)
          left.setZero(), left[1] = std::max(0., force[i][1]);
        else
          left -= rubbing * slip / slip.norm(), left[1] = std::max(0., force[i][1]);
      }
      for (int d = 0; d < dim; ++d) {
        const double power = left[d] * after[i][d];
        wanted[i][d] = (force[i][d] - 0.3 * left[d] * ((power > 0) - (power < 0))) / exact.mass[i];
      }
    }
    expect_equal<dim>(acceleration(box, after), wanted, 1000, sticks ? "sticks" : "slides");
  }
}
TALUS_IN_2D_AND_3D(Boundaries, damping_leaves_contact_alone)

/// A plate gives its velocity to the nodes of its face: all of it, or its part across the face.
template <int dim>
void plates_give_their_velocity() {
  for (const bool smooth : {false, true}) {
    Box<dim> box("", std::string("[boundary.top]\nkind = \"velocity\"\nvelocity = [\"1 + x\", \"2 * x\"") +
                         (dim == 3 ? ", \"3\"" : "") + "]\nsmooth = " + (smooth ? "true" : "false") +
                         "\n[boundary.base]\nkind = \"roller\"\n");
    ASSERT_EQ(box.soil.motion->begin(0), 0);
    const Nodes<dim> v = box.field(1, 5);
    Nodes<dim> wanted = v;
    for (int i = 0; i < box.soil.mesh.node_count(); ++i) {
      const double x = box.soil.mesh.position[i][0];
      if (box.on("base", i)) wanted[i][1] = 0;
      if (!box.on("top", i)) continue;
      if (!smooth) wanted[i].setConstant(3), wanted[i][0] = 1 + x;
      wanted[i][1] = 2 * x;
    }
    expect_equal<dim>(after_boundaries(box, 0.1, v), wanted, 1, smooth ? "smooth" : "rough");
  }
}
TALUS_IN_2D_AND_3D(Boundaries, plates_give_their_velocity)

/// The ledger: forces times the way of the nodes, the impulses of supports over the step likewise (6.6).
template <int dim>
void work_is_force_times_way() {
  constexpr double step = 0.1;
  const std::string third = dim == 3 ? ", 0" : "";
  Box<dim> box("body_acceleration = [4, 7" + third + "]",
               "[boundary.top]\nkind = \"traction\"\ntraction = [300, 500" + third +
                   "]\n[boundary.base]\nkind = \"velocity\"\nvelocity = [0.3, 0" + third + "]\n");
  Equations<dim> exact(box.soil);
  SoilMotion<dim, Dry> &motion = *box.soil.motion;
  motion.loading.gravity = Vec<dim>{0, -9.81}, motion.loading.ramp = 0.5;
  ASSERT_EQ(motion.begin(0), 0);
  motion.loading.damping = 0.3;
  const Nodes<dim> v = box.field(1, 6);
  const Nodes<dim> damped = acceleration(box, v);
  motion.loading.damping = 0;
  const Nodes<dim> free = acceleration(box, v);
  motion.loading.damping = 0.3;
  acceleration(box, v);
  const Nodes<dim> held = after_boundaries(box, step, v);
  // a shift of the whole in which no stress does work; loads are uniform
  Nodes<dim> u(exact.nodes, ColumnVector<dim>::Zero());
  double mass = 0, by_base = 0, by_damping = 0;
  for (int i = 0; i < exact.nodes; ++i) {
    u[i][0] = 2e-3, u[i][1] = 1e-3;
    mass += exact.mass[i];
    by_base += exact.mass[i] * (held[i] - v[i]).dot(u[i]) / step;
    by_damping += exact.mass[i] * (damped[i] - free[i]).dot(u[i]);
  }
  const std::vector<double> way = box.to_motion(u), velocity = box.to_motion(held);
  ASSERT_EQ(motion.accept(step, way.data(), velocity.data()), 0);
  EXPECT_NEAR(box.soil.conditions.work()[0], 300 * 2e-3 + 500 * 1e-3, 1e-12) << "the load";
  EXPECT_NEAR(box.soil.conditions.work()[1], by_base, 1e-9) << "the plate";
  EXPECT_NEAR(motion.work().gravity, -0.5 * 9.81 * mass * 1e-3, 1e-9);
  EXPECT_NEAR(motion.work().imposed, mass * (4 * 2e-3 + 7 * 1e-3), 1e-9) << "body accelerations";
  EXPECT_NEAR(motion.work().damping, by_damping, 1e-9);
  EXPECT_NE(by_damping, 0);
  std::vector<Vec<dim>> impulse;
  ASSERT_EQ(box.soil.conditions.take_impulses(PETSC_COMM_WORLD, impulse), 0);
  double along = 0;
  for (int i = 0; i < exact.nodes; ++i) along += exact.mass[i] * (held[i] - v[i])[0];
  EXPECT_NEAR(impulse[1][0], along, 1e-9) << "impulse of the plate";
}
TALUS_IN_2D_AND_3D(Boundaries, work_is_force_times_way)

/// Energies: m v^2 / 2 of the particles, and what stress stores in the volumes on which it does work.
template <int dim>
void balance_sums_what_particles_have() {
  Box<dim> box("", "[boundary.base]\nkind = \"fixed\"\n");
  Equations<dim> exact(box.soil);
  SoilMotion<dim, Dry> &motion = *box.soil.motion;
  motion.loading.gravity = Vec<dim>{0, -9.81};
  ASSERT_EQ(motion.begin(0), 0);
  Nodes<dim> force = exact.internal_force(exact.stress, true);
  double kinetic = 0, stored = 0, unbalanced = 0, applied = 0;
  for (int i = 0; i < exact.nodes; ++i) {
    force[i][1] -= 9.81 * exact.mass[i], applied += 9.81 * exact.mass[i];
    if (box.on("base", i)) force[i].setZero();
    unbalanced += force[i].norm();
  }
  for (int p = 0; p < exact.particles.count; ++p)  // right after the gather (4.10a) is v_p itself
    kinetic += exact.particles.mass[p] / 2 * exact.velocity[p].squaredNorm();
  for (int c = 0; c < exact.cells; ++c) {
    const Tensor dev = exact.stress[c] - exact.stress[c].trace() / 3 * Tensor::Identity();
    stored +=
        exact.weight[c] * (std::pow(exact.stress[c].trace() / 3, 2) / (2 * bulk) + dev.squaredNorm() / (4 * shear));
  }
  Balance sums;
  ASSERT_EQ(motion.balance(0, &sums), 0);
  EXPECT_NEAR(sums.kinetic, kinetic, 1e-9 * kinetic);
  EXPECT_NEAR(sums.strain, stored, 1e-9 * stored);
  EXPECT_NEAR(sums.unbalanced, unbalanced, 1e-9 * unbalanced);
  EXPECT_NEAR(sums.applied, applied, 1e-9 * applied);
}
TALUS_IN_2D_AND_3D(Boundaries, balance_sums_what_particles_have)

}  // namespace
}  // namespace talus
