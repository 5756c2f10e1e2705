#pragma once
/// How the pores of a soil drain where its pore water is not computed, and what strength it has then: keys beside those
/// of its law, docs/theory/laws/undrained.md.
#include <string>
#include <vector>

#include "base/units.h"
#include "scene/deferred.h"
#include "scene/function.h"

namespace talus {

/// [body.NAME.shansep]: s_u = S sigma'_v OCR^m (Ladd & Foott 1974) from the stress under which soil has consolidated.
struct Shansep {
  std::vector<std::string> stage;    ///< at whose ends the strength is taken
  double ratio = 0;                  ///< S, s_u / sigma'_v of normally consolidated soil [-]
  double exponent = 0.8;             ///< m [-]
  Function overconsolidation_ratio;  ///< OCR at the end of the stages, of the undeformed place [-]
  Function preconsolidation_stress;  ///< sigma'_p in place of it, of the undeformed place [Pa]
  double minimum = 0;                ///< of s_u [Pa]
  template <class Visitor>
  void fields(Visitor &&v) {
    v.texts("stage", stage,
            "name (or list of names) of the quasi-static or consolidation stages at whose ends the soil takes its "
            "undrained strength from its vertical effective stress; before the first of them it has its cohesion and "
            "friction_angle");
    v.number("ratio", ratio, one, Range{0, 2}, "S: undrained strength over vertical effective stress at OCR = 1");
    v.number("exponent", exponent, one, Range{0, 1.5}, "m: exponent of the overconsolidation ratio");
    v.function("overconsolidation_ratio", overconsolidation_ratio, one, Range{1, 100}, of::place,
               "OCR at the end of these stages, function of the undeformed place; default: 1");
    v.function("preconsolidation_stress", preconsolidation_stress, pascal, Range{0, 1e8}, of::place,
               "largest vertical effective stress of the past, function of the undeformed place, in place of "
               "overconsolidation_ratio: OCR is this over the present stress, and at least 1");
    v.number("minimum", minimum, pascal, Range{0, 1e7}, "least undrained strength, as near the ground");
  }
  std::string problem() const;
  bool given() const { return !stage.empty() || ratio > 0; }
};

struct Drainage {
  enum class Kind { drained, undrained } kind = Kind::drained;
  double undrained_poisson_ratio = 0.495;  ///< nu_u of soil and water together [-]
  double skempton_b = 0;                   ///< B, in place of it [-]; 0: not given
  std::vector<std::string> drained_in;     ///< stages in which the soil drains all the same
  Shansep shansep;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.choice(
        "drainage", kind, {{"drained", Kind::drained}, {"undrained", Kind::undrained}},
        "undrained: pore water cannot leave, and an excess pore pressure grows with the loss of volume; with "
        "effective c and phi (PLAXIS: Undrained A), or c_u as cohesion and friction_angle = 0 (Undrained B); needs "
        "phases = \"drained\" or \"dry\"");
    v.number("undrained_poisson_ratio", undrained_poisson_ratio, one, Range{0.1, 0.4999},
             "undrained: Poisson's ratio nu_u of the soil with its water, which gives K_w / n; above poisson_ratio");
    v.number("skempton_b", skempton_b, one, Range{0, 0.9999},
             "undrained: Skempton's B in place of undrained_poisson_ratio: excess pore pressure over the rise of the "
             "mean total stress in elastic soil; 0: not given");
    v.texts("drained_in", drained_in,
            "undrained: name (or list of names) of quasi-static stages in which the soil drains all the same, as "
            "under its own weight or in the long term; its excess pore pressure is then gone (PLAXIS: ignore undrained "
            "behaviour)");
    v.table("shansep", shansep,
            "undrained strength S sigma'_v OCR^m from the stress under which the soil has consolidated, in place of "
            "cohesion and friction_angle (SHANSEP)");
  }
  bool undrained() const { return kind == Kind::undrained; }
};

/// The keys in the table of a body.
Drainage read_drainage(const DeferredTable &body);

}  // namespace talus
