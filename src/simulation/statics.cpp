#include "simulation/statics.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>
#include <sstream>

#include "output/replace_file.h"
#include "output/together.h"
#include "physics/boundary/boundary.h"
#include "physics/laws/drainage.h"
#include "physics/pores/soil_pores.h"
#include "scene/body_source.h"
#include "scene/boundary_source.h"
#include "scene/quasi_static_source.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "scene/water_source.h"
#include "scene/words.h"
#include "simulation/softening.h"
#include "solvers/quasi_static/thin_bodies.h"

namespace talus {
namespace {

/// What is wrong with a body that is one element across where elements are of first order, and what to do.
std::string one_element_across(const Scene &scene, const std::string &body) {
  // a base with friction has no quadratic elements in 3D
  const bool on_base = scene.dimension == 3 && std::ranges::any_of(scene.boundary, [](const BoundarySource &source) {
                         return read_boundary(source.kind).quasi_static == OnSoil::contact;
                       });
  return "body." + body +
         " is one element across, which elements of first order cannot resolve; refine the mesh there" +
         (on_base ? "" : ", or set quasi_static.elements = \"quadratic\"");
}

}  // namespace

template <int dim>
Statics<dim>::Statics(World<dim> &world, const Clock &clock) : world_(world), clock_(clock) {
  if (!world.phases.prescribed || !has_flow_stages(world.scene)) return;
  for (const auto &source : world.seepage_sources)
    for (const std::string &group : source.groups)
      if (!world.mesh.has_group(group) && group != free_surface)
        world.scene.complain("boundary." + source.name + ".group", "must name groups of facets; the mesh has no \"" +
                                                                       group + "\"; " +
                                                                       suggestion(group, world.mesh.group_names()));
  for (const BodySource &body : world.scene.body)  // curves that the motion of drained soil does without
    (void)SoilPores(body, world.scene.water->density, world.scene.water->viscosity);
}

template <int dim>
void Statics<dim>::make() {
  SoilData<dim> data;
  data.elements = elements();
  data.density = [this](const BodySource &source, const Vec<dim> &x, double t) {
    return world_.soil_density(source, x, t);
  };
  data.structures = world_.structures.get();
  data.open_water_load = world_.scene.water->open_water_load;
  if (world_.phases.prescribed) {
    data.pressure = [this](const Vec<dim> &x, double t, int soil) { return world_.pressure(x, t, soil); };
    data.apart = [this](int soil) { return world_.pressure.apart(soil); };
    if (has_flow_stages(world_.scene)) {
      const bool dries = std::any_of(world_.scene.body.begin(), world_.scene.body.end(),
                                     [](const BodySource &b) { return b.retention.reader; });
      world_.pressure.take(nullptr, nullptr);
      flow_ = std::make_unique<PoreFlow<dim>>(world_.mesh, world_.scene, world_.conditions.sources(), dries,
                                              world_.seepage_sources);
    }
  }
  if (world_.phases.liquid) {
    flow_ =
        std::make_unique<PoreFlow<dim>>(world_.mesh, world_.scene, world_.conditions.sources(), world_.phases.suction);
    data.flow = flow_.get();
  }
  problem_ =
      std::make_unique<QuasiStatic<dim>>(world_.mesh, world_.scene, world_.laws, world_.conditions.sources(), data);
  problem_->stop_asked = [comm = world_.comm] {
    int stop = interrupted;
    MPI_Allreduce(MPI_IN_PLACE, &stop, 1, MPI_INT, MPI_MAX, comm);
    return stop != 0;
  };
  for (size_t b = 0; b < world_.bodies.size(); ++b) {
    GaussPoints<dim> &p = problem_->soil().points()[b];
    const std::vector<Function> &given = world_.scene.body[b].stress;
    for (int q = 0; q < p.count() && !given.empty(); ++q)
      for (int k = 0; k < stress_size<dim>; ++k)
        p.stress[q * stress_size<dim> + k] =
            given[k](p.position[q][0], p.position[q][1], dim == 3 ? p.position[q][dim - 1] : 0, 0);
  }
}

template <int dim>
PetscErrorCode Statics<dim>::activate() {
  PetscFunctionBeginUser;
  PetscCall(problem_->activate(world_.present));
  if (world_.phases.liquid)
    PetscCall(flow_->activate(problem_->soil().active(), [this](const Vec<dim> &x) {
      return world_.motion->initial_pressure(x, clock_.load_time);
    }));
  if (world_.phases.prescribed)
    if (flow_)
      PetscCall(flow_->activate(problem_->soil().active(), [this](const Vec<dim> &x) {
        const Function &suction = world_.scene.water->suction;
        const double above = suction.given() ? suction(x[0], x[1], dim == 3 ? x[dim - 1] : 0, clock_.load_time)
                                             : world_.pressure.above_table(x, clock_.load_time);
        return world_.pressure(x, clock_.load_time, common_water) -
               (world_.pressure.below_table(x, clock_.load_time, common_water) ? 0 : above);
      }));
  PetscFunctionReturn(0);
}

template <int dim>
void Statics<dim>::prepare() {
  make();
  require(activate());
  current_ = true;
}

template <int dim>
void Statics<dim>::begin_stage(const Stage &stage, bool soil_moves) {
  if (!problem_) prepare();
  moved_.reset();
  if (moved_since_) to_gauss_points();
  const double before = strain_energy();
  world_.choose_bodies(stage, clock_);
  choose_laws(stage);
  if (world_.structures) world_.structures->begin_stage(stage);
  require(activate());
  require(world_.fix_dashpots(true, clock_.time));
  current_ = true, moved_since_ = false;
  check_supports(soil_moves);
  if (stage.begins_at_rest()) start_stress();
  check_structures();
  imposed_ += strain_energy() - before;
  problem_->set_acceleration(world_.scene.acceleration_in(stage));
  require(problem_->begin_path(clock_.load_time));
}

/// Structures lie in soil when they come, and their bond holds the prestress.
template <int dim>
void Statics<dim>::check_structures() const {
  if (!world_.structures) return;
  for (const Bar<dim> &bar : world_.structures->bars())
    for (int i = 0; bar.fresh && i < bar.points(); ++i)
      if (!bar.in_soil[i]) {
        std::ostringstream place;
        for (int d = 0; d < dim; ++d) place << (d ? ", " : "(") << bar.place[i][d];
        world_.scene.complain(
            "structure." + bar.name + ".points",
            "must lie in the soil that is there when the structure comes, and " + place.str() + ") m does not");
      }
  if (const std::string weak = problem_->structures().too_weak_for_prestress(); !weak.empty()) throw RunFailure(weak);
}

template <int dim>
double Statics<dim>::strain_energy() const {
  double energy = problem_->soil().strain_energy();
  MPI_Allreduce(MPI_IN_PLACE, &energy, 1, MPI_DOUBLE, MPI_SUM, world_.comm);
  return energy;
}

/// Excess pore pressure is gone, so that the effective stress is all.
template <int dim>
void Statics<dim>::let_water_go(GaussPoints<dim> &points) {
  const int memory = history_size(points.law);
  for (int q = 0; q < points.count(); ++q) {
    make_effective(points.law, &points.stress[q * stress_size<dim>], &points.history[q * memory]);
    points.history[(q + 1) * memory - 1] = 0;
  }
}

template <int dim>
Law Statics<dim>::law_in(const Stage &stage, size_t body) const {
  const Law &law = world_.laws[body];
  if (!law.holds_water()) return law;
  const std::vector<std::string> drained_in = read_drainage(world_.scene.body[body].law).drained_in;
  return std::ranges::count(drained_in, stage.name) ? law.holding_water(0) : law;
}

template <int dim>
void Statics<dim>::choose_laws(const Stage &stage) {
  for (size_t b = 0; b < world_.laws.size(); ++b) {
    GaussPoints<dim> &points = problem_->soil().points()[b];
    points.law = law_in(stage, b);
    if (points.law.holds_water() && points.law.pore_stiffness() == 0) let_water_go(points);
    // steps are large here: strength would fall within one, though it is not remembered
    const auto fields = history_fields(points.law);
    int sheared = 0;
    for (size_t k = 0; k < points.history.size(); ++k)
      sheared = sheared || (points.history[k] != 0 && !fields[k % fields.size()].of_stress);
    MPI_Allreduce(MPI_IN_PLACE, &sheared, 1, MPI_INT, MPI_MAX, world_.comm);
    if (!stage.softening && !sheared) points.law = without_softening(points.law);
  }
}

template <int dim>
double Statics<dim>::softening_strain() const {
  double sum = 0;
  for (size_t b = 0; b < world_.laws.size(); ++b) {
    const GaussPoints<dim> &points = problem_->soil().points()[b];
    if (!points.present || !softens(points.law)) continue;
    const int width = world_.bodies[b]->history_count(), field = plastic_strain_field(points.law);
    for (int q = 0; q < points.count(); ++q) sum += points.history[q * width + field];
  }
  MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM, world_.comm);
  return sum;
}

