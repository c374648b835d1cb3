#include "scenegraph/point_spheres.h"

#include <unordered_map>
#include <utility>

namespace simvis {
namespace {

using KnownClouds = std::unordered_map<const Mesh*, std::shared_ptr<const Mesh>>;

void make_solid(Node& node, double radius, ContentPool& pool, KnownClouds& known) {
  if (auto* const shape = dynamic_cast<Shape*>(&node)) {
    if (shape->mesh()->topology != Topology::points) return;
    const auto [cloud, is_new] = known.try_emplace(shape->mesh().get());
    if (is_new) {
      Mesh mesh = *shape->mesh();
      mesh.surface = ExactSurface{.kind = SurfaceKind::sphere, .radius_m = radius};
      compute_bounds(mesh);
      cloud->second = pool.intern(std::move(mesh));
    }
    shape->set_mesh(cloud->second);
    shape->restore_mesh(cloud->second);  // the mesh is not one that changes, which would have a slot of its own
    known.try_emplace(cloud->second.get(), cloud->second);  // a shape may have several parents
    return;
  }
  auto* const group = dynamic_cast<Group*>(&node);
  if (group == nullptr) return;
  for (const NodePtr& child : group->children()) make_solid(*child, radius, pool, known);
}

}  // namespace

bool make_points_solid(PartContent& content, double radius, ContentPool& pool) {
  KnownClouds known;
  make_solid(*content.root, radius, pool, known);
  return !known.empty();
}

}  // namespace simvis
