// Whether something stands between a light and the point that is shaded. Part of color.glsl.
//
// A shadow map holds the depth of what the light meets first at the centre of each texel, moved away from the light by
// what the triangle's plane spans over half the texel (shadow_depth.glsl). The point is held against the texel that it
// falls into, at the nearer one of two places: where it is, and where its own plane is at the texel's centre. So a
// plane never shades itself, however steeply the light comes; nor do two planes that meet: in a valley the point itself
// lies before the other plane, on a ridge its plane does so at the centre. What is left is rounding.
layout(std140, set = SIMVIS_SHADOW_SET, binding = SIMVIS_SHADOWS) uniform Shadows {
  ShadowBlock shadows[SIMVIS_MAX_SHADOWS];
};
layout(set = SIMVIS_SHADOW_SET, binding = SIMVIS_SHADOW_ATLAS) uniform sampler2D shadow_atlas;

// Of a vertex, relative to what it is summed up from: as kVertexRounding in engine/view_projection.cpp.
const float kVertexRounding = 1e-6;
// Of a depth: at most five roundings of 2^-24 each, in the plane's terms and sums.
const float kDepthRounding = 3e-7;
// Light that comes along a plane to within this cosine does not light it.
const float kMinCosine = 1e-6;

// The unit normal of the triangle itself, to either side.
vec3 normal_of_plane() {
  const vec3 normal = cross(dFdx(in_position), dFdy(in_position));
  return normal * inversesqrt(max(dot(normal, normal), 1e-36));
}

// 1 where the light comes through, 0 where it does not. `reach`: of what the position was summed up from, metres.
float free_share(ShadowBlock map, vec3 plane_normal, float reach) {
  const vec4 here = vec4(in_position, 1.0);
  vec3 p = vec3(dot(map.row_x, here), dot(map.row_y, here), dot(map.row_z, here));
  vec3 n = vec3(dot(map.row_x.xyz, plane_normal), dot(map.row_y.xyz, plane_normal), dot(map.row_z.xyz, plane_normal));
  vec2 corner = map.place.xy;
  if (map.depth.w > 0.0) {  // a cube: the side that the point lies before
    const vec3 size = abs(p);
    if (size.z < max(size.x, size.y)) {
      const bool along_x = size.x >= size.y;
      p = along_x ? p.yzx : p.zxy;
      n = along_x ? n.yzx : n.zxy;
      corner.x += map.place.z * (along_x ? 1.0 : 2.0);
    }
    if (p.z < 0.0) {
      p.yz = -p.yz;
      n.yz = -n.yz;
      corner.y += map.place.w;
    }
  }
  const bool orthographic = map.depth.y > 0.0;
  if (!orthographic && p.z <= 0.0) return 1.0;  // behind a spot, where its cone is not
  const vec2 seen = map.projection.xy * (orthographic ? p.xy : p.xy / p.z) + map.projection.zw;
  const vec2 texel = clamp(floor(seen), vec2(0.0), map.place.zw - 1.0);
  const vec2 center = (texel + 0.5 - map.projection.zw) / map.projection.xy;
  // The ray through the texel's centre meets the point's plane at start + z * way, for way.z = 1.
  const vec3 start = orthographic ? vec3(center, 0.0) : vec3(0.0);
  const vec3 way = orthographic ? vec3(0.0, 0.0, 1.0) : vec3(center, 1.0);
  const float along = dot(n, way);
  const float divisor = along < 0.0 ? min(along, -kMinCosine) : max(along, kMinCosine);
  // Of the vertices in both views, and of p.
  const float rounding = kVertexRounding * (3.0 * reach + 2.0 * map.depth.z);
  const float z = min(p.z, dot(n, p - start) / divisor) - rounding / abs(divisor);
  const float met = texelFetch(shadow_atlas, ivec2(corner + texel), 0).r;
  if (orthographic) return met <= (map.depth.x - z) * map.depth.y + kDepthRounding ? 1.0 : 0.0;
  return met * z <= map.depth.x * (1.0 + kDepthRounding) ? 1.0 : 0.0;
}
