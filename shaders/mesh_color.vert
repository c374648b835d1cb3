// Vertex outputs for lit colour, in the view frame. MAPPED is defined if the material has textures in addition to the
// base colour texture.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/mesh.glsl"

layout(constant_id = SIMVIS_UNLIT) const bool kUnlit = false;
layout(constant_id = SIMVIS_FADED) const bool kFaded = false;
layout(constant_id = SIMVIS_GLOSSY) const bool kGlossy = false;
layout(constant_id = SIMVIS_SHADOWED) const bool kShadowed = false;
layout(constant_id = SIMVIS_ITEMS) const bool kItems = false;

#ifdef MAPPED
layout(std430, set = SIMVIS_FRAME_SET, binding = SIMVIS_MAP_PLACES) readonly buffer MapPlaces {
  MapPlacesBlock map_places[];
};

layout(location = 6) flat out vec2 out_strengths;  // scale of the normal map, strength of the occlusion map
layout(location = 7) out vec2 out_map_uv[SIMVIS_TEXTURES - 1];
#endif

layout(location = SIMVIS_NORMAL) in vec4 in_normal;
layout(location = SIMVIS_UV_0) in vec2 in_uv_0;
layout(location = SIMVIS_UV_1) in vec2 in_uv_1;
layout(location = SIMVIS_COLOR) in vec4 in_color;
layout(location = SIMVIS_INSTANCE_MATERIAL) in uint instance_material;
layout(location = SIMVIS_INSTANCE_ERROR) in float instance_error_m;

layout(location = 0) out vec4 out_color;
layout(location = 1) flat out vec4 out_emissive_cutoff;
layout(location = 2) out vec2 out_uv;
layout(location = 3) out vec3 out_position;
layout(location = 4) out vec3 out_normal;  // written only if the surface is lit
layout(location = 5) flat out vec3 out_finish;  // roughness, opacity, metallic share; written only if it is read
layout(location = SIMVIS_ITEM) flat out uint out_instance;  // written only if kItems
layout(location = SIMVIS_SLACK) out float out_slack;  // bound on the error of the position, m

// The direction of inverse(transpose(M)) * n for the matrix M with rows x, y, z. It uses the cofactors of M with the
// sign of the determinant, so that normals are correct under mirrored and non-uniform scale.
vec3 transform_normal(vec3 x, vec3 y, vec3 z, vec3 n) {
  const vec3 turned = vec3(dot(cross(y, z), n), dot(cross(z, x), n), dot(cross(x, y), n));
  const float largest = max(max(abs(turned.x), abs(turned.y)), abs(turned.z));
  if (largest == 0.0) return vec3(0.0);
  return normalize(turned / largest) * (dot(x, cross(y, z)) < 0.0 ? -1.0 : 1.0);
}

void main() {
  const MaterialBlock material = materials[instance_material];
  const vec4 clip = place_vertex();
  out_color = material.base_color * in_color;
  out_emissive_cutoff = material.emissive_cutoff;
  if (kFaded || kGlossy) out_finish = material.finish.xyz;
  if (kItems) out_instance = uint(gl_InstanceIndex);
#ifdef MAPPED
  out_strengths = vec2(material.finish.w, material.uv_row_v.w);
  for (int i = 0; i < SIMVIS_TEXTURES - 1; ++i) {
    out_map_uv[i] =
        texture_uv(map_places[instance_material].row_u[i], map_places[instance_material].row_v[i], in_uv_0, in_uv_1);
  }
#endif
  out_uv = texture_uv(material.uv_row_u, material.uv_row_v, in_uv_0, in_uv_1);
  out_position = vec3((clip.xy - view.projection.yw * clip.w) / view.projection.xz, clip.w);
  if (kShadowed) {
    const vec4 p = abs(vec4(in_position, 1.0));
    const float terms = dot(abs(instance_clip_x), p) / abs(view.projection.x) +
                        dot(abs(instance_clip_y), p) / abs(view.projection.z) + dot(abs(instance_clip_w), p);
    // Vertices are rounded in both views, and so are the point on the ray of its pixel and that in the frame of the map.
    out_slack = 4.0 * SIMVIS_VERTEX_ROUNDING * terms + instance_error_m;
  }
  if (kUnlit) return;
  const vec3 row_z = instance_clip_w.xyz;
  const vec3 row_x = (instance_clip_x.xyz - view.projection.y * row_z) / view.projection.x;
  const vec3 row_y = (instance_clip_y.xyz - view.projection.w * row_z) / view.projection.z;
  out_normal = transform_normal(row_x, row_y, row_z, in_normal.xyz);
  if (kPoints && dot(out_normal, out_position) > 0.0) out_normal = -out_normal;  // both sides of a point are seen
}
