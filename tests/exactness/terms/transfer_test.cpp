// From particles to nodes and back: docs/theory (4.2), (4.9) to (4.12).
#include <algorithm>

#include "equations.h"

namespace talus {
namespace {

template <int dim>
using Nodes = typename Equations<dim>::Nodes;

/// What is mapped back, and how nodes relax, with and without a time constant (4.9), (4.10). A particle that keeps less
/// of its own velocity at the next remap has less of it in the whole part.
template <int dim>
void velocities_are_mapped_back_and_relax() {
  constexpr double step = 0.03, now = 0.07;
  struct {
    double tau;
    const char *transfer;
    double kept;  // 1 - beta
  } const cases[] = {{0, "", 1},
                     {0.2, "", 1},
                     {0, "velocity = \"pic\"", 0},
                     {0.2, "velocity = \"pic\"", 0},
                     {0, "pic_fraction = 0.25", 0.75},
                     {0.2, "pic_fraction = 0.25", 0.75}};
  for (const auto &[tau, transfer, kept] : cases) {
    Box<dim> box("", std::string("[transfer]\n") + transfer + "\n", tau);
    Equations<dim> exact(box.soil);
    SoilMotion<dim, Dry> &motion = *box.soil.motion;
    ASSERT_EQ(motion.begin(0), 0);
    expect_equal<dim>(box.from_motion({motion.velocity(), motion.velocity() + motion.size()}), exact.start, 1, "(4.2)");
    const Nodes<dim> v = box.field(1, 7);
    std::vector<double> relaxed = box.to_motion(v), mapped(relaxed.size());
    ASSERT_EQ(motion.map_back(now + step, step, relaxed.data(), mapped.data()), 0);
    const double a = kept * (tau > 0 ? std::exp(-(now + step) / tau) : 1),
                 share = tau > 0 ? 1 - std::exp(-step / tau) : 0;
    const Nodes<dim> Sv = exact.back_and_forth(v), Sv0 = exact.back_and_forth(exact.start);
    Nodes<dim> w = Sv, left = v;
    for (int i = 0; i < exact.nodes; ++i) w[i] += a * (exact.start[i] - Sv0[i]), left[i] -= share * (v[i] - Sv[i]);
    expect_equal<dim>(box.from_motion(mapped), w, 1, "(4.9)");
    expect_equal<dim>(box.from_motion(relaxed), left, 1, "(4.10)");
    // the rates that other integrators see
    std::vector<double> du(relaxed.size()), dv(relaxed.size()), at = box.to_motion(v), bare(relaxed.size());
    ASSERT_EQ(motion.acceleration(now, nullptr, at.data(), bare.data()), 0);
    ASSERT_EQ(motion.rates(now, nullptr, at.data(), du.data(), dv.data()), 0);
    const double earlier = kept * (tau > 0 ? std::exp(-now / tau) : 1);
    Nodes<dim> rate = Sv, change = box.from_motion(bare);
    for (int i = 0; i < exact.nodes; ++i) {
      rate[i] += earlier * (exact.start[i] - Sv0[i]);
      if (tau > 0) change[i] -= (v[i] - Sv[i]) / tau;
    }
    expect_equal<dim>(box.from_motion(du), rate, 1, "rate of places");
    expect_equal<dim>(box.from_motion(dv), change, 100, "rate of velocities");
    double seen = 0;
    for (int p = 0; p < exact.particles.count; ++p) seen += exact.particles.mass[p] * exact.at(p, v).squaredNorm();
    EXPECT_NEAR(motion.seen_square(at.data()), seen, 1e-11 * seen);
  }
}
TALUS_IN_2D_AND_3D(Transfer, velocities_are_mapped_back_and_relax)

/// What particles take from the nodes at a remap (4.11), (4.12), what they have before it (4.10a), and the velocity
/// that results show (4.12a).
template <int dim>
void particles_take_the_change_of_the_nodes() {
  constexpr double tau = 0.2, time = 0.05;
  for (const auto &[transfer, kept] : {std::pair{"", std::exp(-time / tau)},
                                       {"pic_fraction = 0.25", 0.75 * std::exp(-time / tau)},
                                       {"velocity = \"pic\"", 0.}}) {
    Box<dim> box("", std::string("[transfer]\n") + transfer + "\n", tau);
    Equations<dim> exact(box.soil);
    SoilMotion<dim, Dry> &motion = *box.soil.motion;
    ASSERT_EQ(motion.begin(0), 0);
    const Nodes<dim> v = box.field(1, 8), u = box.field(1e-3, 9);
    const std::vector<double> velocity = box.to_motion(v), way = box.to_motion(u);
    ASSERT_EQ(motion.accept(time, way.data(), velocity.data()), 0);
    ASSERT_EQ(motion.begin_results(time), 0);
    Nodes<dim> shown, wanted, places, taken, gone, shown_places, moving, w = exact.back_and_forth(v);
    const Nodes<dim> Sv0 = exact.back_and_forth(exact.start);
    for (int i = 0; i < exact.nodes; ++i) w[i] += kept * (exact.start[i] - Sv0[i]);
    for (int p = 0; p < exact.particles.count; ++p) {
      Vec<dim> x, s;
      motion.present(*box.soil.bodies[0], p, &x, &s);
      shown.push_back(map<dim>(s)), shown_places.push_back(map<dim>(x));
      const ColumnVector<dim> own = exact.velocity[p] - exact.at(p, exact.start);
      wanted.push_back(exact.at(p, v) + kept * own), taken.push_back(wanted.back());
      places.push_back(exact.position[p] + exact.at(p, u));
      const Vec<dim> speed = motion.moving_velocity(*box.soil.bodies[0], p);
      moving.push_back(map<dim>(speed) - exact.at(p, w));
    }
    expect_equal<dim>(shown, wanted, 1, "(4.10a)");
    expect_equal<dim>(shown_places, places, 1, "places shown");
    expect_equal<dim>(moving, Nodes<dim>(moving.size(), ColumnVector<dim>::Zero()), 1, "(4.12a)");
    std::vector<std::vector<int>> movers(1);
    ASSERT_EQ(motion.update_particles(time, movers), 0);
    Nodes<dim> found;
    for (int p = 0; p < exact.particles.count; ++p)
      found.push_back(map<dim>(exact.particles.velocity[p])), gone.push_back(map<dim>(exact.particles.position[p]));
    expect_equal<dim>(found, taken, 1, "(4.11)");
    expect_equal<dim>(gone, places, 1, "(4.12)");
  }
}
TALUS_IN_2D_AND_3D(Transfer, particles_take_the_change_of_the_nodes)

/// A particle on a side of its cell may lie beyond it by round-off, and its share of the opposite node is then
/// negative. Where that node has no other particle, its velocity stays within that of the soil: it was momentum over
/// the smallest number, 1e290 m/s.
template <int dim>
void round_off_of_a_place_gives_a_node_without_mass_no_velocity() {
  Box<dim> box;
  ParticleArrays<dim> &p = box.soil.particles();
  const BackgroundMesh<dim> &mesh = box.soil.mesh;
  constexpr int corner = 0;
  for (int i = 0; i < p.count; ++i) {
    const auto &node = mesh.cells[p.cell[i]].node;
    if (std::find(node.begin(), node.end(), corner) == node.end()) continue;
    const ColumnVector<dim> tip = map<dim>(mesh.position[corner]);
    ColumnVector<dim> side = ColumnVector<dim>::Zero();
    for (int k : node)
      if (k != corner) side += map<dim>(mesh.position[k]) / dim;
    map<dim>(p.position[i]) = side + 1e-15 * (side - tip);
  }
  SoilMotion<dim, Dry> &motion = *box.soil.motion;
  ASSERT_EQ(motion.begin(0), 0);
  const auto fastest = [](const double *v, int size) {
    return *std::max_element(v, v + size, [](double a, double b) { return std::abs(a) < std::abs(b); });
  };
  EXPECT_LT(std::abs(fastest(motion.velocity(), motion.size())), 2);
  std::vector<double> v = box.to_motion(box.field(1, 7)), mapped(v.size());
  ASSERT_EQ(motion.map_back(0.1, 0.1, v.data(), mapped.data()), 0);
  EXPECT_LT(std::abs(fastest(mapped.data(), motion.size())), 2);
}
TALUS_IN_2D_AND_3D(Transfer, round_off_of_a_place_gives_a_node_without_mass_no_velocity)

}  // namespace
}  // namespace talus
