#include "scene/scene.h"

#include <cmath>
#include <numeric>

#include "scene/reader.h"
#include "scene/tables.h"

namespace talus {

Scene::Scene() = default;
Scene::Scene(const Scene &) = default;
Scene &Scene::operator=(const Scene &) = default;
Scene::~Scene() = default;

double Scene::gravity_size() const {
  return std::sqrt(std::inner_product(gravity.begin(), gravity.end(), gravity.begin(), 0.));
}

std::array<double, 3> Scene::upward() const {
  std::array<double, 3> direction{};
  direction[vertical()] = 1;
  if (const double g = gravity_size(); g > 0)
    for (std::size_t d = 0; d < gravity.size(); ++d) direction[d] = -gravity[d] / g;
  return direction;
}

std::array<double, 3> Scene::acceleration_in(const Stage &one) const {
  std::array<double, 3> acceleration{};
  std::copy(gravity.begin(), gravity.end(), acceleration.begin());
  const std::vector<double> &parts = one.seismic_coefficient();
  for (std::size_t d = 0; d < parts.size(); ++d) acceleration[d] += gravity_size() * parts[d];
  return acceleration;
}

bool Scene::finds_factor() const {
  return std::ranges::any_of(stage, [](const Stage &one) { return one.finds_factor(); });
}

void Scene::add_factor_stage() {
  if (stage.back().finds_factor()) return;
  Stage &added = stage.emplace_back();
  added.name = "strength reduction", added.kind = FactorKeys{}, added.duration = 0, added.hold_loads = true;
}

std::string Scene::function_fault() const { return root ? root->function_fault() : ""; }
void Scene::forget_function_faults() const {
  if (root) root->forget_function_faults();
}

void Scene::complain(const std::string &key_path, const std::string &sentence) const {
  if (root) root->complain(key_path, sentence);
  throw SceneError(key_path + " " + sentence);  // a scene that a program filled in itself
}

}  // namespace talus
