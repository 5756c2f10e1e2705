#pragma once
/// The names of all doubts, by which a scene acknowledges them.
#include <string>
#include <string_view>

namespace talus {

/// Keys with a usual range, and after `young_modulus` relations between things; between blanks.
inline constexpr std::string_view doubt_names =
    " adhesion air_entry attraction averaging_length baseline bond_adhesion bond_friction_angle bulk_modulus cohesion "
    "compression_slope"
    " critical_stress_ratio curvature"
    " damping damping_ratio decay_suction density diameter dilation_angle displacement_tolerance drying_suction "
    "duration"
    " energy_ratio"
    " excess exponent failure_speed failure_time floor force_ratio fraction friction_angle gas_permeability"
    " grain_density grain_size gravity ground_damping ground_frequency heat_capacity high_pass hydraulic_conductivity"
    " geological_strength_index inertial_number inflow intact_constant intact_strength intensity iterations k0 "
    "largest_speed limit limiting_friction load_steps mean_pressure"
    " overconsolidation_ratio particles_per_cell"
    " peak permeability pic_fraction plasticity_index poisson_ratio"
    " pore_pressure_ratio pore_size_index porosity preconsolidation_pressure pressure reference_size"
    " reference_strain reference_suction relaxation residual_cohesion residual_dilation_angle residual_friction_angle"
    " residual_saturation rest_speed rotation rupture_strain saturated_unit_weight scale seismic_coefficient shape "
    "shape_factor "
    "shear_modulus"
    " smallest_step solid_density spacing static_friction step_error storage suction suction_cohesion swelling_slope"
    " tensile_strength tension_cutoff thermal_conductivity thermal_pressurisation thickness tolerance unit_weight "
    "velocity_tolerance"
    " viscosity void_ratio volume_cap yield_stress young_modulus base_slips brittle cavitation changing_table"
    " coarse_cells drainage drift dry_boundary dry_pond early_suction excess_alone faces_left film"
    " free_side gravity_at_once gravity_ramp idle_earthquake late_load mesh_end mesh_units"
    " open_water pore_flow relative_permeability sealed_ground short_waves soft_water steep_face"
    " strength thin_body undrained_stage void water_table ";

constexpr bool is_doubt_name(std::string_view name) {
  return doubt_names.find(" " + std::string(name) + " ") != std::string_view::npos;
}

/// A name of the list; another one does not compile.
struct DoubtName {
  std::string_view name;
  consteval DoubtName(const char *text) : name(text) {  // NOLINT: a text is a name
    if (!is_doubt_name(name)) throw "no name of doubt_names";
  }
};

}  // namespace talus
