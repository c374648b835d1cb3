// The light that a surface reflects to the eye. Included by mesh_color.frag.
//
// Fresnel's share by Schlick, the Trowbridge-Reitz (GGX) microfacet distribution, and Smith's height-correlated
// visibility term.
// Sources: glTF 2.0, appendix B; Heitz, Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs (2014).

layout(constant_id = SIMVIS_DIRECTIONAL_LIGHTS) const uint kDirectionalLights = 0u;
layout(constant_id = SIMVIS_POINT_LIGHTS) const uint kPointLights = 0u;
layout(constant_id = SIMVIS_SPOT_LIGHTS) const uint kSpotLights = 0u;
layout(constant_id = SIMVIS_RANGED) const bool kRanged = false;
layout(constant_id = SIMVIS_ALIKE_POINT_LIGHTS) const bool kAlikePointLights = false;
layout(constant_id = SIMVIS_ALIKE_SPOT_LIGHTS) const bool kAlikeSpotLights = false;
const bool kLit = kDirectionalLights + kPointLights + kSpotLights > 0u;

// A texel buffer and no uniform block: lavapipe reads a block in fragment shaders number by number and lane by lane,
// even at constant places, and a texel as one vector per lane.
layout(set = SIMVIS_FRAME_SET, binding = SIMVIS_LIGHTS) uniform samplerBuffer lights;

const float kDielectric = 0.04;  // reflectance at normal incidence for the refractive index 1.5
// The smallest divisors of a highlight, which keep it finite. With alpha at least SIMVIS_MIN_ROUGHNESS^2 = 0.0025, a
// divisor is below them only if the directions to the light and to the eye are opposite within 1e-7 / alpha = 4e-5 rad,
// or if both lie in the plane of the surface within 1e-9 / alpha = 4e-7 rad.
const float kMinSpread = 1e-14, kMinMasking = 1e-9;

// The properties of a point that are the same for all lights.
struct Reflector {
  vec3 normal;          // on the side of the eye, unit length
  vec3 to_eye;          // unit vector
  float normal_dot_eye;
  float eye_cosine;     // to the eye, at least 0
  float alpha_square;   // roughness to the fourth power
  float density_scale;  // alpha_square / (2 pi)
  float eye_masking;    // Smith's term of the eye
  vec3 normal_reflectance;
#ifdef SHADOWED
  PlanePoint plane;     // of the triangle
#endif
  float slack;          // bound on the error of the position, m; used only for shadows
};

struct Reflected {
  vec3 diffuse;    // radiance of a white surface
  vec3 highlight;  // radiance
};

// The light of a lamp of intensity 1 at a surface. A dielectric has its whole highlight in `facing`.
struct Response {
  float entering;  // irradiance, without the share that Fresnel's reflection adds at grazing incidence
  float facing;    // radiance of the highlight of a surface that reflects everything
  float grazing;   // `facing` times Schlick's power
};

// Sums over lights; members as in Response.
struct LightSums {
  vec3 entering, facing, grazing;
};

Reflector reflector_at(Surface surface, vec3 base) {
  Reflector r;
  r.normal = gl_FrontFacing ? surface.normal : -surface.normal;
  if (!kGlossy) return r;
  r.to_eye = -in_position * inversesqrt(dot(in_position, in_position));
  r.normal_dot_eye = dot(r.normal, r.to_eye);
  r.eye_cosine = max(r.normal_dot_eye, 0.0);
  const float alpha = surface.roughness * surface.roughness;
  r.alpha_square = alpha * alpha;
  r.density_scale = 0.5 * kInversePi * r.alpha_square;
  r.eye_masking = sqrt(r.eye_cosine * r.eye_cosine * (1.0 - r.alpha_square) + r.alpha_square);
  r.normal_reflectance = kMetallic ? mix(vec3(kDielectric), base, surface.metallic) : vec3(kDielectric);
  return r;
}

struct Incident {
  vec3 toward;  // unit vector to the light
  float share;  // irradiance of a surface facing the light, in units of the light's intensity
  uint shadow;  // 1 + index of the light's ShadowBlock; 0 if the light casts no shadow
};

// No branch here or below depends only on uniforms at constant offsets: lavapipe would treat these as constants and
// recompile the shader whenever uniforms are bound, which takes a millisecond per view.
vec4 light_row(uint light, uint row) {
  return texelFetch(lights, int(view.lights.x + light * SIMVIS_LIGHT_ROWS + row));
}

uint shadow_of(uint light) { return kShadowed ? uint(light_row(light, SIMVIS_LIGHT_SHADOW).x) : 0u; }

Incident directional_light(uint light) {
  return Incident(-light_row(light, SIMVIS_LIGHT_DIRECTION).xyz, 1.0, shadow_of(light));
}

