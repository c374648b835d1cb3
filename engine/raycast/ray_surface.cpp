// This file is compiled without contraction of products and sums (-ffp-contract=off), as ray_triangle.cpp is, so that
// its ranges are the same bytes on every machine.
#include "engine/raycast/ray_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/base/assert.h"
#include "engine/draw/round_texture.h"
#include "engine/raycast/placing_error.h"

namespace simvis {

namespace {

constexpr double kShapeUnit = 0x1p-53;
constexpr double kNever = std::numeric_limits<double>::infinity();

// The inverse of a transform may lose this factor in precision: its ranges then have a relative error of about 1e-10.
constexpr double kMaxInverseLoss = 0x1p20;

// A range along the ray where it enters or leaves a piece, and the limits of the true one; without bounds they are t.
struct Crossing {
  double t = 0, low = 0, high = 0;
  std::uint32_t face = kRoundFace;

  double error() const { return std::max(t - low, high - t); }
};

Crossing crossing_at(double t, double error) { return {t, t - error, t + error, kRoundFace}; }

// The ray is inside of a piece from `in` to `out`.
struct Inside {
  Crossing in{-kNever, -kNever, -kNever, kRoundFace}, out{kNever, kNever, kNever, kRoundFace};
  bool any = true;
};
constexpr Inside kOutside{.in = {}, .out = {}, .any = false};

Crossing later(const Crossing& a, const Crossing& b) {
  return {std::max(a.t, b.t), std::max(a.low, b.low), std::max(a.high, b.high), b.t > a.t ? b.face : a.face};
}
Crossing earlier(const Crossing& a, const Crossing& b) {
  return {std::min(a.t, b.t), std::min(a.low, b.low), std::min(a.high, b.high), b.t < a.t ? b.face : a.face};
}

Inside both(const Inside& a, const Inside& b) {
  if (!a.any || !b.any) return kOutside;
  const Inside inside{later(a.in, b.in), earlier(a.out, b.out)};
  return inside.in.t <= inside.out.t ? inside : kOutside;
}

// Of pieces whose union is convex.
Inside either(const Inside& a, const Inside& b) {
  if (!a.any) return b;
  if (!b.any) return a;
  return {earlier(a.in, b.in), later(a.out, b.out)};
}

// A ray in the frame of a shape.
struct LocalRay {
  const SeenShape& seen;
  glm::dvec3 from, way;
  bool with_bounds = false;

  LocalRay(const SeenShape& surface, const glm::dvec3& direction, bool bounds)
      : seen(surface), from(surface.from), with_bounds(bounds) {
    for (int i = 0; i < 3; ++i) way[i] = glm::dot(surface.rows[static_cast<std::size_t>(i)], direction);
  }

  glm::dvec3 at(double t) const { return from + t * way; }

  // The displacement of a point of the ray along each axis.
  glm::dvec3 displacement(double t) const {
    const double way_m = std::abs(t) + seen.distance_m;
    const double placing_m = seen.world_error_m + placing_error_m(way_m, seen.distance_m);
    return seen.row_lengths * (seen.row_errors * way_m + placing_m);
  }
  // By how much it grows per metre of t.
  glm::dvec3 growth() const { return seen.row_lengths * (seen.row_errors + placing_error_m(1, 0)); }
};

// f = sum of weight_i (p_i - middle_i)^2 - square.
struct Quadric {
  glm::dvec3 weight{1}, middle{0};
  double square = 0;
};

// f at a range t0 + s of a ray.
struct RootError {
  const LocalRay& ray;
  const Quadric& quadric;
  glm::dvec3 start;  // p(t0) - middle
  double t0 = 0, a = 0, b = 0;

