// What Coin found in a file, as plain data, and as bytes on their way from the process that runs Coin.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "engine/draw_list.h"
#include "engine/mesh.h"

namespace simvis {

inline constexpr std::uint32_t kNoInventorTexture = ~0u;

struct InventorMaterial {
  Material material;  ///< base_color_texture is left null
  std::uint32_t texture = kNoInventorTexture;
};

struct InventorShape {
  std::string name;  ///< of the innermost node that has one
  glm::dmat4 part_from_shape{1.0};
  std::uint32_t mesh = 0, material = 0;
};

struct InventorLight {
  std::string name;
  glm::dmat4 part_from_light{1.0};
  Light light;
};

struct InventorScene {
  std::vector<Mesh> meshes;  ///< bounds are not set
  std::vector<Texture> textures;
  std::vector<InventorMaterial> materials;
  std::vector<InventorShape> shapes;
  std::vector<InventorLight> lights;
  std::vector<std::string> commands, warnings;
};

/// Takes the scene by value: one description of the layout serves both ways.
std::vector<std::uint8_t> pack_inventor_scene(InventorScene scene);

/// Trusts nothing in `bytes`: sizes, indices and enumerations are checked, and every number is finite.
/// `subject` begins messages. Throws InputError.
InventorScene unpack_inventor_scene(std::span<const std::uint8_t> bytes, const std::string& subject);

}  // namespace simvis
