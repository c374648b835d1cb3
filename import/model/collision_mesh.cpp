#include "import/model/collision_mesh.h"

#include "import/mesh/mesh_file.h"

namespace simvis {

std::shared_ptr<const Group> read_collision_mesh(const std::filesystem::path& file, ContentPool& pool) {
  const PartContent content = read_mesh_file(file, MeshFileAxes::as_written, std::make_shared<const Material>(), pool);
  return std::dynamic_pointer_cast<const Group>(content.root);
}

}  // namespace simvis
