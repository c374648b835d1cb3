// How far two surfaces of triangles are apart, bounded: the Hausdorff distance.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

namespace simvis {

class ThreadPool;

/// A surface of triangles; three indices each.
struct TriangleSurface {
  std::span<const glm::vec3> positions;
  std::span<const std::uint32_t> indices;
};

/// An upper bound on the distance from any point of either surface to the other surface. It exceeds the larger of the
/// true distance and `floor`, which is above 0, by at most a fifth, but for triangles that are longer than 2^7 times
/// `floor`: theirs may be larger. Neither surface is empty. `pool` has the threads to use, null for the calling thread
/// alone; the result does not depend on it.
double surface_deviation(const TriangleSurface& a, const TriangleSurface& b, double floor, ThreadPool* pool = nullptr);

}  // namespace simvis
