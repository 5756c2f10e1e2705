// Loads on a face that moves: docs/theory (6.4) between remaps and (6.5) at a remap.
#include "equations.h"

namespace talus {
namespace {

template <int dim>
using Nodes = typename Equations<dim>::Nodes;

/// Normals turn by Nanson's formula and keep their length.
template <int dim>
ColumnVector<dim> turned(const Square<dim> &F, const Vec<dim> &normal) {
  const ColumnVector<dim> n = F.inverse().transpose() * map<dim>(normal);
  return n / n.norm() * map<dim>(normal).norm();
}

/// Deformation gradients of the cells, whose nodes were at `exact.place` and are at `after`.
template <int dim>
std::vector<Square<dim>> deformations(const Equations<dim> &exact, const Nodes<dim> &after) {
  std::vector<Square<dim>> F;
  for (int c = 0; c < exact.cells; ++c) F.push_back(exact.simplex(c, after).edges * exact.shape[c].edges.inverse());
  return F;
}

const std::string load = "[transfer]\nlocking = \"none\"\n[boundary.top]\nkind = \"traction\"\n";

/// A pressure acts where the face is now, across the face as the deformation of its own cell turns it; at a remap the
/// pieces of the face take the mean deformation around them.
template <int dim>
void pressure_follows_the_face() {
  Box<dim> box("", load + "pressure = \"700 + 300 * x\"\n"), bare("", "[transfer]\nlocking = \"none\"\n");
  Equations<dim> exact(box.soil);
  const Nodes<dim> u = box.field(0.02, 12);
  std::array<Nodes<dim>, 2> acceleration;
  for (Box<dim> *one : {&box, &bare}) {
    SoilMotion<dim, Dry> &motion = *one->soil.motion;
    ASSERT_EQ(motion.begin(0), 0);
    const std::vector<double> way = one->to_motion(u), v(way.size(), 0.);
    ASSERT_EQ(motion.accept(0.1, way.data(), v.data()), 0);
    std::vector<double> a(way.size());
    ASSERT_EQ(motion.acceleration(0.1, nullptr, v.data(), a.data()), 0);
    acceleration[one == &bare] = one->from_motion(a);
  }
  Nodes<dim> after = exact.place, wanted(exact.nodes, ColumnVector<dim>::Zero());
  for (int i = 0; i < exact.nodes; ++i) after[i] += u[i];
  const auto F = deformations(exact, after);
  double area = 0;
  std::vector<std::pair<int, std::array<double, dim + 1>>> pieces;  // particle, and coordinates in its cell
  for (int p = 0; p < exact.particles.count; ++p) {
    const SurfacePiece<dim> &piece = exact.particles.surface[p];
    if (piece.area == 0) continue;
    const int c = exact.particles.cell[p];
    Vec<dim> x;
    map<dim>(x) = exact.position[p] + map<dim>(piece.offset);
    EXPECT_NEAR(x[1], 1, 1e-12) << "on the face";
    pieces.push_back({p, barycentric(exact.mesh.cells[c], x)}), area += piece.area;
    ColumnVector<dim> now = ColumnVector<dim>::Zero();
    for (int k = 0; k <= dim; ++k) now += pieces.back().second[k] * after[exact.mesh.cells[c].node[k]];
    for (int k = 0; k <= dim; ++k)
      wanted[exact.mesh.cells[c].node[k]] -=
          pieces.back().second[k] * piece.area * (700 + 300 * now[0]) * turned<dim>(F[c], piece.normal);
  }
  EXPECT_NEAR(area, 1, 1e-12);
  for (int i = 0; i < exact.nodes; ++i) {
    wanted[i] /= exact.mass[i];
    acceleration[0][i] -= acceleration[1][i];
  }
  expect_equal<dim>(acceleration[0], wanted, 1e4, "(6.4)");  // round-off of the forces of stress, 1e4 times the load

  std::vector<double> of_particles(exact.cells, 0);
  std::vector<Simplex<dim>> shape;
  for (int c = 0; c < exact.cells; ++c) shape.push_back(exact.simplex(c, after));
  for (int p = 0; p < exact.particles.count; ++p) {
    double stress[6], volume;
    box.soil.motion->state(0, p, stress, nullptr, &volume);
    of_particles[exact.particles.cell[p]] += volume;
  }
  const std::vector<double> weight = exact.weights(of_particles, shape);
  std::vector<Square<dim>> sum(exact.nodes, Square<dim>::Zero());
  std::vector<double> all(exact.nodes, 0);
  for (int c = 0; c < exact.cells; ++c)
    for (int i : exact.mesh.cells[c].node) sum[i] += weight[c] * F[c], all[i] += weight[c];
  Nodes<dim> offsets, normals, found_offsets, found_normals;
  for (const auto &[p, n] : pieces) {
    Square<dim> mean = Square<dim>::Zero();
    for (int k = 0; k <= dim; ++k) {
      const int i = exact.mesh.cells[exact.particles.cell[p]].node[k];
      mean += n[k] * sum[i] / all[i];
    }
    offsets.push_back(mean * map<dim>(exact.particles.surface[p].offset));
    normals.push_back(turned<dim>(mean, exact.particles.surface[p].normal));
  }
  std::vector<std::vector<int>> movers(1);
  ASSERT_EQ(box.soil.motion->update_particles(0.1, movers), 0);
  for (const auto &piece : pieces) {
    const SurfacePiece<dim> &now = exact.particles.surface[piece.first];
    found_offsets.push_back(map<dim>(now.offset)), found_normals.push_back(map<dim>(now.normal));
  }
  expect_equal<dim>(found_offsets, offsets, 1, "r of (6.5)");
  expect_equal<dim>(found_normals, normals, 1, "n of (6.5)");
}
TALUS_IN_2D_AND_3D(Loads, pressure_follows_the_face)

/// A piece that its soil has left behind is drawn in to one cell beyond it.
template <int dim>
void pieces_stay_within_a_cell_of_their_soil() {
  Box<dim> box("", load + "pressure = 700\n", 0, false);
  ParticleArrays<dim> &p = box.soil.particles();
  for (int i = 0; i < p.count; ++i)
    if (p.surface[i].area > 0)
      for (int d = 0; d < dim; ++d) p.surface[i].offset[d] *= 50;
  ASSERT_EQ(box.soil.motion->begin(0), 0);
  int drawn_in = 0;
  for (int i = 0; i < p.count; ++i) {
    if (p.surface[i].area == 0) continue;
    Vec<dim> x;
    map<dim>(x) = map<dim>(p.position[i]) + map<dim>(p.surface[i].offset);
    const auto n = barycentric(box.soil.mesh.cells[p.cell[i]], x);
    const double outside = *std::min_element(n.begin(), n.end());
    EXPECT_GE(outside, -1 - 1e-9);
    drawn_in += outside < 0;
  }
  EXPECT_GT(drawn_in, 0);
}
TALUS_IN_2D_AND_3D(Loads, pieces_stay_within_a_cell_of_their_soil)

/// A traction is a dead load: force per undeformed area at the undeformed place, however the face turns.
template <int dim>
void traction_is_a_dead_load() {
  const std::string third = dim == 3 ? ", 0" : "";
  Box<dim> box("", load + "traction = [\"300 * x\", \"-500\"" + third + "]\n", 0, false);
  Equations<dim> exact(box.soil);
  SoilMotion<dim, Dry> &motion = *box.soil.motion;
  ASSERT_EQ(motion.begin(0), 0);
  const std::vector<double> way = box.to_motion(box.field(0.02, 12)), v(way.size(), 0.);
  ASSERT_EQ(motion.accept(0.1, way.data(), v.data()), 0);
  std::vector<double> a(way.size());
  ASSERT_EQ(motion.acceleration(0.1, nullptr, v.data(), a.data()), 0);
  const Nodes<dim> found = box.from_motion(a);
  ColumnVector<dim> sum = ColumnVector<dim>::Zero();  // the forces of stress add up to nothing
  for (int i = 0; i < exact.nodes; ++i) sum += exact.mass[i] * found[i];
  EXPECT_NEAR(sum[0], 300. / 2, 1e-7);
  EXPECT_NEAR(sum[1], -500, 1e-7);
}
TALUS_IN_2D_AND_3D(Loads, traction_is_a_dead_load)

/// A face between two soils is loaded once, half by each of them.
template <int dim>
void face_between_soils_is_loaded_once() {
  const std::string third = dim == 3 ? ", 0" : "";
  Box<dim> box("", "[boundary.middle]\nkind = \"traction\"\ntraction = [300, -500" + third + "]\n", 0, false);
  Equations<dim> exact(box.soil);
  ASSERT_EQ(box.soil.motion->begin(0), 0);
  std::vector<double> a(box.soil.motion->size());
  ASSERT_EQ(box.soil.motion->acceleration(0, nullptr, box.to_motion(box.field(1, 0)).data(), a.data()), 0);
  const Nodes<dim> found = box.from_motion(a);
  ColumnVector<dim> sum = ColumnVector<dim>::Zero();
  for (int i = 0; i < exact.nodes; ++i) sum += exact.mass[i] * found[i];
  double area = 0;  // of the facets, which the mesh lists with the cells on either side
  for (const Facet<dim> &f : box.soil.mesh.facets("middle")) area += f.area / 2;
  EXPECT_GE(area, 1 - 1e-12);
  EXPECT_NEAR(sum[0], 300 * area, 1e-9);
  EXPECT_NEAR(sum[1], -500 * area, 1e-9);
}
TALUS_IN_2D_AND_3D(Loads, face_between_soils_is_loaded_once)

}  // namespace
}  // namespace talus
