// The structs that C++ and GLSL share, and the numbers of bindings and constants.
//
// Rule: members fill rows of 16 bytes and no member is a bare vec3, so that std430, std140 and C++ agree on every
// offset. A test compares the offsets. Names contain the frame; the view frame is x right, y down, z forward.
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

// Descriptor set 0: the frame. Descriptor set 1: the textures of a material. Descriptor set 2: OIT layers.
#define SIMVIS_FRAME_SET 0
#define SIMVIS_MATERIALS 0
#define SIMVIS_LIGHTS 1
#define SIMVIS_MAP_PLACES 2
#define SIMVIS_TEXTURE_SET 1
#define SIMVIS_BASE_COLOR_TEXTURE 0
#define SIMVIS_FIRST_MAP 1  // the maps follow in the order of MapKind
#define SIMVIS_NORMAL_MAP 1
#define SIMVIS_METALLIC_ROUGHNESS_MAP 2
#define SIMVIS_OCCLUSION_MAP 3
#define SIMVIS_EMISSIVE_MAP 4
#define SIMVIS_TEXTURES 5
#define SIMVIS_LAYERS_SET 2
#define SIMVIS_LAYER_LISTS 0
#define SIMVIS_LAYER_NODES 1

// Descriptor set 3: shadow maps, in scenes with shadows.
#define SIMVIS_SHADOW_SET 3
#define SIMVIS_SHADOWS 0
#define SIMVIS_SHADOW_ATLAS 1
#define SIMVIS_MAX_SHADOWS 64  // per view

#define SIMVIS_MAX_LIGHTS 256       // per view
#define SIMVIS_UNROLLED_LIGHTS 16u  // of a kind: more are not unrolled, which bounds the time to compile a shader

// The rows of a LightBlock, as texels of the texel buffer SIMVIS_LIGHTS.
#define SIMVIS_LIGHT_POSITION 0u
#define SIMVIS_LIGHT_DIRECTION 1u
#define SIMVIS_LIGHT_INTENSITY 2u
#define SIMVIS_LIGHT_SHADOW 3u
#define SIMVIS_LIGHT_ROWS 4u

// Descriptor set 0 of ray_cast.comp.
#define SIMVIS_RAY_TOP_NODES 0
#define SIMVIS_RAY_ITEMS 1
#define SIMVIS_RAY_MESH_NODES 2
#define SIMVIS_RAY_TRIANGLES 3
#define SIMVIS_RAY_DIRECTIONS 4
#define SIMVIS_RAY_CANDIDATES 5
#define SIMVIS_RAY_BINDINGS 6

#define SIMVIS_RAY_GROUP 64  // rays per workgroup
#define SIMVIS_MAX_CANDIDATES 7
#define SIMVIS_TREE_DEPTH 32
#define SIMVIS_ITEM_OF_HOST 1u         // GpuRayInstance::tree.w: the host must test the item
#define SIMVIS_HIDDEN_ITEM 2u          // GpuRayInstance::tree.w: rays pass the item
#define SIMVIS_WHOLE_ITEM 0xffffffffu  // primitive of a candidate: the host must test all triangles of the item
#define SIMVIS_FAR_M 1e18              // limit of the range along the ray; hits beyond it are ignored
#define SIMVIS_MAX_SLACK 0.015625      // items with a larger position error, in radii, are tested by the host

// Rounding error of a vertex in clip space, relative to the sum of the magnitudes of its terms.
#define SIMVIS_VERTEX_ROUNDING 1e-6

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
#define SIMVIS_INSTANCE_ITEM 9
#define SIMVIS_INSTANCE_ERROR 10

// Output locations of vertex shaders in addition to the first locations of mesh_color.vert.
#define SIMVIS_SLACK 11
#define SIMVIS_ITEM 12

