#include "import/model/shape_nodes.h"

#include <memory>
#include <utility>

#include "engine/base/assert.h"
#include "scenegraph/primitive_meshes.h"

namespace simvis {
namespace {

Mesh mesh_of(const ModelShape& shape) {
  const glm::dvec3& size = shape.size;
  switch (shape.kind) {
    case ModelShape::Kind::box:
      return box_mesh(size);
    case ModelShape::Kind::sphere:
      return sphere_mesh(size.x);
    case ModelShape::Kind::cylinder:
      return cylinder_mesh(size.x, size.z);
    case ModelShape::Kind::capsule:
      return capsule_mesh(size.x, size.z);
    case ModelShape::Kind::ellipsoid:
      return sphere_mesh(1);
    case ModelShape::Kind::surface:
      return *shape.surface;
    default:
      SIMVIS_ASSERT(false);  // files, nodes and planes are the readers' own
      return {};
  }
}

}  // namespace

void add_shape_nodes(const ModelShape& shape, ContentPool& pool, Group& group) {
  if (shape.kind == ModelShape::Kind::ellipsoid) {
    glm::dmat4 stretch(1);
    for (int i = 0; i < 3; ++i) stretch[i][i] = shape.size[i];
    group.add(std::make_shared<Transform>(stretch));
  }
  const auto node = std::make_shared<Shape>(pool.intern(mesh_of(shape)));
  node->name = node->mesh()->name;
  group.add(node);
}

}  // namespace simvis
