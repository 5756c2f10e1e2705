#pragma once
/// [quasi_static]: finite elements.
#include "base/units.h"

namespace talus {

enum class Elements { quadratic, linear, patches };
enum class LinearSolver { automatic, direct, iterative };

/// Finite elements of quasi-static stages (docs/theory/finite_elements.md).
struct QuasiStaticSource {
  Elements elements = Elements::quadratic;
  double tolerance = 1e-8;      ///< Newton: out-of-balance force over the size of the forces [-]
  int iterations = 25;          ///< Newton: most iterations in a load step
  double smallest_step = 1e-3;  ///< share of a stage's loads below which equilibrium counts as lost [-]
  LinearSolver linear_solver = LinearSolver::automatic;
  double step_error = 1e-3;  ///< seepage, consolidation: what a step may miss, of pressure over its largest change and
                             ///< of saturation [-]
  template <class Visitor>
  void fields(Visitor &&v) {
    v.choice("elements", elements,
             {{"quadratic", Elements::quadratic}, {"linear", Elements::linear}, {"patches", Elements::patches}},
             "displacement of second order, of first order, or of first order with the patches against locking that "
             "the motion of particles uses");
    v.number(
        "tolerance", tolerance, one, Range{1e-14, 1e-2, {1e-12, 1e-4}},
        "Newton's iterations end when the ratio of the out-of-balance force to the applied forces is below this value");
    v.integer("iterations", iterations, Range{1, 1000, {5, 200}},
              "largest number of iterations in a load step, after which the step is halved");
    v.number("smallest_step", smallest_step, one, Range{1e-9, 1, {1e-6, 0.1}},
             "smallest step, as a share of the loads of the stage; equilibrium is lost if a smaller one is needed");
    v.choice("linear_solver", linear_solver,
             {{"automatic", LinearSolver::automatic},
              {"direct", LinearSolver::direct},
              {"iterative", LinearSolver::iterative}},
             "direct: LU (MUMPS); iterative: GMRES with algebraic multigrid (GAMG); automatic: chosen by the number of "
             "unknowns");
    v.number("step_error", step_error, one, Range{1e-8, 1, {1e-5, 0.05}},
             "seepage and consolidation: allowed error of a time step, of pressure relative to its largest change so "
             "far, which counts as a hundredth of the largest pressure at least, and of saturation");
  }
};

}  // namespace talus