// Specialization constants.
#define SIMVIS_MASKED 0
#define SIMVIS_UNLIT 1
#define SIMVIS_DIRECTIONAL_LIGHTS 2  // the number of lights of each kind, see LightBlock
#define SIMVIS_FADED 3
#define SIMVIS_GLOSSY 4
#define SIMVIS_SHADOWED 5
#define SIMVIS_ORTHOGRAPHIC 6
#define SIMVIS_METALLIC 7
#define SIMVIS_MAPS 8  // bit mask of the textures that are present, bit number = binding
#define SIMVIS_FOG 9
#define SIMVIS_POINT_LIGHTS 10
#define SIMVIS_SPOT_LIGHTS 11
#define SIMVIS_RANGED 12              // a light has a range
#define SIMVIS_ALIKE_POINT_LIGHTS 13  // the lights of the kind differ only in their position and shadow
#define SIMVIS_ALIKE_SPOT_LIGHTS 14
#define SIMVIS_ITEMS 15   // alpha of colour holds the number of the instance
#define SIMVIS_POINTS 16  // the primitives are points

// Bits of the alpha that stands for instance 0; instance i has i more. They are those of normal numbers above 0, which
// every device stores as they are.
#define SIMVIS_INSTANCE_0 0x00800000u

#define SIMVIS_MIN_ROUGHNESS 0.05

// The resolve pass: bindings, specialization constants, and the pixels of a row in a workgroup.
#define SIMVIS_RESOLVE_SAMPLES 0
#define SIMVIS_RESOLVE_MEAN 1
#define SIMVIS_RESOLVE_SUPERSAMPLING 0
#define SIMVIS_RESOLVE_MSAA 1
#define SIMVIS_RESOLVE_GROUP 64

#ifdef __cplusplus
// One mesh in one view: rows of clip_from_mesh, computed in double and rounded once. They are vertex inputs with
// instance rate, because a CPU device fetches these once for all SIMD lanes, which it cannot do for a storage buffer.
// A mesh point p = (x, y, z, 1) has clip = (clip_x . p, clip_y . p, near_m, clip_w . p), so depth = near_m / z, where
// z = clip_w . p is the depth along Z in metres. In an orthographic view, clip is
// (clip_x . p, clip_y . p, clip_w . p, 1).
struct Instance {
  vec4 clip_x;
  vec4 clip_y;
  vec4 clip_w;
  uint material;  // slot in the table of materials
  float error_m;  // the drawn mesh lies at most so far from the surface that it stands for
};

// A vertex of a CPU-selected triangle, with the rows of its mesh. Triangles of many meshes thus share one draw.
struct CpuSelectedVertex {
  float x, y, z;  // in the mesh's frame
  vec4 clip_x;    // as in Instance
  vec4 clip_y;
  vec4 clip_w;
};
#endif

struct MaterialBlock {
  vec4 base_color;       // linear RGBA
  vec4 emissive_cutoff;  // rgb: linear radiance; a: the smallest alpha that a mask keeps
  vec4 uv_row_u;         // xyz: texture u = uv_row_u . (u, v, 1); w: set of texture coordinates, 0 or 1
  vec4 uv_row_v;         // xyz: texture v = uv_row_v . (u, v, 1); w: strength of the occlusion map
  vec4 finish;           // x: roughness; y: opacity of a faded surface; z: metallic share; w: scale of the normal map
};

// Texture transforms of the maps of a material, from SIMVIS_FIRST_MAP on; rows as in MaterialBlock.
struct MapPlacesBlock {
  vec4 row_u[SIMVIS_TEXTURES - 1];
  vec4 row_v[SIMVIS_TEXTURES - 1];
};

// A light in the view frame. The intensity of point and spot lights falls with the square of the distance. A view has
// its directional lights first, then its point lights, then its spot lights. A kind reads only the rows that it uses.
struct LightBlock {
  vec4 position;   // point, spot: xyz: metres; w: 1 / range in 1/m, 0 for no limit
  vec4 direction;  // directional, spot: xyz: direction in which the light travels, unit length
                   // spot: w: scale of the cosine to the axis
  vec4 intensity;  // rgb: lux (directional) or candela; spot: w: offset of the scaled cosine to the axis
  vec4 shadow;     // x: 1 + index of its ShadowBlock; 0 if the light casts no shadow
};

// The rows of a ShadowBlock, as texels of the texel buffer SIMVIS_SHADOWS.
#define SIMVIS_SHADOW_ROWS 6u

