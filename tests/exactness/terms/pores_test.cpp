// Pore water and gas that move: docs/theory/pores.md (2.1), (3.1) to (3.3), (4.2) to (4.8a), (5.1), on a few cells.
#include <petscsys.h>

#include "base/eigenvalues.h"
#include "physics/pores/pore_fluid.inl"  // emits what libraries have only inline
#include "pore_equations.h"

namespace talus {
namespace {

/// Calls test<2, Phases>() and test<3, Phases>() for full pores and for pores with gas at rest.
#define TALUS_IN_FULL_AND_OPEN_PORES(test)                       \
  TEST(Pores, test##_saturated_2d) { test<2, Saturated>(); }     \
  TEST(Pores, test##_saturated_3d) { test<3, Saturated>(); }     \
  TEST(Pores, test##_unsaturated_2d) { test<2, Unsaturated>(); } \
  TEST(Pores, test##_unsaturated_3d) { test<3, Unsaturated>(); }

/// Curves are tabulated to 2e-6 where pores hold gas; the rest is round-off.
template <class Phases>
constexpr double curves = Phases::suction ? 1e6 : 1;

template <int dim, class Phases>
using Nodes = typename Equations<dim, Phases>::Nodes;
template <int dim, class Phases>
using Fields = typename PoreEquations<dim, Phases>::Fields;

template <int dim, class Phases>
void expect_equal(const Fields<dim, Phases> &found, const Fields<dim, Phases> &wanted, double scale,
                  const std::string &what) {
  const char *phase[] = {", skeleton", ", liquid", ", gas"};
  for (std::size_t a = 0; a < found.size(); ++a) talus::expect_equal<dim>(found[a], wanted[a], scale, what + phase[a]);
}
/// Velocities of all phases that look drawn.
template <int dim, class Phases>
Fields<dim, Phases> fields(const Box<dim, Phases> &box, double size, int number) {
  Fields<dim, Phases> all;
  for (auto &one : all) one = box.field(size, number++);
  return all;
}

/// Pressure, weight and inertia of all phases, with a pressure beyond the top and without.
template <int dim, class Phases>
void pressure_and_weight_accelerate_the_phases() {
  for (const bool smooths : {true, false})
    for (const bool bishop : {false, true})
      for (const bool pressed : {false, true}) {
        WetBox<dim, Phases> box(water(std::string("stress = \"") + (bishop ? "bishop" : "net") +
                                      "\"\n[transfer]\npore_smoothing = \"" + (smooths ? "nodal" : "none") + "\"\n") +
                                (pressed ? "[boundary.top]\nkind = \"pore_pressure\"\npressure = 5e3\n" : ""));
        const PoreEquations<dim, Phases> exact(box.soil, smooths, bishop, pressed ? "top" : nullptr, 5e3);
        ASSERT_EQ(box.soil.motion->begin(0), 0);
        const Fields<dim, Phases> v = fields(box, 1, 1);
        std::vector<double> a(box.soil.motion->size());
        ASSERT_EQ(box.soil.motion->acceleration(0, nullptr, to_motion(box, v).data(), a.data()), 0);
        expect_equal<dim, Phases>(all_from_motion(box, a.data()), exact.accelerations(), 1000 * curves<Phases>,
                                  std::string(smooths ? "smoothed" : "as they are") + (bishop ? ", bishop" : "") +
                                      (pressed ? ", pressed" : ""));
      }
}
TALUS_IN_FULL_AND_OPEN_PORES(pressure_and_weight_accelerate_the_phases)
TEST(Pores, pressure_and_weight_accelerate_all_three_phases_2d) {
  pressure_and_weight_accelerate_the_phases<2, ThreePhase>();
}
TEST(Pores, pressure_and_weight_accelerate_all_three_phases_3d) {
  pressure_and_weight_accelerate_the_phases<3, ThreePhase>();
}

/// Explicit drag is one of the forces (4.6b), with more conductivity beside a face with a prescribed pressure.
template <int dim, class Phases>
void explicit_drag_is_a_force() {
  for (const double pressure : {0., 5e3, -5e3}) {
    if (pressure < 0 && !Phases::suction) continue;
    WetBox<dim, Phases> box(
        water("drag = \"explicit\"\n") +
        (pressure ? "[boundary.top]\nkind = \"pore_pressure\"\npressure = " + std::to_string(pressure) + "\n" : ""));
    const PoreEquations<dim, Phases> exact(box.soil, true, false, pressure ? "top" : nullptr, pressure);
    ASSERT_EQ(box.soil.motion->begin(0), 0);
    const Fields<dim, Phases> v = fields(box, 1, 1);
    std::vector<double> a(box.soil.motion->size());
    ASSERT_EQ(box.soil.motion->acceleration(0, nullptr, to_motion(box, v).data(), a.data()), 0);
    expect_equal<dim, Phases>(all_from_motion(box, a.data()), exact.accelerations(&v), 1e4 * curves<Phases>, "(4.6b)");
    double rate = 0;  // (6.1a), by which explicit drag limits the step
    for (int i = 0; i < exact.nodes; ++i)
      rate = std::max(rate, (Phases::suction ? 2 : 1) * exact.drag(i, exact.conductivity[i]) *
                                (1 + exact.mass[i] / exact.Equations<dim, Phases>::mass[i]));
    EXPECT_NEAR(box.soil.motion->drag_rate() / rate, 1, 1e-11 * curves<Phases>) << "(6.1a)";
  }
}
TALUS_IN_FULL_AND_OPEN_PORES(explicit_drag_is_a_force)

/// Implicit drag over a step (4.6), with more conductivity beside a face with a prescribed pressure.
template <int dim>
void drag_brings_phases_together() {
  constexpr double step = 2e-3;
  for (const bool pressed : {false, true}) {
    WetBox<dim, Saturated> box(water() + (pressed ? "[boundary.top]\nkind = \"pore_pressure\"\npressure = 5e3\n" : ""));
    const PoreEquations<dim, Saturated> exact(box.soil, true, false, pressed ? "top" : nullptr, 5e3);
    ASSERT_EQ(box.soil.motion->begin(0), 0);
    const Fields<dim, Saturated> v = fields(box, 1, 1);
    std::vector<double> x = to_motion(box, v);
    ASSERT_EQ(box.soil.motion->apply_boundaries_and_drag(0, step, x.data()), 0);
    auto wanted = v;
    for (int i = 0; i < exact.nodes; ++i) {
      const double d = step * exact.drag(i), part = exact.mass[i] * d / (1 + d),
                   m = exact.Equations<dim, Saturated>::mass[i];
      EXPECT_TRUE(d > 0.1 && d < 10) << d << ": neither free nor bound";
      wanted[0][i] = (m * v[0][i] + part * v[1][i]) / (m + part);
      wanted[1][i] = (v[1][i] + d * wanted[0][i]) / (1 + d);
    }
    expect_equal<dim, Saturated>(all_from_motion(box, x.data()), wanted, 1, pressed ? "(4.6), pressed" : "(4.6)");
  }
}
TALUS_IN_2D_AND_3D(Pores, drag_brings_phases_together)

/// A face that no water passes, or a given flux, acts on the skeleton too: both share their momentum along its normal
/// (4.6a).
template <int dim>
void faces_that_limit_the_flux_act_on_both_phases() {
  constexpr double step = 2e-3, inflow = 0.3;
  for (const bool wall : {true, false}) {
    WetBox<dim, Saturated> box(water() + (wall ? "[boundary.top]\nkind = \"impermeable\"\n"
                                               : "[boundary.top]\nkind = \"flux\"\ninflow = 0.3\n"));
    const PoreEquations<dim, Saturated> exact(box.soil, true, false, nullptr);
    ASSERT_EQ(box.soil.motion->begin(0), 0);
    const Fields<dim, Saturated> v = fields(box, 1, 1);
    std::vector<double> x = to_motion(box, v);
    ASSERT_EQ(box.soil.motion->apply_boundaries_and_drag(0, step, x.data()), 0);
    auto wanted = v;
    for (int i = 0; i < exact.nodes; ++i) {
      const double d = step * exact.drag(i), ml = exact.mass[i], part = ml * d / (1 + d),
                   m = exact.Equations<dim, Saturated>::mass[i];
      wanted[0][i] = (m * v[0][i] + part * v[1][i]) / (m + part);
      const double out = (v[1][i] - wanted[0][i])[1] / (1 + d),
                   limit = wall ? 0 : -inflow * water_density * exact.volume[i] / ml;
      if (box.on("top", i)) wanted[0][i][1] += ml * (out - limit) / (m + ml);
      wanted[1][i] = (v[1][i] + d * wanted[0][i]) / (1 + d);
      if (box.on("top", i)) wanted[1][i][1] = wanted[0][i][1] + limit;
    }
    expect_equal<dim, Saturated>(all_from_motion(box, x.data()), wanted, 1, wall ? "wall" : "flux");
  }
}
TALUS_IN_2D_AND_3D(Pores, faces_that_limit_the_flux_act_on_both_phases)

/// Where fluids do not move no flux is there to act: liquid and skeleton have one velocity, and keep their momentum.
template <int dim>
void a_flux_does_nothing_where_fluids_stand() {
  for (const char *inflow : {"0.3", "-0.3"}) {
    WetBox<dim, Saturated> box(water(std::string("[boundary.top]\nkind = \"flux\"\ninflow = ") + inflow + "\n"));
    const PoreEquations<dim, Saturated> exact(box.soil, true, false, nullptr);
    box.soil.motion->loading.pore_flow = false;
    ASSERT_EQ(box.soil.motion->begin(0), 0);
    auto wanted = fields(box, 1, 1);
    std::vector<double> x = to_motion(box, wanted);
    ASSERT_EQ(box.soil.motion->apply_boundaries_and_drag(0, 2e-3, x.data()), 0);
    const auto found = all_from_motion(box, x.data());
    for (int i = 0; i < exact.nodes; ++i) {
      const double gap = (found[1][i] - found[0][i]).norm();
      EXPECT_LT(gap, 1e-4) << "inflow " << inflow << ", node " << i;
    }
  }
}
TALUS_IN_2D_AND_3D(Pores, a_flux_does_nothing_where_fluids_stand)

/// The surface of the soil, where it is sealed, lets no liquid through along its normal.
template <int dim>
void a_wall_on_the_free_surface_seals_it() {
  for (const bool sealed : {true, false}) {
    WetBox<dim, Saturated> box(
        water(sealed ? "[boundary.seal]\ngroup = \"free_surface\"\nkind = \"impermeable\"\n" : ""));
    const PoreEquations<dim, Saturated> exact(box.soil, true, false, nullptr);
    ASSERT_EQ(box.soil.motion->begin(0), 0);
    std::vector<double> x = to_motion(box, fields(box, 1, 1));
    ASSERT_EQ(box.soil.motion->apply_boundaries_and_drag(0, 2e-3, x.data()), 0);
    const auto after = all_from_motion(box, x.data());
    int surface = 0, passes = 0;
    for (int i = 0; i < exact.nodes; ++i) {
      if (exact.gap[i].norm() > 0 || exact.area[i].norm() < 1e-9) continue;
      ++surface, passes += std::abs((after[1][i] - after[0][i]).dot(exact.area[i].normalized())) > 1e-9;
    }
    ASSERT_GT(surface, 2);
    EXPECT_EQ(passes, sealed ? 0 : surface);
  }
}
TALUS_IN_2D_AND_3D(Pores, a_wall_on_the_free_surface_seals_it)

/// A support takes the momentum of the skeleton and of all water along the normal of its wall, or of a face through
/// which water is pumped.
template <int dim>
void supports_stop_skeleton_and_water() {
  for (const double inflow : {0., 0.3}) {
    const bool pumps = inflow > 0;
    WetBox<dim, Saturated> box(water() + "[boundary.base]\nkind = \"roller\"\n" +
                               (pumps ? "[boundary.pump]\ngroup = \"base\"\nkind = \"flux\"\ninflow = 0.3\n" : ""));
    const PoreEquations<dim, Saturated> exact(box.soil, true, false);
    ASSERT_EQ(box.soil.motion->begin(0), 0);
    const Fields<dim, Saturated> v = fields(box, 1, 1);
    std::vector<double> x = to_motion(box, v);
    std::vector<Vec<dim>> impulse;
    ASSERT_EQ(box.soil.conditions.take_impulses(PETSC_COMM_WORLD, impulse), 0);
    ASSERT_EQ(box.soil.motion->apply_boundaries_and_drag(0, 2e-3, x.data()), 0);
    ASSERT_EQ(box.soil.conditions.take_impulses(PETSC_COMM_WORLD, impulse), 0);
    const auto after = all_from_motion(box, x.data());
    double wanted = 0;
    for (int i = 0; i < exact.nodes; ++i) {
      if (!box.on("base", i)) continue;
      const double in = inflow * water_density * exact.volume[i] / exact.mass[i];  // against the skeleton, upwards
      wanted -= exact.Equations<dim, Saturated>::mass[i] * v[0][i][1] + exact.mass[i] * (v[1][i][1] - in);
      EXPECT_LT(std::abs(after[0][i][1]) + std::abs(after[1][i][1] - in), 1e-12);
    }
    EXPECT_NEAR(impulse[0][1], wanted, 1e-9) << "inflow " << inflow;
  }
}
TALUS_IN_2D_AND_3D(Pores, supports_stop_skeleton_and_water)

/// What particles give to the nodes, and what is mapped back from step to step, for both phases by the same operator.
template <int dim>
void velocities_of_both_phases_are_mapped_back() {
  constexpr double step = 0.03;
  for (const double tau : {0., 0.2}) {
    WetBox<dim, Saturated> box(water(), tau);
    const PoreEquations<dim, Saturated> exact(box.soil, true, false);
    SoilMotion<dim, Saturated> &motion = *box.soil.motion;
    ASSERT_EQ(motion.begin(0), 0);
    const auto start = all_from_motion(box, motion.velocity());
    Nodes<dim, Saturated> liquid(exact.nodes, ColumnVector<dim>::Zero());
    for (int p = 0; p < exact.particles.count; ++p) {
      const int c = exact.particles.cell[p];
      for (int k = 0; k <= dim; ++k)
        liquid[exact.mesh.cells[c].node[k]] += exact.liquid[c] / exact.row[c].sum() * exact.particles.mass[p] *
                                               exact.N[p][k] * map<dim>(exact.particles.fluid_velocity[0][p]);
    }
    for (int i = 0; i < exact.nodes; ++i) liquid[i] /= exact.mass[i];
    expect_equal<dim, Saturated>(start, {exact.start, liquid}, 1, "gathered");
    Fields<dim, Saturated> before = start;
    for (const int number : {1, 3}) {  // the mapped velocity of a step is where the next one starts
      const Fields<dim, Saturated> v = fields(box, 1, number);
      std::vector<double> x = to_motion(box, v), mapped(x.size());
      ASSERT_EQ(motion.map_back(step, step, x.data(), mapped.data()), 0);
      const double kept = tau > 0 ? std::exp(-step / tau) : 1;
      auto wanted = v;
      for (int a = 0; a < 2; ++a) {
        for (int i = 0; i < exact.nodes; ++i) wanted[a][i] = v[a][i] - kept * before[a][i];
        wanted[a] = exact.back_and_forth(wanted[a]);
        for (int i = 0; i < exact.nodes; ++i) wanted[a][i] += kept * before[a][i];
      }
      expect_equal<dim, Saturated>(all_from_motion(box, mapped.data()), wanted, 1, "mapped");
      expect_equal<dim, Saturated>(all_from_motion(box, x.data()), wanted, 1, "velocity of the nodes");
      before = wanted;
    }
  }
}
TALUS_IN_2D_AND_3D(Pores, velocities_of_both_phases_are_mapped_back)

/// Volumes follow the skeleton and masses the flux (4.7), (4.8), (4.8a), without gaps (5.1).
template <int dim, class Phases>
void volumes_and_masses_follow_the_motion() {
  for (const bool smooths : {true, false}) {
    WetBox<dim, Phases> box(
        water(std::string("[transfer]\npore_smoothing = \"") + (smooths ? "nodal" : "none") + "\"\n"));
    const PoreEquations<dim, Phases> exact(box.soil, smooths, false);
    SoilMotion<dim, Phases> &motion = *box.soil.motion;
    ASSERT_EQ(motion.begin(0), 0);
    const Fields<dim, Phases> u = fields(box, 1e-3, 1);
    const std::vector<double> way = to_motion(box, u), v(way.size(), 0.),
                              volume_before = exact.Equations<dim, Phases>::volume;
    std::vector<double> theta, divergence;
    for (int c = 0; c < exact.cells; ++c) {
      Square<dim> F = Square<dim>::Identity();
      double out = 0;
      for (int k = 0; k <= dim; ++k) {
        const int i = exact.mesh.cells[c].node[k];
        const ColumnVector<dim> gradient = exact.shape[c].gradient.row(k).transpose(),
                                q = exact.mass[i] / exact.volume[i] * (u[1][i] - u[0][i]);
        F += u[0][i] * gradient.transpose();
        out += q.dot(gradient - exact.reference[c][k] / exact.volume[i] * exact.gap[i]);
      }
      theta.push_back(std::log(F.determinant())), divergence.push_back(out);
    }
    theta = exact.of_pores(theta), divergence = exact.smoothed(divergence);
    std::vector<double> lost(exact.cells), around(exact.nodes, 0), room(exact.nodes, 0), total(exact.cells, 0);
    for (int c = 0; c < exact.cells; ++c)
      for (int i : exact.mesh.cells[c].node)
        around[i] += exact.beyond_particles(c) * divergence[c], room[i] += exact.particle_volume[c];
    for (int c = 0; c < exact.cells; ++c) {
      lost[c] = (exact.weight[c] - exact.beyond_particles(c)) * divergence[c];
      for (int i : exact.mesh.cells[c].node)
        if (Phases::suction) lost[c] += exact.particle_volume[c] / (dim + 1) * around[i] / room[i];
    }
    ASSERT_EQ(motion.accept(0.01, way.data(), v.data()), 0);
    std::vector<std::vector<int>> movers(1);
    ASSERT_EQ(motion.update_particles(0.01, movers), 0);
    for (int p = 0; p < exact.particles.count; ++p) {
      total[exact.particles.cell[p]] += exact.particles.fluid_mass[0][p];
      const double grown = exact.particles.volume[p] / volume_before[p];
      EXPECT_NEAR(std::log(grown), theta[exact.particles.cell[p]], dim == 3 ? 1e-7 : 1e-12) << "(4.7)";  // (3.4) in 3D
    }
    for (int c = 0; c < exact.cells; ++c)
      EXPECT_NEAR(total[c], exact.liquid[c] - lost[c], 1e-11 * exact.liquid[c] * curves<Phases>) << "(4.8), cell " << c;
  }
}
TALUS_IN_FULL_AND_OPEN_PORES(volumes_and_masses_follow_the_motion)

/// The largest frequency of the filled mesh is that of S M^-1 K, theory (5.7), with the strains, stiffness and inertia
/// of the fluids (6.1): all entries of the matrix.
template <int dim, class Phases>
void frequency_of_the_mesh_is_the_largest_of_all_modes() {
  constexpr int fluids = 1 + Phases::gas;
  WetBox<dim, Phases> box(water());
  Equations<dim, Phases> exact(box.soil);
  ASSERT_EQ(box.soil.motion->begin(0), 0);
  const double density[] = {water_density, air_density}, modulus[] = {water_bulk, air_bulk};
  const int field = exact.nodes * dim, size = (1 + fluids) * field;
  std::vector<double> volume(exact.nodes, 0);
  for (int c = 0; c < exact.cells; ++c)
    for (int i : exact.mesh.cells[c].node) volume[i] += exact.weight[c] / (dim + 1);
  Eigen::MatrixXd product(size, size);
  for (int column = 0; column < size; ++column) {
    const int of = column / field, node = column % field / dim, direction = column % dim;
    std::vector<Tensor> stress(exact.cells, Tensor::Zero());
    std::vector<std::vector<Tensor>> pressure(fluids, stress);  // n p_a
    for (int c = 0; c < exact.cells; ++c)
      for (int k = 0; k <= dim; ++k) {
        if (exact.mesh.cells[c].node[k] != node) continue;
        Tensor g = Tensor::Zero();
        g.template topLeftCorner<dim, dim>().row(direction) = exact.shape[c].gradient.row(k);
        if (of == 0) stress[c] = shear * (g + g.transpose()) + (bulk - 2 * shear / 3) * g.trace() * Tensor::Identity();
        for (int a = 0; a < fluids; ++a) {
          const double strain = of == 0 ? (1 - porosity) * g.trace() : of == 1 + a ? porosity * g.trace() : 0;
          const Tensor p = modulus[a] / porosity * strain * Tensor::Identity();
          stress[c] += (1 - porosity) * p, pressure[a][c] = porosity * p;
        }
      }
    for (int f = 0; f <= fluids; ++f) {
      Nodes<dim, Phases> x = exact.internal_force(f == 0 ? stress : pressure[f - 1], false);
      for (int i = 0; i < exact.nodes; ++i) x[i] /= -(f == 0 ? exact.mass[i] : porosity * density[f - 1] * volume[i]);
      x = exact.back_and_forth(x);
      for (int row = 0; row < field; ++row) product(f * field + row, column) = x[row / dim][row % dim];
    }
  }
  const double omega = std::sqrt(eigenvalues(product).real().maxCoeff());
  double found = 0;
  ASSERT_EQ(box.soil.motion->largest_frequency(3000, &found), 0);
  EXPECT_NEAR(found / omega, 1, 1e-4) << "a power iteration, which comes from below";
}
TALUS_IN_FULL_AND_OPEN_PORES(frequency_of_the_mesh_is_the_largest_of_all_modes)
TEST(Pores, frequency_of_the_mesh_is_the_largest_of_all_modes_three_phase_2d) {
  frequency_of_the_mesh_is_the_largest_of_all_modes<2, ThreePhase>();
}

}  // namespace
}  // namespace talus
