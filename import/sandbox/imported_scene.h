// The scene that a sandboxed import program reads from a part file, as plain data, and its serialization.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/mesh.h>

namespace simvis {

inline constexpr std::uint32_t kNoTexture = ~0u, kNoParent = ~0u;

/// A texture whose pixels are stored here or in a picture file.
struct ImportedTexture {
  std::string file;  ///< relative to the part file's folder; empty: `texture` has the pixels
  Texture texture;
};

struct ImportedMaterial {
  Material material;         ///< base_color_texture is left null
  bool is_fallback = false;  ///< no material in the file: the fallback is used; only `unlit` is read
  std::uint32_t texture = kNoTexture;
  bool textured_emission = false;  ///< the emission is multiplied by the texture
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

using PackedBytes = std::function<void(std::span<const std::uint8_t> bytes)>;

/// Hands over the bytes of the packed scene from the first to the last, without a copy of large arrays. The scene stays
/// as it is; it is not const, because packing and unpacking share one description of the layout.
void pack_imported_scene(ImportedScene& scene, const PackedBytes& write);

/// How many bytes these are.
std::uint64_t packed_size(ImportedScene& scene);

/// All of them.
std::vector<std::uint8_t> pack_imported_scene(ImportedScene scene);

/// Does not trust `bytes`: checks sizes, indices and enumerations, and that every number is finite.
/// Throws InputError whose message begins with `subject`.
ImportedScene unpack_imported_scene(std::span<const std::uint8_t> bytes, const std::string& subject);

}  // namespace simvis
