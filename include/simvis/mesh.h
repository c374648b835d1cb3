// Geometry, textures and materials as plain data in host memory. Nothing here knows Vulkan.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace simvis {

enum class Topology : std::uint8_t { triangles, lines, points };

/// What a vertex carries besides its position. Absent data takes the defaults.
struct VertexAttributes {
  glm::vec3 normal{0, 0, 1};        ///< unit length, mesh frame
  glm::vec2 uv[2]{{0, 0}, {0, 0}};  ///< texture coordinates, two sets; v down, as in glTF
  glm::vec4 color{1, 1, 1, 1};      ///< linear RGBA, multiplies the base colour

  bool operator==(const VertexAttributes&) const = default;
};

/// An indexed mesh. Immutable once shared.
///
/// Shape    `attributes` is as long as `positions`; `indices` holds 3 (triangles), 2 (lines) or 1 (points) per
///          primitive, each below positions.size().
/// Units    metres, in the mesh's own frame.
/// Special  every position is finite.
struct Mesh {
  std::string name;
  Topology topology = Topology::triangles;
  std::vector<glm::vec3> positions;
  std::vector<VertexAttributes> attributes;
  std::vector<std::uint32_t> indices;
  glm::vec3 bounds_min{0}, bounds_max{0};  ///< of the positions that indices use; both zero for an empty mesh
  double longest_edge = 0;                 ///< of its triangles; 0 for lines and points

  bool operator==(const Mesh&) const = default;
};

/// Sets `bounds_min`, `bounds_max` and `longest_edge` from what `indices` uses.
void compute_bounds(Mesh& mesh);

enum class Wrap : std::uint8_t { repeat, mirrored_repeat, clamp_to_edge };
enum class Filter : std::uint8_t { nearest, linear };

struct Sampler {
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  Filter magnify = Filter::linear, minify = Filter::linear, between_mips = Filter::linear;
  bool mipmapped = true;

  bool operator==(const Sampler&) const = default;
};

/// An 8-bit RGBA picture and how to sample it. Colours are in sRGB encoding; alpha, and what is no colour (see
/// MapKind), are linear. Immutable once shared.
struct Texture {
  std::string name;
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< rows from the top, 4 * width * height bytes
  Sampler sampler;

  bool operator==(const Texture&) const = default;
};

/// What a map tells of a surface, besides its base colour. Channels as in glTF 2.0.
enum class MapKind : std::uint8_t {
  normal,              ///< rgb from 0 to 1 is x, y, z from -1 to 1 in the tangent frame: along u, along -v, outwards
  metallic_roughness,  ///< g: factor of the roughness; b: of the metallic share
  occlusion,           ///< r: share of the light from all around that arrives
  emissive             ///< rgb, a colour: factor of the emission
};
inline constexpr std::size_t kMapKinds = 4;

struct SurfaceMap {
  std::shared_ptr<const Texture> texture;      ///< null: there is none
  int uv_set = 0;                              ///< 0 or 1
  glm::mat3x2 uv_transform{1, 0, 0, 1, 0, 0};  ///< columns; texture uv = uv_transform * (u, v, 1)

  bool operator==(const SurfaceMap&) const = default;
};

enum class AlphaMode : std::uint8_t { opaque, mask, blend };

/// What a depth camera and a laser scanner meet covers at least this share of what lies behind it.
inline constexpr float kMinDepthVisibleAlpha = 0.5f;

/// A smoother surface shows a light as this rough a one does: its image would be smaller than any pixel.
inline constexpr float kMinRoughness = 0.05f;

/// How a surface looks. One uniform block: to change it touches nothing else.
///
/// A depth camera and a laser scanner see a `mask` texel whose alpha is at least `alpha_cutoff`, and a `blend` texel
/// whose alpha is at least kMinDepthVisibleAlpha; what is more transparent lets them pass.
///
/// `opacity` fades the whole surface, whatever its mode: opaque and kept texels cover that share of what lies behind
/// them, those of `blend` their alpha times it, and this share is what kMinDepthVisibleAlpha is held against. What the
/// cutoff takes away stays away, however faded the rest is. At 0 nothing is drawn.
///
/// `roughness` 1 of what is no metal is Lambert's matte surface. All else reflects lights as glTF 2.0 says (appendix
/// B): reflectance at normal incidence 0.04, and base colour with the metallic share; what is metal has no diffuse
/// part. Ambient light is the same from all around, so a surface shows base colour x ambient, metal or not: see
/// effects/metallic_roughness.cpp.
///
/// For lasers only: a share `mirror` of the light is reflected as by a mirror, and of the rest a share `transmission`
/// meets a thin pane of glass, coloured by the base colour. See effects/specular_path.h.
struct Material {
  std::string name;
  glm::vec4 base_color{1, 1, 1, 1};  ///< linear RGBA, multiplies texture and vertex colour
  glm::vec3 emissive{0, 0, 0};       ///< linear radiance added to what is reflected
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;
  float opacity = 1;          ///< [0, 1]
  float roughness = 1;        ///< [0, 1], the square root of the GGX distribution's alpha
  float metallic = 0;         ///< [0, 1]
  bool unlit = false;         ///< shows the base colour as it is
  bool double_sided = false;  ///< cameras draw back faces only of double-sided materials; scanners meet both sides
  std::optional<float> reflectance{};  ///< [0, 1], of a laser's light; unset: the mean of the base colour
  float retro_reflectance = 0;         ///< gain of a retro-reflector, where white and matte is 1; 0: it is none
  std::shared_ptr<const Texture> base_color_texture;  ///< may be null
  int uv_set = 0;                                     ///< 0 or 1
  glm::mat3x2 uv_transform{1, 0, 0, 1, 0, 0};         ///< columns; texture uv = uv_transform * (u, v, 1)
  std::array<SurfaceMap, kMapKinds> maps{};           ///< by MapKind; shown in colour only
  float normal_scale = 1;                             ///< factor of the normal map's x and y
  float occlusion_strength = 1;                       ///< [0, 1], how much of the occlusion map counts
  float mirror = 0, transmission = 0;                 ///< [0, 1], for lasers
  float refractive_index = 1.5f;                      ///< of a pane of glass, above 0

  const SurfaceMap& map(MapKind kind) const { return maps[static_cast<std::size_t>(kind)]; }
  SurfaceMap& map(MapKind kind) { return maps[static_cast<std::size_t>(kind)]; }

  bool operator==(const Material&) const = default;
};

}  // namespace simvis
