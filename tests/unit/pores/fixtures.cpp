#include "fixtures.h"

#include "scene/body_source.h"
#include "scene/reader.h"

namespace talus {

SoilPores soil_of(const std::string &text) {
  BodySource body;
  TableReader::from_text("law = \"linear_elastic\"\nporosity = 0.35\n" + text, "slope.toml").fill(body);
  return SoilPores(body, 1e4, 1e-3);
}

}  // namespace talus
