// Meshes, textures and materials as plain data in host memory, independent of Vulkan.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <simvis/exact_surface.h>
#include <simvis/export.h>

namespace simvis {

/// The primitives of a mesh.
enum class Topology : std::uint8_t {
  triangles,  ///< three indices each
  lines,      ///< two indices each
  points      ///< one index each
};

/// The data of a vertex in addition to its position. Absent data takes the defaults.
struct VertexAttributes {
  glm::vec3 normal{0, 0, 1};        ///< unit length, mesh frame; of a point zero if the file gives it none
  glm::vec2 uv[2]{{0, 0}, {0, 0}};  ///< texture coordinates, two sets; v down, as in glTF
  glm::vec4 color{1, 1, 1, 1};      ///< linear RGBA, multiplies the base colour

  bool operator==(const VertexAttributes&) const = default;  ///< member by member
};

struct SplatCloud;

/// An indexed mesh. Immutable once shared.
///
/// Shape    `attributes` is as long as `positions`; `indices` holds 3 (triangles), 2 (lines) or 1 (points) per
///          primitive, each below positions.size().
/// Units    metres, in the mesh's own frame.
/// Special  every position is finite.
struct Mesh {
  std::string name;                          ///< for messages; need not be unique
  Topology topology = Topology::triangles;   ///< kind of primitives
  std::vector<glm::vec3> positions;          ///< of the vertices
  std::vector<VertexAttributes> attributes;  ///< of the vertices
  std::vector<std::uint32_t> indices;        ///< vertices of the primitives
  glm::vec3 bounds_min{0},                   ///< smallest coordinates of indexed positions and of a closed `surface`;
                                             ///< zero for an empty mesh
      bounds_max{0};                         ///< largest coordinates of the same; zero for an empty mesh
  double longest_edge = 0;                   ///< of its triangles; 0 for lines and points
  /// Another mesh takes its place when its shape next changes, as that of an animation does: nothing is prepared for it
  /// that takes longer than drawing it.
  bool short_lived = false;
  /// The closed shape, or the plane without end, that the triangles stand for: rays meet it and not the triangles,
  /// unless the item's transform flattens it.
  std::optional<ExactSurface> surface{};
  /// Gaussian splats that stand here in place of vertices, of which such a mesh has none; null: none. Nothing draws or
  /// hits them but what asks for them, see docs/gaussian-splats.md.
  std::shared_ptr<const SplatCloud> splats{};

  bool operator==(const Mesh&) const = default;  ///< member by member; splats by identity
};

/// Sets `bounds_min`, `bounds_max` and `longest_edge` from the vertices that `indices` uses and from `surface`.
SIMVIS_API void compute_bounds(Mesh& mesh);

/// How texture coordinates outside [0, 1] are mapped into it.
enum class Wrap : std::uint8_t {
  repeat,           ///< the texture repeats
  mirrored_repeat,  ///< the texture repeats, every second copy mirrored
  clamp_to_edge     ///< the edge texels continue
};
/// How a value is taken from the texels around a point.
enum class Filter : std::uint8_t {
  nearest,  ///< the nearest texel
  linear    ///< linear interpolation
};

/// How a texture is sampled.
struct Sampler {
  Wrap wrap_u = Wrap::repeat,         ///< outside [0, 1] along u
      wrap_v = Wrap::repeat;          ///< outside [0, 1] along v
  Filter magnify = Filter::linear,    ///< for texels larger than a pixel
      minify = Filter::linear,        ///< for texels smaller than a pixel
      between_mips = Filter::linear;  ///< between mipmap levels
  bool mipmapped = true;              ///< false: only the largest level is used

  bool operator==(const Sampler&) const = default;  ///< member by member
};

/// An 8-bit RGBA image and its sampler. Colours are sRGB-encoded; alpha and data that is not colour (see MapKind) are
/// linear. Immutable once shared.
struct Texture {
  std::string name;                ///< for messages; need not be unique
  std::uint32_t width = 0,         ///< in texels
      height = 0;                  ///< in texels
  std::vector<std::uint8_t> rgba;  ///< rows from the top, 4 * width * height bytes
  Sampler sampler;                 ///< how it is sampled

  bool operator==(const Texture&) const = default;  ///< member by member
};

/// Maps that describe a surface in addition to its base colour. Channels as in glTF 2.0.
enum class MapKind : std::uint8_t {
  normal,              ///< rgb from 0 to 1 is x, y, z from -1 to 1 in the tangent frame: along u, along -v, outwards
  metallic_roughness,  ///< g: factor of the roughness; b: factor of the metallic share
  occlusion,           ///< r: share of the ambient light that arrives
  emissive             ///< rgb, a colour: factor of the emission
};
/// The number of values of MapKind.
inline constexpr std::size_t kMapKinds = 4;

/// A map of a surface.
struct SurfaceMap {
  std::shared_ptr<const Texture> texture;      ///< null: the surface has no such map
  int uv_set = 0;                              ///< 0 or 1
  glm::mat3x2 uv_transform{1, 0, 0, 1, 0, 0};  ///< columns; texture uv = uv_transform * (u, v, 1)

