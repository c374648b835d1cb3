#include "engine/geometry/view_projection.h"

#include <algorithm>
#include <cmath>

namespace simvis {
namespace {

glm::vec4 rounded(const glm::dvec4& row) { return glm::vec4(row); }

glm::dvec3 transform_point(const glm::dmat4& m, const glm::dvec3& p) {
  return glm::dvec3(m[0]) * p.x + glm::dvec3(m[1]) * p.y + glm::dvec3(m[2]) * p.z + glm::dvec3(m[3]);
}

// Bound of the error of a vertex's float32 clip coordinates, relative to the length of the path to the vertex: three
// products and sums of rounded numbers, 8 * 2^-24 at most, with a margin.
constexpr double kVertexRounding = SIMVIS_VERTEX_ROUNDING;
// The same bound for this file's arithmetic in double, relative to the world coordinates.
constexpr double kWorldRounding = 1e-14;

}  // namespace

double rounding_of(const glm::dvec3& center_view, const WorldBox& box) {
  const glm::dvec3 c = glm::abs(center_view), w = glm::abs(box.center);
  return kVertexRounding * (c.x + c.y + c.z + box.radius) + kWorldRounding * (w.x + w.y + w.z);
}

std::uint32_t guard_rows(const View& view) {
  constexpr std::uint32_t kStrip = 8;  // a strip is at least this many times as wide as high
  return !view.orthographic && view.width_px >= kStrip * view.height_px ? (view.width_px - view.height_px) / 2 : 0;
}

ViewProjection make_projection(const View& view) {
  ViewProjection p;
  const Pinhole& k = view.pinhole;
  const double width = view.width_px, height = view.height_px;
  p.view_from_world = view.view_from_world;
  p.near_m = view.near_m;
  p.scale_x = 2 * k.fx_px / width;
  p.shift_x = 2 * k.cx_px / width - 1;
  const double guard = guard_rows(view);
  p.scale_y = 2 * k.fy_px / (height + 2 * guard);
  p.shift_y = 2 * (k.cy_px + guard) / (height + 2 * guard) - 1;
  // A side contains the points with u = 0, u = width, v = 0 or v = height, times z. In an orthographic view the factor
  // z is absent.
  const double eye = view.orthographic ? 0 : 1;
  const double offsets[4] = {k.cx_px, width - k.cx_px, k.cy_px, height - k.cy_px};
  const glm::dvec3 sides[4] = {{k.fx_px, 0, eye * offsets[0]},
                               {-k.fx_px, 0, eye * offsets[1]},
                               {0, k.fy_px, eye * offsets[2]},
                               {0, -k.fy_px, eye * offsets[3]}};
  const glm::dmat3 world_from_view_axes = glm::transpose(glm::dmat3(view.view_from_world));
  for (int i = 0; i < 4; ++i) {
    p.side_view[i] = glm::normalize(sides[i]);
    p.side_offset[i] = (1 - eye) * offsets[i] / glm::length(sides[i]);
    p.side_world[i] = world_from_view_axes * p.side_view[i];
  }
  p.forward_world = world_from_view_axes[2];
  if (view.orthographic) {
    p.orthographic = true;
    p.depth_scale = -1 / (view.far_m - view.near_m);
    p.depth_shift = -view.far_m * p.depth_scale;
  }
  return p;
}

void write_clip_rows(const ViewProjection& p, const glm::dmat4& world_from_mesh, shader::Instance& instance) {
  const glm::dmat4& v = p.view_from_world;
  glm::dvec4 row[3];
  for (int c = 0; c < 4; ++c) {
    const glm::dvec4& column = world_from_mesh[c];
    for (int r = 0; r < 3; ++r) {
      row[r][c] = v[0][r] * column.x + v[1][r] * column.y + v[2][r] * column.z + (c == 3 ? v[3][r] : 0.0);
    }
  }
  if (p.orthographic) {
    instance.clip_x = rounded(p.scale_x * row[0] + glm::dvec4(0, 0, 0, p.shift_x));
    instance.clip_y = rounded(p.scale_y * row[1] + glm::dvec4(0, 0, 0, p.shift_y));
    instance.clip_w = rounded(p.depth_scale * row[2] + glm::dvec4(0, 0, 0, p.depth_shift));
    return;
  }
  instance.clip_x = rounded(p.scale_x * row[0] + p.shift_x * row[2]);
  instance.clip_y = rounded(p.scale_y * row[1] + p.shift_y * row[2]);
  instance.clip_w = rounded(row[2]);
}

WorldBox make_box(const glm::dmat4& world_from_mesh, const glm::dvec3& mesh_center, const glm::dvec3& mesh_half) {
  WorldBox box;
  box.center = transform_point(world_from_mesh, mesh_center);
  for (int i = 0; i < 3; ++i) box.axis[i] = glm::dvec3(world_from_mesh[i]) * mesh_half[i];
  // The farthest corner: four of the eight are tested, and the others are opposite.
  double square = 0;
  for (const double a : {-1.0, 1.0}) {
    for (const double b : {-1.0, 1.0}) {
      const glm::dvec3 corner = a * box.axis[0] + b * box.axis[1] + box.axis[2];
      square = std::max(square, glm::dot(corner, corner));
    }
  }
  box.radius = std::sqrt(square);
  return box;
}

MeshPlanes make_mesh_planes(const ViewProjection& p, const glm::dmat4& world_from_mesh, const WorldBox& box) {
  MeshPlanes planes;
  const glm::dmat4 view_from_mesh = p.view_from_world * world_from_mesh;
  const glm::dmat4 rows = glm::transpose(view_from_mesh);
  // Top and bottom come first, because most content misses a strip there.
  constexpr int kOrder[4] = {2, 3, 0, 1};
  for (int i = 0; i < 4; ++i) {
    const glm::dvec3& n = p.side_view[kOrder[i]];
    planes.plane[i] = n.x * rows[0] + n.y * rows[1] + n.z * rows[2] + glm::dvec4(0, 0, 0, p.side_offset[kOrder[i]]);
  }
  planes.plane[4] = rows[2] - glm::dvec4(0, 0, 0, p.near_m);
  planes.slack = rounding_of(transform_point(p.view_from_world, box.center), box);
  return planes;
}

bool outside(const MeshPlanes& planes, const glm::dvec3& center, const glm::dvec3& half_size) {
  for (const glm::dvec4& plane : planes.plane) {
    const glm::dvec3 normal(plane);
    const double farthest_inwards = glm::dot(normal, center) + plane.w + glm::dot(glm::abs(normal), half_size);
    if (farthest_inwards < -planes.slack) return true;
  }
  return false;
}

bool inside(const MeshPlanes& planes, const glm::dvec3& center, const glm::dvec3& half_size) {
  return std::ranges::all_of(planes.plane, [&](const glm::dvec4& plane) {
    const glm::dvec3 normal(plane);
    return glm::dot(normal, center) + plane.w - glm::dot(glm::abs(normal), half_size) > planes.slack;
  });
}

bool outside(const MeshPlanes& planes, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  for (const glm::dvec4& plane : planes.plane) {
    const auto beyond = [&](const glm::vec3& p) {
      return plane.x * p.x + plane.y * p.y + plane.z * p.z + plane.w < -planes.slack;
    };
    if (beyond(a) && beyond(b) && beyond(c)) return true;
  }
  return false;
}

bool outside(const ViewProjection& p, const WorldBox& box) {
  const glm::dvec3 center = transform_point(p.view_from_world, box.center);
  const double slack = rounding_of(center, box);
  // The sphere comes first, because it decides most cases; then the box, which is tighter for flat content such as a
  // floor.
  const auto beyond = [&](double distance, const glm::dvec3& normal_world) {
    if (distance >= -slack) return false;
    if (distance < -box.radius - slack) return true;
    double extent = 0;
    for (const glm::dvec3& axis : box.axis) extent += std::abs(glm::dot(normal_world, axis));
    return distance < -extent - slack;
  };
  if (beyond(center.z - p.near_m, p.forward_world)) return true;
  for (int i = 0; i < 4; ++i) {
    if (beyond(glm::dot(p.side_view[i], center) + p.side_offset[i], p.side_world[i])) return true;
  }
  return false;
}

// The rounding that outside() assumes is at most the slack here. The centre of a box within this box is also within it,
// so in the view's axes the sum of its coordinates is larger by at most sqrt(3) * length(half_size). The radius of that
// box is at most length(half_size), half the diagonal. The slack is twice the sum, because both functions also round.
bool all_outside(const ViewProjection& p, const glm::dvec3& center, const glm::dvec3& half_size) {
  const glm::dvec3 center_view = transform_point(p.view_from_world, center);
  const glm::dvec3 c = glm::abs(center_view), w = glm::abs(center) + half_size;
  const double slack =
      2 * (kVertexRounding * (c.x + c.y + c.z + 2.75 * glm::length(half_size)) + kWorldRounding * (w.x + w.y + w.z));
  const auto beyond = [&](double distance, const glm::dvec3& normal_world) {
    return distance + glm::dot(glm::abs(normal_world), half_size) < -slack;
  };
  if (beyond(center_view.z - p.near_m, p.forward_world)) return true;
  for (int i = 0; i < 4; ++i) {
    if (beyond(glm::dot(p.side_view[i], center_view) + p.side_offset[i], p.side_world[i])) return true;
  }
  return false;
}

double farthest_depth(const ViewProjection& p, const WorldBox& box) {
  double depth = transform_point(p.view_from_world, box.center).z;
  for (const glm::dvec3& axis : box.axis) depth += std::abs((p.view_from_world * glm::dvec4(axis, 0)).z);
  return depth;
}

}  // namespace simvis
