#include "import/model/projected_picture.h"

#include <cstddef>

namespace simvis {

Mesh with_projected_picture(Mesh mesh, const glm::dmat4& box_from_mesh) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::dvec4 at = box_from_mesh * glm::dvec4(mesh.positions[i], 1);
    mesh.attributes[i].uv[0] = mesh.attributes[i].uv[1] = glm::vec2(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y);
  }
  return mesh;
}

}  // namespace simvis
