#pragma once
/// A cross-section drawn with a CAD program, as a DXF file. Its layers are the parts of a section (section.h), written
/// in capitals or not:
///
///   outline, interfaceN, b_NAME   lines and polylines, in pieces of any order and direction that join at their ends
///   region_NAME                   a point or a text in the piece
///   refine_SIZE                   closed polylines, whose boxes are refined
///
/// Other layers are left out. x goes along the section and y upwards. All numbers, also SIZE, are in the unit of the
/// drawing ($INSUNITS), or in metres where it has none. Arcs and curves become chords, of 4 degrees of an arc.
#include <string>
#include <vector>

#include "meshes/section.h"

namespace talus {

struct Drawing {
  SectionRows rows;
  std::vector<std::string> doubts;  ///< what the user should know: layers that are left out
};

bool is_drawing(const std::string &file);  ///< by the ending of its name

/// Throws std::invalid_argument with file, line and what to do for files that are no drawing or no whole one
/// (drawing_text.h), units that are no length, points out of the plane, pieces that do not join, and entities of
/// another kind than their layer asks for.
Drawing read_drawing(const std::string &file);

}  // namespace talus