  double at(double s) const {
    if (!ray.with_bounds || !std::isfinite(s)) return 0;
    const glm::dvec3 w = glm::abs(quadric.weight), point = start + s * ray.way;
    const glm::dvec3 off = ray.displacement(t0 + s) + 2 * kShapeUnit * glm::abs(quadric.middle);
    const double place = 2 * glm::dot(w * glm::abs(point), off) + glm::dot(w * off, off);
    const glm::dvec3 terms = glm::abs(start) + std::abs(s) * glm::abs(ray.way);
    const double change = place + 16 * kShapeUnit * (glm::dot(w * terms, terms) + std::abs(quadric.square));
    const double g = std::abs(a * s + b);
    const double root = std::abs(a) * change <= g * g ? change / g : 2 * std::sqrt(change / std::abs(a));
    return std::min(root, ray.seen.size_m) + 3 * kShapeUnit * std::abs(t0 + s);
  }
};

// Where f <= 0. A steep ray is inside of both halves of a double cone; the second or the first one is taken.
Inside inside_of(const LocalRay& ray, const Quadric& quadric, bool second_half = true) {
  const glm::dvec3 weighted = quadric.weight * ray.way, sizes = glm::abs(quadric.weight) * ray.way;
  const double nearest = glm::dot(sizes, ray.way);
  const double t0 = nearest > 0 ? glm::dot(sizes, quadric.middle - ray.from) / nearest : 0;
  const glm::dvec3 start = ray.from + t0 * ray.way - quadric.middle;
  const double a = glm::dot(weighted, ray.way), b = glm::dot(weighted, start);
  const double c = glm::dot(quadric.weight * start, start) - quadric.square;
  const double discriminant = b * b - a * c;
  if (a >= 0 && discriminant < 0) return kOutside;
  if (a == 0 && b == 0) return c <= 0 ? Inside{} : kOutside;
  // Between the two halves of a cone the discriminant can be negative only by rounding.
  const double root = std::sqrt(std::max(discriminant, 0.0)), q = -(b + std::copysign(root, b));
  const double s = q / a, other = q != 0 ? c / q : 0;
  const double low = std::min(s, other), high = std::max(s, other);
  const RootError error{ray, quadric, start, t0, a, b};
  const Crossing first = crossing_at(t0 + low, error.at(low)), second = crossing_at(t0 + high, error.at(high));
  if (a >= 0) return {first, second};
  return second_half ? Inside{.in = second} : Inside{.out = first};
}

// The height of the ray is off by at most d + |t| g. The plane is therefore met between the ranges of the plane nearer
// by d with a way steeper by g, and of the plane farther by d with a way that is less steep.
Crossing crossing_of_plane(const LocalRay& ray, double z, std::uint32_t face) {
  const double t = (z - ray.from.z) / ray.way.z;
  if (!ray.with_bounds) return {t, t, t, face};
  const double height = std::abs(z - ray.from.z), steepness = std::abs(ray.way.z),
               rounding = 4 * kShapeUnit * std::abs(t);
  const double d = ray.displacement(0).z, g = ray.growth().z;
  const double least = (height - d) / (steepness + g) - rounding;
  const double most = steepness > g ? (height + d) / (steepness - g) + rounding : kNever;
  return t < 0 ? Crossing{t, -most, -least, face} : Crossing{t, least, most, face};
}

// Between the planes z = low and z = high.
Inside between(const LocalRay& ray, double low, double high) {
  if (ray.way.z == 0) return ray.from.z >= low && ray.from.z <= high ? Inside{} : kOutside;
  const Crossing bottom = crossing_of_plane(ray, low, kBottomFace), top = crossing_of_plane(ray, high, kTopFace);
  return ray.way.z > 0 ? Inside{bottom, top} : Inside{top, bottom};
}

Quadric ball(double radius_m, double z) { return {glm::dvec3(1), {0, 0, z}, radius_m * radius_m}; }
Quadric tube(double radius_m) { return {{1, 1, 0}, glm::dvec3(0), radius_m * radius_m}; }

// The square of the radius of a cone over the square of the distance from its tip.
double steepness(const ExactSurface& cone) {
  const double ratio = cone.radius_m / cone.length_m;
  return ratio * ratio;
}

Inside inside_of(const LocalRay& ray, const ExactSurface& shape) {
  const double half = shape.length_m / 2;
  if (shape.kind == SurfaceKind::sphere) {
    return inside_of(ray, Quadric{glm::dvec3(1), ray.seen.middle, shape.radius_m * shape.radius_m});
  }
  if (shape.kind == SurfaceKind::cylinder) {
    return both(inside_of(ray, tube(shape.radius_m)), between(ray, -half, half));
  }
  if (shape.kind == SurfaceKind::capsule) {
    const Inside middle = both(inside_of(ray, tube(shape.radius_m)), between(ray, -half, half));
    const Inside ends = either(inside_of(ray, ball(shape.radius_m, -half)), inside_of(ray, ball(shape.radius_m, half)));
    return either(ends, middle);
  }
  // A ray that goes down is in the lower half of the double cone last.
  const Quadric cone{{1, 1, -steepness(shape)}, {0, 0, half}, 0};
  return both(inside_of(ray, cone, ray.way.z < 0), between(ray, -half, half));
}

// Only a cylinder has a top, and a capsule has no ends of its own.
std::uint32_t face_of(SurfaceKind kind, std::uint32_t face) {
  if (kind == SurfaceKind::capsule) return kRoundFace;
  return kind == SurfaceKind::cone && face == kTopFace ? kRoundFace : face;
}

SurfaceHits hits_of_plane(const LocalRay& ray) {
  SurfaceHits hits;
  const Inside crossed = between(ray, 0, 0);
  const double t = crossed.in.t;
  if (!crossed.any || !(t > 0) || !std::isfinite(t)) return hits;
  const glm::dvec3 point = ray.at(t);
  const glm::dvec2 half = ray.seen.shape->half_size_m;
  if (std::abs(point.x) > half.x || std::abs(point.y) > half.y) return hits;
  hits.at[hits.count++] = {t, ray.with_bounds ? crossed.in.error() : 0, kRoundFace, ray.way.z > 0};
  return hits;
}

// The limits are those of crossing_of_plane(), with the height over the disc in place of the height over a plane.
SurfaceHits hits_of_disc(const LocalRay& ray) {
  SurfaceHits hits;
  const glm::dvec3 &n = ray.seen.normal, &middle = ray.seen.middle;
  const double radius_m = ray.seen.shape->radius_m;
  const double height = glm::dot(n, middle - ray.from), steepness = glm::dot(n, ray.way), t = height / steepness;
  if (!(t > 0) || !std::isfinite(t)) return hits;
  const glm::dvec3 apart = ray.at(t) - middle;
  if (glm::dot(apart, apart) > radius_m * radius_m) return hits;
  SurfaceHit& hit = hits.at[hits.count++];
  hit = {t, 0, kRoundFace, false};
  if (!ray.with_bounds) return hits;
  constexpr double kSums = 6 * kShapeUnit;
  const glm::dvec3 weight = glm::abs(n);
  const double d = glm::dot(weight, ray.displacement(0) + kSums * (glm::abs(middle) + glm::abs(ray.from)));
  const double g = glm::dot(weight, ray.growth() + kSums * glm::abs(ray.way));
  const double up = std::abs(height), steep = std::abs(steepness), rounding = 4 * kShapeUnit * t;
  const double least = (up - d) / (steep + g) - rounding;
  const double most = steep > g ? (up + d) / (steep - g) + rounding : kNever;
  const double displaced = glm::length(ray.displacement(t) + kSums * glm::abs(middle)) / radius_m;
  hit.error_bound_m = std::min(std::max(t - least, most - t), ray.seen.size_m * (1 + displaced) + rounding);
  return hits;
}

// Error of each row of the inverse, with c the columns of the transform: a cross product rounds by 4 u |c_j| |c_k|, the
// determinant by 3 u |c_0| |c_1 x c_2| and by the error of that product, the quotient by 2 u. 6 u more are those of
// p(t): three of the direction's product, one of its rounding, and two of the sum.
bool invert(const glm::dmat3& linear, SeenShape& seen) {
  const double lengths[3] = {glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2])};
  const glm::dvec3 across[3] = {glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                                glm::cross(linear[0], linear[1])};
  const double determinant = glm::dot(linear[0], across[0]);
  double loss = 0, of_determinant = 0;
  for (int i = 0; i < 3; ++i) {
    const double cross_loss = 4 * lengths[(i + 1) % 3] * lengths[(i + 2) % 3] / glm::length(across[i]);
    seen.rows[static_cast<std::size_t>(i)] = across[i] / determinant;
    seen.row_lengths[i] = glm::length(seen.rows[static_cast<std::size_t>(i)]);
    const double stretch = seen.row_lengths[i] * lengths[i];
    if (i == 0) of_determinant = stretch * (3 + cross_loss);
    seen.row_errors[i] = kShapeUnit * (cross_loss + of_determinant + 2 + 6);
    loss += stretch * seen.row_errors[i] / kShapeUnit;
  }
  return loss <= kMaxInverseLoss;
}

