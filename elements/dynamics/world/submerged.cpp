#include "elements/dynamics/world/submerged.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace simvis {
namespace {

// A volume and the integral of the place over it.
struct VolumeMoments {
  double volume = 0;
  glm::dvec3 first{0};
  void add(double more, const glm::dvec3& center) {
    volume += more;
    first += more * center;
  }
};

// The water in the frame of a shape.
struct Water {
  glm::dvec3 up;
  double level;
  double depth(const glm::dvec3& place) const { return level - glm::dot(up, place); }
};

// The cap of a ball.
VolumeMoments wet_ball(double r, const Water& water) {
  VolumeMoments part;
  const double height = std::clamp(r + water.level, 0.0, 2 * r);
  if (!(height > 0)) return part;
  const double volume = std::numbers::pi * height * height * (3 * r - height) / 3;
  const double away = 2 * r - height;
  part.add(volume, -0.75 * away * away / (3 * r - height) * water.up);
  return part;
}

// Tetrahedra between `apex` and what of the triangle a, b, c is submerged. The apex of a solid that the plane cuts lies
// on the plane, so that the face in the plane adds nothing.
void add_triangle(const std::array<glm::dvec3, 3>& corners, const Water& water, const glm::dvec3& apex,
                  VolumeMoments& part) {
  std::array<glm::dvec3, 4> wet;
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 &from = corners[i], &to = corners[(i + 1) % 3];
    const double here = water.depth(from), there = water.depth(to);
    if (here > 0) wet[count++] = from;
    if ((here > 0) != (there > 0)) wet[count++] = from + here / (here - there) * (to - from);
  }
  for (std::size_t i = 2; i < count; ++i) {
    const glm::dvec3 a = wet[0] - apex, b = wet[i - 1] - apex, c = wet[i] - apex;
    part.add(glm::dot(a, glm::cross(b, c)) / 6, apex + (a + b + c) / 4.0);
  }
}

VolumeMoments wet_polyhedron(std::span<const glm::dvec3> points, std::span<const std::uint32_t> triangles,
                             const Water& water) {
  VolumeMoments part;
  if (points.empty()) return part;
  const auto is_wet = [&](const glm::dvec3& point) { return water.depth(point) > 0; };
  if (std::ranges::none_of(points, is_wet)) return part;
  const bool is_cut = !std::ranges::all_of(points, is_wet);
  const glm::dvec3 apex = is_cut ? points[0] + water.depth(points[0]) * water.up : points[0];
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) {
    add_triangle({points[triangles[i]], points[triangles[i + 1]], points[triangles[i + 2]]}, water, apex, part);
  }
  return part;
}

// Corner i has the signs of the bits of i along x, y and z.
constexpr std::array<std::uint32_t, 36> kBoxTriangles = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                                         2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};

