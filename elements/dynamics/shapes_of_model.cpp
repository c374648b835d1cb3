#include "elements/dynamics/shapes_of_model.h"

#include <numbers>
#include <utility>

#include "elements/dynamics/world/engine_module.h"
#include "elements/dynamics/world/mass.h"
#include "engine/base/assert.h"
#include "scenegraph/primitive_meshes.h"

namespace simvis {
namespace {

Triangles scaled(Triangles triangles, const glm::dvec3& scale) {
  for (glm::dvec3& point : triangles.points) point *= scale;
  return triangles;
}

Triangles triangles_of_mesh(const Mesh& mesh) {
  return {.points = {mesh.positions.begin(), mesh.positions.end()}, .indices = mesh.indices};
}

Triangles surface_of(const ModelShape& shape, CollisionMeshes& meshes) {
  switch (shape.kind) {
    case ModelShape::Kind::mesh:
      return scaled(meshes.read(shape.file), shape.size);
    case ModelShape::Kind::nodes:
      return triangles_of(static_cast<const Group&>(*shape.nodes));
    case ModelShape::Kind::ellipsoid:
      return scaled(triangles_of_mesh(sphere_mesh(1)), shape.size);
    default:
      return triangles_of_mesh(*shape.surface);
  }
}

std::optional<CollisionShape> simple_shape_of(const ModelShape& shape) {
  const glm::dvec3 round(shape.size.x, shape.size.x, shape.size.z / 2);
  switch (shape.kind) {
    case ModelShape::Kind::box:
      return CollisionShape{.kind = CollisionKind::box, .half_m = shape.size / 2.0};
    case ModelShape::Kind::sphere:
      return CollisionShape{.kind = CollisionKind::sphere, .half_m = shape.size};
    case ModelShape::Kind::cylinder:
      return CollisionShape{.kind = CollisionKind::cylinder, .half_m = round};
    case ModelShape::Kind::capsule:
      return CollisionShape{.kind = CollisionKind::capsule, .half_m = round};
    case ModelShape::Kind::plane:
      return CollisionShape{.kind = CollisionKind::plane};
    default:
      return std::nullopt;
  }
}

CollisionShape hull_of(const Triangles& triangles, const ModelShape& shape, const Location& where) {
  if (std::optional<CollisionShape> hull = dynamics_engine().convex_hull(triangles.points)) return *std::move(hull);
  fail_at(where,
          "collision mesh " + in_quotes(shape.file.string()) + " has no volume, expected a mesh that is not flat");
}

// A ball of 1 m, stretched to half axes: second moments of mass grow with their squares.
MassProperties ellipsoid_mass(const glm::dvec3& half_m) {
  const double mass = 4 * std::numbers::pi / 3 * half_m.x * half_m.y * half_m.z;
  const glm::dvec3 s = half_m * half_m * (mass / 5);
  return {.mass_kg = mass,
          .center_m = glm::dvec3(0),
          .inertia_kg_m2 = {{s.y + s.z, 0, 0}, {0, s.x + s.z, 0}, {0, 0, s.x + s.y}}};
}

CollisionShape solid_shape_of(const ModelSolid& solid, CollisionMeshes& meshes) {
  if (auto simple = simple_shape_of(solid)) return *std::move(simple);
  const Triangles triangles = surface_of(solid, meshes);
  if (is_closed(triangles)) {
    CollisionShape closed = mesh_of(triangles);
    closed.kind = CollisionKind::hull;
    if (mass_of({&closed, 1}, 1).mass_kg > 0) return closed;
  }
  return hull_of(triangles, solid, solid.where);
}

}  // namespace

const Triangles& CollisionMeshes::read(const std::filesystem::path& file) {
  const auto known = read_.find(file);
  if (known != read_.end()) return known->second;
  SIMVIS_ASSERT(files_ != nullptr);
  return read_.emplace(file, triangles_of(*files_->surface(file, pool_))).first->second;
}

CollisionShape collision_shape_of(const ModelCollision& collision, MeshCollision as, CollisionMeshes& meshes) {
  if (auto simple = simple_shape_of(collision)) return *std::move(simple);
  const Triangles triangles = surface_of(collision, meshes);
  if (as == MeshCollision::triangles && !triangles.indices.empty()) return mesh_of(triangles);
  return hull_of(triangles, collision, collision.where);
}

MassProperties mass_of_solid(const ModelSolid& solid, CollisionMeshes& meshes) {
  MassProperties mass;  // of density 1
  if (solid.kind == ModelShape::Kind::ellipsoid) {
    mass = ellipsoid_mass(solid.size);
  } else if (solid.kind != ModelShape::Kind::plane) {
    const CollisionShape shape = solid_shape_of(solid, meshes);
    mass = mass_of({&shape, 1}, 1);
  }
  if (!(mass.mass_kg > 0)) return mass;
  return with_mass(mass, solid.mass_kg ? *solid.mass_kg : solid.density_kg_m3 * mass.mass_kg);
}

}  // namespace simvis
