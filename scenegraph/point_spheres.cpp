#include "scenegraph/point_spheres.h"

#include <unordered_map>
#include <utility>

#include "scenegraph/clone_graph.h"

namespace simvis {
namespace {

using KnownClouds = std::unordered_map<const Mesh*, std::shared_ptr<const Mesh>>;

void make_solid(Shape& shape, double radius, ContentPool& pool, KnownClouds& known) {
  if (shape.mesh()->topology != Topology::points) return;
  const auto [cloud, is_new] = known.try_emplace(shape.mesh().get());
  if (is_new) {
    Mesh mesh = *shape.mesh();
    mesh.surface = ExactSurface{.kind = SurfaceKind::sphere, .radius_m = radius};
    compute_bounds(mesh);
    cloud->second = pool.intern(std::move(mesh));
  }
  shape.set_mesh(cloud->second);
  shape.restore_mesh(cloud->second);  // the mesh is not one that changes, which would have a slot of its own
}

}  // namespace

bool make_points_solid(PartContent& content, double radius, ContentPool& pool) {
  KnownClouds known;
  for (const NodePtr& node : nodes_of(content.root)) {  // each once; parts of strangers may be deeply nested
    if (auto* const shape = dynamic_cast<Shape*>(node.get())) make_solid(*shape, radius, pool, known);
  }
  return !known.empty();
}

}  // namespace simvis
