#pragma once
/// All tables of a scene, and its own keys: for what visits all of a scene. Who reads some tables includes their
/// headers.
#include "scene/body_source.h"
#include "scene/boundary_source.h"
#include "scene/contact_source.h"
#include "scene/earthquake_source.h"
#include "scene/factor_source.h"
#include "scene/mesh_source.h"
#include "scene/one_of.h"
#include "scene/output_source.h"
#include "scene/quasi_static_source.h"
#include "scene/rigid_source.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "scene/start_from.h"
#include "scene/structure_source.h"
#include "scene/transfer_source.h"
#include "scene/water_source.h"

namespace talus {

template <class Visitor>
void Scene::fields(Visitor &&v) {
  v.text("title", title, "one line that says what the scene shows");
  v.choice("phases", phases,
           {{"dry", PhaseModel::dry},
            {"drained", PhaseModel::drained},
            {"saturated", PhaseModel::saturated},
            {"unsaturated", PhaseModel::unsaturated},
            {"three-phase", PhaseModel::three_phase}},
           "phase model");
  v.integer("dimension", dimension, Range{2, 3}, "2: plane strain on triangles, 3: tetrahedra");
  v.point("gravity", gravity, metre_per_second_squared, Usual{9.7, 10},
          "acceleration of gravity, one component per dimension; a single number acts downwards, against `up`");
  v.choice("up", up, {{"y", Up::y}, {"z", Up::z}},
           "axis along which elevations are counted, of water tables, levels and vertical stress; z (as in terrain) "
           "needs dimension = 3");
  v.table("start_from", *start_from, "start at the state of another run");
  v.table("mesh", *mesh, "background mesh");
  v.named("body", body, "soils, [body.NAME]");
  v.named("boundary", boundary, "conditions on named groups of facets, [boundary.NAME]");
  v.named("rigid", rigid, "rigid bodies and walls that soil meets, [rigid.NAME]");
  v.named("contact", contact, "contact between two groups of bodies, [contact.NAME]");
  v.named("structure", structure, "anchors, nails and geogrids in the soil, [structure.NAME]");
  v.table("water", *water, "pore water");
  v.table("gas", *gas, "pore gas");
  v.list("stage", stage, "stages in their order, [[stage]]");
  v.list("earthquake", earthquake, "components of the motion of the ground in an earthquake, [[earthquake]]");
  v.deferred_table("integrator", integrator, "time integration");
  v.table("transfer", *transfer, "exchange between particles and nodes");
  v.table("quasi_static", *quasi_static, "finite elements of quasi-static stages");
  v.table("factor_of_safety", *factor_of_safety, "search for the factor of safety");
  v.table("output", *output, "results that are written");
  v.texts("acknowledge", acknowledge,
          "doubts that are meant and not to be said: the names in brackets at the end of warnings, such as "
          "[\"damping\"]");
}

}  // namespace talus
