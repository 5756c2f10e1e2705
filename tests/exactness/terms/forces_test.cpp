// Forces and accelerations, docs/theory (2.2), (2.8), (2.9), (3.5) to (3.7), (4.1) to (4.5), (4.8), (6.4).
#include "equations.h"

namespace talus {
namespace {

template <int dim>
using Nodes = typename Equations<dim>::Nodes;

template <int dim, class Phases = Dry>
Nodes<dim> acceleration(Box<dim, Phases> &box, const Nodes<dim> &v) {
  std::vector<double> a(box.soil.motion->size());
  const std::vector<double> velocity = box.to_motion(v);
  EXPECT_EQ(box.soil.motion->acceleration(0, nullptr, velocity.data(), a.data()), 0);
  return box.from_motion(a);
}

/// Stress, gravity halfway up its ramp, and the accelerations of a body, on soil that fills its nodes in part.
template <int dim>
void forces_are_those_of_stress_gravity_and_body_accelerations() {
  for (const bool patches : {true, false}) {
    Box<dim> box(
        std::string("body_acceleration = [\"3 + 2 * x\", \"1 - y * t\"") + (dim == 3 ? ", \"x * z\"" : "") + "]",
        patches ? "" : "[transfer]\nlocking = \"none\"\n");
    Equations<dim> exact(box.soil);
    SoilMotion<dim, Dry> &motion = *box.soil.motion;
    motion.loading.gravity = Vec<dim>{1, -9.81}, motion.loading.ramp = 0.5, motion.loading.time = 2;
    ASSERT_EQ(motion.begin(0), 0);
    for (const double b : exact.blend) EXPECT_TRUE(b > 0.05 && b < 0.95) << b << ": (4.4) is between its ends";
    Nodes<dim> wanted = exact.internal_force(exact.stress, patches);
    for (int p = 0; p < exact.particles.count; ++p) {
      const Vec<dim> &X = exact.particles.reference[p];
      ColumnVector<dim> b = ColumnVector<dim>::Zero();
      b[0] = 3 + 2 * X[0], b[1] = 1 - X[1] * 2;
      if (dim == 3) b[dim - 1] = X[0] * X[dim - 1];
      for (int k = 0; k <= dim; ++k)
        wanted[exact.mesh.cells[exact.particles.cell[p]].node[k]] += exact.particles.mass[p] * exact.N[p][k] * b;
    }
    for (int i = 0; i < exact.nodes; ++i) {
      EXPECT_NEAR(motion.grid().mass[motion.grid().find_node(i)], exact.mass[i], 1e-12 * exact.mass[i]);
      wanted[i] /= exact.mass[i];
      wanted[i][0] += 0.5, wanted[i][1] -= 0.5 * 9.81;
    }
    expect_equal<dim>(acceleration(box, box.field(1, 0)), wanted, 100, patches ? "with patches" : "without");
  }
}
TALUS_IN_2D_AND_3D(Forces, forces_are_those_of_stress_gravity_and_body_accelerations)

/// Each component of the force is cut where it does work on the node, and grown where it takes some, by the factor.
template <int dim>
void local_damping_resists_the_motion_component_by_component() {
  Box<dim> box;
  Equations<dim> exact(box.soil);
  SoilMotion<dim, Dry> &motion = *box.soil.motion;
  ASSERT_EQ(motion.begin(0), 0);
  motion.loading.damping = 0.3;
  const Nodes<dim> v = box.field(1, 1);
  Nodes<dim> wanted = exact.internal_force(exact.stress, true);
  for (int i = 0; i < exact.nodes; ++i)
    for (int d = 0; d < dim; ++d) wanted[i][d] *= (wanted[i][d] * v[i][d] > 0 ? 0.7 : 1.3) / exact.mass[i];
  expect_equal<dim>(acceleration(box, v), wanted, 100, "damped");
}
TALUS_IN_2D_AND_3D(Forces, local_damping_resists_the_motion_component_by_component)

/// A node without mass takes no force, one of a tiny mass does (3.7).
template <int dim>
void light_nodes_are_not_accelerated() {
  for (const double near : {0., 1e-10}) {
    Box<dim> box;
    ParticleArrays<dim> &p = box.soil.particles();
    int corner = 0;
    for (int i = 0; i < box.soil.mesh.node_count(); ++i)
      if (map<dim>(box.soil.mesh.position[i]).norm() < 1e-12) corner = i;
    for (int k = 0; k < p.count; ++k) {  // all particles around the corner come to lie almost on the opposite side
      const Cell<dim> &cell = box.soil.mesh.cells[p.cell[k]];
      auto n = barycentric(cell, p.position[k]);
      const auto found = std::find(cell.node.begin(), cell.node.end(), corner);
      if (found == cell.node.end()) continue;
      const double before = n[found - cell.node.begin()];
      Vec<dim> x{};
      for (int j = 0; j <= dim; ++j) {
        n[j] = cell.node[j] == corner ? near : n[j] * (1 - near) / (1 - before);
        for (int d = 0; d < dim; ++d) x[d] += n[j] * box.soil.mesh.position[cell.node[j]][d];
      }
      p.position[k] = x;
    }
    Equations<dim> exact(box.soil);
    ASSERT_EQ(box.soil.motion->begin(0), 0);
    Nodes<dim> wanted = exact.internal_force(exact.stress, true);
    for (int i = 0; i < exact.nodes; ++i) wanted[i] /= exact.mass[i];
    EXPECT_GT(wanted[corner].norm(), near > 0 ? 1e9 : 1e3) << "a force is there";
    if (near == 0) wanted[corner].setZero();
    const Nodes<dim> found = acceleration(box, box.field(1, 0));
    const double round_off = 1e-16 / 1e-10 * 100;  // of a share of 1e-10 from coordinates
    expect_equal<dim>({found[corner]}, {wanted[corner]}, round_off * (near > 0 ? wanted[corner].norm() : 1) / 1e-11,
                      "at the corner");
  }
}
TALUS_IN_2D_AND_3D(Forces, light_nodes_are_not_accelerated)

/// Blends of the alternatives to (4.4): by the volume of particles, of cells, and of cells that are full.
template <int dim>
void integration_volumes_are_those_that_the_scene_asks_for() {
  for (const char *integration : {"particle", "cell", "mixed"})
    for (const double filled : {0.45, 0.85, 0.95}) {
      Box<dim> box("", std::string("[transfer]\nlocking = \"none\"\nintegration = \"") + integration + "\"\n");
      for (int p = 0; p < box.soil.particles().count; ++p)
        box.soil.particles().volume[p] = box.soil.particles().initial_volume[p] * filled;
      Equations<dim> exact(box.soil);
      ASSERT_EQ(box.soil.motion->begin(0), 0);
      const bool cell = std::string(integration) == "cell" ? filled > 0.5 : integration[0] == 'm' && filled > 0.9;
      exact.blend.assign(exact.cells, cell);
      exact.weight = exact.weights(exact.particle_volume, exact.shape);
      Nodes<dim> wanted = exact.internal_force(exact.stress, false);
      for (int i = 0; i < exact.nodes; ++i) wanted[i] /= exact.mass[i];
      expect_equal<dim>(acceleration(box, box.field(1, 0)), wanted, 100, integration + std::to_string(filled));
    }
}
TALUS_IN_2D_AND_3D(Forces, integration_volumes_are_those_that_the_scene_asks_for)

/// A load on the top: force and moment are those of the face, and a pressure pushes.
template <int dim>
void loads_act_on_the_face() {
  const std::string zero = dim == 3 ? ", 0" : "";
  for (const std::string &load : {"traction = [300, 500" + zero + "]", std::string("pressure = 700")}) {
    Box<dim> box("", "[boundary.top]\nkind = \"traction\"\n" + load + "\n", 0, false);
    Equations<dim> exact(box.soil);
    ASSERT_EQ(box.soil.motion->begin(0), 0);
    Nodes<dim> force = acceleration(box, box.field(1, 0));
    ColumnVector<dim> sum = ColumnVector<dim>::Zero();
    double moment[2]{};
    for (int i = 0; i < exact.nodes; ++i) {
      force[i] *= exact.mass[i], sum += force[i];
      for (int k = 0; k < 2; ++k) moment[k] += exact.place[i][0] * force[i][k];
      if (!box.on("top", i) && exact.place[i][1] < 0.3) {
        EXPECT_LT(force[i].norm(), 1e-9) << "far from the face";
      }
    }
    const bool traction = load[0] == 't';
    const double along = traction ? 300 : 0, across = traction ? 500 : -700;
    EXPECT_NEAR(sum[0], along, 1e-9);
    EXPECT_NEAR(sum[1], across, 1e-9);
    EXPECT_NEAR(moment[0], along / 2, 1e-9);
    EXPECT_NEAR(moment[1], across / 2, 1e-9);
  }
}
TALUS_IN_2D_AND_3D(Forces, loads_act_on_the_face)

/// Prescribed pore pressure as a body force (2.8), or as a part of the stress (2.9).
template <int dim>
void pore_pressure_acts_as_the_scene_says() {
  for (const bool open : {true, false}) {
    Box<dim, Drained> box(
        "", std::string("[water]\ntable = [[0, 1.5], [1, 2.5]]\nexcess = \"300 * x * y\"\nopen_water_load = ") +
                (open ? "true\n" : "false\n"));
    Equations<dim, Drained> exact(box.soil);
    for (int p = 0; p < exact.particles.count; ++p)  // as heavy as (2.2) says: no water is missing
      box.soil.particles().mass[p] = exact.particles.initial_volume[p] * (0.6 * 2500 + 0.4 * 1000);
    Equations<dim, Drained> heavy(box.soil);
    ASSERT_EQ(box.soil.motion->begin(0), 0);
    Nodes<dim> wanted = heavy.internal_force(heavy.stress, true);
    for (int c = 0; c < heavy.cells; ++c) {
      const auto &node = heavy.mesh.cells[c].node;
      ColumnVector<dim> gradient = ColumnVector<dim>::Zero();
      double pressure = 0;
      for (int k = 0; k <= dim; ++k) {
        const auto &x = heavy.place[node[k]];
        const double p = 9810 * (1.5 + x[0] - x[1]) + 300 * x[0] * x[1];
        gradient += p * heavy.shape[c].gradient.row(k).transpose();
        pressure +=
            p * (heavy.blend[c] / (dim + 1) + (1 - heavy.blend[c]) * heavy.share[c][k] / heavy.particle_volume[c]);
      }
      for (int k = 0; k <= dim; ++k)
        wanted[node[k]] +=
            open ? ColumnVector<dim>(-heavy.share[c][k] * gradient)
                 : ColumnVector<dim>(heavy.weight[c] * pressure * heavy.shape[c].gradient.row(k).transpose());
    }
    for (int i = 0; i < heavy.nodes; ++i) wanted[i] /= heavy.mass[i];
    expect_equal<dim>(acceleration<dim, Drained>(box, box.field(1, 0)), wanted, 100, open ? "(2.8)" : "(2.9)");
  }
}
TALUS_IN_2D_AND_3D(Forces, pore_pressure_acts_as_the_scene_says)

/// Water that pores have taken up since seeding weighs and has no inertia (3.5).
template <int dim>
void water_gained_has_weight_but_no_inertia() {
  Box<dim, Drained> box("", "[water]\ntable = [[0, 10], [1, 10]]\n", 0, false);
  for (int p = 0; p < box.soil.particles().count; ++p)
    box.soil.particles().mass[p] = box.soil.particles().initial_volume[p] * 0.6 * 2500;  // seeded dry
  SoilMotion<dim, Drained> &motion = *box.soil.motion;
  motion.loading.gravity = Vec<dim>{0, -9.81};
  ASSERT_EQ(motion.begin(0), 0);
  Equations<dim, Drained> exact(box.soil);
  Nodes<dim> wanted(exact.nodes, ColumnVector<dim>::Zero());
  for (int i = 0; i < exact.nodes; ++i) {
    const double volume = exact.mass[i] / (0.6 * 2500);
    wanted[i][1] = (9810 * volume - 9.81 * (0.6 * 2500 + 0.4 * 1000) * volume) / exact.mass[i];  // uplift and weight
  }
  expect_equal<dim>(acceleration<dim, Drained>(box, box.field(1, 0)), wanted, 100, "risen table");
}
TALUS_IN_2D_AND_3D(Forces, water_gained_has_weight_but_no_inertia)

}  // namespace
}  // namespace talus
