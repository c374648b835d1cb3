// What a sandboxed import program found in a part file: plain data, and its bytes on their way to SimVis.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/mesh.h>

namespace simvis {

inline constexpr std::uint32_t kNoTexture = ~0u, kNoParent = ~0u;

/// A texture whose pixels are here, or in a picture file.
struct ImportedTexture {
  std::string file;  ///< relative to the part file's folder; empty: `texture` has the pixels
  Texture texture;
};

struct ImportedMaterial {
  Material material;         ///< base_color_texture is left null
  bool is_fallback = false;  ///< the part file has none here: whoever reads it says what to take; only `unlit` counts
  std::uint32_t texture = kNoTexture;
};

struct ImportedShape {
  std::uint32_t mesh = 0, material = 0;
};

struct ImportedNode {
  std::string name;
  std::uint32_t parent = kNoParent;  ///< an earlier node
  glm::dmat4 parent_from_node{1.0};
  std::vector<ImportedShape> shapes;
  std::optional<Light> light;
};

struct ImportedScene {
  std::vector<Mesh> meshes;  ///< bounds are not set
  std::vector<ImportedTexture> textures;
  std::vector<ImportedMaterial> materials;
  std::vector<ImportedNode> nodes;
  std::vector<std::string> commands, warnings;
};

/// Takes the scene by value: one description of the layout serves both directions.
std::vector<std::uint8_t> pack_imported_scene(ImportedScene scene);

/// Trusts nothing in `bytes`: sizes, indices and enumerations are checked, and every number is finite.
/// `subject` begins messages. Throws InputError.
ImportedScene unpack_imported_scene(std::span<const std::uint8_t> bytes, const std::string& subject);

}  // namespace simvis