  bool operator==(const SurfaceMap&) const = default;  ///< member by member; textures by identity
};

/// How alpha is used, as in glTF 2.0.
enum class AlphaMode : std::uint8_t {
  opaque,  ///< alpha is ignored
  mask,    ///< texels with alpha below the cutoff are removed
  blend    ///< alpha is the covered share of what lies behind
};

/// A surface is depth-visible (to depth cameras and laser scanners) where it covers at least this share of what lies
/// behind it.
inline constexpr float kMinDepthVisibleAlpha = 0.5f;

/// The smallest roughness that is shaded: a smoother surface reflects a light with this roughness, because the
/// reflection would be smaller than any pixel.
inline constexpr float kMinRoughness = 0.05f;

/// The appearance of a surface. It becomes one uniform block: a change of a material affects no other data.
///
/// A depth camera and a laser scanner see a `mask` texel whose alpha is at least `alpha_cutoff`, and a `blend` texel
/// whose alpha is at least kMinDepthVisibleAlpha. More transparent texels let them pass.
///
/// `opacity` fades the whole surface in every alpha mode: opaque and kept texels cover that share of what lies behind
/// them, `blend` texels cover their alpha times `opacity`. This share is compared with kMinDepthVisibleAlpha. Texels
/// that the cutoff removes stay removed at any opacity. At opacity 0 nothing is drawn.
///
/// A non-metallic surface of `roughness` 1 is a Lambertian surface. Every other surface reflects lights as glTF 2.0
/// specifies (appendix B): the reflectance at normal incidence is 0.04, mixed with the base colour by the metallic
/// share; a metal has no diffuse part. Ambient light is the same from all directions, so a surface shows base colour x
/// ambient, metallic or not: see effects/scene/metallic_roughness.cpp.
///
/// For lasers, and for cameras that take colour by paths of light: a share `mirror` of the light is reflected as by a
/// mirror. Of the rest, a share `transmission` enters a thin pane of glass that is tinted by the base colour. See
/// engine/light/surface_shares.h.
struct Material {
  std::string name{};                        ///< for messages; need not be unique
  glm::vec4 base_color{1, 1, 1, 1};          ///< linear RGBA, multiplies texture and vertex colour
  glm::vec3 emissive{0, 0, 0};               ///< linear radiance added to reflected light
  AlphaMode alpha_mode = AlphaMode::opaque;  ///< how alpha is used
  float alpha_cutoff = 0.5f;                 ///< `mask`: smallest alpha that is drawn
  float opacity = 1;                         ///< [0, 1]
  float roughness = 1;                       ///< [0, 1], the square root of the GGX distribution's alpha
  float metallic = 0;                        ///< [0, 1]
  bool unlit = false;                        ///< shows the base colour without lighting
  bool double_sided = false;  ///< cameras draw back faces only of double-sided materials; scanners hit both sides
  std::optional<float> reflectance{};  ///< [0, 1], for laser light; unset: the mean of the base colour
  float retro_reflectance = 0;         ///< gain of a retro-reflector relative to a white matte surface; 0: none
  std::shared_ptr<const Texture> base_color_texture{};  ///< may be null
  int uv_set = 0;                                       ///< of the base colour texture, 0 or 1
  glm::mat3x2 uv_transform{1, 0, 0, 1, 0, 0};           ///< columns; texture uv = uv_transform * (u, v, 1)
  std::array<SurfaceMap, kMapKinds> maps{};             ///< by MapKind; they affect colour only
  float normal_scale = 1;                               ///< factor of the normal map's x and y
  float occlusion_strength = 1;                         ///< [0, 1], weight of the occlusion map
  float mirror = 0,                                     ///< [0, 1], share reflected as by a mirror
      transmission = 0;                                 ///< [0, 1], share of the rest that enters the glass
  float refractive_index = 1.5f;                        ///< of a pane of glass, above 0

  const SurfaceMap& map(MapKind kind) const { return maps[static_cast<std::size_t>(kind)]; }  ///< the map of a kind
  SurfaceMap& map(MapKind kind) { return maps[static_cast<std::size_t>(kind)]; }              ///< the map of a kind

  bool operator==(const Material&) const = default;  ///< member by member; textures by identity
};

}  // namespace simvis
