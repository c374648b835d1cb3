#include "elements/dynamics/bullet/bullet_shape.h"

#include <BulletCollision/CollisionShapes/btEmptyShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <LinearMath/btConvexHullComputer.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "elements/dynamics/bullet/bullet_types.h"
#include "elements/dynamics/bullet/contact_face.h"
#include "elements/dynamics/bullet/mesh_shape.h"

namespace simvis {
namespace {

// Bullet rounds the edges of convex shapes by a margin, in which contacts are exact and quick. Boxes, capsules and
// cylinders lose it, hulls are shrunk by it, so that bodies keep their size.
constexpr double kMargin_m = 1e-3;
constexpr double kMarginShare = 0.05;  // of the smallest half edge, or of the radius of a ball inside a hull

double margin_of(const glm::dvec3& half_m) {
  return std::min(kMargin_m, kMarginShare * std::min({half_m.x, half_m.y, half_m.z}));
}

struct Hull {
  std::vector<glm::dvec3> points;
  std::vector<std::uint32_t> triangles;
  double shrunk_m = 0;
};

// The hull whose faces lie `shrink` inside, or less for a small hull.
Hull hull_of(std::span<const glm::dvec3> points, double shrink) {
  btConvexHullComputer computer;
  Hull hull;
  hull.shrunk_m =
      computer.compute(&points.front().x, sizeof(glm::dvec3), static_cast<int>(points.size()), shrink, kMarginShare);
  for (int i = 0; i < computer.vertices.size(); ++i) hull.points.push_back(to_glm(computer.vertices[i]));
  for (int face = 0; face < computer.faces.size(); ++face) {
    const btConvexHullComputer::Edge* const first = &computer.edges[computer.faces[face]];
    const auto corner = static_cast<std::uint32_t>(first->getSourceVertex());
    for (const auto* edge = first->getNextEdgeOfFace(); edge->getTargetVertex() != static_cast<int>(corner);
         edge = edge->getNextEdgeOfFace()) {
      hull.triangles.insert(hull.triangles.end(), {corner, static_cast<std::uint32_t>(edge->getSourceVertex()),
                                                   static_cast<std::uint32_t>(edge->getTargetVertex())});
    }
  }
  return hull;
}

// The corners in order around their middle.
HullShape::Face face_of(std::span<const glm::dvec3> points, const glm::dvec3& normal,
                        std::vector<std::uint32_t> corners) {
  std::ranges::sort(corners);
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  glm::dvec3 middle(0);
  for (const std::uint32_t corner : corners) middle += points[corner] / static_cast<double>(corners.size());
  const glm::dvec3 x = glm::normalize(points[corners[0]] - middle), y = glm::cross(normal, x);
  std::ranges::sort(corners, {}, [&](std::uint32_t corner) {
    const glm::dvec3 arm = points[corner] - middle;
    return std::atan2(glm::dot(arm, y), glm::dot(arm, x));
  });
  HullShape::Face face{.corners = {}, .normal = to_bullet(normal)};
  for (const std::uint32_t corner : corners) face.corners.push_back(to_bullet(points[corner]));
  return face;
}

// The triangles of a hull that lie in one plane as one face.
std::vector<HullShape::Face> hull_faces(const Hull& hull) {
  constexpr double kOnePlane = 1e-6;  // rad, and share of the hull's size
  struct Plane {
    glm::dvec3 normal;
    std::vector<std::uint32_t> corners;
  };
  double size = 0;
  for (const glm::dvec3& point : hull.points) size = std::max(size, glm::length(point - hull.points[0]));
  std::vector<Plane> planes;
  for (std::size_t i = 0; i + 2 < hull.triangles.size(); i += 3) {
    const auto corner = [&](std::size_t k) { return hull.points[hull.triangles[i + k]]; };
    const glm::dvec3 area = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
    if (!(glm::length(area) > 0)) continue;
    const glm::dvec3 normal = glm::normalize(area);
    auto plane = std::ranges::find_if(planes, [&](const Plane& each) {
      return glm::length(each.normal - normal) < kOnePlane &&
             std::abs(glm::dot(normal, corner(0) - hull.points[each.corners[0]])) < kOnePlane * size;
    });
    if (plane == planes.end()) plane = planes.insert(plane, Plane{normal, {}});
    plane->corners.insert(plane->corners.end(), hull.triangles.begin() + static_cast<std::ptrdiff_t>(i),
                          hull.triangles.begin() + static_cast<std::ptrdiff_t>(i + 3));
  }
  std::vector<HullShape::Face> faces;
  for (Plane& plane : planes) faces.push_back(face_of(hull.points, plane.normal, std::move(plane.corners)));
  return faces;
}

}  // namespace

template <typename Made>
Made* BulletShape::keep(std::unique_ptr<Made> made) {
  Made* const raw = made.get();
  shapes_.push_back(std::move(made));
  return raw;
}

BulletShape::BulletShape(std::span<const CollisionShape> shapes, const SurfaceProperties& surface,
                         const btTransform& frame_from_body) {
  std::vector<std::pair<btTransform, btCollisionShape*>> children;
  for (const CollisionShape& shape : shapes) {
    btCollisionShape* const child = add(shape);
    auto own = std::make_unique<BulletSurface>(BulletSurface{shape.surface ? *shape.surface : surface});
    child->setUserPointer(own.get());
    child->setUserIndex(shape.part);
    mask_.category |= own->mask.category;
    mask_.collides |= own->mask.collides;
    pieces_.push_back({shape.part, to_bullet(shape.body_from_shape).getBasis().transpose(), std::move(own)});
    children.emplace_back(frame_from_body * to_bullet(shape.body_from_shape), child);
  }
  if (children.empty()) {
    whole_ = keep(std::make_unique<btEmptyShape>());
    return;
  }
  if (children.size() == 1 && children[0].first == btTransform::getIdentity()) {
    whole_ = children[0].second;
    return;
  }
  auto* const compound = keep(std::make_unique<btCompoundShape>());
  for (const auto& [frame_from_shape, child] : children) compound->addChildShape(frame_from_shape, child);
  whole_ = compound;
}

void BulletShape::move_surface(int part, const SurfaceMotion& motion) {
  for (const Piece& piece : pieces_) {
    if (piece.part != part) continue;
    piece.surface->belt_m_s = piece.piece_from_body * to_bullet(motion.belt_m_s);
    piece.surface->roller_axis = piece.piece_from_body * to_bullet(motion.roller_axis.value_or(glm::dvec3(0)));
  }
}

btCollisionShape* BulletShape::add(const CollisionShape& shape) {
  const glm::dvec3& half = shape.half_m;
  switch (shape.kind) {
    case CollisionKind::box: {
      auto* const box = keep(std::make_unique<btBoxShape>(to_bullet(half)));
      box->setMargin(margin_of(half));
      return box;
    }
    case CollisionKind::sphere:
      return keep(std::make_unique<btSphereShape>(half.x));
    case CollisionKind::capsule:
      return keep(std::make_unique<btCapsuleShapeZ>(half.x, 2 * half.z));
    case CollisionKind::cylinder: {
      auto* const cylinder = keep(std::make_unique<btCylinderShapeZ>(to_bullet(half)));
      cylinder->setMargin(margin_of(half));
      return cylinder;
    }
    case CollisionKind::hull: {
      const Hull inner = hull_of(shape.points, kMargin_m);
      auto* const hull = keep(std::make_unique<HullShape>(hull_faces(hull_of(shape.points, 0))));
      for (const glm::dvec3& point : inner.points) hull->addPoint(to_bullet(point), false);
      hull->setMargin(inner.shrunk_m);
      hull->recalcLocalAabb();
      return hull;
    }
    case CollisionKind::plane:
      return keep(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), 0));
    case CollisionKind::mesh:
      break;
  }
  return add_mesh(shape);
}

