// Meshes at places as a part that any scene can load: a glTF 2.0 binary file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include <simvis/mesh.h>

namespace simvis::bench {

struct PlacedMesh {
  std::size_t mesh = 0;
  glm::dvec3 position_m{0};
  glm::dquat turn{1, 0, 0, 0};
};

/// Positions, normals and indices as they are: the part's command says up="z". Throws std::runtime_error if the file
/// cannot be written.
void write_glb(const std::filesystem::path& file, std::span<const Mesh> meshes, std::span<const PlacedMesh> placed);

/// The two halves of such a file.
struct GlbDocument {
  nlohmann::json json;
  std::string buffer;

  /// Puts bytes at the buffer's end and tells where: the number of a new buffer view.
  std::size_t add_view(const void* bytes, std::size_t size);
};

GlbDocument read_glb(const std::filesystem::path& file);
void write_glb(const std::filesystem::path& file, GlbDocument document);

}  // namespace simvis::bench