template <int dim>
void Statics<dim>::check_supports(bool soil_moves) const {
  std::string freedom;
  require(problem_->find_freedom(clock_.load_time, &freedom));
  if (!freedom.empty() && soil_moves)
    throw RunFailure("the supports leave soil free to move as a whole: " + freedom +
                     "; hold it by fixed or roller boundaries, or by a base with friction");
  if (elements() != Elements::quadratic && !world_.mesh.report().one_element_slice) {
    std::vector<int> body_of(world_.mesh.cell_count(), -1);
    for (int c = 0; c < world_.mesh.cell_count(); ++c)
      if (problem_->soil().active(c)) body_of[c] = problem_->soil().body_of(c);
    const std::vector<char> thin = find_thin_bodies(world_.mesh, body_of, world_.bodies.size());
    for (size_t b = 0; b < thin.size(); ++b)
      if (thin[b]) throw RunFailure(one_element_across(world_.scene, world_.scene.body[b].name));
  }
}

template <int dim>
void Statics<dim>::take_seeped_pressure() {
  require(flow_->pressure_of_cells(clock_.load_time, &seeped_cells_));
  use_seeped_pressure();
}

/// Laws that read suction see it, others take pressure below zero for none; by the retention curve it determines the
/// weight of the soil. Where no rank has a cell with a pressure, there was no seepage yet.
template <int dim>
void Statics<dim>::use_seeped_pressure() {
  const auto found = std::make_shared<const CellPressure<dim>>(world_.comm, seeped_cells_);
  if (found->empty()) return;
  seeped_ = found;
  const bool suction =
      std::any_of(world_.laws.begin(), world_.laws.end(), [](const Law &law) { return reads_suction(law); });
  auto felt = found;
  if (!suction) {
    std::vector<double> cells = seeped_cells_;
    for (size_t k = dim; k < cells.size(); k += dim + 1) cells[k] = std::max(0., cells[k]);
    felt = std::make_shared<const CellPressure<dim>>(world_.comm, cells);
  }
  std::vector<SoilPores> pores;
  for (const BodySource &body : world_.scene.body)  // all of them have a curve, or none
    if (body.retention.reader) pores.emplace_back(body, world_.scene.water->density, world_.scene.water->viscosity);
  typename PrescribedPressure<dim>::Saturation saturation;
  if (!pores.empty())
    saturation = [found, pores, first = world_.scene.body.data()](const BodySource &body, const double *x) {
      const double p = (*found)(x);
      return std::isnan(p) ? p : talus::saturation(pores[&body - first].retention(), std::max(0., -p));
    };
  const auto or_none = [felt](const double *x) {  // beside soil and open water
    const double p = (*felt)(x);
    return std::isnan(p) ? 0 : p;
  };
  world_.pressure.take(or_none, saturation);
}

