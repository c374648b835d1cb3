// Linear radiance of a surface in the lights of KHR_lights_punctual: Lambert, and where it is glossy a highlight of each
// light over it. TEXTURED is defined where the material has a texture, LAYER where the surface is transparent: its colour
// is then not drawn but kept.
#extension GL_GOOGLE_include_directive : require
#include "shaders/interop.h"

layout(constant_id = SIMVIS_MASKED) const bool kMasked = false;
layout(constant_id = SIMVIS_UNLIT) const bool kUnlit = false;
layout(constant_id = SIMVIS_LIGHT_COUNT) const uint kLightCount = 0u;
layout(constant_id = SIMVIS_FADED) const bool kFaded = false;
layout(constant_id = SIMVIS_GLOSSY) const bool kGlossy = false;

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
layout(location = 5) flat in vec2 in_finish;  // roughness, opacity; written only where kGlossy or kFaded

#include "shaders/fog.glsl"
#ifdef LAYER
#include "shaders/layers.glsl"
layout(early_fragment_tests) in;  // what is hidden is not kept
vec4 out_color;
#else
layout(location = 0) out vec4 out_color;
#endif

const float kInversePi = 0.3183098861837907;
const float kLeastSquare = 1e-20;  // keeps divisions finite, in m^2
const float kNormalReflectance = 0.04;  // of a dielectric with the refractive index 1.5

struct Incident {
  vec3 toward;  // unit vector to the light
  float share;  // of its intensity that arrives on a surface square to it, in 1/m^2 where the light has a place
};

// Source: KHR_lights_punctual, "Range Property" and "Inner and Outer Cone Angles".
Incident incident(LightBlock light) {
  if (light.position.w == 0.0) return Incident(-light.direction.xyz, 1.0);
  const vec3 to_light = light.position.xyz - in_position;
  const float square = max(dot(to_light, to_light), kLeastSquare);
  const vec3 toward = to_light * inversesqrt(square);
  const float relative = square * light.direction.w * light.direction.w;  // (distance / range)^2
  const float window = clamp(1.0 - relative * relative, 0.0, 1.0);
  const float cone = clamp(-dot(toward, light.direction.xyz) * light.cone.x + light.cone.y, 0.0, 1.0);
  return Incident(toward, window * cone * cone / square);
}

// Fresnel reflectance after Schlick (x), and that times the density of microfacets after Trowbridge and Reitz (GGX) and
// their visibility after Smith, correlated in height: reflected radiance per irradiance (y).
// Sources: glTF 2.0, appendix B; Heitz, Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs (2014).
vec2 reflectance(vec3 normal, vec3 toward, vec3 to_eye) {
  const vec3 sum = toward + to_eye;
  const vec3 half_way = sum * inversesqrt(max(dot(sum, sum), kLeastSquare));
  const float alpha = in_finish.x * in_finish.x, square = alpha * alpha;
  const float to_light = max(dot(normal, toward), 0.0), eye = max(dot(normal, to_eye), 0.0);
  // Lagrange's identity gives 1 - cos^2 without cancellation.
  const vec3 across = cross(normal, half_way);
  const float along = max(dot(normal, half_way), 0.0) * alpha;
  const float density = alpha / max(dot(across, across) + along * along, kLeastSquare);
  const float masking = to_light * sqrt(eye * eye * (1.0 - square) + square) +
                        eye * sqrt(to_light * to_light * (1.0 - square) + square);
  const float grazing = 1.0 - clamp(dot(to_eye, half_way), 0.0, 1.0), twice = grazing * grazing;
  const float fresnel = kNormalReflectance + (1.0 - kNormalReflectance) * twice * twice * grazing;
  return vec2(fresnel, fresnel * kInversePi * density * density * 0.5 / max(masking, kLeastSquare));
}

void shade() {
  vec4 base = in_color;
  float mask = base.a;
#ifdef TEXTURED
  base *= texture(base_color_texture, in_uv);
  if (kMasked) mask *= textureLod(base_color_texture, in_uv, 0).a;  // as in mask.glsl: colour shows what depth measures
#endif
  if (kMasked && mask < in_emissive_cutoff.a) discard;
  if (kFaded) base.a = in_finish.y;
  if (kUnlit) {
    out_color = base;
    return;
  }
  vec3 arriving = view.ambient.rgb, highlight = vec3(0.0);
  if (kLightCount > 0u) {
    const vec3 outward = in_normal * inversesqrt(max(dot(in_normal, in_normal), kLeastSquare));
    const vec3 normal = gl_FrontFacing ? outward : -outward;
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < kLightCount; ++i) {
      const Incident light = incident(lights[i]);
      const vec3 lux = lights[i].intensity.rgb * (light.share * max(0.0, dot(normal, light.toward)));
      if (kGlossy) {
        const vec2 reflected = reflectance(normal, light.toward, -normalize(in_position));
        sum += lux * (1.0 - reflected.x);
        highlight += lux * reflected.y;
      } else {
        sum += lux;
      }
    }
    arriving += kInversePi * sum;
  }
  out_color = vec4(base.rgb * arriving + in_emissive_cutoff.rgb, base.a);
  if (kGlossy) out_color.rgb += highlight;
}

void main() {
  shade();
  if (kFog) out_color.rgb = in_fog(out_color.rgb, length(in_position));
#ifdef LAYER
  add_layer(out_color);
#endif
}
