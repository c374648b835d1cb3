#include "elements/dynamics/drawn_bodies.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "elements/dynamics/world/mass.h"

namespace simvis {
namespace {

std::optional<DrawnShape::Kind> drawn_kind(CollisionKind kind) {
  switch (kind) {
    case CollisionKind::box:
      return DrawnShape::Kind::box;
    case CollisionKind::sphere:
      return DrawnShape::Kind::sphere;
    case CollisionKind::capsule:
      return DrawnShape::Kind::capsule;
    case CollisionKind::cylinder:
      return DrawnShape::Kind::cylinder;
    case CollisionKind::hull:
      return DrawnShape::Kind::hull;
    case CollisionKind::plane:
      return DrawnShape::Kind::plane;
    case CollisionKind::mesh:
      break;
  }
  return std::nullopt;
}

DrawnJoint drawn_joint(const LinkDesc& link) {
  DrawnJoint joint{.kind = DrawnJoint::Kind::fixed, .axis = link.axis};
  if (link.joint == JointKind::revolute) joint.kind = DrawnJoint::Kind::revolute;
  if (link.joint == JointKind::prismatic) joint.kind = DrawnJoint::Kind::prismatic;
  if (link.joint == JointKind::ball) joint.kind = DrawnJoint::Kind::ball;
  return joint;
}

// A solid ellipsoid of mass m and half axes a, b, c has the moment m / 5 (b^2 + c^2) about the first of its axes.
glm::dvec3 ellipsoid_of(double mass_kg, const glm::dvec3& moments_kg_m2) {
  const double sum = moments_kg_m2.x + moments_kg_m2.y + moments_kg_m2.z;
  const auto half_m = [&](double moment) { return std::sqrt(std::max(0.0, 5 / (2 * mass_kg) * (sum - 2 * moment))); };
  return {half_m(moments_kg_m2.x), half_m(moments_kg_m2.y), half_m(moments_kg_m2.z)};
}

void set_mass(const MassProperties& mass, DrawnBody& body) {
  if (!(mass.mass_kg > 0)) return;
  const PrincipalInertia inertia = principal_inertia(mass.inertia_kg_m2);
  body.mass_kg = mass.mass_kg;
  body.center_m = mass.center_m;
  body.axes = inertia.axes;
  body.half_m = ellipsoid_of(mass.mass_kg, inertia.diagonal_kg_m2);
}

void set_shapes(std::span<const CollisionShape> shapes, DrawnBody& body) {
  for (const CollisionShape& shape : shapes) {
    const std::optional<DrawnShape::Kind> kind = drawn_kind(shape.kind);
    if (!kind) continue;
    DrawnShape& drawn = body.shapes.emplace_back(DrawnShape{*kind, shape.body_from_shape, shape.half_m});
    if (*kind != DrawnShape::Kind::hull) continue;
    drawn.points = shape.points;
    drawn.triangles = shape.triangles;
  }
}

}  // namespace

LinkParts DynamicParts::of_link(int link) const {
  if (link < 0) return {kind == BodyKind::dynamic ? mass : nullptr, shapes};
  const LinkDesc& own = links[static_cast<std::size_t>(link)];
  return {own.mass.mass_kg > 0 ? &own.mass : nullptr, own.shapes};
}

double DynamicParts::moved_mass_kg() const {
  double sum_kg = kind == BodyKind::dynamic ? mass->mass_kg : 0;
  for (const LinkDesc& link : links) sum_kg += link.mass.mass_kg;
  return sum_kg;
}

void append_drawn_bodies(const std::string& element, const DynamicParts& parts,
                         const std::function<std::string(int)>& point_of, std::vector<DrawnBody>& bodies) {
  DrawnBody& base = bodies.emplace_back();
  base.element = element;
  base.name = point_of(-1);
  if (parts.kind == BodyKind::kinematic) base.motion = DrawnBody::Motion::kinematic;
  if (parts.kind == BodyKind::dynamic) {
    base.motion = DrawnBody::Motion::dynamic;
    set_mass(*parts.mass, base);
  }
  set_shapes(parts.shapes, base);
  for (std::size_t i = 0; i < parts.links.size(); ++i) {
    const LinkDesc& link = parts.links[i];
    DrawnBody& body = bodies.emplace_back();
    body.motion = DrawnBody::Motion::dynamic;
    body.element = element;
    body.name = point_of(static_cast<int>(i));
    body.joint = drawn_joint(link);
    set_mass(link.mass, body);
    set_shapes(link.shapes, body);
  }
}

}  // namespace simvis
