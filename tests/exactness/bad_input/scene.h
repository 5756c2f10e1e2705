#pragma once
/// A small scene without fault, which each claim spoils in one place: a block of sand in a box with room to fall.
#include <stdexcept>
#include <string>

#include "program.h"

namespace talus {

inline const std::string good_section = R"(part,x,y
outline,0,0
outline,2,0
outline,2,1
outline,0,1
interface0,0,0.5
interface0,1,0.5
interface0,1,0
region_sand,0.5,0.25
region_air,1.5,0.5
)";

inline const std::string good_scene = R"(title = "a block of sand"
gravity = 9.81
[mesh]
section = "section.csv"
size = 0.25
[body.sand]
region = "sand"
density = 2000
law = "mohr_coulomb"
young_modulus = "1 MPa"
poisson_ratio = 0.3
cohesion = 0
friction_angle = 30
[boundary.base]
kind = "fixed"
[boundary.left]
kind = "roller"
[[stage]]
name = "fall"
duration = 0.05
[output]
interval = 0.01
)";

/// Two triangles of sand on a base, format 2.2.
inline const std::string good_mesh = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 1 "base"
2 2 "sand"
$EndPhysicalNames
$Nodes
4
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
$EndNodes
$Elements
3
1 1 2 1 1 1 2
2 2 2 2 1 1 2 3
3 2 2 2 1 1 3 4
$EndElements
)";

/// The text with one place changed, which must be there.
inline std::string changed(const std::string &text, const std::string &from, const std::string &to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("nothing to change: " + from);
  return text.substr(0, at) + to + text.substr(at + from.size());
}

}  // namespace talus
