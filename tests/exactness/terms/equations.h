#pragma once
/// The equations of docs/theory/README.md as they stand there, summed up particle by particle and node by node without
/// thought for speed: what one step of the program has to give on a few cells. Numbers in brackets are those of the
/// equations. On one rank.
#include <algorithm>
#include <cmath>

#include "box_mesh.h"
#include "look_ahead/soil.h"

namespace talus {

using Tensor = Eigen::Matrix3d;

/// A symmetric tensor from its components as stored: xx, yy, zz, xy (, yz, xz).
template <int dim>
Tensor tensor(const double *s) {
  Tensor t = Tensor::Zero();
  t(0, 0) = s[0], t(1, 1) = s[1], t(2, 2) = s[2], t(0, 1) = t(1, 0) = s[3];
  if constexpr (dim == 3) t(1, 2) = t(2, 1) = s[4], t(0, 2) = t(2, 0) = s[5];
  return t;
}

/// Gradients of the shape functions of a simplex, by vertex, and its volume.
template <int dim>
struct Simplex {
  Square<dim> edges;
  Eigen::Matrix<double, dim + 1, dim> gradient;
  double volume;
};

/// A number between -1 and 1 that looks drawn, from two counters.
inline double drawn(int i, int k) { return std::sin(1. + 12.9898 * i + 78.233 * k); }

/// The state of a soil right after its particles were gathered.
template <int dim, class Phases = Dry>
struct Equations {
  using V = ColumnVector<dim>;
  using Nodes = std::vector<V>;

  explicit Equations(const Soil<dim, Phases> &soil)
      : mesh(soil.mesh), particles(soil.particles()), nodes(mesh.node_count()), cells(mesh.cell_count()) {
    for (int i = 0; i < nodes; ++i) place.push_back(map<dim>(mesh.position[i]));
    for (int c = 0; c < cells; ++c) shape.push_back(simplex(c, place));
    mass.assign(nodes, 0), start.assign(nodes, V::Zero());
    filling.assign(nodes, 0), particle_volume.assign(cells, 0), stress.assign(cells, Tensor::Zero());
    share.assign(cells, Eigen::Matrix<double, dim + 1, 1>::Zero());
    for (int p = 0; p < particles.count; ++p) {
      const int c = particles.cell[p];
      Eigen::Matrix<double, dim + 1, 1> n;
      n.template tail<dim>() =
          shape[c].edges.inverse() * (map<dim>(particles.position[p]) - place[mesh.cells[c].node[0]]);
      n[0] = 1 - n.template tail<dim>().sum();
      N.push_back(n);
      velocity.push_back(map<dim>(particles.velocity[p])), position.push_back(map<dim>(particles.position[p]));
      volume.push_back(particles.volume[p]);
      particle_stress.push_back(tensor<dim>(particles.stress + p * stress_size<dim>));
      particle_volume[c] += particles.volume[p], share[c] += particles.volume[p] * n;
      stress[c] += particles.volume[p] * particle_stress.back();
    }
    std::vector<double> around(nodes, 0);
    for (int p = 0; p < particles.count; ++p)
      for (int k = 0; k <= dim; ++k) {
        const int i = mesh.cells[particles.cell[p]].node[k];
        mass[i] += particles.mass[p] * N[p][k];                 // (4.2)
        start[i] += particles.mass[p] * N[p][k] * velocity[p];  // (4.2)
        filling[i] += N[p][k] * particles.volume[p];
      }
    for (int c = 0; c < cells; ++c)
      for (int i : mesh.cells[c].node) around[i] += shape[c].volume / (dim + 1);
    for (int i = 0; i < nodes; ++i) start[i] /= mass[i], filling[i] /= around[i];  // (4.4)
    for (int c = 0; c < cells; ++c) {
      stress[c] /= particle_volume[c];  // (4.3)
      double least = 1e300;
      for (int i : mesh.cells[c].node) least = std::min(least, filling[i]);
      const double r0 = dim == 2 ? 0.7 : 0.6;
      blend.push_back(std::clamp((least - r0) / 0.2, 0., 1.));  // (4.4)
    }
    weight = weights(particle_volume, shape);
  }

