// The values of the maps of a surface at a point.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include <simvis/mesh.h>

namespace simvis {

/// The map at a point of a triangle, at its largest level, filtered and wrapped as its sampler specifies: RGBA from 0
/// to 1, of an emissive map linear. The map has a texture. `weights` are as those of surface_alpha().
glm::dvec4 map_value(const SurfaceMap& map, MapKind kind, const Mesh& mesh, std::uint32_t primitive,
                     const glm::dvec3& weights);

}  // namespace simvis
