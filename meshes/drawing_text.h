#pragma once
/// The text of a DXF file (Autodesk, DXF reference): pairs of lines, a group code and its value. GDAL passes over what
/// it cannot read, so that the text is checked before GDAL turns it into lines and points.
#include <functional>
#include <map>
#include <string>

namespace talus {

struct DrawnEntity {
  std::string kind, layer;  ///< such as "LWPOLYLINE"; the layer in small letters
};

struct DrawingText {
  std::map<int, DrawnEntity> entities;  ///< of the section ENTITIES, by the line of the file where each begins
  int unit = 0;                         ///< number of $INSUNITS; 0: none
  std::string marked;                   ///< the text, in which the handle of each entity is its line, in hexadecimal
};

/// The name of a layer in small letters, without outer blanks.
std::string layer_name(const std::string &text);

/// Throws std::invalid_argument with file and line for files that are no text, end early, or whose sections are not
/// closed; and for entities on layers that are `used`, and blocks, whose numbers cannot be read whole, that lack some,
/// or that are neither lines nor points.
DrawingText read_drawing_text(const std::string &file, const std::function<bool(const std::string &layer)> &used);

}  // namespace talus
