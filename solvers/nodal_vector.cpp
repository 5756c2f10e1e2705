#include "solvers/nodal_vector.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace talus {
namespace {

struct Content {
  NodalSpace *space;
  std::vector<double> data;  // [2 capacity]: u, then v, each `size()` long
};

Content &content(N_Vector x) { return *static_cast<Content *>(x->content); }
double *data(N_Vector x) { return content(x).data.data(); }
int length(N_Vector x) { return 2 * content(x).space->motion->size(); }

N_Vector clone(N_Vector like) {
  N_Vector x = N_VNewEmpty(like->sunctx);
  if (!x) return nullptr;
  N_VCopyOps(like, x);
  Content *copy = new Content{content(like).space, {}};
  copy->data.assign(content(like).data.size(), 0);
  x->content = copy;
  return x;
}

void destroy(N_Vector x) {
  if (!x) return;
  delete static_cast<Content *>(x->content);
  x->content = nullptr;
  N_VFreeEmpty(x);
}

template <class Operation>
void each(N_Vector z, Operation operation) {
  double *out = data(z);
  const int n = length(z);
#pragma omp simd
  for (int i = 0; i < n; ++i) out[i] = operation(i);
}

void linear_sum(double a, N_Vector x, double b, N_Vector y, N_Vector z) {
  const double *p = data(x), *q = data(y);
  each(z, [=](int i) { return a * p[i] + b * q[i]; });
}

void scale(double a, N_Vector x, N_Vector z) {
  const double *p = data(x);
  if (a == 1)
    std::copy_n(p, p == data(z) ? 0 : length(z), data(z));
  else
    each(z, [=](int i) { return a * p[i]; });
}

/// z = sum_k c_k x_k in one sweep over memory; z may be x_0.
int linear_combination(int count, double *c, N_Vector *x, N_Vector z) {
  constexpr int block = 256;
  double *out = data(z);
  const int n = length(z);
  double sum[block];
  for (int begin = 0; begin < n; begin += block) {
    const int size = std::min(block, n - begin);
    std::fill_n(sum, size, 0.);
    for (int k = 0; k < count; ++k) {
      const double *p = data(x[k]) + begin, a = c[k];
#pragma omp simd
      for (int i = 0; i < size; ++i) sum[i] += a * p[i];
    }
    std::copy_n(sum, size, out + begin);
  }
  return 0;
}

double max_norm(N_Vector x) {
  double largest = 0, all;
  for (int i = 0; i < length(x); ++i) largest = std::max(largest, std::abs(data(x)[i]));
  MPI_Allreduce(&largest, &all, 1, MPI_DOUBLE, MPI_MAX, content(x).space->motion->comm());
  return all;
}

}  // namespace

N_Vector make_nodal_vector(NodalSpace &space, SUNContext context) {
  N_Vector x = N_VNewEmpty(context);
  if (!x) return nullptr;
  x->content = new Content{&space, std::vector<double>(2 * static_cast<size_t>(space.motion->capacity()), 0)};
  auto &ops = *x->ops;
  ops.nvclone = clone, ops.nvdestroy = destroy;
  ops.nvgetlength = [](N_Vector y) { return static_cast<sunindextype>(length(y)); };
  ops.nvlinearsum = linear_sum, ops.nvscale = scale, ops.nvlinearcombination = linear_combination;
  ops.nvconst = [](double c, N_Vector z) { each(z, [=](int) { return c; }); };
  ops.nvprod = [](N_Vector a, N_Vector b, N_Vector z) { each(z, [p = data(a), q = data(b)](int i) { return p[i] * q[i]; }); };
  ops.nvdiv = [](N_Vector a, N_Vector b, N_Vector z) { each(z, [p = data(a), q = data(b)](int i) { return p[i] / q[i]; }); };
  ops.nvabs = [](N_Vector a, N_Vector z) { each(z, [p = data(a)](int i) { return std::abs(p[i]); }); };
  ops.nvinv = [](N_Vector a, N_Vector z) { each(z, [p = data(a)](int i) { return 1 / p[i]; }); };
  ops.nvaddconst = [](N_Vector a, double b, N_Vector z) { each(z, [p = data(a), b](int i) { return p[i] + b; }); };
  ops.nvmaxnorm = max_norm;
  ops.nvwrmsnorm = [](N_Vector e, N_Vector) { return error_norm(e); };  // the weights are in the space
  return x;
}

double *displacement_of(N_Vector y) { return data(y); }
double *velocity_of(N_Vector y) { return data(y) + length(y) / 2; }

double error_norm(N_Vector error) {
  NodalSpace &space = *content(error).space;
  const Motion &motion = *space.motion;
  const double u = space.displacement_tolerance, v = space.velocity_tolerance;
  double sums[2] = {motion.seen_square(displacement_of(error)) / (u * u) + motion.seen_square(velocity_of(error)) / (v * v),
                    space.inverted ? 1. : 0.};
  space.inverted = false;
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, motion.comm());
  if (sums[1] > 0) ++space.inversions;
  constexpr double hopeless = 1e10;
  const double norm = std::sqrt(sums[0] / motion.mass());
  return sums[1] == 0 && norm < hopeless ? norm : hopeless;
}

}  // namespace talus
