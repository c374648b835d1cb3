// The draw list: one flattened frame of the world as plain data. The scene graph builds it; the renderer and the ray
// casters read it. It can be built, printed and compared without a GPU.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <iosfwd>
#include <memory>
#include <vector>

#include <simvis/draw_list_delta.h>
#include <simvis/export.h>
#include <simvis/mesh.h>
#include <simvis/sky_picture.h>

namespace simvis {

/// The shape of a light's emission.
enum class LightKind : std::uint8_t {
  directional,  ///< parallel light from infinity
  point,        ///< the same intensity in all directions
  spot          ///< a cone around `direction`
};

/// What a light stands for together with the other lights of its lamp.
enum class LampShape : std::uint8_t {
  point,       ///< itself
  ball,        ///< the surface of a ball
  disc,        ///< a disc in the sky
  even_sky,    ///< the sphere of all directions, with the same radiance everywhere
  sky_picture  ///< the picture of the sky, see SkyView
};

/// A light, in the units of KHR_lights_punctual. It sits at the origin of its frame and shines along `direction`.
struct Light {
  LightKind kind = LightKind::directional;  ///< shape of the emission
  glm::vec3 color{1, 1, 1};                 ///< linear RGB
  double intensity = 1;                     ///< directional: lux; point and spot: candela
  double range_m = 0;                       ///< the light is off beyond this distance; 0: no limit
  double inner_cone_rad = 0;                ///< spot: full intensity up to this angle from the axis
  double outer_cone_rad = 0.785;            ///< spot: no light beyond this angle from the axis
  glm::dvec3 direction{1, 0, 0};  ///< the way the light travels (directional, spot), unit length, in the light's frame
  std::uint32_t shadow_px = 0;    ///< texels along a side of its shadow map; 0: the light casts no shadows
  std::uint32_t lamp_points = 1;  ///< lights, this one included, that are the points of one lamp with a size
  std::uint32_t lamp_point = 0;   ///< which of these points it is: [0, lamp_points)
  LampShape lamp_shape = LampShape::point;  ///< of all of them
  double lamp_radius = 0;                   ///< ball: m; disc: rad
  glm::dvec3 lamp_middle{0};                ///< in the light's frame; ball: m; disc: the `direction` of its middle

  bool operator==(const Light&) const = default;  ///< member by member
};

/// A mesh with a material at a place. The numbers index the tables of the DrawList.
struct DrawItem {
  std::uint32_t mesh = 0;       ///< in DrawList::meshes
  std::uint32_t material = 0;   ///< in DrawList::materials
  std::uint32_t transform = 0;  ///< in DrawList::world_from_node
  bool visible = true;          ///< no sensor sees an item that is not visible

  bool operator==(const DrawItem&) const = default;  ///< member by member
};

/// A light at a place.
struct LightItem {
  Light light;                  ///< in its own frame
  std::uint32_t transform = 0;  ///< in DrawList::world_from_node

  bool operator==(const LightItem&) const = default;  ///< member by member
};

/// The surroundings of the scene.
struct Environment {
  glm::vec3 ambient{0.3f};                    ///< linear RGB radiance, the same from all directions
  glm::vec3 background{0.55f, 0.68f, 0.85f};  ///< linear RGB of pixels where nothing is hit

  bool operator==(const Environment&) const = default;  ///< member by member
};

/// A picture of the sky, which cameras see where nothing is hit. Its light on surfaces comes from lights of the list.
struct SkyView {
  std::shared_ptr<const SkyPicture> picture{};  ///< null: Environment::background is seen
  float factor = 1;                             ///< of the picture's radiance
  glm::vec3 mean{0};                            ///< radiance of the picture in the mean over the sphere
  std::uint32_t transform = 0;                  ///< of the picture's frame, in DrawList::world_from_node

  bool operator==(const SkyView&) const = default;  ///< member by member; pictures by address
};

/// The medium that fills the air everywhere: haze, fog, rain, snow, dust. All zeros are clear air.
struct Medium {
  /// Extinction of visible light: the transmittance is exp(-extinction distance), Beer and Lambert.
  double extinction_per_m = 0;
  glm::vec3 airlight{0.7f};           ///< linear RGB radiance that it scatters towards a camera, at infinite distance
  double laser_extinction_per_m = 0;  ///< extinction of laser light, in the near infrared
  double backscatter_per_m_sr = 0;    ///< share of laser light scattered back per metre of path and steradian, by all
  double particles_per_m3 = 0;        ///< drops, flakes or grains that may be large enough for echoes of their own
  double particle_diameter_m = 0;     ///< their mean diameter; diameters are distributed exponentially

  bool operator==(const Medium&) const = default;  ///< member by member
};

/// A flattened frame.
///
/// Frames     `world_from_node[t]` transforms coordinates of a mesh or a light to the world; entry 0 is the identity.
/// Order      items are in the order of traversal.
/// Revisions  each number grows whenever the tables that it covers change, so that a reader updates only these:
///            `structure`: items, meshes, the number of lights, the identity of materials; `materials`: the content of
///            a material (`material_revision[m]` says which one); `transforms`: any entry of `world_from_node`;
///            `lights`.
/// Lifetime   meshes and materials are shared with the scene graph and never change.
struct DrawList {
  std::vector<DrawItem> items;                             ///< what is drawn, and what is hidden for now
  std::vector<LightItem> lights;                           ///< of the whole scene
  std::vector<glm::dmat4> world_from_node;                 ///< transforms; entry 0 is the identity
  std::vector<std::shared_ptr<const Mesh>> meshes;         ///< indexed by DrawItem::mesh
  std::vector<std::shared_ptr<const Material>> materials;  ///< indexed by DrawItem::material
  std::vector<std::uint64_t> material_revision;            ///< as long as `materials`
  Environment environment;                                 ///< surroundings
  SkyView sky;                                             ///< what is seen instead of the background
  Medium medium;                                           ///< air

  /// Change counters of the tables.
  struct Revisions {
    std::uint64_t structure = 0,                        ///< items, meshes, number of lights, identity of materials
        transforms = 0,                                 ///< entries of `world_from_node`
        materials = 0,                                  ///< content of materials
        lights = 0;                                     ///< content of lights
    bool operator==(const Revisions&) const = default;  ///< member by member
  } revisions;                                          ///< change counters of the tables

  DrawListDelta changes;  ///< change log of items, meshes, the set of materials, and transforms
};

/// Whether the content is the same: items, lights, transforms bit by bit, meshes and materials by value. Revisions are
/// not compared.
SIMVIS_API bool same_content(const DrawList& a, const DrawList& b);

/// A 64-bit FNV-1a hash of the content that same_content() compares.
SIMVIS_API std::uint64_t content_hash(const DrawList& list);

/// Prints the list as text, for tests and debugging.
SIMVIS_API std::ostream& operator<<(std::ostream& out, const DrawList& list);

}  // namespace simvis
