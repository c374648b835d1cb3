// Linear radiance of a surface: Lambert, with the lights of KHR_lights_punctual. TEXTURED is defined where the
// material has a texture.
#extension GL_GOOGLE_include_directive : require
#include "shaders/interop.h"

layout(constant_id = SIMVIS_MASKED) const bool kMasked = false;
layout(constant_id = SIMVIS_UNLIT) const bool kUnlit = false;
layout(constant_id = SIMVIS_LIGHT_COUNT) const uint kLightCount = 0u;

layout(std430, push_constant) uniform View { ViewBlock view; };
// Uniform and counted by a constant: so the loop unrolls and its loads are the same for all pixels, which a CPU device
// makes scalar.
layout(std140, set = SIMVIS_FRAME_SET, binding = SIMVIS_LIGHTS) uniform Lights { LightBlock lights[SIMVIS_MAX_LIGHTS]; };
#ifdef TEXTURED
layout(set = SIMVIS_TEXTURE_SET, binding = SIMVIS_BASE_COLOR_TEXTURE) uniform sampler2D base_color_texture;
#endif

layout(location = 0) in vec4 in_color;
layout(location = 1) flat in vec4 in_emissive_cutoff;
layout(location = 2) in vec2 in_uv;
layout(location = 3) in vec3 in_position;
layout(location = 4) in vec3 in_normal;

layout(location = 0) out vec4 out_color;

const float kInversePi = 0.3183098861837907;
const float kLeastSquare = 1e-20;  // keeps divisions finite, in m^2

// Irradiance from one light on the surface, in lux.
// Source: KHR_lights_punctual, "Range Property" and "Inner and Outer Cone Angles".
vec3 irradiance(LightBlock light, vec3 normal) {
  if (light.position.w == 0.0) return light.intensity.rgb * max(0.0, -dot(normal, light.direction.xyz));
  const vec3 to_light = light.position.xyz - in_position;
  const float square = max(dot(to_light, to_light), kLeastSquare);
  const vec3 toward = to_light * inversesqrt(square);
  const float relative = square * light.direction.w * light.direction.w;  // (distance / range)^2
  const float window = clamp(1.0 - relative * relative, 0.0, 1.0);
  const float cone = clamp(-dot(toward, light.direction.xyz) * light.cone.x + light.cone.y, 0.0, 1.0);
  return light.intensity.rgb * (window * cone * cone / square * max(0.0, dot(normal, toward)));
}

void main() {
  vec4 base = in_color;
#ifdef TEXTURED
  base *= texture(base_color_texture, in_uv);
#endif
  if (kMasked && base.a < in_emissive_cutoff.a) discard;
  if (kUnlit) {
    out_color = base;
    return;
  }
  vec3 arriving = view.ambient.rgb;
  if (kLightCount > 0u) {
    const vec3 outward = in_normal * inversesqrt(max(dot(in_normal, in_normal), kLeastSquare));
    const vec3 normal = gl_FrontFacing ? outward : -outward;
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < kLightCount; ++i) sum += irradiance(lights[i], normal);
    arriving += kInversePi * sum;
  }
  out_color = vec4(base.rgb * arriving + in_emissive_cutoff.rgb, base.a);
}
