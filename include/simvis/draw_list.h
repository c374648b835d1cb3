// One flattened frame of the world: what there is to draw, as plain data. Built by the scene graph, read by the
// renderer and the ray casters. It can be built, printed and compared without a GPU.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <iosfwd>
#include <memory>
#include <vector>

#include <simvis/draw_list_delta.h>
#include <simvis/mesh.h>

namespace simvis {

enum class LightKind : std::uint8_t { directional, point, spot };

/// A light, in the units of KHR_lights_punctual. It sits at the origin of its frame and shines along `direction`.
struct Light {
  LightKind kind = LightKind::directional;
  glm::vec3 color{1, 1, 1};       ///< linear RGB
  double intensity = 1;           ///< directional: lux; point and spot: candela
  double range_m = 0;             ///< beyond it the light is off; 0 = no limit
  double inner_cone_rad = 0;      ///< spot: full intensity within this angle from the axis
  double outer_cone_rad = 0.785;  ///< spot: none beyond it
  glm::dvec3 direction{1, 0, 0};  ///< the way the light travels (directional, spot), unit length, in the light's frame
  std::uint32_t shadow_px = 0;    ///< texels along a side of its shadow map; 0: what stands in its way casts no shadow

  bool operator==(const Light&) const = default;
};

/// A mesh with a material at a place. The numbers index the tables of the DrawList.
struct DrawItem {
  std::uint32_t mesh = 0;
  std::uint32_t material = 0;
  std::uint32_t transform = 0;

  bool operator==(const DrawItem&) const = default;
};

struct LightItem {
  Light light;
  std::uint32_t transform = 0;

  bool operator==(const LightItem&) const = default;
};

/// What surrounds the scene.
struct Environment {
  glm::vec3 ambient{0.3f};                    ///< linear RGB radiance from all around
  glm::vec3 background{0.55f, 0.68f, 0.85f};  ///< linear RGB seen where nothing is hit

  bool operator==(const Environment&) const = default;
};

/// What fills the air everywhere: haze, fog, rain, dust. Clear air has none of it.
struct Medium {
  double extinction_per_m = 0;        ///< of visible light: transmittance exp(-extinction distance), Beer and Lambert
  glm::vec3 airlight{0.7f};           ///< linear RGB radiance that it scatters towards a camera, seen at infinity
  double laser_extinction_per_m = 0;  ///< the same for lasers, in the near infrared
  double backscatter_per_m_sr = 0;    ///< of a laser: share that it sends back per metre of way and steradian
  double particles_per_m3 = 0;        ///< drops, large enough for an echo each
  double particle_diameter_m = 0;     ///< their mean; diameters are distributed exponentially

  bool operator==(const Medium&) const = default;
};

/// A frame, flattened.
///
/// Frames   `world_from_node[t]` takes a mesh's or light's own coordinates to the world; entry 0 is the identity.
/// Order    items stand in the order of traversal.
/// Revisions  each grows whenever the tables that it names changed, so a reader does only the work that changed:
///          `structure`: items, meshes, lights' number, the identity of materials; `materials`: a material's content
///          (`material_revision[m]` says which); `transforms`: any entry of `world_from_node`; `lights`.
struct DrawList {
  std::vector<DrawItem> items;
  std::vector<LightItem> lights;
  std::vector<glm::dmat4> world_from_node;
  std::vector<std::shared_ptr<const Mesh>> meshes;
  std::vector<std::shared_ptr<const Material>> materials;
  std::vector<std::uint64_t> material_revision;  ///< as long as `materials`
  Environment environment;
  Medium medium;

  struct Revisions {
    std::uint64_t structure = 0, transforms = 0, materials = 0, lights = 0;
    bool operator==(const Revisions&) const = default;
  } revisions;

  DrawListDelta changes;  ///< of items, meshes, which materials there are, and transforms
};

/// Same content: items, lights, transforms to the bit, meshes and materials by value. Revisions do not count.
bool same_content(const DrawList& a, const DrawList& b);

/// A 64-bit FNV-1a hash of the same content.
std::uint64_t content_hash(const DrawList& list);

std::ostream& operator<<(std::ostream& out, const DrawList& list);

}  // namespace simvis
