#include "tests/verify/rung.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "scene/reader.h"
#include "scene/scene.h"

namespace talus {
namespace {

template <class T>
std::vector<T> of_all_ranks(const std::vector<T> &mine, MPI_Datatype type) {
  int ranks, count = static_cast<int>(mine.size());
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  std::vector<int> counts(ranks), starts(ranks + 1, 0);
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, PETSC_COMM_WORLD);
  std::partial_sum(counts.begin(), counts.end(), starts.begin() + 1);
  std::vector<T> all(starts[ranks]);
  MPI_Allgatherv(mine.data(), count, type, all.data(), counts.data(), starts.data(), type, PETSC_COMM_WORLD);
  return all;
}

Snapshot of_all_ranks(const Snapshot &mine) {
  Snapshot all = mine;
  const auto id = of_all_ranks(mine.id, MPI_LONG_LONG);
  const auto body = of_all_ranks(mine.body, MPI_INT);
  std::vector<size_t> order(id.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return id[a] < id[b]; });
  all.id.clear(), all.body.clear();
  for (size_t i : order) all.id.push_back(id[i]), all.body.push_back(body[i]);
  for (Column &column : all.columns) {
    const auto values = of_all_ranks(column.values, MPI_DOUBLE);
    column.values.clear();
    for (size_t i : order)
      for (int k = 0; k < column.components; ++k) column.values.push_back(values[i * column.components + k]);
  }
  return all;
}

}  // namespace

Run Rung::run(const std::vector<std::string> &overrides) {
  if (compared_) wall_seconds_ = 0, compared_ = false;
  const auto begin = std::chrono::steady_clock::now();
  Scene scene = read_scene(scene_, overrides);
  RunOptions options;
  options.pictures = options.screen = false, options.gauss_points = true;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  Run run;
  run.start = of_all_ranks(simulation->snapshot());
  simulation->run();
  run.end = of_all_ranks(simulation->snapshot());
  run.history = simulation->history(), run.events = simulation->events();
  run.steps = simulation->steps(), run.remaps = simulation->remaps();
  simulation->nodal_field("velocity", [&](PetscInt, const double *v) {
    for (int d = 0; d < scene.dimension; ++d) run.nodal_speed = std::max(run.nodal_speed, std::abs(v[d]));
  });
  MPI_Allreduce(MPI_IN_PLACE, &run.nodal_speed, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  wall_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return run;
}

FactorOfSafety Rung::factor_of_safety(const std::vector<std::string> &overrides) {
  if (compared_) wall_seconds_ = 0, compared_ = false;
  const auto begin = std::chrono::steady_clock::now();
  Scene scene = read_scene(scene_, overrides);
  scene.add_factor_stage();
  RunOptions options;
  options.pictures = options.screen = false, options.gauss_points = true;
  const FactorOfSafety factor = make_simulation(PETSC_COMM_WORLD, scene, options)->factor_of_safety();
  wall_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return factor;
}

std::vector<ElementState> Rung::element_test(const std::string &name, const std::vector<std::string> &overrides) {
  if (compared_) wall_seconds_ = 0, compared_ = false;
  const auto begin = std::chrono::steady_clock::now();
  SoilFile soil;
  TableReader::from_file(scene_, overrides).fill(soil);
  const auto found =
      std::find_if(soil.test.begin(), soil.test.end(), [&](const ElementTest &test) { return test.name == name; });
  if (found == soil.test.end()) throw std::out_of_range("no test " + name + " in " + scene_);
  const auto states = drive(read_law(soil.material.law), *found);
  wall_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return states;
}

void Rung::compare(const std::string &quantity, double exact, double computed, double tolerance, double scale) {
  const double error = std::abs(computed - exact) / (scale > 0 ? scale : std::abs(exact));
  quantities_.push_back({quantity, exact, computed, error, tolerance, wall_seconds_});
  compared_ = true;
}

void Rung::report(const std::string &quantity, double exact, double computed, double scale) {
  compare(quantity, exact, computed, std::numeric_limits<double>::infinity(), scale);
}

std::string number(double x) {
  char text[32];
  return std::string(text, std::to_chars(text, text + sizeof text, x).ptr);
}

std::vector<double> component(const Snapshot &snapshot, const std::string &field, int k) {
  for (const Column &column : snapshot.columns)
    if (column.name == field) {
      std::vector<double> values;
      for (size_t i = 0; i < snapshot.id.size(); ++i) values.push_back(column.values.at(i * column.components + k));
      return values;
    }
  throw std::out_of_range("no field " + field + " in the snapshot");
}

double at_time(const HistoryTable &history, const std::string &column, double t) {
  const auto time = history.column("time_s"), value = history.column(column);
  for (size_t i = 1; i < time.size(); ++i)
    if (t <= time[i] * (1 + 1e-12))
      return value[i - 1] + (value[i] - value[i - 1]) * (t - time[i - 1]) / (time[i] - time[i - 1]);
  throw std::out_of_range("the history of " + column + " ends before t = " + std::to_string(t));
}

}  // namespace talus
