// Strain, stress and volume of cells that deform, and the step that they bear: docs/theory (2.5), (3.1) to (3.9),
// (4.6), (4.7), (5.5), (5.6).
#include <petscsys.h>

#include <Eigen/Eigenvalues>

#include "base/eigenvalues.h"
#include "equations.h"
#include "solvers/critical_step.h"

namespace talus {
namespace {

template <int dim>
using Nodes = typename Equations<dim>::Nodes;

/// Large stretch and rotation of all cells: stress by (3.3) with the exact R and ln U, the volume strain of patches,
/// nodes or cells, volumes by (3.9).
template <int dim>
void stress_and_volume_follow_the_deformation() {
  for (const std::string locking : {"patches", "nodal", "none"}) {
    Box<dim> box("", "[transfer]\nlocking = \"" + locking + "\"\n");
    Equations<dim> exact(box.soil);
    SoilMotion<dim, Dry> &motion = *box.soil.motion;
    ASSERT_EQ(motion.begin(0), 0);
    Nodes<dim> u = box.field(0.02, 10), after = exact.place;
    for (int i = 0; i < exact.nodes; ++i) {
      const ColumnVector<dim> x = exact.place[i];  // turned by half a radian, beside the strain
      u[i][0] += (std::cos(0.5) - 1) * x[0] - std::sin(0.5) * x[1];
      u[i][1] += std::sin(0.5) * x[0] + (std::cos(0.5) - 1) * x[1];
      after[i] += u[i];
    }
    const std::vector<double> way = box.to_motion(u), v(way.size(), 0.);
    ASSERT_EQ(motion.accept(0.1, way.data(), v.data()), 0);
    std::vector<Tensor> rotation, strain;
    std::vector<double> volume_strain, mean;
    std::vector<Simplex<dim>> shape;
    double slender = 1;
    for (int c = 0; c < exact.cells; ++c) {
      shape.push_back(exact.simplex(c, after));
      Tensor F = Tensor::Identity();
      F.topLeftCorner<dim, dim>() = shape[c].edges * exact.shape[c].edges.inverse();
      const Eigen::SelfAdjointEigenSolver<Tensor> eigen(F.transpose() * F);
      const Eigen::Vector3d stretch = eigen.eigenvalues().cwiseSqrt();
      const Tensor axes = eigen.eigenvectors();
      rotation.push_back(F * axes * stretch.cwiseInverse().asDiagonal() * axes.transpose());
      strain.push_back(axes * stretch.array().log().matrix().asDiagonal() * axes.transpose());
      volume_strain.push_back(std::log(F.determinant()));
      slender = std::max(slender, shape[c].gradient.template bottomRows<dim>().squaredNorm() /
                                      exact.shape[c].gradient.template bottomRows<dim>().squaredNorm());
    }
    EXPECT_NEAR(motion.measures().step_ratio, 1 / std::sqrt(slender), 1e-12) << "(5.6)";
    if (locking == "patches") mean = exact.over_patches(volume_strain, exact.weight);
    if (locking == "none") mean = volume_strain;
    if (locking == "nodal") {  // means over the cells of a node, weighted by volume, then over the nodes of a cell
      std::vector<double> sum(exact.nodes, 0), around(exact.nodes, 0);
      for (int c = 0; c < exact.cells; ++c)
        for (int i : exact.mesh.cells[c].node)
          sum[i] += shape[c].volume * volume_strain[c], around[i] += shape[c].volume;
      for (int c = 0; c < exact.cells; ++c) {
        mean.push_back(0);
        for (int i : exact.mesh.cells[c].node) mean[c] += sum[i] / around[i] / (dim + 1);
      }
    }
    for (int p = 0; p < exact.particles.count; ++p) {
      const int c = exact.particles.cell[p];
      const Tensor e = strain[c] + (mean[c] - volume_strain[c]) / 3 * Tensor::Identity();  // (4.6)
      const Tensor trial =
          exact.stress[c] + (bulk - 2 * shear / 3) * e.trace() * Tensor::Identity() + 2 * shear * e;  // (2.5)
      const Tensor wanted = rotation[c] * trial * rotation[c].transpose();                            // (3.3)
      double found[6]{}, volume = 0;
      motion.state(0, p, found, nullptr, &volume);
      EXPECT_LT((tensor<dim>(found) - wanted).norm(), 1e-8 * young) << locking << " cell " << c;
      EXPECT_NEAR(volume, exact.volume[p] * std::exp(mean[c]), 1e-12 * volume) << locking;  // (3.9)
    }
  }
}
TALUS_IN_2D_AND_3D(Deformation, stress_and_volume_follow_the_deformation)

/// Integration volumes follow particles and cells, each by its share (4.5): the force after a step.
template <int dim>
void integration_volumes_follow_the_motion() {
  Box<dim> box("", "[transfer]\nlocking = \"none\"\n");
  Equations<dim> exact(box.soil);
  SoilMotion<dim, Dry> &motion = *box.soil.motion;
  ASSERT_EQ(motion.begin(0), 0);
  Nodes<dim> u = box.field(0.02, 11), after = exact.place;
  for (int i = 0; i < exact.nodes; ++i) u[i] += 0.1 * exact.place[i], after[i] += u[i];
  const std::vector<double> way = box.to_motion(u), v(way.size(), 0.);
  ASSERT_EQ(motion.accept(0.1, way.data(), v.data()), 0);
  std::vector<double> of_particles(exact.cells, 0);
  std::vector<Tensor> stress(exact.cells);
  for (int p = 0; p < exact.particles.count; ++p) {
    double found[6]{}, volume = 0;
    motion.state(0, p, found, nullptr, &volume);
    of_particles[exact.particles.cell[p]] += volume, stress[exact.particles.cell[p]] = tensor<dim>(found);
  }
  for (int c = 0; c < exact.cells; ++c) exact.shape[c] = exact.simplex(c, after);
  exact.weight = exact.weights(of_particles, exact.shape);
  Nodes<dim> wanted = exact.internal_force(stress, false);
  for (int i = 0; i < exact.nodes; ++i) wanted[i] /= exact.mass[i];
  std::vector<double> a(way.size());
  ASSERT_EQ(motion.acceleration(0.1, nullptr, v.data(), a.data()), 0);
  expect_equal<dim>(box.from_motion(a), wanted, 1e4, "after a step");
}
TALUS_IN_2D_AND_3D(Deformation, integration_volumes_follow_the_motion)

/// Cohesionless soil grows no larger than it was (3.9), up to the scene's factor.
template <int dim>
void volumes_are_capped() {
  Box<dim> box("volume_cap = 1.05\n", "", 0, false);
  constexpr double midpoint_rule = 1e-7;  // (3.4) in 3D: g^3 / 12 in each direction for stretches 1 + g, g = 0.0066
  SoilMotion<dim, Dry> &motion = *box.soil.motion;
  ASSERT_EQ(motion.begin(0), 0);
  for (const auto &[growth, limit] : {std::pair{1.02, 1.02}, {1.04, 1.05}}) {  // in turn, in all directions
    Nodes<dim> u;
    for (int i = 0; i < box.soil.mesh.node_count(); ++i)
      u.push_back((std::pow(growth, 1. / dim) - 1) * map<dim>(motion.grid().position[motion.grid().find_node(i)]));
    const std::vector<double> way = box.to_motion(u), v(way.size(), 0.);
    ASSERT_EQ(motion.accept(0.1, way.data(), v.data()), 0);
    for (int p = 0; p < box.soil.particles().count; ++p) {
      double stress[6], volume;
      motion.state(0, p, stress, nullptr, &volume);
      EXPECT_NEAR(volume / box.soil.particles().initial_volume[p], limit, dim == 3 ? midpoint_rule : 1e-9);
    }
  }
}
TALUS_IN_2D_AND_3D(Deformation, volumes_are_capped)

/// The element size of softening (2.7) is the side of the regular simplex of the same volume.
TEST(Deformation, element_size_is_the_side_of_the_regular_simplex) {
  EXPECT_NEAR(element_size<2>(std::sqrt(3.) / 4 * 0.7 * 0.7), 0.7, 1e-15);
  EXPECT_NEAR(element_size<3>(0.7 * 0.7 * 0.7 / (6 * std::sqrt(2.))), 0.7, 1e-15);
}

/// The critical step of a cell is 2 / omega of its own fastest mode, by B, D and lumped masses (5.5): neither longer,
/// as that would not be stable, nor shorter than it has to be.
template <int dim>
void critical_step_is_that_of_the_fastest_mode_of_the_cell() {
  Box<dim> box;
  Equations<dim> exact(box.soil);
  constexpr int strains = dim == 2 ? 3 : 6, size = dim * (dim + 1);
  const double lambda = bulk - 2 * shear / 3;
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(strains, strains);  // of any size: compiled in half the time
  for (int i = 0; i < strains; ++i) D(i, i) = i < dim ? 2 * shear : shear;
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) D(i, j) += lambda;
  CriticalStep<dim> step(box.soil.mesh, box.soil.bodies[0]->law(), density);
  for (int c = 0; c < exact.cells; ++c) {
    const auto &g = exact.shape[c].gradient;
    Eigen::MatrixXd B = Eigen::MatrixXd::Zero(strains, size);
    for (int k = 0; k <= dim; ++k) {
      for (int d = 0; d < dim; ++d) B(d, k * dim + d) = g(k, d);
      B(dim, k * dim) = g(k, 1), B(dim, k * dim + 1) = g(k, 0);
      if constexpr (dim == 3)
        B(4, k * 3 + 1) = g(k, 2), B(4, k * 3 + 2) = g(k, 1), B(5, k * 3) = g(k, 2), B(5, k * 3 + 2) = g(k, 0);
    }
    const double node_mass = density * exact.shape[c].volume / (dim + 1);
    const Eigen::MatrixXd K = exact.shape[c].volume / node_mass * B.transpose() * D * B;
    const double omega = std::sqrt(eigenvalues(K).real().maxCoeff());
    EXPECT_NEAR(step(c) * omega / 2, 1, 1e-10) << "cell " << c;
  }
}
TALUS_IN_2D_AND_3D(Deformation, critical_step_is_that_of_the_fastest_mode_of_the_cell)

/// The same with two fluids that no drag holds back, each with the strain (1 - n) div v_s + n div v_a, pores.md (6.1).
template <int dim>
void critical_step_knows_the_fluids() {
  constexpr double n = 0.4, skeleton = 1500;
  const PoreStiffness pores{n, {{1000, 2e7}, {500, 3e6}}};
  Box<dim> box;
  Equations<dim> exact(box.soil);
  constexpr int solid = dim * (dim + 1), size = 3 * solid;
  CriticalStep<dim> step(box.soil.mesh, box.soil.bodies[0]->law(), skeleton, pores);
  for (int c = 0; c < exact.cells; ++c) {
    const double volume = exact.shape[c].volume;
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd mass(size), divergence(solid);
    for (int j = 0; j < solid; ++j) divergence[j] = exact.shape[c].gradient(j / dim, j % dim);
    for (int i = 0; i < solid; ++i)
      for (int j = 0; j < solid; ++j) {  // lambda div u div w + G (grad u + grad u^T) : grad w
        const int a = i / dim, p = i % dim, b = j / dim, q = j % dim;
        const auto &g = exact.shape[c].gradient;
        K(i, j) = volume * ((bulk - 2 * shear / 3) * divergence[i] * divergence[j] +
                            shear * ((p == q ? g.row(a).dot(g.row(b)) : 0) + g(a, q) * g(b, p)));
      }
    mass.head(solid).setConstant(skeleton * volume / (dim + 1));
    for (int f = 0; f < 2; ++f) {
      Eigen::VectorXd strain = Eigen::VectorXd::Zero(size);
      strain.head(solid) = (1 - n) * divergence, strain.segment((1 + f) * solid, solid) = n * divergence;
      K += volume * pores.fluids[f].bulk_modulus / n * strain * strain.transpose();
      mass.segment((1 + f) * solid, solid).setConstant(n * pores.fluids[f].density * volume / (dim + 1));
    }
    const Eigen::VectorXd scale = mass.cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd symmetric = scale.asDiagonal() * K * scale.asDiagonal();
    const double omega = std::sqrt(eigenvalues(symmetric).real().maxCoeff());
    EXPECT_NEAR(step(c) * omega / 2, 1, 1e-9) << "cell " << c;
  }
}
TALUS_IN_2D_AND_3D(Deformation, critical_step_knows_the_fluids)

/// The largest frequency of the filled mesh is that of S M^-1 K (5.7), with all entries of the matrices.
template <int dim>
void frequency_of_the_mesh_is_the_largest_of_all_modes() {
  Box<dim> box;
  Equations<dim> exact(box.soil);
  ASSERT_EQ(box.soil.motion->begin(0), 0);
  const int size = exact.nodes * dim;
  Eigen::MatrixXd product(size, size);
  Nodes<dim> unit(exact.nodes, ColumnVector<dim>::Zero());
  for (int column = 0; column < size; ++column) {
    unit[column / dim][column % dim] = 1;
    std::vector<Tensor> stress(exact.cells, Tensor::Zero());
    for (int c = 0; c < exact.cells; ++c) {
      Tensor g = Tensor::Zero();
      for (int k = 0; k <= dim; ++k)
        g.template topLeftCorner<dim, dim>() += unit[exact.mesh.cells[c].node[k]] * exact.shape[c].gradient.row(k);
      stress[c] = shear * (g + g.transpose()) + (bulk - 2 * shear / 3) * g.trace() * Tensor::Identity();
    }
    Nodes<dim> x = exact.internal_force(stress, false);
    for (int i = 0; i < exact.nodes; ++i) x[i] /= -exact.mass[i];
    x = exact.back_and_forth(x);
    for (int row = 0; row < size; ++row) product(row, column) = x[row / dim][row % dim];
    unit[column / dim].setZero();
  }
  const double omega = std::sqrt(eigenvalues(product).real().maxCoeff());
  double found = 0;
  ASSERT_EQ(box.soil.motion->largest_frequency(3000, &found), 0);
  EXPECT_NEAR(found / omega, 1, 1e-4) << "a power iteration, which comes from below";
}
TALUS_IN_2D_AND_3D(Deformation, frequency_of_the_mesh_is_the_largest_of_all_modes)

}  // namespace
}  // namespace talus
