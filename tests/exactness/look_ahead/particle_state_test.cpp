// The state at the nodes is that of the particles: an integrator whose unknowns are places, velocities and strains of
// the particles, in cells that stay, takes the same steps to round-off, docs/theory/integrators.md (1). And in that
// state methods have the order they are asked for.
#include <cmath>

#include "soil.h"
#include "solvers/arkode.h"

namespace talus {
namespace {

/// Particles of one body as the unknowns: u holds their displacements, then those of the nodes (the strain of cells), v
/// their velocities, then nothing. Nodes move with the mass-weighted mean of the particles around them.
template <int dim>
class ParticleState final : public Motion {
 public:
  explicit ParticleState(Soil<dim> &soil) : soil_(soil), p_(soil.particles()) {
    EXPECT_EQ(soil.motion->begin(0), 0);
    const FilledGrid<dim> &grid = soil.motion->grid();
    nodes_ = grid.node_count();
    for (int i = 0; i < p_.count; ++i)
      shape_.push_back(barycentric(soil.mesh.cells[p_.cell[i]], p_.position[i])),
          node_.push_back(grid.shape[grid.find_cell(p_.cell[i])].node);
    velocity_.assign(size(), 0), place_.assign(p_.count * dim, 0), nodal_.resize(nodes_ * dim),
        unused_.resize(nodes_ * dim), change_.resize(nodes_ * dim);
    for (int i = 0; i < p_.count; ++i)
      std::copy_n(p_.velocity[i].data(), dim, &velocity_[i * dim]),
          std::copy_n(p_.position[i].data(), dim, &place_[i * dim]);
  }
  const std::vector<double> &place() const { return place_; }

  PetscErrorCode begin(double) override { return 0; }
  PetscErrorCode acceleration(double, const double *, const double *, double *) override { return PETSC_ERR_SUP; }
  PetscErrorCode rates(double t, const double *u, const double *v, double *du, double *dv) override {
    double *node_rate = du + p_.count * dim;
    to_nodes(v, node_rate);
    PetscCall(soil_.motion->rates(t, u ? u + p_.count * dim : nullptr, node_rate, unused_.data(), change_.data()));
    at_particles(node_rate, du), at_particles(change_.data(), dv);
    std::fill_n(dv + p_.count * dim, nodes_ * dim, 0.);
    return 0;
  }
  PetscErrorCode apply_boundaries_and_drag(double, double, double *) override { return 0; }
  PetscErrorCode map_back(double, double, double *, double *) override { return PETSC_ERR_SUP; }
  PetscErrorCode accept(double t, const double *u, const double *v) override {
    std::copy_n(v, size(), velocity_.begin());
    for (int i = 0; i < p_.count * dim; ++i) place_[i] += u[i];
    to_nodes(v, nodal_.data());
    return soil_.motion->accept(t, u + p_.count * dim, nodal_.data());
  }
  bool inverted() const override { return soil_.motion->inverted(); }
  int size() const override { return (p_.count + nodes_) * dim; }
  int capacity() const override { return size(); }
  double *velocity() override { return velocity_.data(); }
  double seen_square(const double *x) const override {
    double sum = 0;
    for (int i = 0; i < p_.count * dim; ++i) sum += p_.mass[i / dim] * x[i] * x[i];
    return sum;
  }
  double mass() const override { return soil_.motion->mass(); }
  MPI_Comm comm() const override { return MPI_COMM_WORLD; }

 private:
  void to_nodes(const double *v, double *out) const {
    std::fill_n(out, nodes_ * dim, 0.);
    for (int i = 0; i < p_.count; ++i)
      for (int k = 0; k <= dim; ++k)
        for (int d = 0; d < dim; ++d)
          out[node_[i][k] * dim + d] +=
              p_.mass[i] * shape_[i][k] * v[i * dim + d] / soil_.motion->grid().mass[node_[i][k]];
  }
  void at_particles(const double *x, double *out) const {
    for (int i = 0; i < p_.count; ++i)
      for (int d = 0; d < dim; ++d) {
        out[i * dim + d] = 0;
        for (int k = 0; k <= dim; ++k) out[i * dim + d] += shape_[i][k] * x[node_[i][k] * dim + d];
      }
  }

