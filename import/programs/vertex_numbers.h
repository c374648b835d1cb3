// Merges corners with equal bits into one vertex of a mesh.
#pragma once

#include <cstdint>
#include <vector>

#include <simvis/mesh.h>

namespace simvis {

/// Numbers the vertices of one mesh in the order of their addition. The table holds only numbers and hashes and looks
/// up the vertices in the mesh, so no other code may add vertices to that mesh.
class VertexNumbers {
 public:
  /// Returns the number of the vertex in `mesh`. Adds the vertex if the mesh has none with the same bits.
  std::uint32_t add(Mesh& mesh, const glm::vec3& position, const VertexAttributes& attributes);

 private:
  struct Slot {
    std::uint32_t number, hash;
  };
  void grow();

  std::vector<Slot> slots_;  // the size is a power of two; at most half of the slots are used
};

}  // namespace simvis