template <int dim>
void Statics<dim>::save_seeped_pressure(const std::string &directory) const {
  const std::string file = directory + "/pore_pressure.csv";
  on_first_rank(world_.comm, [&] {
    if (seeped_)
      replace_file(file, seeped_->table());
    else
      std::filesystem::remove(file);
  });
}

template <int dim>
void Statics<dim>::serialize(Archive &archive) {
  bool begun = made();
  PathWork done = work();
  archive.serialize("statics", begun, current_, moved_since_, dilated);
  archive.serialize("work of statics", imposed_, done.stress, done.gravity, done.of_boundary);
  archive.records("pressure of seepage", seeped_cells_);
  std::string lost;
  for (const std::string &name : lost_stages) lost += name + '\n';
  archive.serialize("lost stages", lost);
  const bool any_holds_water =
      std::any_of(world_.laws.begin(), world_.laws.end(), [](const Law &law) { return law.holds_water(); });
  std::string drains(world_.laws.size(), '-');  // bodies whose water may leave in the stage that has ended
  for (size_t b = 0; problem_ && b < drains.size(); ++b) {
    const Law &law = problem_->soil().points()[b].law;
    if (law.holds_water() && law.pore_stiffness() == 0) drains[b] = '+';
  }
  if (any_holds_water) archive.serialize("soil that drains", drains);
  if (archive.reading()) {
    std::istringstream names(lost);
    lost_stages.clear();
    for (std::string name; std::getline(names, name);) lost_stages.push_back(name);
    if (begun) {
      make();
      for (size_t b = 0; b < drains.size(); ++b)
        if (drains[b] == '+') problem_->soil().points()[b].law = world_.laws[b].holding_water(0);
      require(activate());
    }
  }
  if (begun) {
    problem_->serialize(archive);
    problem_->set_work(done);
    if (flow_) flow_->serialize(archive);
  }
  if (archive.reading()) use_seeped_pressure();
}

