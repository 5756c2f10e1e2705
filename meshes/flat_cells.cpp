#include "meshes/flat_cells.h"

#include <algorithm>
#include <array>
#include <map>

#include "meshes/simplex.h"

namespace talus {
namespace {

using Nodes = std::array<std::size_t, 3>;  // of a facet, ascending

Nodes facet(const std::size_t *node) {
  Nodes nodes{node[0], node[1], node[2]};
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

/// The facet of a cell across from its node k.
Nodes facet_across(const std::size_t *cell, int k) {
  std::array<std::size_t, 3> others;
  for (int a = 0, n = 0; a < 4; ++a)
    if (a != k) others[n++] = cell[a];
  return facet(others.data());
}

double quality_of(const std::function<Vec<3>(std::size_t)> &place, const std::size_t *cell) {
  std::array<Vec<3>, 4> corner;
  for (int a = 0; a < 4; ++a) corner[a] = place(cell[a]);
  const Simplex<3> simplex(corner);
  return has_no_volume<3>(corner, simplex.volume) ? 0 : shape<3>(corner, simplex.gradient).quality;
}

}  // namespace

int drop_flat_cells(const std::function<Vec<3>(std::size_t)> &place, std::vector<NodeList> &volumes,
                    std::vector<NodeList> &surfaces) {
  constexpr double flat = 0.05;  // quality: its height is a fiftieth of its edges
  struct At {
    int surface = 0;
    std::size_t first = 0;  // of its nodes there
    int cells = 0;
  };
  std::map<Nodes, At> on_surface;
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    for (std::size_t k = 0; k + 2 < surfaces[s].size(); k += 3)
      on_surface[facet(&surfaces[s][k])] = {static_cast<int>(s), k, 0};
  for (const NodeList &cells : volumes)
    for (std::size_t c = 0; c < cells.size(); c += 4)
      for (int k = 0; k < 4; ++k)
        if (const auto found = on_surface.find(facet_across(&cells[c], k)); found != on_surface.end())
          ++found->second.cells;
  int dropped = 0;
  for (NodeList &cells : volumes) {
    std::size_t kept = 0;
    for (std::size_t c = 0; c < cells.size(); c += 4) {
      std::vector<std::map<Nodes, At>::iterator> borne;
      std::vector<Nodes> inside;
      for (int k = 0; k < 4; ++k) {
        const Nodes nodes = facet_across(&cells[c], k);
        const auto found = on_surface.find(nodes);
        if (found == on_surface.end())
          inside.push_back(nodes);
        else
          borne.push_back(found);
      }
      const bool lies = borne.size() == 2 && borne[0]->second.surface == borne[1]->second.surface &&
                        borne[0]->second.cells == 1 && borne[1]->second.cells == 1;
      if (!lies || quality_of(place, &cells[c]) > flat) {
        std::copy_n(cells.begin() + static_cast<long>(c), 4, cells.begin() + static_cast<long>(kept));
        kept += 4;
        continue;
      }
      for (int k = 0; k < 2; ++k) {
        const At at = borne[k]->second;
        std::copy(inside[k].begin(), inside[k].end(), surfaces[at.surface].begin() + static_cast<long>(at.first));
        on_surface.erase(borne[k]);
        on_surface[inside[k]] = at;
      }
      ++dropped;
    }
    cells.resize(kept);
  }
  return dropped;
}

}  // namespace talus