  Simplex<dim> simplex(int cell, const Nodes &x) const {
    Simplex<dim> s;
    const auto &node = mesh.cells[cell].node;
    for (int k = 0; k < dim; ++k) s.edges.col(k) = x[node[k + 1]] - x[node[0]];
    s.gradient.template bottomRows<dim>() = s.edges.inverse();
    s.gradient.row(0) = -s.gradient.template bottomRows<dim>().colwise().sum();
    s.volume = std::abs(s.edges.determinant()) / (dim == 2 ? 2 : 6);
    return s;
  }
  /// Integration volumes (4.5).
  std::vector<double> weights(const std::vector<double> &of_particles,
                              const std::vector<Simplex<dim>> &of_cells) const {
    std::vector<double> w;
    for (int c = 0; c < cells; ++c) w.push_back(of_particles[c] + blend[c] * (of_cells[c].volume - of_particles[c]));
    return w;
  }
  /// Means over the patches of cells (4.7), (4.8).
  std::vector<double> over_patches(const std::vector<double> &values, const std::vector<double> &w) const {
    std::vector<double> sum(mesh.patch_count, 0), total(mesh.patch_count, 0), mean;
    for (int c = 0; c < cells; ++c) sum[mesh.patch[c]] += w[c] * values[c], total[mesh.patch[c]] += w[c];
    for (int c = 0; c < cells; ++c) mean.push_back(sum[mesh.patch[c]] / total[mesh.patch[c]]);
    return mean;
  }
  /// Forces of the stress of cells (3.6), with patches (4.8).
  Nodes internal_force(std::vector<Tensor> s, bool patches) const {
    if (patches) {
      std::vector<double> pressure;
      for (const Tensor &t : s) pressure.push_back(t.trace() / 3);
      const auto mean = over_patches(pressure, weight);
      for (int c = 0; c < cells; ++c) s[c] += (mean[c] - pressure[c]) * Tensor::Identity();
    }
    Nodes f(nodes, V::Zero());
    for (int c = 0; c < cells; ++c)
      for (int k = 0; k <= dim; ++k)
        f[mesh.cells[c].node[k]] -=
            weight[c] * s[c].template topLeftCorner<dim, dim>() * shape[c].gradient.row(k).transpose();
    return f;
  }
  /// What particles read off a nodal field.
  V at(int particle, const Nodes &x) const {
    V sum = V::Zero();
    for (int k = 0; k <= dim; ++k) sum += N[particle][k] * x[mesh.cells[particles.cell[particle]].node[k]];
    return sum;
  }
  /// S x (4.9): to the particles and back.
  Nodes back_and_forth(const Nodes &x) const {
    Nodes out(nodes, V::Zero());
    for (int p = 0; p < particles.count; ++p)
      for (int k = 0; k <= dim; ++k) {
        const int i = mesh.cells[particles.cell[p]].node[k];
        out[i] += particles.mass[p] * N[p][k] / mass[i] * at(p, x);
      }
    return out;
  }