template <int dim>
std::vector<double> Statics<dim>::inflow() const {
  if (flow_ && current_) return flow_->inflow();
  return std::vector<double>(world_.conditions.sources().size(),
                             world_.phases.liquid ? std::numeric_limits<double>::quiet_NaN() : 0);
}

/// Of the Gauss points of a cell in a value at a place that is linear between them; if `between`, none is negative.
template <int dim>
std::array<double, dim + 1> Statics<dim>::weights_of_points(const Barycentric<dim> &l, bool between) const {
  const SoilElements<dim> &soil = problem_->soil();
  const int per_cell = soil.points_per_cell();
  const double near = per_cell > 1 ? soil.rule().point[0][0] : 1, far = per_cell > 1 ? soil.rule().point[0][1] : 0;
  std::array<double, dim + 1> weight{};
  for (int a = 0; a < per_cell; ++a) weight[a] = per_cell > 1 ? (l[a] - far) / (near - far) : 1;
  if (between) {
    double sum = 0;
    for (double &w : weight) sum += w = std::max(w, 0.);
    for (double &w : weight) w /= sum;
  }
  return weight;
}

/// Stress is linear between the Gauss points of a cell; history too, but not beyond what the points have: strength must
/// not grow. Nor does stress go beyond them where it is `between`: what soil bears at all of them, it bears there.
template <int dim>
void Statics<dim>::interpolate(int cell, const Barycentric<dim> &l, bool between, double *stress,
                               double *history) const {
  const SoilElements<dim> &soil = problem_->soil();
  const int per_cell = soil.points_per_cell(), first = soil.first_point(cell), body = soil.body_of(cell);
  const auto weight = weights_of_points(l, between);
  const GaussPoints<dim> &points = soil.points()[body];
  const auto value = [&](const std::vector<double> &field, int width, int k) {
    double sum = 0;
    for (int a = 0; a < per_cell; ++a) sum += weight[a] * field[(first + a) * width + k];
    return sum;
  };
  for (int k = 0; k < stress_size<dim>; ++k) stress[k] = value(points.stress, stress_size<dim>, k);
  const int memory = world_.bodies[body]->history_count();
  for (int k = 0; k < memory; ++k) {
    double low = points.history[first * memory + k], high = low;
    for (int a = 1; a < per_cell; ++a)
      low = std::min(low, points.history[(first + a) * memory + k]),
      high = std::max(high, points.history[(first + a) * memory + k]);
    history[k] = std::clamp(value(points.history, memory, k), low, high);
  }
}

template <int dim>
void Statics<dim>::to_particles() {
  if (world_.motion->gathered()) require(world_.release(clock_.time));
  const bool anew = problem_->soil().restarted();
  for (size_t b = 0; b < world_.bodies.size(); ++b) {
    ParticleArrays<dim> &p = world_.bodies[b]->particles();
    const int memory = world_.bodies[b]->history_count();
    for (int i = 0; i < p.count; ++i) {
      const int cell = p.cell[i];
      const Barycentric<dim> l = barycentric(world_.mesh.cells[cell], p.position[i]);
      interpolate(cell, l, false, &p.stress[i * stress_size<dim>], p.history + i * memory);
      world_.bodies[b]->refer_to_stress(i);
      const Vec<dim> u = anew ? problem_->soil().displacement(cell, l) : problem_->soil().further_displacement(cell, l);
      for (int d = 0; d < dim; ++d)
        p.reference[i][d] = (anew ? p.position[i][d] : p.reference[i][d]) - u[d], p.velocity[i][d] = 0;
    }
  }
  problem_->soil().displacement_is_taken();
  require(
      world_.conditions.bases().set_normal_forces(world_.mesh, problem_->bases().normal_forces(), clock_.load_time));
  if (world_.phases.liquid)
    world_.motion->fill_pores([this](int cell, const Vec<dim> &x) {
      return flow_->pressure_at(cell, barycentric(world_.mesh.cells[cell], x));
    });
}

