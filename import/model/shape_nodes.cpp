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
    default:
      SIMVIS_ASSERT(false);  // surfaces have a mesh; files, nodes and planes are the readers' own
      return {};
  }
}

// Not that of the mesh, which may be another mesh's with the same content.
std::string name_of(const ModelShape& shape) {
  switch (shape.kind) {
    case ModelShape::Kind::box:
      return "box";
    case ModelShape::Kind::sphere:
    case ModelShape::Kind::ellipsoid:
      return "sphere";
    case ModelShape::Kind::cylinder:
      return "cylinder";
    case ModelShape::Kind::capsule:
      return "capsule";
    default:
      SIMVIS_ASSERT(shape.kind == ModelShape::Kind::surface);
      return shape.surface->name;
  }
}

}  // namespace

std::shared_ptr<const Mesh> ShapeMeshes::mesh(const ModelShape& shape) {
  if (shape.kind == ModelShape::Kind::surface) return pool_.intern(Mesh(*shape.surface));
  // Of an ellipsoid it is the sphere that is stretched.
  const glm::dvec3 size = shape.kind == ModelShape::Kind::ellipsoid ? glm::dvec3(1) : shape.size;
  std::shared_ptr<const Mesh>& known = known_[Key(shape.kind, size.x, size.y, size.z)];
  if (known == nullptr) {
    known = pool_.intern(mesh_of(shape));
    ++computed_;
  }
  return known;
}

void add_shape_nodes(const ModelShape& shape, ShapeMeshes& meshes, Group& group) {
  glm::dmat4 stretch(1);
  if (shape.kind == ModelShape::Kind::ellipsoid) {
    for (int i = 0; i < 3; ++i) stretch[i][i] = shape.size[i];
  } else if (shape.kind == ModelShape::Kind::box) {
    stretch = exact_box_scale(shape.size);
  }
  if (stretch != glm::dmat4(1)) group.add(std::make_shared<Transform>(stretch));
  const auto node = std::make_shared<Shape>(meshes.mesh(shape));
  node->name = name_of(shape);
  group.add(node);
}

}  // namespace simvis
