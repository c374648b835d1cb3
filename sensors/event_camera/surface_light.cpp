#include "sensors/event_camera/surface_light.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "engine/draw/luminance.h"
#include "engine/draw/sky_sphere.h"
#include "engine/draw/surface_alpha.h"
#include "engine/light/direct_light.h"

namespace simvis {
namespace {

/// Of a triangle at a point, world frame, unit length, towards the eye. It is that of the vertices if they have any.
glm::dvec3 shading_normal(const Mesh& mesh, std::uint32_t primitive, const glm::dvec3& weights,
                          const glm::dmat3& world_from_mesh, const glm::dvec3& world_direction) {
  const std::uint32_t* const corner = mesh.indices.data() + 3 * std::size_t{primitive};
  const glm::dvec3 a(mesh.positions[corner[0]]), b(mesh.positions[corner[1]]), c(mesh.positions[corner[2]]);
  glm::dvec3 of_plane = glm::cross(world_from_mesh * (b - a), world_from_mesh * (c - a));
  if (glm::determinant(world_from_mesh) < 0) of_plane = -of_plane;
  glm::dvec3 of_vertices(0);
  for (int i = 0; i < 3; ++i) of_vertices += weights[i] * glm::dvec3(mesh.attributes[corner[i]].normal);
  // The inverse transpose keeps normals perpendicular under any scale.
  of_vertices = glm::transpose(glm::inverse(world_from_mesh)) * of_vertices;
  const bool has_own = glm::dot(of_vertices, of_vertices) > 0;
  const glm::dvec3 normal = glm::normalize(has_own ? of_vertices : of_plane);
  return glm::dot(of_plane, world_direction) > 0 ? -normal : normal;
}

}  // namespace

double surface_light(const SceneOverTime& scene, double share, std::uint32_t item, std::uint32_t primitive,
                     const glm::dvec3& weights, const glm::dvec3& direction) {
  const DrawList& list = scene.list();
  const Mesh& mesh = *list.meshes[list.items[item].mesh];
  const Material& material = *list.materials[list.items[item].material];
  const glm::dvec3 base(surface_color(material, mesh, primitive, weights));
  if (material.unlit) return luminance(base);
  glm::dvec3 arriving(list.environment.ambient);
  if (!list.lights.empty()) {
    const glm::dmat4 world_from_mesh = scene.world_from_mesh(item, share);
    glm::dvec3 place(0);
    for (int i = 0; i < 3; ++i)
      place += weights[i] * glm::dvec3(mesh.positions[mesh.indices[3 * std::size_t{primitive} + std::size_t(i)]]);
    const glm::dvec3 point_m(world_from_mesh * glm::dvec4(place, 1));
    const glm::dvec3 normal = shading_normal(mesh, primitive, weights, glm::dmat3(world_from_mesh),
                                             glm::dmat3(scene.world_from_view(share)) * direction);
    for (const LightItem& light : list.lights) {
      const DirectLight direct = direct_light(light.light, list.world_from_node[light.transform], point_m);
      arriving += direct.irradiance * (std::max(0.0, glm::dot(normal, direct.toward)) / std::numbers::pi);
    }
  }
  return luminance(base * arriving + glm::dvec3(material.emissive));
}

double background_light(const DrawList& list) { return luminance(mean_background(list)); }

}  // namespace simvis
