// Fuzz target: scenes, their overrides, and the tables of laws, boundaries and pores, which are read later.
#include "scene/scene.h"

#include "input.h"
#include "physics/boundary/boundary.h"
#include "physics/laws/law.h"
#include "physics/pores/soil_pores.h"
#include "scene/body_source.h"
#include "scene/boundary_source.h"
#include "scene/reader.h"
#include "scene/water_source.h"

namespace talus {
namespace {

/// Values of functions, which muParser computes.
void evaluate(const Function &function) {
  if (function.given())
    for (const double at : {0., -1., 1e300}) (void)function(at, at, at, at, at);
}

void read_tables(const Scene &scene) {
  for (const BodySource &body : scene.body) {
    take_or_refuse([&] { (void)read_law(body.law); });
    take_or_refuse([&] { (void)SoilPores(body, 9810, 1e-3); });
    for (const auto *functions : {&body.velocity, &body.displacement, &body.stress, &body.body_acceleration})
      for (const Function &function : *functions) evaluate(function);
  }
  for (const BoundarySource &boundary : scene.boundary) take_or_refuse([&] { (void)read_boundary(boundary.kind); });
  evaluate(scene.water->level), evaluate(scene.water->excess);
}

}  // namespace
}  // namespace talus

/// The text of a scene; lines behind it that begin with --set are overrides.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
  std::string text(reinterpret_cast<const char *>(data), size);
  std::vector<std::string> overrides;
  for (std::size_t at; (at = text.rfind("\n--set ")) != std::string::npos; text.resize(at))
    overrides.insert(overrides.begin(), text.substr(at + 7));
  if (text.find("umat") != std::string::npos) return 0;  // loads any library of the machine
  talus::take_or_refuse([&] { talus::read_tables(talus::parse_scene(text, "scene.toml", overrides)); });
  return 0;
}
