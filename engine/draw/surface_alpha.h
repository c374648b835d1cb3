// What a point of a surface is like: its colour, and whether a laser meets it or passes through it.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include <simvis/mesh.h>

namespace simvis {

/// Alpha at a point of a primitive: base colour x vertex colour x texture at its largest level, filtered and wrapped as
/// its sampler says. `weights` of the corners sum to 1.
float surface_alpha(const Material& material, const Mesh& mesh, std::uint32_t primitive, const glm::dvec3& weights);

/// Linear RGBA there, by the same product.
glm::dvec4 surface_color(const Material& material, const Mesh& mesh, std::uint32_t primitive,
                         const glm::dvec3& weights);

/// Whether what a depth sensor sees of the material there is solid (see Material).
bool is_solid(const Material& material, const Mesh& mesh, std::uint32_t primitive, const glm::dvec3& weights);

/// Whether it is so at every point, whatever the mesh.
bool is_solid_throughout(const Material& material);

}  // namespace simvis
