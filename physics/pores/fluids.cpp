#include "physics/pores/fluids.h"

#include "scene/water_source.h"

namespace talus {

Liquid::Liquid(const Water &water)
    : density(water.density),
      bulk_modulus(water.bulk_modulus),
      viscosity(water.viscosity),
      exponential(water.compression == Compression::exponential) {}

PoreGas::PoreGas(const Gas &gas) : density(gas.density), bulk_modulus(gas.bulk_modulus), viscosity(gas.viscosity) {}

}  // namespace talus
