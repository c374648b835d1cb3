#include "elements/dynamics/body_rows.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "elements/dynamics/world/engine_module.h"
#include "elements/dynamics/world/mass.h"
#include "elements/dynamics/world/part_shapes.h"
#include "engine/base/decimal.h"

namespace simvis {
namespace {

const CommandAttribute& part_of(const ElementContext& context) {
  const CommandAttribute& at = context.command.require("insert_at");
  if (context.scene.has_part(at.value)) return at;
  fail_at(at.where, "attribute \"insert_at\": " + in_quotes(at.value) +
                        " is not allowed for a body, expected the name of a part");
}

CollisionShape hull_of(const ElementContext& context, const std::vector<glm::dvec3>& points, const std::string& part) {
  if (std::optional<CollisionShape> hull = dynamics_engine().convex_hull(points)) return *std::move(hull);
  fail_at(context.attributes.where("shape"), "a hull of part " + in_quotes(part) +
                                                 " has no volume: its mesh is open and flat, expected a closed mesh, " +
                                                 "or another shape");
}

std::vector<CollisionShape> hulls_of_pieces(const Triangles& triangles) {
  std::vector<CollisionShape> hulls;
  for (const Triangles& piece : connected_pieces(triangles)) {
    if (std::optional<CollisionShape> hull = dynamics_engine().convex_hull(piece.points))
      hulls.push_back(*std::move(hull));
  }
  return hulls;
}

// Whether a closed mesh fills its hull, so that there is no hollow to speak of.
bool fills(const Triangles& triangles, const CollisionShape& hull) {
  constexpr double kShare = 0.98;
  if (!is_closed(triangles)) return false;
  CollisionShape solid = mesh_of(triangles);
  solid.kind = CollisionKind::hull;
  return mass_of({&solid, 1}, 1).mass_kg >= kShare * mass_of({&hull, 1}, 1).mass_kg;
}

std::vector<CollisionShape> decomposed(const ElementContext& context, const Triangles& triangles) {
  constexpr double kConcavityShare = 0.02;  // of the diagonal
  const double concavity_m = context.attributes.is_set("concavity")
                                 ? context.attributes.number("concavity")
                                 : kConcavityShare * 2 * glm::length(fitted(CollisionKind::box, triangles).half_m);
  std::vector<CollisionShape> hulls;
  for (const Triangles& piece : connected_pieces(triangles)) {
    std::optional<CollisionShape> hull = dynamics_engine().convex_hull(piece.points);
    if (hull && fills(piece, *hull)) {
      hulls.push_back(*std::move(hull));
      continue;
    }
    std::ranges::move(dynamics_engine().convex_pieces(piece.points, piece.indices, concavity_m),
                      std::back_inserter(hulls));
  }
  return hulls;
}

std::vector<CollisionShape> read_collision(const ElementContext& context, const Triangles& triangles,
                                           const std::string& part, std::string_view shape) {
  if (shape == "box") return {fitted(CollisionKind::box, triangles)};
  if (shape == "sphere") return {fitted(CollisionKind::sphere, triangles)};
  if (shape == "capsule") return {fitted(CollisionKind::capsule, triangles)};
  if (shape == "cylinder") return {fitted(CollisionKind::cylinder, triangles)};
  if (shape == "mesh") return {mesh_of(triangles)};
  if (shape == "hull") return {hull_of(context, triangles.points, part)};
  std::vector<CollisionShape> hulls =
      shape == "decomposition" ? decomposed(context, triangles) : hulls_of_pieces(triangles);
  if (hulls.empty()) return {hull_of(context, triangles.points, part)};  // which throws
  return hulls;
}

// An open mesh, or one that is turned inside out, has no volume of its own.
std::vector<CollisionShape> solid_of(const Triangles& triangles, const std::vector<CollisionShape>& pieces) {
  if (!is_closed(triangles)) return pieces;
  CollisionShape solid = mesh_of(triangles);
  solid.kind = CollisionKind::hull;
  return mass_of({&solid, 1}, 1).mass_kg > 0 ? std::vector{std::move(solid)} : pieces;
}

std::string text_of(const glm::dvec3& moments_kg_m2) {
  return decimal(moments_kg_m2.x, 6) + " " + decimal(moments_kg_m2.y, 6) + " " + decimal(moments_kg_m2.z, 6);
}

void read_mask(SurfaceProperties& surface, const AttributeValues& attributes) {
  const auto bits = [&](const AttributeSpec& row, std::uint32_t fallback) {
    return attributes.is_set(row.name) ? static_cast<std::uint32_t>(attributes.integer(row.name)) : fallback;
  };
  surface.mask.collides = bits(kCollideBitmaskRow, CollisionMask::kAll);
  surface.mask.category = bits(kCategoryBitmaskRow, surface.mask.collides);
}

const AttributeRows<SurfaceProperties>& surface_attributes() {
  static const AttributeRows<SurfaceProperties> rows = {
      row(&SurfaceProperties::friction, kFrictionName, "", kFrictionLimits,
          "of two surfaces that touch, the product is the coefficient of friction"),
      row(&SurfaceProperties::restitution, kRestitutionName, "", kRestitutionLimits,
          "of two surfaces that touch, the product is the share of their speed that a bounce leaves"),
      kCategoryBitmaskRow, kCollideBitmaskRow, checked<SurfaceProperties>(read_mask)};
  return rows;
}

}  // namespace

void correct_inertia(Scene& scene, const Location& where, const std::string& whose, MassProperties& mass) {
  const PrincipalInertia given = principal_inertia(mass.inertia_kg_m2);
  if (is_possible(given)) return;
  const glm::dvec3& d = given.diagonal_kg_m2;
  const std::string problem = whose + " has an inertia that no body has: its principal moments are " + text_of(d) +
                              " kg m^2, expected moments above 0 of which none is above the sum of the two others";
  if (!std::isfinite(d.x + d.y + d.z)) fail_at(where, problem);
  const PrincipalInertia possible = nearest_possible(given, mass.mass_kg);
  scene.warn(where, problem + "; physics uses the nearest ones, " + text_of(possible.diagonal_kg_m2));
  mass.inertia_kg_m2 = inertia_of(possible);
}

BodyShapes read_shapes(const ElementContext& context, std::string_view by_default, double lowest_m) {
  const CommandAttribute& part = part_of(context);
  context.scene.read_shapes_of(part.value, "physics, element " + in_quotes(context.command.require("name").value));
  const auto separator = std::dynamic_pointer_cast<const Group>(context.scene.find_node(part.value));
  const auto content = std::dynamic_pointer_cast<const Group>(separator->children().back());  // see Scene::Part
  Triangles triangles = content == nullptr ? Triangles() : triangles_of(*content);
  if (triangles.indices.empty()) {
    fail_at(part.where, "part " + in_quotes(part.value) + " has no surface, expected one that has for a body");
  }
  for (glm::dvec3& point : triangles.points) point.z = std::max(point.z, lowest_m);
  const std::string shape(context.attributes.is_set("shape") ? context.attributes.choice("shape") : by_default);
  if (shape != "decomposition" && context.attributes.is_set("concavity")) {
    fail_at(context.attributes.where("concavity"),
            "attribute \"concavity\" is allowed with shape=\"decomposition\" only, not with " + in_quotes(shape));
  }
  std::vector<CollisionShape> collision = read_collision(context, triangles, part.value, shape);
  std::vector<CollisionShape> solid = shape == "decomposition" ? solid_of(triangles, collision) : collision;
  return {std::move(collision), std::move(solid)};
}

MassProperties read_mass(const ElementContext& context, const BodyShapes& shapes) {
  const AttributeValues& attributes = context.attributes;
  const bool has_mass = attributes.is_set("mass"), has_density = attributes.is_set("density");
  if (has_mass == has_density) {
    fail_at(attributes.where("mass"), std::string("a dynamic body has ") +
                                          (has_mass ? "both \"mass\" and" : "neither \"mass\" nor") +
                                          " \"density\", expected one of them");
  }
  for (const CollisionShape& shape : shapes.collision) {
    if (shape.kind != CollisionKind::mesh) continue;
    fail_at(attributes.where("shape"),
            "attribute \"shape\": \"mesh\" is not allowed for a dynamic body, expected hull, pieces, decomposition or "
            "a simple shape");
  }
  MassProperties mass = mass_of(shapes.solid, has_density ? attributes.number("density") : 1);
  if (!(mass.mass_kg > 0)) {
    fail_at(attributes.where("shape"), "the shape of a dynamic body has no volume, expected one that is not flat");
  }
  if (has_mass) mass = with_mass(mass, attributes.number("mass"));
  if (attributes.is_set("center")) {
    const double(&c)[3] = attributes.vector("center");
    mass.center_m = {c[0], c[1], c[2]};
  }
  if (attributes.is_set("inertia")) {
    const double(&i)[3] = attributes.vector("inertia");
    mass.inertia_kg_m2 = {{i[0], 0, 0}, {0, i[1], 0}, {0, 0, i[2]}};
  }
  correct_inertia(context.scene, attributes.where("inertia"),
                  "element " + in_quotes(context.command.require("name").value), mass);
  return mass;
}

std::vector<AttributeSpec> surface_rows() {
  const AttributeTable table = surface_attributes().table();
  return {table.begin(), table.end()};
}

glm::dvec3 unit_axis(const ElementContext& context, std::string_view attribute) {
  const double(&v)[3] = context.attributes.vector(attribute);
  const double length = std::hypot(v[0], v[1], v[2]);
  if (length > 0 && std::isfinite(length)) return glm::dvec3(v[0], v[1], v[2]) / length;
  fail_at(context.attributes.where(attribute),
          "attribute " + in_quotes(attribute) + " has no direction, expected three numbers that are not all 0");
}

SurfaceProperties read_surface(const AttributeValues& attributes) { return surface_attributes().read(attributes); }

}  // namespace simvis
