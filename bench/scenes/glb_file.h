// Writes placed meshes as a glTF 2.0 binary file that any scene can load as a part.
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

/// Positions, normals and indices are written unchanged: the part's command needs up="z". Throws std::runtime_error if
/// the file cannot be written.
void write_glb(const std::filesystem::path& file, std::span<const Mesh> meshes, std::span<const PlacedMesh> placed);

/// The JSON and binary chunks of such a file.
struct GlbDocument {
  nlohmann::json json;
  std::string buffer;

  /// Appends bytes to the buffer; returns the index of the new buffer view.
  std::size_t add_view(const void* bytes, std::size_t size);
};

GlbDocument read_glb(const std::filesystem::path& file);
void write_glb(const std::filesystem::path& file, GlbDocument document);

}  // namespace simvis::bench