/// The active cell that holds x, or the one that x is least beyond; the same whatever the partition. -1 where another
/// rank has it. Collective.
template <int dim>
int Statics<dim>::cell_at(const Vec<dim> &x) const {
  constexpr double round_off = 1e-9;
  double least = std::numeric_limits<double>::lowest();  // of the barycentric coordinates in the best cell, zero inside
  long long mine = std::numeric_limits<long long>::max();
  int best = -1;
  for (int cell = 0; cell < world_.mesh.cell_count(); ++cell) {
    if (!problem_->soil().active(cell)) continue;
    const Barycentric<dim> l = barycentric(world_.mesh.cells[cell], x);
    const double lowest = *std::min_element(l.begin(), l.end()), within = lowest > -round_off ? 0 : lowest;
    if (within > least || (within == least && world_.mesh.global_cell[cell] < mine))
      least = within, mine = world_.mesh.global_cell[cell], best = cell;
  }
  double largest;
  MPI_Allreduce(&least, &largest, 1, MPI_DOUBLE, MPI_MAX, world_.comm);
  if (least < largest - round_off) mine = std::numeric_limits<long long>::max();
  long long winner;
  MPI_Allreduce(&mine, &winner, 1, MPI_LONG_LONG, MPI_MIN, world_.comm);
  return best >= 0 && mine == winner ? best : -1;
}

template <int dim>
std::optional<ParticleState<dim>> Statics<dim>::state_at(const Vec<dim> &x) const {
  const int cell = cell_at(x);
  if (cell < 0) return std::nullopt;
  Barycentric<dim> l = barycentric(world_.mesh.cells[cell], x);
  double sum = 0;
  for (double &coordinate : l) sum += coordinate = std::max(coordinate, 0.);
  for (double &coordinate : l) coordinate /= sum;
  ParticleState<dim> state;
  state.body = problem_->soil().body_of(cell), state.position = x;
  state.displacement = problem_->soil().displacement(cell, l);
  state.history.resize(world_.bodies[state.body]->history_count());
  if (world_.phases.prescribed) state.pore_pressure = world_.pressure(x, clock_.load_time, state.body);
  if (world_.phases.liquid) {
    state.pore_pressure = flow_->pressure_on_faces(cell, l), state.saturation = flow_->saturation(cell, l);
    state.suction = std::max(0., -state.pore_pressure);
  }
  const Law &law = world_.bodies[state.body]->law();
  state.strength =
      StrengthByPlace(world_.scene.body[state.body].law, law).shares(law, x[0], x[1], dim == 3 ? x[dim - 1] : 0);
  if (consolidates(law)) state.strength = shares_at(cell, l);
  interpolate(cell, l, false, state.stress.data(), state.history.data());
  if (!bears(cell, state)) interpolate(cell, l, true, state.stress.data(), state.history.data());
  state.softened_by = softened_by(cell, state.body, state.history.data());
  state.pore_pressure += make_effective(law, state.stress.data(), state.history.data());
  return state;
}

/// Finite elements soften by the strain of a point and the size of its cell.
template <int dim>
SofteningInput Statics<dim>::softened_by(int cell, int body, const double *history) const {
  const int field = plastic_strain_field(world_.bodies[body]->law());
  return {field < 0 ? 0 : history[field], element_size<dim>(world_.mesh.volume[cell])};
}

