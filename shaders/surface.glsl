// Surface properties at a fragment. Included by mesh_color.frag.

#ifdef MAPPED
layout(set = SIMVIS_TEXTURE_SET, binding = SIMVIS_NORMAL_MAP) uniform sampler2D normal_map;
layout(set = SIMVIS_TEXTURE_SET, binding = SIMVIS_METALLIC_ROUGHNESS_MAP) uniform sampler2D metallic_roughness_map;
layout(set = SIMVIS_TEXTURE_SET, binding = SIMVIS_OCCLUSION_MAP) uniform sampler2D occlusion_map;
layout(set = SIMVIS_TEXTURE_SET, binding = SIMVIS_EMISSIVE_MAP) uniform sampler2D emissive_map;

layout(location = 6) flat in vec2 in_strengths;  // scale of the normal map, strength of the occlusion map
layout(location = 7) in vec2 in_map_uv[SIMVIS_TEXTURES - 1];
#define MAP(binding_name, sampler_name) texture(sampler_name, in_map_uv[binding_name - SIMVIS_FIRST_MAP])
#endif

bool has_map(uint binding) { return (kMaps & 1u << binding) != 0u; }
#ifdef MAPPED
const bool kTextured = (kMaps & 1u << SIMVIS_BASE_COLOR_TEXTURE) != 0u;
#else
const bool kTextured = true;  // used only if TEXTURED is defined
#endif

struct Surface {
  vec3 normal;  // outwards, unit length, view frame
  float roughness, metallic;
  float occlusion;  // share of the ambient light that reaches the surface
  vec3 emission;
};

#ifdef MAPPED
// The normal of a normal map. `bend` has components from -1 to 1 along the direction of increasing u, the direction of
// decreasing v, and outwards. The directions come from the screen-space derivatives of position and texture
// coordinates. On a flat triangle they equal those of its corners, also with mirrored coordinates, so vertices need no
// tangents.
vec3 bent_normal(vec3 outward, vec3 bend) {
  const vec2 uv = in_map_uv[SIMVIS_NORMAL_MAP - SIMVIS_FIRST_MAP];
  const vec3 p_x = dFdx(in_position), p_y = dFdy(in_position);
  const vec2 uv_x = dFdx(uv), uv_y = dFdy(uv);
  const float area = uv_x.x * uv_y.y - uv_y.x * uv_x.y;
  const float turn = sign(area);
  const vec3 along_u = (p_x * uv_y.y - p_y * uv_x.y) * turn;
  const vec3 against_v = (p_x * uv_y.x - p_y * uv_x.x) * turn;
  const vec3 in_plane = along_u - outward * dot(outward, along_u);
  const float square = dot(in_plane, in_plane);
  if (square == 0.0) return outward;  // the texture coordinates are degenerate here
  const vec3 tangent = in_plane * inversesqrt(square);
  const vec3 across = cross(outward, tangent);
  const vec3 bitangent = dot(across, against_v) < 0.0 ? -across : across;
  return normalize(tangent * bend.x + bitangent * bend.y + outward * bend.z);
}
#endif

Surface surface_here() {
  Surface s;
  s.normal = in_normal * inversesqrt(max(dot(in_normal, in_normal), kMinSquare));
  s.roughness = in_finish.x;
  s.metallic = in_finish.z;
  s.occlusion = 1.0;
  s.emission = in_emissive_cutoff.rgb;
#ifdef MAPPED
  if (has_map(SIMVIS_NORMAL_MAP)) {
    const vec3 bend = MAP(SIMVIS_NORMAL_MAP, normal_map).rgb * 2.0 - 1.0;
    s.normal = bent_normal(s.normal, bend * vec3(in_strengths.xx, 1.0));
  }
  if (has_map(SIMVIS_METALLIC_ROUGHNESS_MAP)) {
    const vec4 factor = MAP(SIMVIS_METALLIC_ROUGHNESS_MAP, metallic_roughness_map);
    s.roughness = max(s.roughness * factor.g, SIMVIS_MIN_ROUGHNESS);
    s.metallic *= factor.b;
  }
  if (has_map(SIMVIS_OCCLUSION_MAP)) {
    s.occlusion += in_strengths.y * (MAP(SIMVIS_OCCLUSION_MAP, occlusion_map).r - 1.0);
  }
  if (has_map(SIMVIS_EMISSIVE_MAP)) s.emission *= MAP(SIMVIS_EMISSIVE_MAP, emissive_map).rgb;
#endif
  return s;
}