double size_of(const ExactSurface& shape, const glm::dmat3& linear) {
  if (shape.kind == SurfaceKind::plane) return kNever;
  const double stretch =
      std::sqrt(glm::dot(linear[0], linear[0]) + glm::dot(linear[1], linear[1]) + glm::dot(linear[2], linear[2]));
  return stretch * (2 * shape.radius_m + shape.length_m);
}

// The angle around the axis in turns, from 0 to 1.
double turns(const glm::dvec3& p) {
  const double turn = std::atan2(p.y, p.x) / (2 * std::numbers::pi);
  return turn < 0 ? turn + 1 : turn;
}

double capsule_v(const ExactSurface& shape, const glm::dvec3& p, int set) {
  const double half = shape.length_m / 2, ends = (1 - kCapsuleSideShare) / 2;
  if (std::abs(p.z) <= half) {
    return set == 1 ? 0.5 - p.z / shape.length_m : 1 - (ends + kCapsuleSideShare * (p.z + half) / shape.length_m);
  }
  const double latitude = std::atan2(std::abs(p.z) - half, std::hypot(p.x, p.y)) / (std::numbers::pi / 2);
  if (set == 1) return capsule_end_v(latitude, p.z > 0);
  const double beyond = ends * latitude;
  return 1 - (p.z > 0 ? ends + kCapsuleSideShare + beyond : ends - beyond);
}

