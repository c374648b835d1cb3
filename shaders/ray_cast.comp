// Finds candidates for each ray: the triangles that it may hit first. The host makes the final decision in double.
//
// The computation is not exact, but it is conservative: no triangle that may be the first hit is lost. All values are
// float32 with the errors that Vulkan allows: a sum or a product has an error of at most 1 ulp, a quotient of 2.5 ulp
// and an inverse square root of 2 ulp, fused or not, in any direction (1 ulp is e = 2^-23, relative). Each margin below
// is the sum of the possible errors of the operations before it. engine/raycast/gpu_ray_instance.h adds up the errors
// of the transform of a ray into the unit frame of an item. `precise` marks expressions in which a compiler that
// distributes a product over a difference would cause a larger error.
//
// Boxes. The distances to the sides of a box have a relative error of 5 e, so the nearer distance may appear up to 11 e
// greater than the farther one (Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013).
//
// Triangles. The test is that of engine/raycast/ray_triangle.h, in the unit frame, from a point of the ray at most 1.6
// from the centre. Coordinates are at most 2.6, with an error of 2.6 e, plus 0.25 e for the rounded corner. Sheared
// coordinates are at most 5.2, with an error of 2 slack + 20 e (5.7 corner, 6.5 shear, 2.6 product, 5.2 difference).
// The edge function then has an error of (2 slack + 20 e) (|p| + |q|) + 2 (...)^2, plus its own rounding of
// 2 e 5.2 (|p| + |q|); kShearError covers both. If the margins m of the weights are less than half of the sum A of the
// weights, the height z of the hit has an error of at most 2 sum(m_i |z_i - z|) / A, plus slack, plus rounding: twice
// 39 e for the quotient, and 3 e for the corners.
//
// Backs. Where all weights exceed their margins, their signs are exact, and with them the side that the ray sees (see
// shows_back() in engine/raycast/ray_triangle.h). It is the same in the frame of the mesh, mirrored or not: both the
// winding and the normal turn round. All other triangles are candidates, and the host decides.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/interop.h"

layout(local_size_x = SIMVIS_RAY_GROUP) in;

layout(std430, binding = SIMVIS_RAY_TOP_NODES) readonly buffer TopNodes { TreeNode top_nodes[]; };
layout(std430, binding = SIMVIS_RAY_ITEMS) readonly buffer Items { GpuRayInstance items[]; };
layout(std430, binding = SIMVIS_RAY_MESH_NODES) readonly buffer MeshNodes { TreeNode mesh_nodes[]; };
layout(std430, binding = SIMVIS_RAY_TRIANGLES) readonly buffer Triangles { RayTriangle triangles[]; };
layout(std430, binding = SIMVIS_RAY_DIRECTIONS) readonly buffer Directions { vec4 directions[]; };
layout(std430, binding = SIMVIS_RAY_CANDIDATES) writeonly buffer Candidates { RayCandidates candidates[]; };
layout(push_constant) uniform View { RayCastBlock view; };

const float kUlp = 1.1920929e-7;         // e
const float kBoxError = 1 + 16 * kUlp;   // 11, plus its own rounding
const float kShearError = 40 * kUlp;     // 20 + 10.4 per sum of coordinates, plus the rounding of the margins
const float kCornerError = 6 * kUlp;     // 2.85
const float kHeightError = 96 * kUlp;    // 2 * 39 + 3, plus the rounding of the margins
const float kWayError = 32 * kUlp;       // of a height divided by the z of `way`: 5 e of at most 4.5
const float kFar = SIMVIS_FAR_M;

uint ray;
vec3 direction;
float passed_m;  // hits at or before this range do not count; rounded down
uint found = 0;
float found_from_m[SIMVIS_MAX_CANDIDATES];
float hit_by_m = kFar;         // the ray hits an opaque triangle at this range or before
float complete_to_m = 2 * kFar;

uint waiting = 0;  // nodes on the stack; those of the current item lie above those of the top-level tree
uint stack_node[2 * (SIMVIS_TREE_DEPTH + 1)];
float stack_near[2 * (SIMVIS_TREE_DEPTH + 1)];

// A ray in the unit frame of an item.
struct LocalRay {
  uint item, first_triangle;
  bool solid, passes_backs;
  vec3 from, way;  // `way` has approximately unit length
  float start, metres, slack, range_error;
  int axis;  // the largest component of `way`
  vec2 shear;
  float per_height;
};

float end_m() { return min(hit_by_m, complete_to_m); }

