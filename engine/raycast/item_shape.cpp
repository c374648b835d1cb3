#include "engine/raycast/item_shape.h"

#include "engine/draw/solid_cloud.h"
#include "engine/raycast/placing_error.h"

namespace simvis {

std::optional<SeenShape> shape_of_item(const DrawList& list, std::uint32_t item, const glm::dmat4& world_from_sensor) {
  const Mesh& mesh = *list.meshes[list.items[item].mesh];
  if (!mesh.surface) return {};
  const glm::dmat4& world_from_mesh = list.world_from_node[list.items[item].transform];
  return see_shape(
      *mesh.surface, place_mesh(world_from_mesh, world_from_sensor),
      world_error_m(glm::length(glm::dvec3(world_from_mesh[3])), glm::length(glm::dvec3(world_from_sensor[3]))));
}

std::uint32_t face_of_hit(SeenShape& shape, const Mesh& mesh, std::uint32_t primitive) {
  if (!is_solid_cloud(mesh)) return primitive;
  set_point(shape, mesh, primitive);
  return kRoundFace;
}

}  // namespace simvis