VolumeMoments wet_box(const glm::dvec3& half, const Water& water) {
  std::array<glm::dvec3, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    corners[i] = half * glm::dvec3((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
  }
  return wet_polyhedron(corners, kBoxTriangles, water);
}

struct GaussNode {
  double place, weight;
};

// Nodes in [-1, 1], the sines of those of Gauss and Legendre: the sine takes away the root at both ends of a segment's
// chord. The roots come by Newton's method from Tricomi's approximation.
std::array<GaussNode, 32> gauss_nodes() {
  std::array<GaussNode, 32> nodes;
  const auto count = static_cast<double>(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    double x = std::cos(std::numbers::pi * (static_cast<double>(i) + 0.75) / (count + 0.5)), slope = 1;
    for (int round = 0; round < 6; ++round) {
      double before = 1, now = x;
      for (double n = 2; n <= count; ++n) {
        const double next = ((2 * n - 1) * x * now - (n - 1) * before) / n;
        before = now;
        now = next;
      }
      slope = count * (x * now - before) / (x * x - 1);
      x -= now / slope;
    }
    const double angle = std::numbers::pi / 2 * x;
    nodes[i] = {std::sin(angle), std::numbers::pi * std::cos(angle) / ((1 - x * x) * slope * slope)};
  }
  return nodes;
}

// A piece of a solid of revolution about z, from `low` to `high`: the square of its radius is r^2 - round (z -
// middle)^2, with 0 for a cylinder and 1 for a ball.
struct Turned {
  double low, high, r, round, middle;
  double square(double z) const { return std::max(0.0, r * r - round * (z - middle) * (z - middle)); }
};

// The slice at z is a disc whose submerged part lies within the signed distance e of its centre: a segment of the area
// R^2 (pi - acos(e / R)) + e sqrt(R^2 - e^2), whose first moment is -2/3 (R^2 - e^2)^(3/2).
void add_slices(const Turned& piece, double low, double high, const Water& water, VolumeMoments& part) {
  static const std::array<GaussNode, 32> kNodes = gauss_nodes();
  const double across = std::hypot(water.up.x, water.up.y), middle = (low + high) / 2, half = (high - low) / 2;
  const glm::dvec3 along = across > 0 ? glm::dvec3(water.up.x, water.up.y, 0) / across : glm::dvec3(0);
  for (const GaussNode& node : kNodes) {
    const double z = middle + half * node.place, width = half * node.weight;
    const double square = piece.square(z), radius = std::sqrt(square), depth = water.level - water.up.z * z;
    if (depth <= -across * radius) continue;
    if (depth >= across * radius) {
      part.add(width * std::numbers::pi * square, {0, 0, z});
      continue;
    }
    const double e = depth / across, chord2 = std::max(0.0, square - e * e), chord = std::sqrt(chord2);
    const double area = square * (std::numbers::pi - std::acos(std::clamp(e / radius, -1.0, 1.0))) + e * chord;
    part.volume += width * area;
    part.first += width * (area * glm::dvec3(0, 0, z) - 2.0 / 3 * chord2 * chord * along);
  }
}

// Between the places where the plane reaches the surface of the piece, its slices are all dry, all cut or all wet.
void add_turned(const Turned& piece, const Water& water, VolumeMoments& part) {
  const double across = std::hypot(water.up.x, water.up.y), c = water.up.z, d = water.level - c * piece.middle;
  const double square = c * c + piece.round * across * across;
  const double inner = across * across * (square * piece.r * piece.r - piece.round * d * d);
  std::vector<double> ends{piece.low, piece.high};
  if (square > 0 && inner >= 0) {
    for (const double sign : {-1.0, 1.0}) {
      const double z = piece.middle + (d * c + sign * std::sqrt(inner)) / square;
      if (z > piece.low && z < piece.high) ends.push_back(z);
    }
  }
  std::ranges::sort(ends);
  for (std::size_t i = 1; i < ends.size(); ++i) add_slices(piece, ends[i - 1], ends[i], water, part);
}

VolumeMoments wet_part(const CollisionShape& shape, const Water& water) {
  const double r = shape.half_m.x, half = shape.half_m.z;
  VolumeMoments part;
  switch (shape.kind) {
    case CollisionKind::box:
      return wet_box(shape.half_m, water);
    case CollisionKind::sphere:
      return wet_ball(r, water);
    case CollisionKind::hull:
      return wet_polyhedron(shape.points, shape.triangles, water);
    case CollisionKind::capsule:
      add_turned({-half - r, -half, r, 1, -half}, water, part);
      add_turned({half, half + r, r, 1, half}, water, part);
      [[fallthrough]];
    case CollisionKind::cylinder:
      add_turned({-half, half, r, 0, 0}, water, part);
      return part;
    case CollisionKind::mesh:
    case CollisionKind::plane:
      break;
  }
  return part;
}

}  // namespace

SubmergedSolid submerged(std::span<const CollisionShape> shapes, const glm::dvec3& up, double level_m) {
  VolumeMoments all;
  for (const CollisionShape& shape : shapes) {
    const glm::dmat3 turn(shape.body_from_shape);
    const glm::dvec3 origin(shape.body_from_shape[3]);
    const VolumeMoments part = wet_part(shape, {glm::transpose(turn) * up, level_m - glm::dot(up, origin)});
    all.volume += part.volume;
    all.first += turn * part.first + part.volume * origin;
  }
  if (!(all.volume > 0)) return {};
  return {.volume_m3 = all.volume, .center_m = all.first / all.volume};
}

}  // namespace simvis