// Adds a candidate that the ray may hit at a range of `from_m` or more. The list keeps the nearest candidates. A
// dropped candidate limits the range up to which the list is complete.
void add_candidate(uint item, uint primitive, float from_m) {
  if (from_m > end_m()) return;
  uint slot = found;
  if (found < SIMVIS_MAX_CANDIDATES) {
    ++found;
  } else {
    slot = 0;
    for (uint i = 1; i < SIMVIS_MAX_CANDIDATES; ++i) {
      if (found_from_m[i] > found_from_m[slot]) slot = i;
    }
    if (from_m >= found_from_m[slot]) {
      complete_to_m = min(complete_to_m, from_m);
      return;
    }
    if (found_from_m[slot] <= hit_by_m) complete_to_m = min(complete_to_m, found_from_m[slot]);
  }
  found_from_m[slot] = from_m;
  candidates[ray].found[slot] = uvec2(item, primitive);
}

// Prevents division by 0; 1e-12 is far below the rounding error of a unit vector.
vec3 apart_from_zero(vec3 v) { return mix(v, vec3(1e-12), lessThan(abs(v), vec3(1e-12))); }

// The parameter at which a ray from 0 along 1 / per_way enters the box, whose corners are relative to the start of the
// ray. Returns a value beyond kFar if the ray misses the box.
float enter_box(vec3 low, vec3 high, vec3 per_way, float end) {
  const vec3 s = low * per_way, t = high * per_way;
  const vec3 first = min(s, t), last = max(s, t);
  const float near = max(max(first.x, first.y), max(first.z, 0));
  const float far = min(min(last.x, last.y), min(last.z, end));
  return near <= far * kBoxError ? near : 4 * kFar * kFar;
}

// Pushes the children of a node; the nearer child is visited first.
void await(uint first, float near_left, float near_right, float end) {
  const bool right_first = near_right < near_left;
  const float nearer = min(near_left, near_right), farther = max(near_left, near_right);
  if (farther <= end) {
    stack_node[waiting] = right_first ? first : first + 1;
    stack_near[waiting++] = farther;
  }
  if (nearer <= end) {
    stack_node[waiting] = right_first ? first + 1 : first;
    stack_near[waiting++] = nearer;
  }
}

vec3 turned(vec3 v, int axis) { return axis == 0 ? v.yzx : axis == 1 ? v.zxy : v; }

float size(vec2 v) { return abs(v.x) + abs(v.y); }

void try_triangle(const LocalRay r, RayTriangle triangle) {
  const vec3 a = turned(uintBitsToFloat(triangle.a_primitive.xyz) - r.from, r.axis);
  const vec3 b = turned(triangle.b.xyz - r.from, r.axis), c = turned(triangle.c.xyz - r.from, r.axis);
  precise const vec2 p = a.xy - r.shear * a.z, q = b.xy - r.shear * b.z, s = c.xy - r.shear * c.z;
  precise const vec3 weights = vec3(q.x * s.y - q.y * s.x, s.x * p.y - s.y * p.x, p.x * q.y - p.y * q.x);
  const float error = 2 * r.slack + kShearError, of_p = size(p), of_q = size(q), of_s = size(s);
  const vec3 margins = error * vec3(of_q + of_s, of_s + of_p, of_p + of_q) + 2 * error * error;
  if (any(lessThan(weights, -margins)) && any(greaterThan(weights, margins))) return;

  const vec3 heights = vec3(a.z, b.z, c.z);
  const float corner_error = r.slack + kCornerError;
  float low = min(min(a.z, b.z), c.z) - corner_error, high = max(max(a.z, b.z), c.z) + corner_error;
  const float sum = weights.x + weights.y + weights.z, margin = margins.x + margins.y + margins.z;
  bool certain = false;
  if (abs(sum) > 2.001 * margin) {
    const float height = dot(weights, heights) / sum;
    const float off = 2 * dot(margins, abs(heights - height)) / abs(sum) + r.slack + kHeightError;
    low = max(low, height - off);
    high = min(high, height + off);
    certain = all(greaterThan(weights, margins)) || all(lessThan(weights, -margins));
  }
  const float one = low * r.per_height, other = high * r.per_height;
  const float first = max(r.start + min(one, other) - kWayError, 0), last = r.start + max(one, other) + kWayError;
  if (last < 0) return;
  if (certain && r.passes_backs && (weights.x > 0) == (r.per_height > 0)) return;
  const float from_m = first * r.metres * (1 - r.range_error), to_m = last * r.metres * (1 + r.range_error);
  if (to_m < passed_m) return;
  add_candidate(r.item, triangle.a_primitive.w, from_m);
  if (certain && r.solid && first > 0 && from_m >= passed_m * (1 + 2 * kUlp)) hit_by_m = min(hit_by_m, to_m);
}