btCollisionShape* BulletShape::add_mesh(const CollisionShape& shape) {
  auto data = std::make_unique<MeshData>();
  for (const glm::dvec3& point : shape.points) data->points.push_back(to_bullet(point));
  data->indices.assign(shape.triangles.begin(), shape.triangles.end());
  btIndexedMesh mesh;
  mesh.m_numTriangles = static_cast<int>(data->indices.size() / 3);
  mesh.m_triangleIndexBase = reinterpret_cast<const unsigned char*>(data->indices.data());
  mesh.m_triangleIndexStride = 3 * sizeof(int);
  mesh.m_numVertices = static_cast<int>(data->points.size());
  mesh.m_vertexBase = reinterpret_cast<const unsigned char*>(data->points.data());
  mesh.m_vertexStride = sizeof(btVector3);
  auto array = std::make_unique<btTriangleIndexVertexArray>();
  array->addIndexedMesh(mesh, PHY_INTEGER);
  auto* const made = keep(std::make_unique<MeshShape>(array.get(), data->points, data->indices));
  made->setMargin(0);
  meshes_.push_back(std::move(data));
  arrays_.push_back(std::move(array));
  return made;
}

std::optional<CollisionShape> bullet_convex_hull(std::span<const glm::dvec3> points) {
  if (points.empty()) return std::nullopt;
  Hull hull = hull_of(points, 0);
  double volume = 0, reach = 0;
  for (const glm::dvec3& point : hull.points) reach = std::max(reach, glm::length(point - hull.points[0]));
  for (std::size_t i = 0; i + 2 < hull.triangles.size(); i += 3) {
    const glm::dvec3 origin = hull.points[0], a = hull.points[hull.triangles[i]] - origin,
                     b = hull.points[hull.triangles[i + 1]] - origin, c = hull.points[hull.triangles[i + 2]] - origin;
    volume += glm::dot(a, glm::cross(b, c)) / 6;
  }
  constexpr double kFlat = 1e-9;  // of the cube of its reach: far thinner than paper
  if (!(volume > kFlat * reach * reach * reach)) return std::nullopt;
  return CollisionShape{
      .kind = CollisionKind::hull, .points = std::move(hull.points), .triangles = std::move(hull.triangles)};
}

}  // namespace simvis
