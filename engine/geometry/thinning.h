// Fewer, larger parts of a mesh that cover the same area: how a crown of separate leaves becomes coarser.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include <simvis/mesh.h>

namespace simvis {

/// The area of triangles of a mesh, given by its indices.
double surface_area(const Mesh& mesh, std::span<const std::uint32_t> indices);

/// The number of parts of a mesh with so many vertices. Triangles with a common vertex belong to one part.
std::size_t count_parts(std::size_t vertices, std::span<const std::uint32_t> indices);

/// A mesh with fewer parts is not thinned.
inline constexpr std::size_t kMinThinnedParts = 16;

/// Every second part of a mesh.
struct ThinnedParts {
  std::vector<std::uint32_t> indices;  ///< of their triangles
  double enlarged = 1;                 ///< factor of their lengths that keeps the area of all parts
};

/// `indices` are those of triangles of the mesh. Triangles with a common vertex belong to one part. Parts that stay are
/// spread evenly in space. Nothing if there are fewer than kMinThinnedParts, or none has an area.
std::optional<ThinnedParts> thinned(const Mesh& mesh, std::span<const std::uint32_t> indices);

/// The positions of a mesh whose parts, which `indices` make up, are enlarged, each about the middle of its box.
std::vector<glm::vec3> enlarged_positions(const Mesh& mesh, std::span<const std::uint32_t> indices, double factor);

}  // namespace simvis
