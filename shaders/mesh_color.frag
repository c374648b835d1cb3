// Linear radiance of a surface in the lights of KHR_lights_punctual. TEXTURED is defined if the base colour texture is
// the only texture of the material, MAPPED if the material has other textures. SHADOWED is defined if the surface reads
// shadow maps. LAYER is defined for transparent surfaces: their colour is stored as an OIT layer and not drawn.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/interop.h"

layout(constant_id = SIMVIS_MASKED) const bool kMasked = false;
layout(constant_id = SIMVIS_UNLIT) const bool kUnlit = false;
layout(constant_id = SIMVIS_FADED) const bool kFaded = false;
layout(constant_id = SIMVIS_GLOSSY) const bool kGlossy = false;
layout(constant_id = SIMVIS_SHADOWED) const bool kShadowed = false;
layout(constant_id = SIMVIS_METALLIC) const bool kMetallic = false;
layout(constant_id = SIMVIS_MAPS) const uint kMaps = 0u;
layout(constant_id = SIMVIS_ITEMS) const bool kItems = false;

layout(std430, push_constant) uniform View { ViewBlock view; };
#if defined(TEXTURED) || defined(MAPPED)
layout(set = SIMVIS_TEXTURE_SET, binding = SIMVIS_BASE_COLOR_TEXTURE) uniform sampler2D base_color_texture;
#endif

layout(location = 0) in vec4 in_color;
layout(location = 1) flat in vec4 in_emissive_cutoff;
layout(location = 2) in vec2 in_uv;
layout(location = 3) in vec3 in_position;
layout(location = 4) in vec3 in_normal;
layout(location = 5) flat in vec3 in_finish;  // roughness, opacity, metallic share; written if kGlossy or kFaded
layout(location = SIMVIS_ITEM) flat in uint in_instance;  // written only if kItems
layout(location = SIMVIS_SLACK) in float in_slack;  // written only if kShadowed

#include "shaders/fog.glsl"
#ifdef LAYER
#include "shaders/layers.glsl"
layout(early_fragment_tests) in;  // hidden fragments are not stored
vec4 out_color;
#else
layout(location = 0) out vec4 out_color;
#endif

const float kInversePi = 0.3183098861837907;
const float kMinSquare = 1e-20;  // keeps divisions finite, in m^2

#include "shaders/surface.glsl"

#ifdef SHADOWED
#include "shaders/shadows.glsl"
#endif
#include "shaders/lights.glsl"

void shade() {
  const float slack = kShadowed ? in_slack : 0.0;  // every variant must read all outputs of the vertex shader
#ifdef SHADOWED
  const PlanePoint plane = plane_point();  // before any discard: derivatives need the neighbours
#endif
  vec4 base = in_color;
  float mask = base.a;
#if defined(TEXTURED) || defined(MAPPED)
  if (kTextured) {
    base *= texture(base_color_texture, in_uv);
    if (kMasked) mask *= textureLod(base_color_texture, in_uv, 0).a;  // as in mesh_mask.frag, as depth does
  }
#endif
  const Surface surface = surface_here();
  if (kMasked && mask < in_emissive_cutoff.a) discard;
  if (kFaded) base.a = in_finish.y;
  if (kUnlit) {
    out_color = base;
    return;
  }
  vec3 arriving = view.ambient.rgb, highlight = vec3(0.0);
  if (has_map(SIMVIS_OCCLUSION_MAP)) arriving *= surface.occlusion;
  if (kLit) {
    Reflector reflector = reflector_at(surface, base.rgb);
#ifdef SHADOWED
    reflector.plane = plane;
    reflector.slack = slack;
#endif
    const Reflected reflected = reflect_lights(reflector);
    arriving += kMetallic ? reflected.diffuse * (1.0 - surface.metallic) : reflected.diffuse;
    highlight = reflected.highlight;
  }
  out_color = vec4(base.rgb * arriving + surface.emission, base.a);
  if (kGlossy) out_color.rgb += highlight;
}

void main() {
  const uint instance = kItems ? in_instance : 0u;  // every variant must read all outputs of the vertex shader
  shade();
  if (kFog) out_color.rgb = in_fog(out_color.rgb, length(in_position));
#ifdef LAYER
  add_layer(out_color);
#else
  if (kItems) out_color.a = uintBitsToFloat(SIMVIS_INSTANCE_0 + instance);
#endif
}