glm::dvec2 uv_of(const ExactSurface& shape, const glm::dvec3& p, std::uint32_t face, int set) {
  if (shape.kind == SurfaceKind::plane) return {0.5 + p.x / shape.drawn_m.x, 0.5 - p.y / shape.drawn_m.y};
  if (shape.kind == SurfaceKind::disc) return {0, 0};  // the point has the coordinates of its vertex
  if (face != kRoundFace) {
    const double up = face == kTopFace ? 1 : -1;
    const double v = set == 1 ? disc_v(p.y / shape.radius_m) : 0.5 - 0.5 * up * p.y / shape.radius_m;
    return {0.5 + 0.5 * p.x / shape.radius_m, v};
  }
  if (shape.kind == SurfaceKind::sphere) {
    return {turns(p), 0.5 - std::atan2(p.z, std::hypot(p.x, p.y)) / std::numbers::pi};
  }
  if (shape.kind == SurfaceKind::capsule) return {turns(p), capsule_v(shape, p, set)};
  return {turns(p), 0.5 - p.z / shape.length_m};
}

// The outward gradient in the frame of the shape, and the weight of the point's coordinates in it.
glm::dvec3 gradient_of(const ExactSurface& shape, const glm::dvec3& p, std::uint32_t face, glm::dvec3& weight) {
  const double half = shape.length_m / 2;
  weight = glm::dvec3(0);
  if (shape.kind == SurfaceKind::plane || face == kTopFace) return {0, 0, 1};
  if (face == kBottomFace) return {0, 0, -1};
  weight = {1, 1, 0};
  if (shape.kind == SurfaceKind::cylinder) return {p.x, p.y, 0};
  if (shape.kind == SurfaceKind::cone) {
    weight.z = steepness(shape);
    const glm::dvec3 gradient(p.x, p.y, weight.z * (half - p.z));
    return gradient == glm::dvec3(0) ? glm::dvec3(0, 0, 1) : gradient;  // the tip
  }
  weight.z = 1;
  const double middle = shape.kind == SurfaceKind::sphere ? 0 : std::clamp(p.z, -half, half);
  if (shape.kind == SurfaceKind::capsule && middle == p.z) weight.z = 0;
  return {p.x, p.y, p.z - middle};
}

}  // namespace

