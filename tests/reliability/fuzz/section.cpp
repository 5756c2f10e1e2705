// Fuzz target: sections, tables as spreadsheet programs save them.
#include "meshes/section.h"

#include "input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
  talus::take_or_refuse([&] {
    const talus::Section section = talus::read_section(talus::file_of(data, size));
    (void)section.area(), (void)section.largest_extent(), (void)talus::crossing_interfaces(section);
    for (const auto &x : section.outline.points) (void)section.layer_at(x);
  });
  return 0;
}
