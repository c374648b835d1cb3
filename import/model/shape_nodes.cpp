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
  glm::dmat4 stretch(1);
  if (shape.kind == ModelShape::Kind::ellipsoid) {
    for (int i = 0; i < 3; ++i) stretch[i][i] = shape.size[i];
  } else if (shape.kind == ModelShape::Kind::box) {
    stretch = exact_box_scale(shape.size);
  }
  if (stretch != glm::dmat4(1)) group.add(std::make_shared<Transform>(stretch));
  const auto node = std::make_shared<Shape>(pool.intern(mesh_of(shape)));
  node->name = node->mesh()->name;
  group.add(node);
}

}  // namespace simvis
