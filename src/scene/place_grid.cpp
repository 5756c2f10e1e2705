#include "scene/place_grid.h"

namespace talus {
namespace {

const NamedGrids none;
const NamedGrids *callable = &none;
std::vector<std::weak_ptr<PlaceGrid>> remembered;

}  // namespace

CallableGrids::CallableGrids(const NamedGrids &grids) { callable = &grids; }
CallableGrids::~CallableGrids() { callable = &none; }
const NamedGrids &CallableGrids::now() { return *callable; }

void remember(const std::shared_ptr<PlaceGrid> &grid) {
  std::erase_if(remembered, [](const std::weak_ptr<PlaceGrid> &one) { return one.expired(); });
  remembered.push_back(grid);
}

std::vector<std::shared_ptr<PlaceGrid>> grids_of(const std::string &scene) {
  std::vector<std::shared_ptr<PlaceGrid>> found;
  for (const std::weak_ptr<PlaceGrid> &one : remembered)
    if (auto grid = one.lock(); grid && grid->scene == scene) found.push_back(std::move(grid));
  return found;
}

}  // namespace talus
