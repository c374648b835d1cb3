// Linear radiance of a surface in the lights of KHR_lights_punctual. TEXTURED is defined if the base colour texture is
// the only texture of the material, MAPPED if the material has other textures. SHADOWED is defined if the surface reads
// shadow maps. LAYER is defined for transparent surfaces: their colour is stored as an OIT layer and not drawn.
#extension GL_GOOGLE_include_directive : require
#include "shaders/interop.h"

layout(constant_id = SIMVIS_MASKED) const bool kMasked = false;
layout(constant_id = SIMVIS_UNLIT) const bool kUnlit = false;
layout(constant_id = SIMVIS_LIGHT_COUNT) const uint kLightCount = 0u;
layout(constant_id = SIMVIS_FADED) const bool kFaded = false;
layout(constant_id = SIMVIS_GLOSSY) const bool kGlossy = false;
layout(constant_id = SIMVIS_SHADOWED) const bool kShadowed = false;
layout(constant_id = SIMVIS_METALLIC) const bool kMetallic = false;
layout(constant_id = SIMVIS_MAPS) const uint kMaps = 0u;

layout(std430, push_constant) uniform View { ViewBlock view; };
// A uniform block with a constant light count: the loop unrolls and its loads are the same for all pixels, so a CPU
// device uses scalar loads.
layout(std140, set = SIMVIS_FRAME_SET, binding = SIMVIS_LIGHTS) uniform Lights { LightBlock lights[SIMVIS_MAX_LIGHTS]; };
#if defined(TEXTURED) || defined(MAPPED)
layout(set = SIMVIS_TEXTURE_SET, binding = SIMVIS_BASE_COLOR_TEXTURE) uniform sampler2D base_color_texture;
#endif

layout(location = 0) in vec4 in_color;
layout(location = 1) flat in vec4 in_emissive_cutoff;
layout(location = 2) in vec2 in_uv;
layout(location = 3) in vec3 in_position;
layout(location = 4) in vec3 in_normal;
layout(location = 5) flat in vec3 in_finish;  // roughness, opacity, metallic share; written if kGlossy or kFaded
layout(location = SIMVIS_REACH) in float in_reach;  // written only if kShadowed

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

struct Incident {
  vec3 toward;  // unit vector to the light
  float share;  // irradiance of a surface facing the light per intensity; in 1/m^2 for point and spot lights
};

// Source: KHR_lights_punctual, "Range Property" and "Inner and Outer Cone Angles".
//
// No branch here or below depends only on uniforms at constant offsets: lavapipe would treat these as constants and
// recompile the shader whenever uniforms are bound, which takes a millisecond per view.
Incident incident(LightBlock light) {
  const bool directional = light.position.w == 0.0;
  const vec3 to_light = light.position.xyz - in_position;
  const float square = max(dot(to_light, to_light), kMinSquare);
  const vec3 toward = to_light * inversesqrt(square);
  const float relative = square * light.direction.w * light.direction.w;  // (distance / range)^2
  const float window = clamp(1.0 - relative * relative, 0.0, 1.0);
  const float cone = clamp(-dot(toward, light.direction.xyz) * light.cone.x + light.cone.y, 0.0, 1.0);
  return Incident(mix(toward, -light.direction.xyz, bvec3(directional)),
                  mix(window * cone * cone / square, 1.0, directional));
}

void shade() {
  const float reach = kShadowed ? in_reach : 0.0;  // every variant must read all outputs of the vertex shader
#ifdef SHADOWED
  const vec3 plane_normal = normal_of_plane();  // before any discard: derivatives need the neighbours
#endif
  vec4 base = in_color;
  float mask = base.a;
#if defined(TEXTURED) || defined(MAPPED)
  if (kTextured) {
    base *= texture(base_color_texture, in_uv);
    if (kMasked) mask *= textureLod(base_color_texture, in_uv, 0).a;  // as in mask.glsl, as depth does
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
  if (kLightCount > 0u) {
    const vec3 normal = gl_FrontFacing ? surface.normal : -surface.normal;
    const vec3 normal_reflectance =
        kMetallic ? mix(vec3(kDielectric), base.rgb, surface.metallic) : vec3(kDielectric);
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < kLightCount; ++i) {
      Incident light = incident(lights[i]);
      const float cosine = max(0.0, dot(normal, light.toward));
#ifdef SHADOWED
      // Surfaces that face away from the light need no shadow test.
      if (min(lights[i].cone.z, cosine) > 0.0) {
        light.share *= free_share(shadows[uint(lights[i].cone.z) - 1u], plane_normal, reach);
      }
#endif
      const vec3 lux = lights[i].intensity.rgb * (light.share * cosine);
      if (kGlossy) {
        const Reflected reflected =
            reflect_light(normal_reflectance, surface.roughness, normal, light.toward, -normalize(in_position));
        sum += lux * (1.0 - reflected.fresnel);
        highlight += lux * reflected.highlight;
      } else {
        sum += lux;
      }
    }
    if (kMetallic) sum *= 1.0 - surface.metallic;
    arriving += kInversePi * sum;
  }
  out_color = vec4(base.rgb * arriving + surface.emission, base.a);
  if (kGlossy) out_color.rgb += highlight;
}

void main() {
  shade();
  if (kFog) out_color.rgb = in_fog(out_color.rgb, length(in_position));
#ifdef LAYER
  add_layer(out_color);
#endif
}
