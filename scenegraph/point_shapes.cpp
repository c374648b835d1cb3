#include "scenegraph/point_shapes.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <simvis/location.h>
#include "scenegraph/clone_graph.h"

namespace simvis {
namespace {

// Points of meshes that stand at several places count once.
struct SolidPoints {
  std::size_t solid = 0, left_out = 0;
};

using KnownClouds = std::unordered_map<const Mesh*, std::shared_ptr<const Mesh>>;

void leave_out_points_without_normal(Mesh& mesh) {
  std::erase_if(mesh.indices, [&](std::uint32_t vertex) { return mesh.attributes[vertex].normal == glm::vec3(0); });
}

void make_solid(Shape& drawn, const ExactSurface& shape, ContentPool& pool, KnownClouds& known, SolidPoints& points) {
  if (drawn.mesh()->topology != Topology::points) return;
  const auto [cloud, is_new] = known.try_emplace(drawn.mesh().get());
  if (is_new) {
    Mesh mesh = *drawn.mesh();
    mesh.surface = shape;
    if (shape.kind == SurfaceKind::disc) leave_out_points_without_normal(mesh);
    compute_bounds(mesh);
    points.solid += mesh.indices.size();
    points.left_out += drawn.mesh()->indices.size() - mesh.indices.size();
    cloud->second = pool.intern(std::move(mesh));
  }
  drawn.set_mesh(cloud->second);
  drawn.restore_mesh(cloud->second);  // the mesh is not one that changes, which would have a slot of its own
}

}  // namespace

std::optional<ExactSurface> shape_of_points(const Command& part, const AttributeValues& attributes, double scale) {
  if (attributes.is_set(kPointRadiusRow.name)) {
    return ExactSurface{
        .kind = attributes.choice(kPointShapeRow.name) == "disc" ? SurfaceKind::disc : SurfaceKind::sphere,
        .radius_m = attributes.number(kPointRadiusRow.name) / scale};
  }
  if (const CommandAttribute* const shape = part.find(kPointShapeRow.name)) {
    fail_at(shape->where,
            "attribute \"point_shape\": it shapes points that have a radius, expected \"point_radius\" too");
  }
  return {};
}

void make_points_solid(PartContent& content, const std::filesystem::path& file, const ExactSurface& shape,
                       ContentPool& pool) {
  KnownClouds known;
  SolidPoints points;
  for (const NodePtr& node : nodes_of(content.root)) {  // each once; parts of strangers may be deeply nested
    if (auto* const drawn = dynamic_cast<Shape*>(node.get())) make_solid(*drawn, shape, pool, known, points);
  }
  if (points.left_out > 0 && points.solid == 0) {
    fail_at({.file = file.string()},
            "its points have no normals, expected point_shape=\"sphere\" or points with normals");
  }
  if (points.left_out > 0) {
    content.warnings.push_back(file.string() + ": " + std::to_string(points.left_out) +
                               " points are left out, which have no normal for a disc");
  }
  if (points.solid == 0) {
    content.warnings.push_back(file.string() + ": holds no points, so that \"point_radius\" changes nothing");
  }
}

}  // namespace simvis