void walk_mesh(const LocalRay r, uint root, float units_per_m) {
  const vec3 per_way = 1 / r.way;
  const float padding = r.slack + kCornerError;
  const vec3 from_low = r.from + padding, from_high = r.from - padding;
  const uint base = waiting;
  stack_node[waiting] = root;
  stack_near[waiting++] = 0;
  while (waiting > base) {
    --waiting;
    const float end = end_m() * units_per_m - r.start;
    if (stack_near[waiting] > end * kBoxError) continue;
    const uvec4 node_low = mesh_nodes[stack_node[waiting]].low_first;
    const uint count = mesh_nodes[stack_node[waiting]].high_count.w;
    if (count > 0) {
      for (uint k = 0; k < count; ++k) try_triangle(r, triangles[r.first_triangle + node_low.w + k]);
      continue;
    }
    const uint left = root + node_low.w;
    float near[2];
    for (uint k = 0; k < 2; ++k) {
      const TreeNode child = mesh_nodes[left + k];
      precise const vec3 low = uintBitsToFloat(child.low_first.xyz) - from_low;
      precise const vec3 high = uintBitsToFloat(child.high_count.xyz) - from_high;
      near[k] = enter_box(low, high, per_way, end);
    }
    await(left, near[0], near[1], end * kBoxError);
  }
}

void walk_item(uint index, float near_m) {
  const GpuRayInstance item = items[index];
  if (item.tree.w == SIMVIS_HIDDEN_ITEM) return;
  precise const vec3 apart =
      (view.sensor_high.xyz - item.centre_high.xyz) + (view.sensor_low.xyz - item.centre_low.xyz);
  const float scale = item.row_x.w;
  const vec3 sensor =
      scale * vec3(dot(item.row_x.xyz, apart), dot(item.row_y.xyz, apart), dot(item.row_z.xyz, apart));
  // A norm that is at least the length and cannot overflow.
  const float distance = abs(sensor.x) + abs(sensor.y) + abs(sensor.z);
  LocalRay r;
  r.slack = item.row_y.w + item.row_z.w * distance;
  if (item.tree.w == SIMVIS_ITEM_OF_HOST || !(r.slack <= SIMVIS_MAX_SLACK)) {
    add_candidate(index, SIMVIS_WHOLE_ITEM, near_m / kBoxError);
    return;
  }
  const vec3 way = vec3(dot(item.row_x.xyz, direction), dot(item.row_y.xyz, direction), dot(item.row_z.xyz, direction));
  const float length_squared = dot(way, way), per_length = inversesqrt(length_squared);
  r.way = apart_from_zero(way * per_length);
  const float middle_at = -dot(sensor, r.way);
  const vec3 middle = sensor + middle_at * r.way;
  if (middle_at < -1.25 || dot(middle, middle) > 1.07) return;  // misses a ball of radius 1 + 2 * SIMVIS_MAX_SLACK
  r.item = index;
  r.first_triangle = item.tree.y;
  r.solid = (item.tree.z & 1) == 1;
  r.passes_backs = (item.tree.z & 2) == 2 && view.rays.y == 1;
  r.start = max(middle_at - 1.25, 0);
  precise const vec3 from = sensor + r.start * r.way;
  r.from = from;
  r.metres = per_length / scale;
  r.range_error = item.centre_high.w;
  const vec3 large = abs(r.way);
  r.axis = large.x >= large.y && large.x >= large.z ? 0 : large.y >= large.z ? 1 : 2;
  const vec3 turned_way = turned(r.way, r.axis);
  r.shear = turned_way.xy / turned_way.z;
  r.per_height = 1 / turned_way.z;
  walk_mesh(r, item.tree.x, scale * length_squared * per_length * (1 + r.range_error));
}

void main() {
  ray = gl_GlobalInvocationID.x;
  if (ray >= view.rays.x) return;
  direction = directions[ray].xyz;
  passed_m = directions[ray].w;
  const vec3 per_way = 1 / apart_from_zero(direction), from = view.sensor_high.xyz;
  stack_node[0] = 0;
  stack_near[0] = 0;
  waiting = 1;
  while (waiting > 0) {
    --waiting;
    const float near_m = stack_near[waiting];
    if (near_m > end_m() * kBoxError) continue;
    const uvec4 node_low = top_nodes[stack_node[waiting]].low_first;
    if (top_nodes[stack_node[waiting]].high_count.w > 0) {
      walk_item(node_low.w, near_m);
      continue;
    }
    float near[2];
    for (uint k = 0; k < 2; ++k) {
      const TreeNode child = top_nodes[node_low.w + k];
      precise const vec3 low = uintBitsToFloat(child.low_first.xyz) - from;
      precise const vec3 high = uintBitsToFloat(child.high_count.xyz) - from;
      near[k] = enter_box(low, high, per_way, end_m());
    }
    await(node_low.w, near[0], near[1], end_m() * kBoxError);
  }
  candidates[ray].count = found;
  candidates[ray].complete_to_m = complete_to_m;
}
