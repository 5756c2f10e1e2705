#pragma once
/// How fast the soils of a scene soften, compared with their stiffness, their cells and the height of the ground.
#include <string>
#include <vector>

#include "physics/laws/law.h"
#include "simulation.h"

namespace talus {

/// Softening of one body, in the middle of its height.
struct Softening {
  double slope = 0;            ///< of strength over plastic strain at its steepest, over 2 G [-]; 0: no softening
  double critical_length = 0;  ///< of a slip surface that spreads by itself [m]; 0: no softening
};

/// What a slip surface needs to spread without more load: the length at which the strength that its slip costs equals
/// what the elastic soil around it gives back, 1.158 G / ((1 - nu) W) with the loss of strength per slip W [Pa/m].
/// Uenishi & Rice (2003), J. Geophys. Res. 108, 2042, for slip in plane strain; Palmer & Rice (1973) for slopes. A band
/// of width h slips by sqrt(3) h times its plastic strain (2.6), so W = slope 2 G / (sqrt(3) h). `size` is the width h
/// [m] to which the slope belongs: the size of a cell, or twice the averaging length.
double critical_slip_length(double slope, double poisson_ratio, double size);

/// Softening of each body, where the weight of the soil above its middle acts as the mean stress.
std::vector<Softening> softening_of(const Scene &scene, const std::vector<Law> &laws,
                                    const std::vector<BodyReport> &bodies);

/// A sentence for each body whose critical length is less than 1.5 times the height of all soil. Slip surfaces of
/// slopes are that long or longer. Where the critical length exceeds them, a surface loses strength along all its
/// length before the slope falls, and the load at failure hardly depends on the mesh. Where it is less, a slope falls
/// from one place inside it, at a load that depends on the cells and on the initial stress. docs/theory/README.md,
/// below (2.12): loads at failure with seven cell sizes are 4 % apart where the critical length is twice the height,
/// 19 % at 1.3, and 67 % at 0.8.
std::vector<std::string> brittle_soils(const Scene &scene, const std::vector<Law> &laws,
                                       const std::vector<BodyReport> &bodies);

}  // namespace talus
