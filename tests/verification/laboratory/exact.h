#pragma once
/// Element tests of an elastic soil (E = 20 MPa, nu = 0.3) and of Mohr-Coulomb soils, by `talus soil`'s own driver.
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void laboratory(Rung &rung) {
  constexpr double degree = 3.14159265358979323846 / 180, E = 20e6, nu = 0.3;
  struct Soil {
    int phi, cohesion;  // [deg], [kPa]
    double N() const { return std::pow(std::tan((45 + phi / 2.) * degree), 2); }
    double strength(double sigma_3) const { return sigma_3 * N() + 2000 * cohesion * std::sqrt(N()); }
    std::vector<std::string> keys() const {
      return {"material.law=mohr_coulomb", "material.friction_angle=" + std::to_string(phi),
              "material.cohesion=" + std::to_string(1000 * cohesion)};
    }
  };
  for (const Soil soil : {Soil{35, 5}, {47, 3}, {30, 3}, {40, 1}}) {
    const std::string of =
        " Mohr-Coulomb, phi " + std::to_string(soil.phi) + " deg, c " + std::to_string(soil.cohesion) + " kPa";
    rung.compare("compression sigma_1 [Pa]," + of, soil.strength(50e3),
                 -rung.element_test("compression", soil.keys()).back().stress[1], 1e-9);
  }
  const Soil sand{35, 5};
  rung.compare("biaxial sigma_1 [Pa], Mohr-Coulomb", sand.strength(50e3),
               -rung.element_test("biaxial", sand.keys()).back().stress[1], 1e-9);
  const double axial = -rung.element_test("extension", sand.keys()).back().stress[1];
  rung.compare("extension sigma_1 [Pa], Mohr-Coulomb", 100e3, sand.strength(axial), 1e-9);
  // without dilation p' stays, but for the 1e-8 of its volume that a step of 2.5e-4 loses to the midpoint rule, theory
  // (3.4)
  const double sine = std::sin(35 * degree), cosine = std::cos(35 * degree);
  rung.compare("undrained q [Pa], Mohr-Coulomb", 6 * (5e3 * cosine + 100e3 * sine) / (3 - sine),
               rung.element_test("undrained", sand.keys()).back().deviator(), 1e-6);

  // a plane that slips under an infinite slope, at constant stress across it: tan phi only if it dilates as much (Davis
  // 1968)
  for (const int psi : {0, 15, 35}) {
    const double slip = 1 - sine * std::sin(psi * degree);
    const ElementState state =
        rung.element_test("plane", {"material.law=mohr_coulomb", "material.friction_angle=35", "material.cohesion=5000",
                                    "material.dilation_angle=" + std::to_string(psi), "material.young_modulus=2e9"})
            .back();
    rung.compare("shear stress of a slipping plane [Pa], Mohr-Coulomb, psi " + std::to_string(psi) + " deg",
                 (100e3 * sine + 5e3 * cosine) * std::cos(psi * degree) / slip, state.stress[3], 1e-3);
  }

  const double G = E / (2 * (1 + nu)), K = E / (3 * (1 - 2 * nu)), M = K + 4 * G / 3;
  const auto oedometer = rung.element_test("oedometer");
  for (const int leg : {1, 2, 3}) {
    const double strain = std::vector<double>{0.02, 0.01, 0.04}[leg - 1];
    rung.compare("oedometer sigma_y [Pa], elastic, to " + number(100 * strain) + " %", 50e3 + M * strain,
                 -oedometer[200 * leg].stress[1], 1e-8);
  }
  rung.compare("isotropic p [Pa], elastic", 50e3 + 0.03 * K, rung.element_test("isotropic").back().mean_pressure(),
               1e-8);
  const ElementState end = rung.element_test("skempton").back();
  rung.compare("dp'/dp = 1 - B, elastic", 0.1, (end.mean_pressure() - 100e3) / (end.deviator() / 3), 1e-7);
}

}  // namespace talus::rungs
