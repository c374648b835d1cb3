// The shadow test: whether an object lies between a light and the shaded point. Part of mesh_color.frag.
//
// A shadow map stores the depth of the first surface at the centre of each texel, moved away from the light by the
// depth that the triangle's plane spans over half a texel (shadow_depth.glsl). The test compares the depth of the texel
// that contains the point with the nearer of two depths: that of the point, and that of the point's own plane at the
// centre of the texel. So a plane never shadows itself, at any angle of the light. Two planes that meet do not shadow
// each other either: in a valley, the point lies before the other plane; on a ridge, its plane lies before the other
// plane at the centre.
//
// The point lies on the ray through its pixel, at the interpolated depth, and the plane's normal follows from how 1 / z
// changes from pixel to pixel. Interpolated positions would not do. The slopes of x / z and y / z over the picture are
// quotients of a triangle's differences by its area, so each has an error of about 2^-24 / h for a triangle that is h
// pixels high. Over X pixels that is 2^-24 X / h of the distance across the ray: 6e-5 for X = 1000 and h = 1, where
// kDepthRounding and `slack` allow some 1e-6. On the ray, the error of 1 / z moves the point along the ray alone. A plane
// that appears h pixels high has an angle of h / f times some factor to its rays, with the focal length f in pixels, and
// the error 2^-24 X / h of z becomes 2^-24 X / f of the distance from the plane, whatever h is.
//
// What remains is the error of the point: rounding, and the distance of a mesh from the surface that it stands for. The
// shadow map may show another mesh of the same surface. A mesh of a round shape never lies outside the shape, so the
// point lies before it once its own error is taken away.
layout(set = SIMVIS_SHADOW_SET, binding = SIMVIS_SHADOWS) uniform samplerBuffer shadows;  // as lights in lights.glsl
layout(set = SIMVIS_SHADOW_SET, binding = SIMVIS_SHADOW_ATLAS) uniform sampler2D shadow_atlas;

// Rounding error of a depth: at most five roundings of 2^-24 each, in the terms and sums of the plane.
const float kDepthRounding = 3e-7;
// Smallest cosine between the plane's normal and the light at which the light reaches the plane.
const float kMinCosine = 1e-6;

// A point of a triangle, and the unit normal of its plane on either side; in the view frame.
struct PlanePoint {
  vec3 place, normal;
};

// The points p of a plane that does not contain the eye have n . p = 1, so 1 / z = n . p / z is affine in the picture.
PlanePoint plane_point() {
  const vec4 pixel = texelFetch(shadows, int(view.lights.y) - 1);  // see pixel_row() in engine/render/shadow_maps.h
  const vec2 tangent = (gl_FragCoord.xy - pixel.xy) * pixel.zw;
  const float per_z = gl_FragCoord.w;
  const vec2 across = vec2(dFdx(per_z), dFdy(per_z)) / pixel.zw;
  const vec3 normal = vec3(across, per_z - dot(across, tangent));
  return PlanePoint(vec3(tangent, 1.0) / per_z, normal * inversesqrt(max(dot(normal, normal), 1e-36)));
}

ShadowBlock shadow_map(uint number) {
  const int first = int(view.lights.y + number * SIMVIS_SHADOW_ROWS);
  return ShadowBlock(texelFetch(shadows, first), texelFetch(shadows, first + 1), texelFetch(shadows, first + 2),
                     texelFetch(shadows, first + 3), texelFetch(shadows, first + 4), texelFetch(shadows, first + 5));
}

// 1 if the light reaches the point, 0 if it is in shadow. `slack`: bound on the error of the position, m.
float free_share(ShadowBlock map, PlanePoint seen_point, float slack) {
  const vec4 here = vec4(seen_point.place, 1.0);
  const vec3 plane_normal = seen_point.normal;
  vec3 p = vec3(dot(map.row_x, here), dot(map.row_y, here), dot(map.row_z, here));
  vec3 n = vec3(dot(map.row_x.xyz, plane_normal), dot(map.row_y.xyz, plane_normal), dot(map.row_z.xyz, plane_normal));
  vec2 corner = map.place.xy;
  if (map.depth.w > 0.0) {  // a cube: select the side that the point faces
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
  if (!orthographic && p.z <= 0.0) return 1.0;  // behind a spot light, outside its cone
  const vec2 seen = map.projection.xy * (orthographic ? p.xy : p.xy / p.z) + map.projection.zw;
  const vec2 texel = clamp(floor(seen), vec2(0.0), map.place.zw - 1.0);
  const vec2 center = (texel + 0.5 - map.projection.zw) / map.projection.xy;
  // The ray through the centre of the texel intersects the plane of the point at start + z * way, with way.z = 1.
  const vec3 start = orthographic ? vec3(center, 0.0) : vec3(0.0);
  const vec3 way = orthographic ? vec3(0.0, 0.0, 1.0) : vec3(center, 1.0);
  const float along = dot(n, way);
  const float divisor = along < 0.0 ? min(along, -kMinCosine) : max(along, kMinCosine);
  const float error = slack + 2.0 * SIMVIS_VERTEX_ROUNDING * map.depth.z;  // with the rounding between the frames
  const float z = min(p.z, dot(n, p - start) / divisor) - error / abs(divisor);
  const float stored = texelFetch(shadow_atlas, ivec2(corner + texel), 0).r;
  if (orthographic) return stored <= (map.depth.x - z) * map.depth.y + kDepthRounding ? 1.0 : 0.0;
  return stored * z <= map.depth.x * (1.0 + kDepthRounding) ? 1.0 : 0.0;
}
