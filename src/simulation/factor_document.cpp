#include "simulation/factor_document.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace talus {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const FactorBracket &bracket) {
  const bool known = bracket.decided && bracket.lower > 0 && bracket.upper > 0;
  return {{"decided", bracket.decided},
          {"value", known ? bracket.value() : NAN},
          {"equilibrium", bracket.lower},
          {"mechanism", bracket.upper}};
}

Json json_of(const std::map<TrialFlow, FactorBracket> &by_flow) {
  Json object = Json::object();
  for (const auto &[flow, bracket] : by_flow) object[name_of(flow)] = json_of(bracket);
  return object;
}

Json json_of(const Mechanism &mechanism) {
  return {{"factor_of_safety", json_of(static_cast<const FactorBracket &>(mechanism))},
          {"by_flow", json_of(mechanism.by_flow)},
          {"moving_volume_m3", mechanism.moving_volume},
          {"low_m", mechanism.low},
          {"high_m", mechanism.high},
          {"share_of_critical_soil", mechanism.of_critical},
          {"slip_surface_m", mechanism.slip_surface}};
}

Json json_of(const FactorOfSafety &factor) {
  Json mechanisms = Json::array(), trials = Json::array();
  mechanisms.push_back(json_of(static_cast<const Mechanism &>(factor)));
  for (const Mechanism &m : factor.further) mechanisms.push_back(json_of(m));
  for (const StrengthTrial &t : factor.trials)
    trials.push_back({{"search", t.search},
                      {"factor", t.factor},
                      {"flow", name_of(t.flow)},
                      {"outcome", name_of(t.outcome)},
                      {"iterations", t.iterations},
                      {"steps", t.steps},
                      {"residual", t.residual},
                      {"displacement_m", t.displacement},
                      {"surplus_of_work", t.surplus},
                      {"wall_s", t.wall_seconds}});
  return {{"factor_of_safety", json_of(static_cast<const FactorBracket &>(factor))},
          {"flow", name_of(factor.flow)},
          {"by_flow", json_of(factor.by_flow)},
          {"weakened", factor.weakened.upper > 0 ? json_of(factor.weakened) : Json()},
          {"stages_without_equilibrium", factor.lost_stages},
          {"mechanisms", mechanisms},
          {"trials", trials}};
}

}  // namespace

std::string document_of(const FactorOfSafety &factor) { return json_of(factor).dump(1) + "\n"; }

}  // namespace talus