  const BackgroundMesh<dim> &mesh;
  const ParticleArrays<dim> &particles;
  const int nodes, cells;
  Nodes place, start;
  std::vector<Simplex<dim>> shape;
  std::vector<double> mass, filling, particle_volume, blend, weight, volume;
  std::vector<Tensor> stress, particle_stress;
  std::vector<Eigen::Matrix<double, dim + 1, 1>> share, N;
  Nodes velocity, position;  ///< of particles
};

/// The unit square or cube, cut into a few cells of uneven shape and filled with elastic soil of which particles differ
/// in mass, volume, stress and velocity.
constexpr double density = 2000, young = 1e6, poisson = 0.3;
constexpr double bulk = young / (3 * (1 - 2 * poisson)), shear = young / (2 * (1 + poisson));

template <int dim, class Phases = Dry>
struct Box {
  explicit Box(const std::string &more_body = "", const std::string &more = "", double relaxation_time = 0,
               bool uneven = true)
      : file(test::BoxMesh(dim, 2)), soil(scene(more_body, more), relaxation_time) {
    ParticleArrays<dim> &p = soil.particles();
    for (int i = 0; uneven && i < p.count; ++i) {
      p.volume[i] *= (dim == 2 ? 0.78 : 0.68) + 0.04 * drawn(i, 0);  // nodes are filled between r_0 and r_0 + 0.2
      p.mass[i] *= 1 + 0.2 * drawn(i, 1);
      for (int s = 0; s < stress_size<dim>; ++s) p.stress[i * stress_size<dim> + s] = 1e4 * drawn(i, 2 + s);
      for (int d = 0; d < dim; ++d) p.velocity[i][d] = drawn(i, 10 + d);
    }
  }
  std::string scene(const std::string &more_body, const std::string &more) const {
    return std::string("phases = \"") + Phases::name + "\"\ndimension = " + std::to_string(dim) +
           "\ngravity = 0\n[mesh]\nfile = \"" + file.name() +
           "\"\n[body.soil]\nregion = [\"lower\", \"upper\"]\nlaw = \"linear_elastic\"\nyoung_modulus = 1e6\n"
           "poisson_ratio = 0.3\n" +
           (Phases::pressure ? "porosity = 0.4\ngrain_density = 2500\n" : "density = 2000\n") + more_body +
           "\n[[stage]]\nduration = 1\n" + more;
  }
  /// A nodal field that looks drawn.
  typename Equations<dim, Phases>::Nodes field(double size, int number) const {
    typename Equations<dim, Phases>::Nodes all;
    for (int i = 0; i < soil.mesh.node_count(); ++i) {
      all.push_back({});
      for (int d = 0; d < dim; ++d) all.back()[d] = size * drawn(i, 20 + 5 * number + d);
    }
    return all;
  }
  /// As the motion numbers nodes, and back.
  std::vector<double> to_motion(const typename Equations<dim, Phases>::Nodes &x) const {
    std::vector<double> all(soil.motion->size());
    for (int i = 0; i < soil.mesh.node_count(); ++i)
      for (int d = 0; d < dim; ++d) all[soil.motion->grid().find_node(i) * dim + d] = x[i][d];
    return all;
  }
  typename Equations<dim, Phases>::Nodes from_motion(const std::vector<double> &x) const {
    typename Equations<dim, Phases>::Nodes all(soil.mesh.node_count());
    for (int i = 0; i < soil.mesh.node_count(); ++i)
      for (int d = 0; d < dim; ++d) all[i][d] = x[soil.motion->grid().find_node(i) * dim + d];
    return all;
  }
  bool on(const char *side, int node) const {
    return std::abs(soil.mesh.position[node][1] - (side == std::string("base") ? 0 : 1)) < 1e-12;
  }

  test::SharedFile file;
  Soil<dim, Phases> soil;
};

/// Are two nodal fields equal to round-off of `scale`?
template <int dim>
void expect_equal(const std::vector<ColumnVector<dim>> &found, const std::vector<ColumnVector<dim>> &wanted,
                  double scale, const std::string &what) {
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_LT((found[i] - wanted[i]).norm(), 1e-11 * scale)
        << what << ", " << dim << "D, at " << i << ": " << found[i].transpose() << ", not " << wanted[i].transpose();
}

/// Calls test<2>() and test<3>().
#define TALUS_IN_2D_AND_3D(suite, test) \
  TEST(suite, test##_2d) { test<2>(); } \
  TEST(suite, test##_3d) { test<3>(); }

}  // namespace talus
