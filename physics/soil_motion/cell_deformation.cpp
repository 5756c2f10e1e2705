#include "physics/soil_motion/cell_deformation.h"

#include <algorithm>

#include "physics/block.h"

namespace talus {
namespace {

/// `lanes` cells that are deformed together.
template <int dim>
struct CellBlock {
  static constexpr int vertices = dim + 1, rotations = std::tuple_size_v<decltype(Increment<dim>::rotation)>;
  Block<dim> displacement[vertices], position[vertices];
  Block<dim * dim> gradient;  ///< of the shape functions 1..dim; on entry at the start, then at the end
  Block<stress_size<dim>> strain;
  Block<rotations> rotation;
  Block<dim * dim> displacement_gradient;
  Block<1> volume, small;
  Block<1> slenderness, mesh_volume;  ///< at the remap and in the mesh
  Block<1> slenderest, smallest;      ///< WorstCell of all blocks so far

  CellBlock() { slenderest.fill(1), smallest.fill(1); }
  [[gnu::always_inline]] void load(const Vec<dim> *u, const Vec<dim> *x, const Shape<dim> *const shape[lanes]) {
    const double *from[lanes];
    for (int k = 0; k < vertices; ++k) {
      for (int i = 0; i < lanes; ++i) from[i] = u[shape[i]->node[k]].data();
      displacement[k].load(from);
      for (int i = 0; i < lanes; ++i) from[i] = x[shape[i]->node[k]].data();
      position[k].load(from);
    }
    for (int i = 0; i < lanes; ++i) from[i] = shape[i]->gradient[0].data();
    gradient.load(from);
  }

  [[gnu::always_inline]] void deform(int i) {
    const auto at_start = take<Gradient<dim>>(gradient, i);  // row k: of shape function k + 1
    Gradient<dim> g{};
    std::array<Vec<dim>, dim> edge, at_end;
#pragma GCC unroll 3
    for (int k = 0; k < dim; ++k) {
#pragma GCC unroll 3
      for (int d = 0; d < dim; ++d) {
        edge[k][d] = position[k + 1].value[d][i] - position[0].value[d][i];
        const double du = displacement[k + 1].value[d][i] - displacement[0].value[d][i];
#pragma GCC unroll 3
        for (int j = 0; j < dim; ++j) g[dim * d + j] += du * at_start[dim * k + j];
      }
    }
    Increment<dim> increment;
    small.value[0][i] = decompose_small<dim>(g, increment) ? 1 : 0;
    put(strain, i, increment.strain), put(rotation, i, increment.rotation), put(displacement_gradient, i, g);
    volume.value[0][i] = simplex_gradients<dim>(edge, at_end);
    double sum = 0;
#pragma GCC unroll 3
    for (int k = 0; k < dim; ++k) {
#pragma GCC unroll 3
      for (int d = 0; d < dim; ++d) sum += at_end[k][d] * at_end[k][d], gradient.value[dim * k + d][i] = at_end[k][d];
    }
    const double slender = sum / slenderness.value[0][i], left = volume.value[0][i] / mesh_volume.value[0][i];
    slenderest.value[0][i] = slender > slenderest.value[0][i] ? slender : slenderest.value[0][i];
    smallest.value[0][i] = left < smallest.value[0][i] ? left : smallest.value[0][i];
  }
};

template <int dim>
void set_no_increment(Increment<dim> &increment) {
  increment = {};
  for (int d = 0; d < (dim == 2 ? 1 : 3); ++d) increment.rotation[4 * d] = 1;
}

}  // namespace

template <int dim>
WorstCell deform_cells(const FilledGrid<dim> &grid, const Vec<dim> *u, const Vec<dim> *position, const Shape<dim> *from,
                       const double *slenderness, Shape<dim> *to, Increment<dim> *increment, double *volume_strain) {
  const int cells = grid.cell_count();
  const std::vector<double> &mesh_volume = grid.mesh().volume;
  WorstCell worst;
  CellBlock<dim> block;
  for (int first = 0; first < cells; first += lanes) {
    const int filled = std::min(lanes, cells - first);
    const Shape<dim> *shape[lanes];
    const double *slender[lanes], *whole[lanes];
    double *strain[lanes], *rotation[lanes], *gradient[lanes];
    for (int i = 0; i < lanes; ++i) {
      const int c = first + std::min(i, filled - 1);  // the last one is repeated
      shape[i] = from + c, slender[i] = slenderness + c, whole[i] = &mesh_volume[grid.mesh_cell[c]];
      strain[i] = increment[c].strain.data(), rotation[i] = increment[c].rotation.data();
      gradient[i] = to[c].gradient[0].data();
    }
    block.load(u, position, shape), block.slenderness.load(slender), block.mesh_volume.load(whole);
#pragma omp simd
    for (int i = 0; i < lanes; ++i) block.deform(i);
    block.strain.store(strain), block.rotation.store(rotation), block.gradient.store(gradient);
    for (int i = 0; i < filled; ++i) {
      const int c = first + i;
      if (block.small.value[0][i] == 0 &&
          !decompose_exactly(take<Gradient<dim>>(block.displacement_gradient, i), increment[c])) {
        worst.volume = -1, worst.inverted = true;
        set_no_increment(increment[c]);
      }
      volume_strain[c] = trace<dim>(increment[c]);
      to[c].node = from[c].node;
      to[c].volume = block.volume.value[0][i];
    }
  }
  for (int i = 0; i < lanes; ++i) {
    worst.slenderness = std::max(worst.slenderness, block.slenderest.value[0][i]);
    worst.volume = std::min(worst.volume, block.smallest.value[0][i]);
  }
  return worst;
}

#define TALUS_INSTANTIATE(dim)                                                                      \
  template WorstCell deform_cells<dim>(const FilledGrid<dim> &, const Vec<dim> *, const Vec<dim> *, \
                                       const Shape<dim> *, const double *, Shape<dim> *, Increment<dim> *, double *);
TALUS_INSTANTIATE(2)
TALUS_INSTANTIATE(3)

}  // namespace talus
