// What only mesh, soil or particles can tell is wrong with a scene: complaints at the door, before the first step;
// included only where it is instantiated (src/variants).
#include <algorithm>
#include <cmath>

#include "scene/words.h"
#include "simulation/simulation_impl.h"

namespace talus {

template <int dim>
void Simulation<dim>::check_bodies() const {
  const auto check_lattice = [&](const std::string &path, int count) {
    if (lattice<dim>(count).empty())
      scene_.complain(path + ".particles_per_cell",
                      std::string("has no lattice of that many points; take ") +
                          (dim == 2 ? "1, 3, 4, 6, 9, 10, 12, 15 or 16" : "1, 4, 8, 10 or 20"));
  };
  std::vector<int> owner(mesh_.cell_count(), -1);
  for (int b = 0; b < static_cast<int>(scene_.body.size()); ++b) {
    const BodySource &body = scene_.body[b];
    const std::string path = "body." + body.name;
    int other = -1;
    for (const std::string &region : body.region) {
      if (!mesh_.has_region(region))
        scene_.complain(path + ".region", "must name groups of cells; the mesh has no \"" + region + "\"; " +
                                              suggestion(region, mesh_.region_names()));
      for (int cell : mesh_.region(region)) {
        if (owner[cell] >= 0 && owner[cell] != b) other = owner[cell];
        owner[cell] = b;
      }
    }
    MPI_Allreduce(MPI_IN_PLACE, &other, 1, MPI_INT, MPI_MAX, comm_);
    if (other >= 0)
      scene_.complain(path + ".region",
                      "fills cells that body." + scene_.body[other].name + " fills too; give each cell to one body");
    if (!phases_.prescribed && !phases_.suction && reads_suction(laws_[b]))
      scene_.complain(path + ".law", std::string("takes strength from suction, and `phases = \"") + phases_.name +
                                         "\"` has none; model the water (`phases = \"drained\"` and a [water] excess "
                                         "below zero), or leave out the "
                                         "keys suction_...");
    check_lattice(path, body.particles_per_cell);
    for (size_t k = 0; k < body.dense.size(); ++k)
      check_lattice(path + ".dense." + std::to_string(k), body.dense[k].particles_per_cell);
  }
}

template <int dim>
void Simulation<dim>::check_boundaries(const std::vector<typename Conditions<dim>::Source> &sources) const {
  const bool quasi_static =
      std::any_of(scene_.stage.begin(), scene_.stage.end(), [](const Stage &stage) { return is_static(stage.kind); });
  for (const auto &source : sources) {
    const std::string path = "boundary." + source.name;
    for (const std::string &group : source.groups)
      if (!mesh_.has_group(group) && !(concerns_water(source.kind) && group == free_surface))
        scene_.complain(path + ".group", "must name groups of facets; the mesh has no \"" + group + "\"; " +
                                             suggestion(group, mesh_.group_names()));
    if (concerns_water(source.kind) && !phases_.liquid)
      scene_.complain(path, std::string("is a boundary of moving pore water, but phases = \"") + phases_.name +
                                "\" has none; set phases = \"saturated\", \"unsaturated\" or \"three-phase\"");
    if (concerns_gas(source.kind) && !phases_.gas)
      scene_.complain(path + ".kind", std::string("is a boundary of moving pore gas, but phases = \"") + phases_.name +
                                          "\" has none; set phases = \"three-phase\"");
    const auto check_vector = [&](const char *key, const std::vector<Function> &value) {
      if (!value.empty() && value.size() != dim)
        scene_.complain(path + "." + key, "must have " + std::to_string(dim) + " components");
    };
    const bool has_static_form = std::visit(
        [](const auto &kind) {
          return requires { kind.template directions<dim>(Vec<dim>{}); }
          || requires { kind.template load<dim>(Vec<dim>{}, Vec<dim>{}, 0.); };
        },
        source.kind);
    if (quasi_static && !has_static_form && !concerns_water(source.kind))
      scene_.complain(path + ".kind", "has no quasi-static form; take fixed, roller, velocity or traction");
    if (const auto *moved = std::get_if<PrescribedVelocity>(&source.kind)) check_vector("velocity", moved->velocity);
    if (const auto *loaded = std::get_if<Traction>(&source.kind)) check_vector("traction", loaded->traction);
  }
}

/// What the functions of place made of a body's particles. Collective.
template <int dim>
void Simulation<dim>::check_seeded(const Body<dim> &body, const std::string &path) const {
  const ParticleArrays<dim> &p = body.particles();
  const auto check = [&](const char *key, auto &&finite) {
    int bad = 0;
    while (bad < p.count && finite(bad)) ++bad;
    const std::string where = place_of(bad < p.count, bad < p.count ? p.reference[bad] : Vec<dim>{});
    if (!where.empty()) scene_.complain(path + "." + key, "is no number at " + where);
  };
  const auto all_finite = [](const double *x, int count) {
    return std::all_of(x, x + count, [](double value) { return std::isfinite(value); });
  };
  check("velocity", [&](int i) { return all_finite(p.velocity[i].data(), dim); });
  check("stress", [&](int i) { return all_finite(p.stress + i * stress_size<dim>, stress_size<dim>); });
  check("displacement", [&](int i) { return all_finite(p.position[i].data(), dim) && p.volume[i] > 0; });
}

/// A fixed step that the first state already forbids is bad input; one that a later state forbids ends the run.
template <int dim>
void Simulation<dim>::check_step() {
  const StepRule rule = step_rule(integrator_settings_);
  if (rule.fixed == 0) return;
  double critical =
      rule.bound == FrequencyBound::mesh || explicit_drag() ? critical_step() : std::numeric_limits<double>::infinity();
  if (std::isinf(critical))
    for (const BodyReport &body : bodies()) critical = std::min(critical, body.critical_step);
  if (rule.fixed > rule.limit * critical)
    scene_.complain("integrator.step", "must not exceed the critical step of " + rounded(rule.limit * critical) +
                                           " s (" + rounded(2 * rule.limit) + " / omega_max of the filled cells" +
                                           (explicit_drag() ? ", less for explicit drag" : "") +
                                           "); take a smaller step, a coarser mesh, or leave step out");
}

/// A picture that nobody can draw is refused before the run, not missed after it.
template <int dim>
void Simulation<dim>::check_pictures() {
  if (scene_.output.picture.empty()) return;
  const Snapshot state = snapshot();
  std::vector<std::string> known;
  for (const Column &column : state.columns)
    if (column.name != "position") known.push_back(column.name);
  for (const std::string &field : scene_.output.picture) {
    const bool drawn = std::any_of(state.columns.begin(), state.columns.end(), [&](const Column &column) {
      return field == column.name || (column.components > 1 && field.rfind(column.name + "_", 0) == 0);
    });
    if (!drawn)
      scene_.complain("output.picture",
                      "names \"" + field + "\", which this run does not have; " + suggestion(field, known));
  }
}

}  // namespace talus
