// Parts on the disk for hard cases that need a whole simulation.
#pragma once

#include <filesystem>
#include <vector>

#include <simvis/mesh.h>
#include "tests/support/parts/gltf_fixture.h"

namespace simvis {

/// Writes a mesh as a glTF part in the project's own axes: insert it with up="z".
inline void write_part(const std::filesystem::path& file, const Mesh& mesh) {
  test::GltfBuilder builder;
  std::vector<float> positions;
  for (const glm::vec3& p : mesh.positions) positions.insert(positions.end(), {p.x, p.y, p.z});
  test::json& primitive = builder.primitive({{"POSITION", builder.accessor("VEC3", positions)}});
  primitive["indices"] = builder.accessor("SCALAR", mesh.indices);
  write_text(file, builder.text());
}

}  // namespace simvis
