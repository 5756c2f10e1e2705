#include "solvers/quasi_static/faces_inside.h"

#include <algorithm>

#include "scene/body_source.h"
#include "scene/scene.h"
#include "scene/stage.h"

namespace talus {

template <int dim>
FacesInside<dim>::FacesInside(const BackgroundMesh<dim> &mesh, const Scene &scene)
    : mesh_(mesh), lasting_(mesh.cell_count(), 0) {
  for (const BodySource &body : scene.body) {
    const bool lasts = std::ranges::none_of(
        scene.stage, [&](const Stage &stage) { return stage.adds(body.name) || stage.removes(body.name); });
    for (const std::string &region : body.region)
      for (const int cell : mesh.region(region)) lasting_[cell] = lasts;
  }
  lasting_across_ = mesh.across(lasting_);
}

template class FacesInside<2>;
template class FacesInside<3>;

}  // namespace talus