/// Is the stress within the strength of the soil in this cell? On a line from one Gauss point through another it may
/// leave it behind them.
template <int dim>
bool Statics<dim>::bears(int cell, const ParticleState<dim> &state) const {
  constexpr double round_off = 1e-9;
  const GaussPoints<dim> &points = problem_->soil().points()[state.body];
  if (never_fails(points.law)) return true;
  const int first = problem_->soil().first_point(cell), number = 0;
  std::array<double, stress_size<dim>> stress, admitted;
  std::copy_n(state.stress.begin(), stress_size<dim>, stress.begin());
  std::vector<double> history(state.history.begin(), state.history.end()), changed = history;
  admit_stress<dim>(points.law, {.count = 1,
                                 .stress_in = stress.data(),
                                 .history_in = history.data(),
                                 .stress_out = admitted.data(),
                                 .history_out = changed.data(),
                                 .cell = &number,
                                 .increment = &points.increment[first],
                                 .size = &points.size[first],
                                 .suction = points.suction.empty() ? nullptr : &points.suction[first],
                                 .cohesion_share = &state.strength.cohesion,
                                 .friction_share = &state.strength.friction});
  double largest = 0, change = 0;
  for (int k = 0; k < stress_size<dim>; ++k)
    largest = std::max(largest, std::abs(stress[k])), change = std::max(change, std::abs(admitted[k] - stress[k]));
  return change <= round_off * largest;
}

template <int dim>
Snapshot Statics<dim>::gauss_points() const {
  Snapshot s;
  s.time = clock_.time, s.step = clock_.steps, s.stage = clock_.stage;
  const auto fields = output_fields<GaussPointState<dim>>(world_.phases, world_.bodies);
  const SoilElements<dim> &soil = problem_->soil();
  const int per_cell = soil.points_per_cell();
  std::size_t count = 0;
  for (const GaussPoints<dim> &p : soil.points()) count += p.present ? p.count() : 0;
  s.columns = fields.columns(count);
  for (int b = 0; b < static_cast<int>(world_.bodies.size()); ++b) {
    const GaussPoints<dim> &p = soil.points()[b];
    if (!p.present) continue;
    for (int q = 0; q < p.count(); ++q) {
      const int cell = p.cell[q], place = q - soil.first_point(cell);
      const Barycentric<dim> &l = soil.rule().point[place];
      s.id.push_back(world_.mesh.global_cell[cell] * per_cell + place), s.body.push_back(b);
      GaussPointState<dim> point;
      point.body = b, point.position = p.position[q], point.displacement = soil.displacement(cell, l);
      std::copy_n(&p.stress[q * stress_size<dim>], stress_size<dim>, point.stress.begin());
      point.volume = p.volume[q];
      point.mass = p.volume[q] * (world_.soil_density(world_.scene.body[b], p.position[q], clock_.load_time) +
                                  (world_.phases.liquid ? flow_->water_density(cell, l) : 0));
      Stress<dim> strain;
      std::copy_n(&p.total_strain[q * stress_size<dim>], stress_size<dim>, &strain.xx);
      point.shear_strain = Invariants<dim>(strain).q * std::sqrt(4. / 3);
      if (!p.cohesion_share.empty()) point.strength = {p.cohesion_share[q], p.friction_share[q]};
      if (world_.phases.prescribed) point.pore_pressure = world_.pressure(p.position[q], clock_.load_time, b);
      if (world_.phases.liquid)
        point.pore_pressure = flow_->pressure_at(cell, l), point.saturation = flow_->saturation(cell, l),
        point.suction = std::max(0., -point.pore_pressure);
      point.history = p.history.data() + static_cast<size_t>(q) * world_.bodies[b]->history_count();
      point.softened_by = softened_by(cell, b, point.history);
      point.pore_pressure += make_effective(world_.laws[b], point.stress.data(), point.history);
      fields.append(point, s.columns);
    }
  }
  return s;
}

template <int dim>
void Statics<dim>::each_gauss_point(
    const std::function<void(const Vec<dim> &, const Vec<dim> &, double, double)> &visit) const {
  const SoilElements<dim> &soil = problem_->soil();
  for (int b = 0; b < static_cast<int>(world_.bodies.size()); ++b) {
    const GaussPoints<dim> &p = soil.points()[b];
    for (int q = 0; p.present && q < p.count(); ++q) {
      const int cell = p.cell[q];
      Stress<dim> strain;
      std::copy_n(&p.total_strain[q * stress_size<dim>], stress_size<dim>, &strain.xx);
      visit(p.position[q], soil.displacement(cell, soil.rule().point[q - soil.first_point(cell)]),
            p.volume[q] * world_.soil_density(world_.scene.body[b], p.position[q], clock_.load_time),
            Invariants<dim>(strain).q * std::sqrt(4. / 3));
    }
  }
}

template <int dim>
Elements Statics<dim>::elements() const {
  return world_.scene.finds_factor() ? Elements::quadratic : world_.scene.quasi_static->elements;
}

template class Statics<2>;
template class Statics<3>;

}  // namespace talus
