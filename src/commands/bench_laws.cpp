#include "commands/bench_laws.h"

#include <petsctime.h>

#include <algorithm>
#include <random>

#include "physics/laws/update_stress.h"
#include "scene/reader.h"

namespace talus {
namespace {

struct Soil {
  DeferredTable law;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.deferred("law", law, "soil model");
  }
};

const std::string elastic = "young_modulus = 1e7\npoisson_ratio = 0.3\n",
                  frictional = elastic + "cohesion = 1e3\nfriction_angle = 30\n";
const std::string softening = "residual_cohesion = 5e2\nresidual_friction_angle = 25\nshape_factor = 50\n",
                  wet = "suction_cohesion = 1e4\nsuction_cohesion_rate = 1e-6\n";
const std::vector<std::pair<std::string, std::string>> soils = {
    {"linear_elastic", "law = \"linear_elastic\"\n" + elastic},
    {"drucker_prager", "law = \"drucker_prager\"\n" + frictional},
    {"drucker_prager, softening", "law = \"drucker_prager\"\n" + frictional + softening},
    {"mohr_coulomb", "law = \"mohr_coulomb\"\n" + frictional},
    {"mohr_coulomb, suction", "law = \"mohr_coulomb\"\n" + frictional + wet},
    {"mohr_coulomb, softening", "law = \"mohr_coulomb\"\n" + frictional + softening},
    {"mohr_coulomb, softening, suction", "law = \"mohr_coulomb\"\n" + frictional + softening + wet},
    {"hoek_brown", "law = \"hoek_brown\"\n" + elastic +
                       "intact_strength = 3e7\ngeological_strength_index = 5\nintact_constant = 2\n"},
    {"cam_clay",
     "law = \"cam_clay\"\ncompression_slope = 0.2\nswelling_slope = 0.04\ncritical_stress_ratio = 1\npoisson_ratio = "
     "0.3\n"
     "void_ratio = 1\npreconsolidation_pressure = 1e5\n"},
    {"mu_i", "law = \"mu_i\"\n" + elastic + "static_friction = 0.38\nlimiting_friction = 0.64\ngrain_size = 1e-3\n"},
    {"newtonian", "law = \"newtonian\"\n" + elastic + "viscosity = 10\n"},
    {"bingham", "law = \"bingham\"\n" + elastic + "viscosity = 10\nyield_stress = 1e3\n"},
    {"hencky_elastic", "law = \"hencky_elastic\"\n" + elastic},
    {"hencky_mohr_coulomb", "law = \"hencky_mohr_coulomb\"\n" + frictional},
    {"hencky_drucker_prager", "law = \"hencky_drucker_prager\"\n" + frictional},
};

/// Best of many rounds [ns] of an update of random points around an isotropic pressure.
template <int dim>
double time_of(const Law &law, bool with_tangent) {
  constexpr int count = 1024, size = stress_size<dim>;
  const int memory = history_size(law), rounds = with_tangent ? 3 : 100;
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> random(-1, 1);
  std::vector<double> stress(count * size), history(count * memory), element_size(count, 1), suction(count, 3e4);
  std::vector<double> stress_out(stress.size()), history_out(history.size()),
      tangent(with_tangent ? count * size * size : 0);
  std::vector<Increment<dim>> increment(count);
  std::vector<int> cell(count);
  for (int i = 0; i < count; ++i) {
    cell[i] = i;
    for (int k = 0; k < size; ++k)
      stress[i * size + k] = (k < 3 ? -5e4 : 0) + 2e4 * random(generator),
                        increment[i].strain[k] = 2e-3 * random(generator);
    increment[i].rotation = {};
    for (int d = 0; d < (dim == 2 ? 1 : 3); ++d) increment[i].rotation[4 * d] = 1;
  }
  const StressPoints<dim> points{.count = count,
                                 .stress_in = stress.data(),
                                 .history_in = history.data(),
                                 .stress_out = stress_out.data(),
                                 .history_out = history_out.data(),
                                 .cell = cell.data(),
                                 .increment = increment.data(),
                                 .size = element_size.data(),
                                 .suction = suction.data(),
                                 .time_step = 1e-3};
  double best = 1e30;
  for (int round = 0; round < rounds; ++round) {
    PetscLogDouble start, end;
    PetscTime(&start);
    if (with_tangent)
      update_stress_with_tangent<dim>(law, points, tangent.data());
    else
      update_stress<dim>(law, points);
    PetscTime(&end);
    best = std::min(best, 1e9 * (end - start) / count);
  }
  return best;
}

}  // namespace

const std::vector<std::pair<std::string, std::string>> &bench_soils() { return soils; }

std::vector<LawRate> measure_laws() {
  std::vector<LawRate> rates;
  for (const auto &[label, text] : soils) {
    Soil soil;
    TableReader::from_text(text, "bench").fill(soil);
    const Law law = read_law(soil.law);
    rates.push_back({label, time_of<2>(law, false), time_of<3>(law, false), time_of<3>(law, true)});
  }
  return rates;
}

}  // namespace talus