std::optional<SeenShape> see_shape(const ExactSurface& shape, const MeshPlacement& placement, double world_error_m) {
  SeenShape seen;
  seen.shape = &shape;
  // The axes of the mesh in cyclic order, the shape's axis last.
  const glm::dmat3 linear(placement.linear[(shape.axis + 1) % 3], placement.linear[(shape.axis + 2) % 3],
                          placement.linear[shape.axis]);
  if (!invert(linear, seen)) return std::nullopt;
  seen.size_m = size_of(shape, linear);
  return shape_seen_from(seen, placement.offset, world_error_m);
}

SeenShape shape_seen_from(SeenShape seen, const glm::dvec3& offset, double world_error_m) {
  for (int i = 0; i < 3; ++i) seen.from[i] = -glm::dot(seen.rows[static_cast<std::size_t>(i)], offset);
  seen.distance_m = glm::length(offset);
  seen.world_error_m = world_error_m;
  return seen;
}

SurfaceHits intersect(const SeenShape& seen, const glm::dvec3& direction, bool with_bounds) {
  const LocalRay ray(seen, direction, with_bounds);
  if (seen.shape->kind == SurfaceKind::plane) return hits_of_plane(ray);
  if (seen.shape->kind == SurfaceKind::disc) return hits_of_disc(ray);
  SurfaceHits hits;
  const Inside inside = inside_of(ray, *seen.shape);
  if (!inside.any) return hits;
  for (const bool leaves : {false, true}) {
    const Crossing& crossing = leaves ? inside.out : inside.in;
    if (!(crossing.t > 0) || !std::isfinite(crossing.t)) continue;
    const double error_m = with_bounds ? crossing.error() : 0;
    hits.at[hits.count++] = {crossing.t, error_m, face_of(seen.shape->kind, crossing.face), leaves};
  }
  return hits;
}

SurfaceHit find_hit(const SurfaceHits& hits, double range_m, std::uint32_t face) {
  const auto* const end = hits.at.begin() + hits.count;
  const auto* const found = std::find_if(
      hits.at.begin(), end, [&](const SurfaceHit& hit) { return hit.range_m == range_m && hit.face == face; });
  SIMVIS_ASSERT(found != end);
  return *found;
}

ShapePoint shape_point(const SeenShape& seen, const glm::dvec3& direction, const SurfaceHit& hit) {
  const LocalRay ray(seen, direction, true);
  const glm::dvec3 p = ray.at(hit.range_m) - seen.middle;
  glm::dvec3 weight(0);
  const bool is_disc = seen.shape->kind == SurfaceKind::disc;
  const glm::dvec3 gradient = is_disc ? seen.normal : gradient_of(*seen.shape, p, hit.face, weight);
  const glm::dvec3 off = weight * (ray.displacement(hit.range_m) + 2 * kShapeUnit * glm::abs(seen.middle) +
                                   hit.error_bound_m * glm::abs(ray.way));
  glm::dvec3 normal(0);
  double error = 0;
  for (int i = 0; i < 3; ++i) {
    normal += gradient[i] * seen.rows[static_cast<std::size_t>(i)];
    error += seen.row_lengths[i] * (off[i] + seen.row_errors[i] * std::abs(gradient[i]));
  }
  const double length = glm::length(normal);
  // The angle of a vector that is off by less than its length is less than pi / 2 times the share.
  const double turned = error < length ? std::numbers::pi / 2 * error / length : std::numbers::pi;
  return {normal / length, turned};
}

glm::dvec2 shape_uv(const SeenShape& seen, const glm::dvec3& direction, double range_m, std::uint32_t face, int set) {
  return uv_of(*seen.shape, LocalRay(seen, direction, false).at(range_m), face, set);
}

}  // namespace simvis
