#include "elements/dynamics/bullet/contact_face.h"

#include <BulletCollision/CollisionShapes/btTriangleShape.h>

#include <algorithm>
#include <cmath>

namespace simvis {
namespace {

void add_point(ContactFace& face, const btVector3& point) {
  if (face.size < ContactFace::kMaxPoints) face.points[static_cast<std::size_t>(face.size++)] = point;
}

void find_box_face(const btBoxShape& box, const btVector3& direction, ContactFace& face) {
  const btVector3 half = box.getHalfExtentsWithMargin();
  const int k = direction.absolute().maxAxis(), i = (k + 1) % 3, j = (k + 2) % 3;
  const double side = direction[k] < 0 ? -1 : 1;
  constexpr std::array<std::array<double, 2>, 4> kCorners = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  for (std::size_t c = 0; c < 4; ++c) {
    const auto& corner = kCorners[side > 0 ? c : 3 - c];
    btVector3 point(0, 0, 0);
    point[k] = side * half[k];
    point[i] = corner[0] * half[i];
    point[j] = corner[1] * half[j];
    add_point(face, point);
  }
  face.normal.setZero();
  face.normal[k] = side;
}

// The line along z on which a cylinder lies.
void find_side_line(double radius, double half_length, const btVector3& direction, ContactFace& face) {
  face.normal = btVector3(direction.x(), direction.y(), 0).normalized();
  add_point(face, radius * face.normal + btVector3(0, 0, half_length));
  add_point(face, radius * face.normal - btVector3(0, 0, half_length));
}

// A cap as a polygon. One of its corners is the lowest point of the rim if the cylinder leans.
void find_cap(double radius, double half_length, const btVector3& direction, ContactFace& face) {
  constexpr int kCorners = 16;
  constexpr double kLeans = 0.02;  // rad: below it, the lowest point moves about with rounding
  const double lowest =
      std::hypot(direction.x(), direction.y()) > kLeans ? std::atan2(direction.y(), direction.x()) : 0;
  const double side = direction.z() < 0 ? -1 : 1;
  for (int c = 0; c < kCorners; ++c) {
    const double angle = lowest + side * SIMD_2_PI * c / kCorners;
    add_point(face, {radius * std::cos(angle), radius * std::sin(angle), side * half_length});
  }
  face.normal.setValue(0, 0, side);
}

void find_cylinder_face(const btCylinderShape& cylinder, const btVector3& direction, ContactFace& face) {
  const btVector3 half = cylinder.getHalfExtentsWithMargin();
  constexpr double kDiagonal = 0.7071;
  if (std::abs(direction.z()) > kDiagonal) {
    find_cap(half.x(), half.z(), direction, face);
  } else {
    find_side_line(half.x(), half.z(), direction, face);
  }
}

void find_hull_face(const HullShape& hull, const btVector3& direction, ContactFace& face) {
  const HullShape::Face& found = hull.face_towards(direction);
  const std::size_t stride = 1 + found.corners.size() / ContactFace::kMaxPoints;
  for (std::size_t i = 0; i < found.corners.size(); i += stride) add_point(face, found.corners[i]);
  face.normal = found.normal;
}

void find_triangle_face(const btTriangleShape& triangle, const btVector3& direction, ContactFace& face) {
  triangle.calcNormal(face.normal);
  const bool front = face.normal.dot(direction) >= 0;
  for (const int corner : {0, 1, 2}) add_point(face, triangle.m_vertices1[front ? corner : 2 - corner]);
  if (!front) face.normal = -face.normal;
}

// The farthest points of both ends, which are balls.
void find_capsule_line(const btCapsuleShape& capsule, const btVector3& direction, ContactFace& face) {
  face.normal = direction;
  for (const double side : {1.0, -1.0}) {
    add_point(face, capsule.getRadius() * direction + btVector3(0, 0, side * capsule.getHalfHeight()));
  }
}

void find_point(const btConvexShape& shape, const btVector3& direction, ContactFace& face) {
  add_point(face, shape.localGetSupportingVertex(direction));
  face.normal = direction;
}

void find_local_face(const btConvexShape& shape, const btVector3& direction, ContactFace& face) {
  switch (shape.getShapeType()) {
    case BOX_SHAPE_PROXYTYPE:
      return find_box_face(static_cast<const btBoxShape&>(shape), direction, face);
    case CYLINDER_SHAPE_PROXYTYPE:
      return find_cylinder_face(static_cast<const btCylinderShape&>(shape), direction, face);
    case CONVEX_HULL_SHAPE_PROXYTYPE:
      return find_hull_face(static_cast<const HullShape&>(shape), direction, face);
    case TRIANGLE_SHAPE_PROXYTYPE:
      return find_triangle_face(static_cast<const btTriangleShape&>(shape), direction, face);
    case CAPSULE_SHAPE_PROXYTYPE:
      return find_capsule_line(static_cast<const btCapsuleShape&>(shape), direction, face);
    default:
      return find_point(shape, direction, face);
  }
}

// Keeps what lies on the inner side of a plane through `at`.
void clip_by_plane(const btVector3& at, const btVector3& outward, double tolerance, ContactFace& face) {
  ContactFace kept;
  for (int i = 0; i < face.size; ++i) {
    const btVector3 &here = face.points[static_cast<std::size_t>(i)],
                    &next = face.points[static_cast<std::size_t>((i + 1) % face.size)];
    const double outside = outward.dot(here - at), next_outside = outward.dot(next - at);
    if (outside <= tolerance) add_point(kept, here);
    const bool last_of_line = face.size <= 2 && i + 1 == face.size;
    if (!last_of_line &&
        ((outside < -tolerance && next_outside > tolerance) || (outside > tolerance && next_outside < -tolerance))) {
      add_point(kept, here.lerp(next, outside / (outside - next_outside)));
    }
  }
  std::copy_n(kept.points.begin(), kept.size, face.points.begin());
  face.size = kept.size;
}

}  // namespace

const HullShape::Face& HullShape::face_towards(const btVector3& direction) const {
  return *std::ranges::max_element(faces_, {}, [&](const Face& face) { return face.normal.dot(direction); });
}

void find_face(const btConvexShape& shape, const btTransform& world_from_shape, const btVector3& direction,
               ContactFace& face) {
  face.size = 0;
  find_local_face(shape, world_from_shape.getBasis().transpose() * direction, face);
  for (int i = 0; i < face.size; ++i) {
    btVector3& point = face.points[static_cast<std::size_t>(i)];
    point = world_from_shape * point;
  }
  face.normal = world_from_shape.getBasis() * face.normal;
}

void clip_face(const ContactFace& base, ContactFace& face) {
  constexpr double kTolerance = 1e-9;  // of an edge's length squared: what lies on the edge stays
  for (int i = 0; i < base.size && face.size > 0; ++i) {
    const btVector3 &from = base.points[static_cast<std::size_t>(i)],
                    &to = base.points[static_cast<std::size_t>((i + 1) % base.size)];
    const btVector3 outward = (to - from).cross(base.normal);
    clip_by_plane(from, outward, kTolerance * outward.length2(), face);
  }
}

}  // namespace simvis
