// The common part of the vertex shaders of meshes. ITEM is defined if the pass has items.
#extension GL_GOOGLE_include_directive : require
#include "shaders/interop.h"

layout(std430, push_constant) uniform View { ViewBlock view; };
layout(std430, set = SIMVIS_FRAME_SET, binding = SIMVIS_MATERIALS) readonly buffer Materials {
  MaterialBlock materials[];
};

layout(constant_id = SIMVIS_ORTHOGRAPHIC) const bool kOrthographic = false;
layout(constant_id = SIMVIS_POINTS) const bool kPoints = false;

layout(location = SIMVIS_POSITION) in vec3 in_position;
layout(location = SIMVIS_INSTANCE_CLIP_X) in vec4 instance_clip_x;
layout(location = SIMVIS_INSTANCE_CLIP_Y) in vec4 instance_clip_y;
layout(location = SIMVIS_INSTANCE_CLIP_W) in vec4 instance_clip_w;
#ifdef ITEM
layout(location = SIMVIS_INSTANCE_ITEM) in uint instance_item;

layout(location = SIMVIS_ITEM) flat out uint out_item;
#endif

out gl_PerVertex {
  invariant vec4 gl_Position;
  float gl_PointSize;
};

// The side in pixels of the square of a point whose size in the mesh's frame is in ViewBlock; 1 for points without one.
float point_size_px(float depth) {
  const vec3 row_x = instance_clip_x.xyz - (kOrthographic ? 0.0 : view.projection.y) * instance_clip_w.xyz;
  return max(uintBitsToFloat(view.lights.z) * length(row_x) / (kOrthographic ? 1.0 : depth), 1.0);
}

// Gives bit-identical results in every shader, so that all passes over a surface have the same depth.
vec4 place_vertex() {
  const vec4 p = vec4(in_position, 1.0);
  const float depth = dot(instance_clip_w, p);
  gl_Position = vec4(dot(instance_clip_x, p), dot(instance_clip_y, p), kOrthographic ? depth : view.ambient.w,
                     kOrthographic ? 1.0 : depth);
  gl_PointSize = kPoints ? point_size_px(depth) : 1.0;
  return gl_Position;
}

vec2 texture_uv(vec4 row_u, vec4 row_v, vec2 uv_0, vec2 uv_1) {
  const vec3 uv = vec3(row_u.w > 0.5 ? uv_1 : uv_0, 1.0);
  return vec2(dot(row_u.xyz, uv), dot(row_v.xyz, uv));
}