// `alike`: the light itself, or the first of its kind if all of them have the same direction, cone and intensity.
// Source: KHR_lights_punctual, "Range Property" and "Inner and Outer Cone Angles".
Incident placed_light(uint light, uint alike, bool spot) {
  const vec4 position = light_row(light, SIMVIS_LIGHT_POSITION);
  const vec3 to_light = position.xyz - in_position;
  const float distance_square = max(dot(to_light, to_light), kMinSquare), per_metre = inversesqrt(distance_square);
  const vec3 toward = to_light * per_metre;
  float share = per_metre * per_metre;
  if (spot) {
    const vec4 direction = light_row(alike, SIMVIS_LIGHT_DIRECTION);
    const float offset = light_row(alike, SIMVIS_LIGHT_INTENSITY).w;
    const float cone = clamp(offset - dot(toward, direction.xyz) * direction.w, 0.0, 1.0) * per_metre;
    share = cone * cone;
  }
  if (kRanged) {
    const float relative = distance_square * position.w * position.w;  // (distance / range)^2
    share *= clamp(1.0 - relative * relative, 0.0, 1.0);
  }
  return Incident(toward, share, shadow_of(light));
}

Response respond(Incident from, Reflector r) {
  const float normal_dot_light = dot(r.normal, from.toward), cosine = max(0.0, normal_dot_light);
  float arriving = cosine * from.share;
#ifdef SHADOWED
  // Surfaces that face away from the light need no shadow test.
  if (min(float(from.shadow), cosine) > 0.0) {
    arriving *= free_share(shadow_map(from.shadow - 1u), r.plane, r.slack);
  }
#endif
  if (!kGlossy) return Response(arriving, 0.0, 0.0);
  // The half vector keeps its length: that cancels in the density of the microfacets.
  const vec3 half_way = from.toward + r.to_eye;
  const float length_square = dot(half_way, half_way), along = normal_dot_light + r.normal_dot_eye;
  // Lagrange's identity gives 1 - cos^2 without cancellation: it is the square of `across`.
  const vec3 across = cross(r.normal, half_way);
  const float facing = max(along, 0.0);
  const float spread = max(dot(across, across) + facing * facing * r.alpha_square, kMinSpread);
  const float light_masking = sqrt(cosine * cosine * (1.0 - r.alpha_square) + r.alpha_square);
  const float masking = cosine * r.eye_masking + r.eye_cosine * light_masking;
  const float highlight =
      arriving * (r.density_scale * length_square * length_square / (spread * spread * max(masking, kMinMasking)));
  // The cosine of the half vector to the eye is half its length.
  const float tilted = 1.0 - min(0.5 * sqrt(length_square), 1.0), tilted_square = tilted * tilted;
  const float power = tilted_square * tilted_square * tilted, entering = arriving - arriving * power;
  if (kMetallic) return Response(entering, highlight, highlight * power);
  return Response(entering, highlight * (kDielectric + (1.0 - kDielectric) * power), 0.0);
}

// `light`: one of those that have caused the response.
void add_response(Response response, uint light, inout LightSums sums) {
  const vec3 intensity = light_row(light, SIMVIS_LIGHT_INTENSITY).rgb;
  sums.entering += intensity * response.entering;
  if (kGlossy) sums.facing += intensity * response.facing;
  if (kMetallic) sums.grazing += intensity * response.grazing;
}

// Adds the lights of a kind. The responses of alike lights are summed first and multiplied by the intensity once. An
// unrolled loop reads constant places of the lights, and its masks and sums need no blending on a CPU device.
#define ADD_LIGHT(first, alike, incident)                                           \
  const uint light = first + i, alike_light = alike ? first : light;                \
  const Response of_light = respond(incident, r);                                   \
  if (alike) {                                                                      \
    all.entering += of_light.entering;                                              \
    all.facing += of_light.facing;                                                  \
    all.grazing += of_light.grazing;                                                \
  } else {                                                                          \
    add_response(of_light, light, sums);                                            \
  }
#define ADD_LIGHTS(first, count, alike, incident)                                   \
  {                                                                                 \
    Response all = Response(0.0, 0.0, 0.0);                                         \
    if (count <= SIMVIS_UNROLLED_LIGHTS) {                                          \
      [[unroll]] for (uint i = 0u; i < count; ++i) {                                \
        ADD_LIGHT(first, alike, incident)                                           \
      }                                                                             \
    } else {                                                                        \
      [[dont_unroll]] for (uint i = 0u; i < count; ++i) {                           \
        ADD_LIGHT(first, alike, incident)                                           \
      }                                                                             \
    }                                                                               \
    if (alike && count > 0u) add_response(all, first, sums);                        \
  }

Reflected reflect_lights(Reflector r) {
  LightSums sums = LightSums(vec3(0.0), vec3(0.0), vec3(0.0));
  ADD_LIGHTS(0u, kDirectionalLights, false, directional_light(light))
  ADD_LIGHTS(kDirectionalLights, kPointLights, kAlikePointLights, placed_light(light, alike_light, false))
  ADD_LIGHTS(kDirectionalLights + kPointLights, kSpotLights, kAlikeSpotLights, placed_light(light, alike_light, true))
  if (!kGlossy) return Reflected(kInversePi * sums.entering, vec3(0.0));
  const vec3 entering = (kInversePi * (1.0 - r.normal_reflectance)) * sums.entering;
  if (!kMetallic) return Reflected(entering, sums.facing);
  return Reflected(entering, r.normal_reflectance * sums.facing + (1.0 - r.normal_reflectance) * sums.grazing);
}
