#include "elements/dynamics/bullet/convex_contact.h"

#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include <algorithm>
#include <cmath>

#include "elements/dynamics/bullet/contact_face.h"

namespace simvis {
namespace {

// A face counts as the one that touches if its normal is as near to that of the contact: 0.8 degrees.
constexpr double kFaceTouches = 1 - 1e-4;
// Two lines of round shapes touch along their common part if the sine between them is below this: 0.8 degrees.
constexpr double kLinesTouch = 0.0141;
// Two faces of one height within this are flush.
constexpr double kFlush_m = 1e-4;
// A body that moves further in a step than this is followed on its way, so that it does not hit what it passes by.
constexpr double kFollowed_m = 0.01;

struct Nearest {
  btVector3 on_b, normal;  // from b towards a
  double distance = 0;
};

struct NearestResult : btDiscreteCollisionDetectorInterface::Result {
  std::optional<Nearest> found;
  void setShapeIdentifiersA(int, int) override {}
  void setShapeIdentifiersB(int, int) override {}
  void addContactPoint(const btVector3& normal, const btVector3& on_b, btScalar distance) override {
    found = Nearest{on_b, normal, distance};
  }
};

// Two convex shapes, of which a may stand elsewhere than its body.
struct ConvexPair {
  const btConvexShape &a, &b;
  btTransform world_from_a;
  const btTransform& world_from_b;
};

std::optional<Nearest> find_nearest(const ConvexPair& pair, double reach) {
  btVoronoiSimplexSolver simplex;
  btGjkEpaPenetrationDepthSolver penetration;
  btGjkPairDetector detector(&pair.a, &pair.b, &simplex, &penetration);
  btDiscreteCollisionDetectorInterface::ClosestPointInput input;
  input.m_transformA = pair.world_from_a;
  input.m_transformB = pair.world_from_b;
  const double farthest = pair.a.getMargin() + pair.b.getMargin() + reach;
  input.m_maximumDistanceSquared = farthest * farthest;
  NearestResult result;
  detector.getClosestPoints(input, result, nullptr);
  if (result.found && result.found->distance > reach) return std::nullopt;
  return result.found;
}

btVector3 support(const btConvexShape& shape, const btTransform& world_from_shape, const btVector3& direction) {
  return world_from_shape * shape.localGetSupportingVertex(world_from_shape.getBasis().transpose() * direction);
}

// Moves a along `motion` until it touches b. Returns the way, or none if it passes by.
std::optional<btVector3> way_to_touch(ConvexPair pair, const btVector3& motion, double reach) {
  constexpr double kTouches_m = 1e-5;
  constexpr int kMaxSteps = 32;
  const btVector3 start = pair.world_from_a.getOrigin();
  double share = 0;
  for (int i = 0; i < kMaxSteps; ++i) {
    const auto nearest = find_nearest(pair, reach);
    if (!nearest) return std::nullopt;
    if (nearest->distance <= kTouches_m) break;
    const double closing = -nearest->normal.dot(motion);
    if (closing <= 0) return std::nullopt;
    share += nearest->distance / closing;
    if (share > 1) return std::nullopt;
    pair.world_from_a.setOrigin(start + share * motion);
  }
  return share * motion;
}

// Turns the normal into the one that the neighbours of a triangle allow. False: they have the contact.
bool follow_neighbours(const ConvexPair& pair, const MeshTriangle& triangle, Nearest& nearest) {
  const auto& shape = static_cast<const btTriangleShape&>(pair.b);
  const btMatrix3x3& world_from_mesh = pair.world_from_b.getBasis();
  const auto normal = triangle.mesh.allowed_normal({
      .triangle = triangle.index,
      .corners = {shape.m_vertices1[0], shape.m_vertices1[1], shape.m_vertices1[2]},
      .on_mesh = pair.world_from_b.invXform(nearest.on_b),
      .normal = world_from_mesh.transpose() * nearest.normal,
      .body_center = pair.world_from_b.invXform(pair.world_from_a.getOrigin()),
      .overlaps = nearest.distance < 0,
  });
  if (!normal) return false;
  const btVector3 allowed = world_from_mesh * *normal;
  if (allowed.dot(nearest.normal) > 1 - 1e-12) return true;
  // The point of the body that is deepest along the new normal.
  const btVector3 deepest = support(pair.a, pair.world_from_a, -allowed);
  nearest.normal = allowed;
  nearest.distance = allowed.dot(deepest - pair.world_from_b * shape.m_vertices1[0]);
  nearest.on_b = deepest - allowed * nearest.distance;
  return true;
}

// Adds what of the other face lies over the base. Returns whether there was anything within reach.
bool add_face_contacts(const ContactFace& base, ContactFace& other, bool base_is_b, double reach,
                       std::vector<ContactPoint>& contacts) {
  clip_face(base, other);
  const std::size_t before = contacts.size();
  const btVector3 normal = base_is_b ? base.normal : -base.normal;
  for (int i = 0; i < other.size; ++i) {
    const btVector3& point = other.points[static_cast<std::size_t>(i)];
    const double distance = base.normal.dot(point - base.points[0]);
    if (distance > reach) continue;
    const btVector3 on_base = point - distance * base.normal;
    contacts.push_back({.on_a = base_is_b ? point : on_base,
                        .on_b = base_is_b ? on_base : point,
                        .normal = normal,
                        .distance = distance});
  }
  return contacts.size() > before;
}

// Adds the ends of what two parallel lines have in common. Returns whether there was anything within reach.
bool add_line_contacts(const ContactFace& a, const ContactFace& b, const btVector3& normal, double reach,
                       std::vector<ContactPoint>& contacts) {
  const btVector3 along_a = a.points[1] - a.points[0], along_b = b.points[1] - b.points[0];
  const double length2 = along_a.length2();
  if (along_a.cross(along_b).length2() > kLinesTouch * kLinesTouch * length2 * along_b.length2()) return false;
  const auto share = [&](const btVector3& point) { return along_a.dot(point - a.points[0]) / length2; };
  const double first = share(b.points[0]), last = share(b.points[1]);
  const double from = std::max(0.0, std::min(first, last)), to = std::min(1.0, std::max(first, last));
  if (from >= to) return false;
  const std::size_t before = contacts.size();
  for (const double at : {from, to}) {
    const btVector3 on_a = a.points[0] + at * along_a;
    const btVector3 on_b = b.points[0] + (at - first) / (last - first) * along_b;
    const double distance = normal.dot(on_a - on_b);
    if (distance > reach) continue;
    contacts.push_back({.on_a = on_a, .on_b = on_b, .normal = normal, .distance = distance});
  }
  return contacts.size() > before;
}

// Returns whether the faces lie in one plane although the nearest points lie on their rounded edges. This happens where
// a body slides from one plate to the next.
bool are_flush(const ContactFace& a, const ContactFace& b, const Nearest& nearest) {
  constexpr double kDiagonal = 0.7;
  if (a.size < 3 || b.size < 3 || a.normal.dot(b.normal) > -kFaceTouches) return false;
  const double along = b.normal.dot(nearest.normal);
  return along > kDiagonal && along < kFaceTouches && std::abs(b.normal.dot(a.points[0] - b.points[0])) < kFlush_m;
}

void add_touching(const ConvexPair& pair, const Nearest& nearest, double reach, std::vector<ContactPoint>& contacts) {
  ContactFace face_a, face_b;
  find_face(pair.a, pair.world_from_a, -nearest.normal, face_a);
  find_face(pair.b, pair.world_from_b, nearest.normal, face_b);
  if (are_flush(face_a, face_b, nearest)) {
    add_face_contacts(face_b, face_a, true, reach, contacts);  // none if they lie beside each other
    return;
  }
  const double a_touches = face_a.size > 2 ? -face_a.normal.dot(nearest.normal) : 0;
  const double b_touches = face_b.size > 2 ? face_b.normal.dot(nearest.normal) : 0;
  // A line or a point of a round shape is sought again along the normal of the flat face: the nearest points give it to
  // some micrometres, and a cylinder that does not stand right above its line rolls away.
  if (b_touches > kFaceTouches && b_touches >= a_touches - 1e-9) {
    if (face_a.size < 3) find_face(pair.a, pair.world_from_a, -face_b.normal, face_a);
    if (add_face_contacts(face_b, face_a, true, reach, contacts)) return;
  } else if (a_touches > kFaceTouches) {
    if (face_b.size < 3) find_face(pair.b, pair.world_from_b, -face_a.normal, face_b);
    if (add_face_contacts(face_a, face_b, false, reach, contacts)) return;
  } else if (face_a.size == 2 && face_b.size == 2) {
    if (add_line_contacts(face_a, face_b, nearest.normal, reach, contacts)) return;
  }
  contacts.push_back({.on_a = nearest.on_b + nearest.distance * nearest.normal,
                      .on_b = nearest.on_b,
                      .normal = nearest.normal,
                      .distance = nearest.distance});
}

}  // namespace

void add_convex_contacts(const ContactPiece& a, const ContactPiece& b, const ContactReach& reach,
                         const std::optional<MeshTriangle>& triangle, std::vector<ContactPoint>& contacts) {
  ConvexPair pair{static_cast<const btConvexShape&>(a.shape), static_cast<const btConvexShape&>(b.shape),
                  a.world_from_shape, b.world_from_shape};
  btVector3 way(0, 0, 0);
  double within = reach.length();
  if (reach.motion.length2() > kFollowed_m * kFollowed_m) {
    if (const auto found = way_to_touch(pair, reach.motion, within)) way = *found;
    within = reach.turn + reach.rest;
  }
  pair.world_from_a.setOrigin(a.world_from_shape.getOrigin() + way);
  auto nearest = find_nearest(pair, within);
  if (!nearest) return;
  if (triangle && !follow_neighbours(pair, *triangle, *nearest)) return;
  if (nearest->distance > within) return;
  const std::size_t first = contacts.size();
  add_touching(pair, *nearest, within, contacts);
  for (std::size_t i = first; i < contacts.size(); ++i) {
    contacts[i].on_a -= way;
    contacts[i].distance -= contacts[i].normal.dot(way);
  }
}

void add_plane_contacts(const ContactPiece& convex, const ContactPiece& plane, const ContactReach& reach,
                        std::vector<ContactPoint>& contacts) {
  const auto& shape = static_cast<const btConvexShape&>(convex.shape);
  const auto& half_space = static_cast<const btStaticPlaneShape&>(plane.shape);
  const btVector3 normal = plane.world_from_shape.getBasis() * half_space.getPlaneNormal();
  const double height = half_space.getPlaneConstant() + normal.dot(plane.world_from_shape.getOrigin());
  const double within = reach.length();
  const auto add = [&](const btVector3& point) {
    const double distance = normal.dot(point) - height;
    if (distance > within) return;
    contacts.push_back({.on_a = point, .on_b = point - distance * normal, .normal = normal, .distance = distance});
  };
  ContactFace face;
  find_face(shape, convex.world_from_shape, -normal, face);
  for (int i = 0; i < face.size; ++i) add(face.points[static_cast<std::size_t>(i)]);
}

}  // namespace simvis