  Soil<dim> &soil_;
  ParticleArrays<dim> &p_;
  int nodes_;
  std::vector<std::array<double, dim + 1>> shape_;
  std::vector<std::array<int, dim + 1>> node_;
  std::vector<double> velocity_, place_, nodal_, unused_, change_;
};

/// A free block that swells, shears and turns; strains of a few percent.
std::string block(int dimension) {
  return "phases = \"dry\"\ndimension = " + std::to_string(dimension) + "\ngravity = 0\n[mesh]\nsection = \"" +
         TALUS_MESHES + "/flight.csv\"\nsize = 0.17\n" + (dimension == 3 ? "thickness = 0.3\nlayers = 0\n" : "") +
         "[body.soil]\nregion = \"block\"\ndensity = 2000\nyoung_modulus = \"1 MPa\"\npoisson_ratio = 0.3\nlaw = "
         "\"linear_elastic\"\n"
         "velocity = [\"sin(3 * x) - y\", \"cos(2 * y) + x\"" +
         (dimension == 3 ? ", \"sin(x + y + 3 * z)\"" : "") +
         "]\n[[stage]]\nduration = 1\n"
         "[transfer]\nrelaxation = 0\nlocking = \"none\"\nremap_interval = 0.3\n";
}

constexpr double end = 0.008;  // about two thirds of a period

ArkodeSettings fixed(int order, int steps) {
  ArkodeSettings settings;
  settings.order = order, settings.step = end / steps;
  return settings;
}

void advance(Motion &motion, const ArkodeSettings &settings, int steps) {
  Arkode integrator(settings);
  double t = 0, taken;
  for (int i = 0; i < steps; ++i, t += taken) ASSERT_EQ(integrator.advance(motion, t, {1, end}, &taken), 0);
}

template <int dim>
std::vector<double> places_of_particles(int order, int steps) {
  Soil<dim> soil(block(dim), 0);
  ParticleState<dim> motion(soil);
  advance(motion, fixed(order, steps), steps);
  return motion.place();
}

template <int dim>
std::vector<double> places_of_nodes(int order, int steps) {
  Soil<dim> soil(block(dim), 0);
  EXPECT_EQ(soil.motion->begin(0), 0);
  advance(*soil.motion, fixed(order, steps), steps);
  std::vector<double> places;
  for (int i = 0; i < soil.particles().count; ++i) {
    Vec<dim> x, v;
    soil.motion->present(*soil.bodies[0], i, &x, &v);
    places.insert(places.end(), x.begin(), x.end());
  }
  return places;
}

double difference(const std::vector<double> &a, const std::vector<double> &b) {
  double largest = 0;
  for (size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

TEST(ParticleState, is_what_the_nodal_state_stands_for) {
  for (int order : {2, 5}) {
    EXPECT_LT(difference(places_of_particles<2>(order, 20), places_of_nodes<2>(order, 20)), 1e-14) << order;
    EXPECT_LT(difference(places_of_particles<3>(order, 20), places_of_nodes<3>(order, 20)), 1e-14) << order;
  }
}

/// Differences of places to those of the finest run, with `steps` and twice as many.
template <int dim>
std::array<double, 2> errors(int order, int steps) {
  static const std::vector<double> exact = places_of_particles<dim>(5, 160);
  return {difference(places_of_particles<dim>(order, steps), exact),
          difference(places_of_particles<dim>(order, 2 * steps), exact)};
}

TEST(ParticleState, has_the_order_it_is_asked_for_on_triangles) {
  for (int order : {2, 3, 4, 5}) {
    const auto [coarse, fine] = errors<2>(order, order == 5 ? 10 : 20);
    EXPECT_NEAR(std::log2(coarse / fine), order, 0.35) << "order " << order << ": " << coarse << ", " << fine;
  }
}

// In 3D small increments are decomposed by the midpoint rule, whose error is of third order in a step: below 1e-10 m
// order 5 ends at order 2.
TEST(ParticleState, has_the_order_it_is_asked_for_on_tetrahedra) {
  for (int order : {2, 3, 4}) {
    const auto [coarse, fine] = errors<3>(order, 20);
    EXPECT_NEAR(std::log2(coarse / fine), order, 0.35) << "order " << order << ": " << coarse << ", " << fine;
  }
  EXPECT_LT(errors<3>(5, 20)[0], 1e-10);
}

}  // namespace
}  // namespace talus
