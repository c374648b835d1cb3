// Corners of equal bits become one vertex of a mesh.
#pragma once

#include <cstdint>
#include <vector>

#include <simvis/mesh.h>

namespace simvis {

/// Numbers the vertices of one mesh in the order in which they come. The table holds numbers and hashes alone: what
/// they stand for is looked up in the mesh, which nobody else may add to meanwhile.
class VertexNumbers {
 public:
  /// The number of the vertex in `mesh`, to which it is added if no vertex has its bits.
  std::uint32_t add(Mesh& mesh, const glm::vec3& position, const VertexAttributes& attributes);

 private:
  struct Slot {
    std::uint32_t number, hash;
  };
  void grow();

  std::vector<Slot> slots_;  // a power of two of them, at most half of them taken
};

}  // namespace simvis
