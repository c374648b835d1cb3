// What a library that is kept in a process of its own found in a file: plain data, and bytes on their way from there.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/mesh.h>

namespace simvis {

inline constexpr std::uint32_t kNoForeignTexture = ~0u;

struct ForeignMaterial {
  Material material;  ///< base_color_texture is left null
  std::uint32_t texture = kNoForeignTexture;
};

struct ForeignShape {
  std::string name;  ///< of the innermost node that has one
  glm::dmat4 part_from_shape{1.0};
  std::uint32_t mesh = 0, material = 0;
};

struct ForeignLight {
  std::string name;
  glm::dmat4 part_from_light{1.0};
  Light light;
};

struct ForeignScene {
  std::vector<Mesh> meshes;  ///< bounds are not set
  std::vector<Texture> textures;
  std::vector<ForeignMaterial> materials;
  std::vector<ForeignShape> shapes;
  std::vector<ForeignLight> lights;
  std::vector<std::string> commands, warnings;
};

/// Takes the scene by value: one description of the layout serves both ways.
std::vector<std::uint8_t> pack_foreign_scene(ForeignScene scene);

/// Trusts nothing in `bytes`: sizes, indices and enumerations are checked, and every number is finite.
/// `subject` begins messages. Throws InputError.
ForeignScene unpack_foreign_scene(std::span<const std::uint8_t> bytes, const std::string& subject);

}  // namespace simvis
