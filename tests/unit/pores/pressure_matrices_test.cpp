/// Sparse matrices of implicit pressure against sums over cells, on the unit square and cube with shifted nodes.
#include "physics/pores/pressure_matrices.h"

#include <gtest/gtest.h>

#include <random>

#include "box_mesh.h"

namespace talus {
namespace {

using test::BoxMesh;
using test::SharedFile;

template <int dim>
struct Filled {
  Filled() : file(BoxMesh(dim, 3)), mesh(BackgroundMesh<dim>::read(PETSC_COMM_WORLD, file.name(), {})), grid(mesh) {
    for (int c = 0; c < mesh.cell_count(); c += 2) {  // some nodes have few of their cells
      auto &matrix = grid.mass_matrix[grid.enter_cell(c)];
      for (double &entry : matrix) entry = random();
      weight.push_back(random());
    }
    grid.complete();
    matrices.make_room_for(mesh), matrices.begin(grid);
    matrices.integrate(grid.shape.data(), weight.data(), {{grid.shape[0].node[1], 0, 0.3}});
    for (int i = 0; i < grid.node_count(); ++i) {
      pressure.push_back(random());
      velocity.push_back({Quad{random(), random(), dim == 3 ? random() : 0, random()}, quad(random())});
    }
  }
  double random() { return std::uniform_real_distribution<double>(0.5, 1.5)(generator); }

  std::mt19937 generator{1};
  SharedFile file;
  BackgroundMesh<dim> mesh;
  FilledGrid<dim> grid;
  PressureMatrices<dim> matrices;
  std::vector<double> weight, pressure;
  std::vector<NodalPair> velocity;
};

template <int dim>
void push_is_the_sum_over_cells() {
  Filled<dim> of;
  const int nodes = of.grid.node_count();
  std::vector<Quad> push(nodes), expected(nodes, Quad{});
  of.matrices.push(of.pressure.data(), push.data());
  for (int c = 0; c < of.grid.cell_count(); ++c) {
    const Shape<dim> &shape = of.grid.shape[c];
    double force = 0;  // w times the mean pressure
    for (const int i : shape.node) force += of.weight[c] / (dim + 1) * of.pressure[i];
    for (int k = 0; k < dim; ++k) {
      const Quad part = quad(force) * load<dim>(shape.gradient[k].data());
      expected[shape.node[k + 1]] += part, expected[shape.node[0]] -= part;
    }
    if (c == 0) expected[shape.node[1]][of.matrices.gap] += 0.3 * force;
  }
  for (int i = 0; i < nodes; ++i)
    for (int d = 0; d < 4; ++d) EXPECT_NEAR(push[i][d], expected[i][d], 1e-12);
}

template <int dim>
void divergence_is_the_adjoint_of_push() {
  Filled<dim> of;
  const int nodes = of.grid.node_count();
  std::vector<Quad> push(nodes), v(nodes);
  std::vector<double> divergence(nodes);
  for (int i = 0; i < nodes; ++i) v[i] = of.velocity[i].solid;
  of.matrices.push(of.pressure.data(), push.data());
  of.matrices.divergence(v.data(), divergence.data());
  double left = 0, right = 0;
  for (int i = 0; i < nodes; ++i) {
    left += of.pressure[i] * divergence[i];
    for (int d = 0; d < 4; ++d) right += push[i][d] * v[i][d];
  }
  EXPECT_NEAR(left, right, 1e-12 * nodes);
}

template <int dim>
void momentum_is_that_of_the_mass_matrices() {
  Filled<dim> of;
  const int nodes = of.grid.node_count();
  std::vector<NodalPair> momentum(nodes), expected(nodes, NodalPair{});
  of.matrices.momentum(of.velocity.data(), momentum.data());
  for (int c = 0; c < of.grid.cell_count(); ++c) {
    const auto &node = of.grid.shape[c].node;
    const auto &matrix = of.grid.mass_matrix[c];
    for (int k = 0, pair = dim + 1; k <= dim; ++k) {
      expected[node[k]].solid += quad(matrix[k]) * of.velocity[node[k]].solid;
      for (int l = k + 1; l <= dim; ++l, ++pair) {
        expected[node[k]].solid += quad(matrix[pair]) * of.velocity[node[l]].solid;
        expected[node[l]].solid += quad(matrix[pair]) * of.velocity[node[k]].solid;
      }
    }
  }
  for (int i = 0; i < nodes; ++i)
    for (int d = 0; d < dim; ++d) EXPECT_NEAR(momentum[i].solid[d], expected[i].solid[d], 1e-12);
}

TEST(PressureMatrices, push_is_the_sum_over_cells) { push_is_the_sum_over_cells<2>(), push_is_the_sum_over_cells<3>(); }
TEST(PressureMatrices, divergence_is_the_adjoint_of_push) {
  divergence_is_the_adjoint_of_push<2>(), divergence_is_the_adjoint_of_push<3>();
}
TEST(PressureMatrices, momentum_is_that_of_the_mass_matrices) {
  momentum_is_that_of_the_mass_matrices<2>(), momentum_is_that_of_the_mass_matrices<3>();
}

}  // namespace
}  // namespace talus
