#include "physics/pores/soil_pores.h"

#include "scene/body_source.h"
#include "scene/reader.h"

namespace talus {

SoilPores::SoilPores(const BodySource &body, double unit_weight, double liquid_viscosity) {
  change_ = body.permeability_change, porosity_ = body.porosity;
  permeability_ =
      body.permeability > 0 ? body.permeability : body.hydraulic_conductivity * liquid_viscosity / unit_weight;
  gas_permeability_ = body.gas_permeability > 0 ? body.gas_permeability : permeability_;
  if (!body.retention.reader) return;
  read_one_of(body.retention, "curve", retention_);
  read_one_of(body.relative_permeability, "curve", relative_);
  residual_ = residual_saturation(retention_);
  inverse_range_ = 1 / (1 - residual_);
  const auto columns = [&](double wet, double dry) {
    const double suction = suction_at(retention_, wet, dry);
    const Wetness w{wet, dry, suction};
    return std::array<double, 3>{suction, talus::liquid_permeability(relative_, w),
                                 talus::gas_permeability(relative_, w)};
  };
  curves_.fill(wet_end, [&](double dry) { return columns(1 - dry, dry); });
  curves_.fill(dry_end, [&](double wet) { return columns(wet, 1 - wet); });
  entry_ = suction_at(retention_, 1, 0);
}

}  // namespace talus
