// The colour of a surface at a point, and whether a laser hits the surface there or passes through it.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include <simvis/mesh.h>

namespace simvis {

/// Alpha at a point of a primitive: base colour x vertex colour x texture. The texture is sampled at its largest level,
/// filtered and wrapped as its sampler specifies. `weights` are the barycentric weights of the three corners and sum to
/// 1.
float surface_alpha(const Material& material, const Mesh& mesh, std::uint32_t primitive, const glm::dvec3& weights);

/// Linear RGBA at a point, from the same product.
glm::dvec4 surface_color(const Material& material, const Mesh& mesh, std::uint32_t primitive,
                         const glm::dvec3& weights);

/// Returns whether the material is solid for a depth sensor at a point: see Material.
bool is_solid(const Material& material, const Mesh& mesh, std::uint32_t primitive, const glm::dvec3& weights);

/// The same at texture coordinates of a surface without vertex colours.
glm::dvec4 surface_color(const Material& material, const glm::dvec2& uv);
bool is_solid(const Material& material, const glm::dvec2& uv);

/// The same of a point of a mesh of points: base colour x vertex colour x texture at its texture coordinates.
glm::dvec4 point_color(const Material& material, const Mesh& mesh, std::uint32_t primitive);
bool is_solid_point(const Material& material, const Mesh& mesh, std::uint32_t primitive);

/// Returns whether the material is solid at every point of any mesh.
bool is_solid_throughout(const Material& material);

}  // namespace simvis
