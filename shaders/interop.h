// Every struct that C++ and GLSL share, and the numbers that name bindings and constants.
//
// Rule: members fill rows of 16 bytes, no bare vec3, so that std430, std140 and C++ agree on every offset; a test
// compares them. Frames are in the names: the view frame is x right, y down, z forward.
#ifndef SIMVIS_SHADERS_INTEROP_H_
#define SIMVIS_SHADERS_INTEROP_H_

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>

namespace simvis::shader {
using glm::uvec2;
using glm::uvec4;
using glm::vec4;
using uint = std::uint32_t;
#endif

// Descriptor set 0: the frame. Descriptor set 1: the textures of a material. Descriptor set 2: layers of transparent
// surfaces.
#define SIMVIS_FRAME_SET 0
#define SIMVIS_MATERIALS 0
#define SIMVIS_LIGHTS 1
#define SIMVIS_MAP_PLACES 2
#define SIMVIS_TEXTURE_SET 1
#define SIMVIS_BASE_COLOR_TEXTURE 0
#define SIMVIS_FIRST_MAP 1  // then as MapKind
#define SIMVIS_NORMAL_MAP 1
#define SIMVIS_METALLIC_ROUGHNESS_MAP 2
#define SIMVIS_OCCLUSION_MAP 3
#define SIMVIS_EMISSIVE_MAP 4
#define SIMVIS_TEXTURES 5
#define SIMVIS_LAYERS_SET 2
#define SIMVIS_LAYER_LISTS 0
#define SIMVIS_LAYER_NODES 1

// Descriptor set 3, of scenes with shadows: where light may be in something's way.
#define SIMVIS_SHADOW_SET 3
#define SIMVIS_SHADOWS 0
#define SIMVIS_SHADOW_ATLAS 1
#define SIMVIS_MAX_SHADOWS 64  // of a view

// The lights of a view are one uniform block: 16384 bytes, which every device allows.
#define SIMVIS_MAX_LIGHTS 256

// Descriptor set 0 of ray_cast.comp.
#define SIMVIS_RAY_TOP_NODES 0
#define SIMVIS_RAY_ITEMS 1
#define SIMVIS_RAY_MESH_NODES 2
#define SIMVIS_RAY_TRIANGLES 3
#define SIMVIS_RAY_DIRECTIONS 4
#define SIMVIS_RAY_CANDIDATES 5
#define SIMVIS_RAY_BINDINGS 6

#define SIMVIS_RAY_GROUP 64  // rays of a workgroup
#define SIMVIS_MOST_CANDIDATES 7
#define SIMVIS_TREE_DEPTH 32
#define SIMVIS_WHOLE_ITEM 0xffffffffu  // a candidate's primitive: the host has to test the item's triangles
#define SIMVIS_FAR_M 1e18              // beyond it nothing is met
#define SIMVIS_MOST_SLACK 0.015625     // what is placed less exactly, in radii, is left to the host

// Vertex inputs.
#define SIMVIS_POSITION 0
#define SIMVIS_NORMAL 1
#define SIMVIS_UV_0 2
#define SIMVIS_UV_1 3
#define SIMVIS_COLOR 4
#define SIMVIS_INSTANCE_CLIP_X 5
#define SIMVIS_INSTANCE_CLIP_Y 6
#define SIMVIS_INSTANCE_CLIP_W 7
#define SIMVIS_INSTANCE_MATERIAL 8

// What vertex shaders hand to fragments, besides the first locations of mesh_color.vert.
#define SIMVIS_REACH 11

// Specialization constants.
#define SIMVIS_MASKED 0
#define SIMVIS_UNLIT 1
#define SIMVIS_LIGHT_COUNT 2
#define SIMVIS_FADED 3
#define SIMVIS_GLOSSY 4
#define SIMVIS_SHADOWED 5
#define SIMVIS_ORTHOGRAPHIC 6
#define SIMVIS_METALLIC 7
#define SIMVIS_MAPS 8  // a sum of 1 << binding of the textures that are there
#define SIMVIS_FOG 9

#define SIMVIS_LEAST_ROUGHNESS 0.05

// The mean of a pixel's samples: bindings, specialization constants, and the side of a work group's square.
#define SIMVIS_AVERAGE_SAMPLES 0
#define SIMVIS_AVERAGE_MEAN 1
#define SIMVIS_AVERAGE_GRID 0
#define SIMVIS_AVERAGE_MSAA 1
#define SIMVIS_AVERAGE_GROUP 8

#ifdef __cplusplus
// One mesh in one view, read as vertex inputs of instance rate (a CPU device fetches those once for all lanes, which it
// cannot do for a storage buffer): rows of clip_from_mesh, formed in double and rounded once.
// A mesh point p = (x, y, z, 1) has clip = (clip_x . p, clip_y . p, near_m, clip_w . p), so depth = near_m / z with
// z = clip_w . p, in metres along the optical axis. In a parallel view clip = (clip_x . p, clip_y . p, clip_w . p, 1).
struct Instance {
  vec4 clip_x;
  vec4 clip_y;
  vec4 clip_w;
  uint material;  // slot in the table of materials
};

// A vertex of a triangle that was picked by itself, with the rows of its mesh: triangles of many meshes are one draw.
struct CpuSelectedVertex {
  float x, y, z;  // in the mesh's frame
  vec4 clip_x;    // as in Instance
  vec4 clip_y;
  vec4 clip_w;
};
#endif

struct MaterialBlock {
  vec4 base_color;       // linear RGBA
  vec4 emissive_cutoff;  // rgb: linear radiance; a: the least alpha that a mask keeps
  vec4 uv_row_u;         // xyz: texture u = uv_row_u . (u, v, 1); w: which set of texture coordinates, 0 or 1
  vec4 uv_row_v;         // xyz: likewise for v; w: strength of the occlusion map
  vec4 finish;           // x: roughness; y: opacity of a surface that is faded as a whole; z: metallic share;
                         // w: scale of the normal map
};

// Where a material's maps lie, from SIMVIS_FIRST_MAP on; rows as in MaterialBlock.
struct MapPlacesBlock {
  vec4 row_u[SIMVIS_TEXTURES - 1];
  vec4 row_v[SIMVIS_TEXTURES - 1];
};

// A light in the view frame. Point and spot: intensity falls with the square of the distance.
struct LightBlock {
  vec4 position;   // xyz: metres; w: 1 for point and spot, 0 for directional
  vec4 direction;  // xyz: the way the light travels, unit length; w: 1 / range in 1/m, 0 for no limit
  vec4 intensity;  // rgb: lux (directional) or candela
  vec4 cone;       // x, y: scale and offset of the cosine to the axis; (0, 1) where there is no cone
                   // z: 1 + number of its ShadowBlock; 0: it casts no shadow
};

// A light's shadow map: one view of the atlas, or the six of a cube (see ShadowUse in engine/frame_plan.h).
struct ShadowBlock {
  vec4 row_x;  // of map_from_view, the frame of its first view from that of the view that is lit, in metres
  vec4 row_y;
  vec4 row_z;
  vec4 projection;  // texel (u, v) of a side = xy * (x, y) / z + zw; in parallel light xy * (x, y) + zw
  vec4 depth;       // x: near_m, depth = near_m / z; in parallel light far_m, depth = (far_m - z) * y
                    // y: 1 / (far_m - near_m), 0 where light is not parallel; z: distance of the frames'
                    // origins, metres; w: 1 for a cube
  vec4 place;       // xy: the first view's corner in the atlas; zw: width and height of a side; all in texels
};

// One view; push constants.
struct ViewBlock {
  vec4 projection;  // clip.x = projection.x * x + projection.y * z; clip.y = projection.z * y + projection.w * z
  vec4 ambient;     // rgb: linear radiance from all around; w: near_m
  vec4 airlight;    // rgb: linear radiance of the air, seen at infinity; w: its extinction in 1/m
};

// Rows of a pass whose transparent surfaces are kept apart at one time; each of their samples has a list of layers.
struct LayerBand {
  uvec4 rows;  // x: layers so far; y: samples' texels in a row; z: the first row; w: samples of a texel
};

// A transparent surface at one sample.
struct LayerNode {
  vec4 color;   // linear radiance, alpha
  uvec4 place;  // x: bits of its depth near / z; y: the list's next layer, counted from 1, 0: none
};

// A node of a Bvh (see engine/bvh.h), read as whole rows; xyz are bits of floats.
struct TreeNode {
  uvec4 low_first;
  uvec4 high_count;
};

// A triangle in its mesh's unit frame.
struct RayTriangle {
  uvec4 a_primitive;  // xyz: bits of floats; w: its number in the mesh
  vec4 b;             // xyz
  vec4 c;             // xyz
};

// An item in the top tree's frame. A point at `apart` from its centre has unit coordinates scale * (row . apart); the
// rows together have the length sqrt(3). A ray's line in the unit frame is off by at most slack + slack_per_unit * D
// there, D the sensor's distance in units: see engine/gpu_ray_instance.h.
struct RayItem {
  vec4 row_x;        // w: scale, 1/m
  vec4 row_y;        // w: slack
  vec4 row_z;        // w: slack_per_unit
  vec4 centre_high;  // xyz: m, rounded; w: by what share a range is off
  vec4 centre_low;   // xyz: m, what rounding left
  uvec4 tree;        // x: root; y: first triangle; z: 1 if every point is solid; w: 1 if the host has to test it all
};

// Which triangles a ray may meet first. What is not among them lies at or beyond `complete_to_m`.
struct RayCandidates {
  uint count;
  float complete_to_m;
  uvec2 found[SIMVIS_MOST_CANDIDATES];  // item, as RayItem; primitive
};

// One cast; push constants.
struct RayCastBlock {
  vec4 sensor_high;  // xyz: m, in the top tree's frame, rounded
  vec4 sensor_low;   // xyz: m, what rounding left
  uvec4 rays;        // x: how many
};

#ifdef __cplusplus
}  // namespace simvis::shader
#endif

#endif  // SIMVIS_SHADERS_INTEROP_H_