// The shadow map of a light: one view of the atlas, or the six views of a cube (see ShadowUse in simvis/frame_plan.h).
struct ShadowBlock {
  vec4 row_x;  // row of map_from_view: from the frame of the lit view to that of the map's first view, in metres
  vec4 row_y;
  vec4 row_z;
  vec4 projection;  // texel (u, v) of a side = xy * (x, y) / z + zw; orthographic: xy * (x, y) + zw
  vec4 depth;       // x: near_m, depth = near_m / z; orthographic: far_m, depth = (far_m - z) * y
                    // y: 1 / (far_m - near_m) if the view is orthographic, else 0
                    // z: distance between the origins of the two frames, metres; w: 1 for a cube
  vec4 place;       // xy: corner of the first view in the atlas; zw: width and height of a side; all in texels
};

// One view; push constants.
struct ViewBlock {
  vec4 projection;  // clip.x = projection.x * x + projection.y * z; clip.y = projection.z * y + projection.w * z
  vec4 ambient;     // rgb: linear radiance from all directions; w: near_m
  vec4 airlight;    // rgb: linear radiance of the air at infinite distance; w: extinction of the air in 1/m
  uvec4 lights;     // x, y: the first texels of its lights and of its shadow maps in their texel buffers
                 // z: bits of a float: size of points in the frame of their mesh times half the view's width in pixels
};

// What a view shows of the picture of the sky; push constants.
struct SkyBlock {
  vec4 row_x;  // xyz: the direction in the picture's frame is the rows times (x, y, 1) of clip coordinates
  vec4 row_y;
  vec4 row_z;
  vec4 brightness;  // x: factor of the radiance; y: alpha
};

// A band of rows of a pass whose OIT layers are stored at the same time. Each sample has a list of layers.
struct LayerBand {
  uvec4 rows;  // x: number of layers so far; y: texels per row; z: first row; w: samples per texel
};

// An OIT layer: one transparent surface at one sample.
struct LayerNode {
  vec4 color;   // linear radiance, alpha
  uvec4 place;  // x: bits of its depth near / z; y: next layer of the list, counted from 1; 0 at the end
};

// A node of a Bvh (see engine/geometry/bvh.h), read as whole rows; xyz are bits of floats.
struct TreeNode {
  uvec4 low_first;
  uvec4 high_count;
};

// A triangle in the unit frame of its mesh.
struct RayTriangle {
  uvec4 a_primitive;  // xyz: bits of floats; w: index of the triangle in the mesh
  vec4 b;             // xyz
  vec4 c;             // xyz
};

// An item in the frame of the top-level tree (TLAS). A point at `apart` from its centre has the unit coordinates
// scale * (row . apart); the rows together have the length sqrt(3). The line of a ray in the unit frame has an error of
// at most slack + slack_per_unit * D, where D is the distance of the sensor in units: see
// engine/raycast/gpu_ray_instance.h.
struct GpuRayInstance {
  vec4 row_x;        // w: scale, 1/m
  vec4 row_y;        // w: slack
  vec4 row_z;        // w: slack_per_unit
  vec4 centre_high;  // xyz: m, rounded; w: relative error of a range
  vec4 centre_low;   // xyz: m, the rest that rounding removed
  uvec4 tree;        // x: root; y: first triangle; z: 1 if every point is solid, plus 2 if cameras see no backs; w: 0,
                     // SIMVIS_ITEM_OF_HOST, or SIMVIS_HIDDEN_ITEM
};

// The triangles that a ray may hit first. All other triangles lie at a range of `complete_to_m` or more.
struct RayCandidates {
  uint count;
  float complete_to_m;
  uvec2 found[SIMVIS_MAX_CANDIDATES];  // x: index of the GpuRayInstance; y: primitive
};

// One cast; push constants.
struct RayCastBlock {
  vec4 sensor_high;  // xyz: m, in the frame of the top-level tree, rounded
  vec4 sensor_low;   // xyz: m, the rest that rounding removed
  uvec4 rays;        // x: number of rays; y: 1 if rays pass the backs that cameras do not see
};

#ifdef __cplusplus
}  // namespace simvis::shader
#endif

#endif  // SIMVIS_SHADERS_INTEROP_H_
