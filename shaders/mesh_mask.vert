// Depth of masked surfaces: outputs the values of the alpha test. With ITEM defined, the item too, with
// INSTANCE the number of the instance.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/mesh.glsl"

layout(location = SIMVIS_UV_0) in vec2 in_uv_0;
layout(location = SIMVIS_UV_1) in vec2 in_uv_1;
layout(location = SIMVIS_COLOR) in vec4 in_color;
layout(location = SIMVIS_INSTANCE_MATERIAL) in uint instance_material;

layout(location = 0) out vec2 out_uv;
layout(location = 1) out float out_alpha;
layout(location = 2) flat out float out_cutoff;
#ifdef INSTANCE
layout(location = SIMVIS_ITEM) flat out uint out_instance;
#endif

void main() {
  const MaterialBlock material = materials[instance_material];
  place_vertex();
  out_uv = texture_uv(material.uv_row_u, material.uv_row_v, in_uv_0, in_uv_1);
  out_alpha = material.base_color.a * in_color.a;
  out_cutoff = material.emissive_cutoff.a;
#ifdef ITEM
  out_item = instance_item;
#endif
#ifdef INSTANCE
  out_instance = uint(gl_InstanceIndex);
#endif
}
