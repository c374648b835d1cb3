#include "tests/combinations/exact_world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace simvis::combined {
namespace {

constexpr Real kPi = std::numbers::pi_v<Real>;

Matrix turn_about(const Vector& axis, Real angle) {
  const Vector u = glm::normalize(axis);
  const Real c = std::cos(angle), s = std::sin(angle), v = 1 - c;
  Matrix m(0);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) m[column][row] = v * u[row] * u[column] + (row == column ? c : Real(0));
  }
  m[0][1] += s * u.z;
  m[0][2] -= s * u.y;
  m[1][0] -= s * u.z;
  m[1][2] += s * u.x;
  m[2][0] += s * u.y;
  m[2][1] -= s * u.x;
  return m;
}

// The screw of a rigid motion: the turn's axis and angle from its matrix, and
// the line of points that move along it.
Twisting screw_of(const Frame& frame) {
  const Matrix& r = frame.turn;
  const Vector twice(r[1][2] - r[2][1], r[2][0] - r[0][2],
                     r[0][1] - r[1][0]);  // 2 sin(angle) axis
  const Real sine = glm::length(twice) / 2, cosine = (r[0][0] + r[1][1] + r[2][2] - 1) / 2;
  Twisting screw;
  screw.angle = std::atan2(sine, cosine);
  if (screw.angle < 1e-12L) {
    screw.angle = 0;
    screw.shift = frame.at;
    return screw;
  }
  screw.axis = glm::normalize(twice);
  screw.way = glm::dot(screw.axis, frame.at);
  const Vector across = frame.at - screw.way * screw.axis;
  screw.point = Real(0.5) * (across + glm::cross(screw.axis, across) / std::tan(screw.angle / 2));
  return screw;
}

Frame along(const Twisting& screw, Real share) {
  if (screw.angle == 0) return {Matrix(1), share * screw.shift};
  const Matrix turn = turn_about(screw.axis, share * screw.angle);
  return {turn, screw.point - turn * screw.point + share * screw.way * screw.axis};
}

/// The surfaces of a shape along a ray in its frame, from + range way.
class ShapeHits {
 public:
  ShapeHits(const Body& body, const Vector& from, const Vector& way, std::vector<ExactHit>& hits)
      : body_(body), from_(from), way_(way), hits_(hits) {}

  void find() {
    const Real radius = body_.radius_m, half = Real(body_.length_m) / 2;
    const auto inside = [&](const Vector& p) { return std::abs(p.z) <= half; };
    switch (body_.kind) {
      case ShapeKind::box:
        for (int axis = 0; axis < 3; ++axis) rectangle(axis);
        break;
      case ShapeKind::plane:
        flat({0, 0, 0}, {0, 0, 1}, 0, [&](const Vector& p) {
          return std::abs(p.x) <= Real(body_.size_m.x) / 2 && std::abs(p.y) <= Real(body_.size_m.y) / 2;
        });
        break;
      case ShapeKind::sphere:
        quadric({1, 1, 1}, Vector(0), radius * radius, 0, [](const Vector&) { return true; });
        break;
      case ShapeKind::cylinder:
        quadric({1, 1, 0}, Vector(0), radius * radius, 0, inside);
        disc(-half, 1);
        disc(half, 2);
        break;
      case ShapeKind::cone: {
        const Real slope = radius / (2 * half);
        quadric({1, 1, -slope * slope}, {0, 0, half}, 0, 0, inside);
        disc(-half, 1);
        break;
      }
      case ShapeKind::capsule:
        quadric({1, 1, 0}, Vector(0), radius * radius, 0, inside);
        quadric({1, 1, 1}, {0, 0, half}, radius * radius, 0, [&](const Vector& p) { return p.z > half; });
        quadric({1, 1, 1}, {0, 0, -half}, radius * radius, 0, [&](const Vector& p) { return p.z < -half; });
        break;
      case ShapeKind::triangles:
        for (std::size_t i = 0; i < body_.triangles.size(); ++i) {
          const auto& [a, b, c] = body_.triangles[i];
          triangle({Vector(a), Vector(b), Vector(c)}, static_cast<int>(i));
        }
        break;
      case ShapeKind::heights:
        heights();
        break;
      case ShapeKind::balls:
      case ShapeKind::discs:
        for (std::size_t i = 0; i < body_.points.size(); ++i) point(body_.points[i], static_cast<int>(i));
        break;
      case ShapeKind::splats:
        break;
    }
  }

 private:
  void add(Real range, int face, const Vector& normal) {
    if (!(range > 0)) return;
    hits_.push_back({.range_m = range, .face = face, .normal = normal, .in_shape = from_ + range * way_});
  }

  template <class OnFace>
  void flat(const Vector& point, const Vector& normal, int face, const OnFace& on_face) {
    const Real steepness = glm::dot(normal, way_);
    if (steepness == 0) return;
    const Real range = glm::dot(normal, point - from_) / steepness;
    if (on_face(from_ + range * way_)) add(range, face, normal);
  }

  void rectangle(int axis) {
    const Vector half = Vector(body_.size_m) / Real(2);
    for (const int side : {-1, 1}) {
      Vector normal(0);
      normal[axis] = side;
      flat(half * normal, normal, 2 * axis + (side + 1) / 2, [&](const Vector& p) {
        const int i = (axis + 1) % 3, k = (axis + 2) % 3;
        return std::abs(p[i]) <= half[i] && std::abs(p[k]) <= half[k];
      });
    }
  }

  void disc(Real height, int face) {
    const Real radius = body_.radius_m;
    flat({0, 0, height}, {0, 0, 1}, face, [&](const Vector& p) { return p.x * p.x + p.y * p.y <= radius * radius; });
  }

  // w . (p - centre)^2 = square, from the point of the ray that is nearest to
  // the centre.
  template <class OnFace>
  void quadric(const Vector& w, const Vector& centre, Real square, int face, const OnFace& on_face) {
    const Real nearest = glm::dot(centre - from_, way_) / glm::dot(way_, way_);
    const Vector foot = from_ + nearest * way_ - centre;
    const Real a = glm::dot(w * way_, way_), b = glm::dot(w * way_, foot), c = glm::dot(w * foot, foot) - square;
    const Real discriminant = b * b - a * c;
    if (a == 0 || discriminant < 0) return;
    const Real q = -(b + std::copysign(std::sqrt(discriminant), b));
    const Real roots[] = {q / a, q == 0 ? Real(0) : c / q};
    for (const Real root : roots) {
      const Vector p = from_ + (nearest + root) * way_;
      if (on_face(p)) add(nearest + root, face, glm::normalize(w * (p - centre)));
    }
  }

  void point(const CloudPoint& point, int face) {
    const Vector centre(point.at_m);
    const Real square = Real(body_.radius_m) * Real(body_.radius_m);
    if (body_.kind == ShapeKind::balls)
      return quadric({1, 1, 1}, centre, square, face, [](const Vector&) { return true; });
    // The normal is rounded to float32 once.
    const Vector normal(glm::vec3(point.normal / glm::length(point.normal)));
    flat(centre, glm::normalize(normal), face,
         [&](const Vector& p) { return glm::dot(p - centre, p - centre) <= square; });
  }

  // Every triangle of the cells above which the ray is: of each column of cells those rows that it crosses, and one
  // more on each side.
  void heights() {
    const Heights& h = body_.heights;
    const Real cell_x = Real(body_.size_m.x) / (h.columns - 1), cell_y = Real(body_.size_m.y) / (h.rows - 1);
    const auto corner = [&](int column, int row) {
      const Real code = h.codes[static_cast<std::size_t>(row * h.columns + column)];
      return Vector((column - (h.columns - 1) / Real(2)) * cell_x, ((h.rows - 1) / Real(2) - row) * cell_y,
                    Real(h.low_m) + code / 65535 * (Real(h.high_m) - Real(h.low_m)));
    };
    for (int column = 0; column + 1 < h.columns; ++column) {
      const auto [first, last] = rows_under_ray(corner(column, 0).x, corner(column + 1, 0).x, cell_y);
      for (int row = first; row <= last; ++row) {
        const Vector a = corner(column, row), b = corner(column, row + 1), c = corner(column + 1, row + 1);
        const int face = 2 * (row * (h.columns - 1) + column);
        triangle({a, b, c}, face);
        triangle({a, c, corner(column + 1, row)}, face + 1);
      }
    }
  }

  std::pair<int, int> rows_under_ray(Real low_x, Real high_x, Real cell_y) const {
    const int rows = body_.heights.rows;
    const Real pad = high_x - low_x;  // of one cell, far above the rounding
    Real first = 0, last = std::numeric_limits<Real>::max();
    if (way_.x == 0) {
      if (from_.x < low_x - pad || from_.x > high_x + pad) return {0, -1};
    } else {
      const Real a = (low_x - from_.x) / way_.x, b = (high_x - from_.x) / way_.x;
      first = std::max(first, std::min(a, b));
      last = std::max(a, b);
    }
    if (last < first) return {0, -1};
    const auto row_at = [&](Real range) {
      const Real row = (rows - 1) / Real(2) - (from_.y + range * way_.y) / cell_y;
      return static_cast<int>(std::floor(std::clamp(row, Real(-2), Real(rows + 2))));
    };
    const auto [low, high] = std::minmax({row_at(first), row_at(last)});
    return {std::max(low - 1, 0), std::min(high + 1, rows - 2)};
  }

  void triangle(const std::array<Vector, 3>& corners, int face) {
    const Vector a = corners[0], ab = corners[1] - a, ac = corners[2] - a;
    const Vector across = glm::cross(way_, ac);
    const Real determinant = glm::dot(ab, across);
    if (determinant == 0) return;
    const Vector to = from_ - a;
    const Real u = glm::dot(to, across) / determinant;
    const Vector q = glm::cross(to, ab);
    const Real v = glm::dot(way_, q) / determinant;
    if (u < 0 || v < 0 || u + v > 1) return;
    add(glm::dot(ac, q) / determinant, face, glm::normalize(glm::cross(ab, ac)));
  }

  const Body& body_;
  const Vector &from_, &way_;
  std::vector<ExactHit>& hits_;
};

using Vector2 = glm::vec<2, Real>;

Vector2 distorted(const SensorDesc& camera, const Vector2& tangents) {
  const auto& k = camera.lens_k;
  const Real x = tangents.x, y = tangents.y, r2 = x * x + y * y;
  const Real s = 1 + r2 * (Real(k[0]) + r2 * (Real(k[1]) + r2 * Real(k[2])));
  return {x * s + 2 * Real(k[3]) * x * y + Real(k[4]) * (r2 + 2 * x * x),
          y * s + Real(k[3]) * (r2 + 2 * y * y) + 2 * Real(k[4]) * x * y};
}

Real fisheye_radius(const SensorDesc& camera, Real theta) {
  const auto& k = camera.lens_k;
  const Real t2 = theta * theta;
  return theta * (1 + t2 * (Real(k[0]) + t2 * (Real(k[1]) + t2 * (Real(k[2]) + t2 * Real(k[3])))));
}

constexpr Real kFisheyeLimit_rad = 110 * kPi / 180;

}  // namespace

Frame frame_of(const Place& place) {
  const auto radians = [&](std::size_t i) { return Real(place.number[i]) * kPi / 180; };
  return {turn_about({0, 0, 1}, radians(5)) * turn_about({0, 1, 0}, radians(4)) * turn_about({1, 0, 0}, radians(3)),
          {place.number[0], place.number[1], place.number[2]}};
}

namespace {

Frame frame_of_joint(const Body& body, Real value) {
  const Vector axis = glm::normalize(Vector(body.axis));
  return body.slides ? Frame{Matrix(1), value * axis} : Frame{turn_about(axis, value * kPi / 180), Vector(0)};
}

}  // namespace

Frame operator*(const Frame& parent, const Frame& child) {
  return {parent.turn * child.turn, parent.turn * child.at + parent.at};
}

Frame inverse(const Frame& frame) {
  const Matrix turn = glm::transpose(frame.turn);
  return {turn, -(turn * frame.at)};
}

Frame world_from_body(const CombinedScene& scene, int body, std::size_t frame) {
  if (body == kNoParent) return frame_of(scene.frame);
  const Body& each = scene.bodies[static_cast<std::size_t>(body)];
  Frame result = world_from_body(scene, each.parent, frame) * frame_of(each.offset);
  if (each.moves) result = result * frame_of(each.move[frame]);
  return each.has_joint ? result * frame_of_joint(each, each.joint[frame]) : result;
}

ExactWorld::ExactWorld(const CombinedScene& scene, std::size_t frame)
    : scene_(scene), before_(frame == 0 ? 0 : frame - 1), now_(frame) {}

const std::vector<Frame>& ExactWorld::places(Real share) const {
  const auto [found, is_new] = places_.try_emplace(share);
  std::vector<Frame>& places = found->second;
  if (!is_new) return places;
  const Frame frame = frame_of(scene_.frame);
  for (const Body& each : scene_.bodies) {  // parents come first
    places.push_back(
        place(each, each.parent == kNoParent ? frame : places[static_cast<std::size_t>(each.parent)], share));
  }
  return places;
}

Frame ExactWorld::place(const Body& body, const Frame& parent, Real share) const {
  Frame result = parent * frame_of(body.offset);
  if (body.moves) {
    const Frame before = frame_of(body.move[before_]), now = frame_of(body.move[now_]);
    result = result * (share == 1 ? now : before * along(screw_of(inverse(before) * now), share));
  }
  if (!body.has_joint) return result;
  return result * frame_of_joint(body, body.joint[before_] + share * (Real(body.joint[now_]) - body.joint[before_]));
}

Frame ExactWorld::sensor(std::size_t index, Real share) const {
  const SensorDesc& sensor = scene_.sensors[index];
  const Frame parent =
      sensor.parent == kNoParent ? frame_of(scene_.frame) : body(static_cast<std::size_t>(sensor.parent), share);
  return parent * frame_of(sensor.offset);
}

Frame ExactWorld::body(std::size_t index, Real share) const { return places(share)[index]; }

std::vector<ExactHit> ExactWorld::hits(const Vector& origin, const Vector& direction, Real share) const {
  std::vector<ExactHit> all;
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    const Frame place = body(i, share);
    const Matrix body_from_world = glm::transpose(place.turn);
    const Vector scale(scene_.bodies[i].scale);
    const Vector from = body_from_world * (origin - place.at) / scale, way = body_from_world * direction / scale;
    const std::size_t first = all.size();
    ShapeHits(scene_.bodies[i], from, way, all).find();
    for (std::size_t k = first; k < all.size(); ++k) {
      all[k].body = static_cast<int>(i);
      const Vector normal = glm::normalize(place.turn * (all[k].normal / scale));
      const Real facing = glm::dot(normal, direction);
      all[k].normal = facing > 0 ? -normal : normal;
      all[k].cosine = std::abs(facing);
      all[k].from_behind = facing > 0;
    }
  }
  std::ranges::sort(all, {}, &ExactHit::range_m);
  return all;
}

namespace {

// The standard deviations of a splat as its file has them: logarithms in float32, read as float32.
Vector sigma_of(const test::FileSplat& splat) {
  Vector sigma;
  for (int i = 0; i < 3; ++i) sigma[i] = std::exp(static_cast<float>(std::log(splat.sigma_m[i])));
  return sigma;
}

Matrix turn_of(const glm::dvec4& quaternion) {
  const glm::vec<4, Real> q = glm::normalize(glm::vec<4, Real>(quaternion));
  const Real x = q.x, y = q.y, z = q.z, w = q.w;
  return {Vector(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)),
          Vector(2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)),
          Vector(2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))};
}

glm::mat<2, 2, Real> slope_of_distortion(const SensorDesc& camera, const Vector2& tangents) {
  constexpr Real kStep = 1e-6L;
  const Vector2 here = distorted(camera, tangents);
  return {(distorted(camera, tangents + Vector2(kStep, 0)) - here) / kStep,
          (distorted(camera, tangents + Vector2(0, kStep)) - here) / kStep};
}

// Newton, along with the place from the middle outwards. The slopes are differences, which lead to the last digits in
// the end. Empty: the place lies behind a fold of the distortion, beyond which a lens shows nothing.
std::optional<Vector2> undistorted(const SensorDesc& camera, const Vector2& place) {
  constexpr int kParts = 8, kRough = 3, kFine = 8, kLooks = 16;
  Vector2 tangents(0);
  for (int part = 1; part <= kParts; ++part) {
    const Vector2 goal = place * (Real(part) / kParts);
    for (int i = 0; i < (part < kParts ? kRough : kFine); ++i) {
      tangents += glm::inverse(slope_of_distortion(camera, tangents)) * (goal - distorted(camera, tangents));
    }
  }
  constexpr Real kFound = 1e-12L;  // far above the rounding of long double
  if (!(glm::length(distorted(camera, tangents) - place) < kFound)) return std::nullopt;
  for (int look = 1; look <= kLooks; ++look) {
    if (!(glm::determinant(slope_of_distortion(camera, tangents * (Real(look) / kLooks))) > 0)) return std::nullopt;
  }
  return tangents;
}

}  // namespace

std::vector<SplatHit> ExactWorld::splats(const Vector& origin, const Vector& direction, Real share) const {
  std::vector<SplatHit> all;
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    const Body& body = scene_.bodies[i];
    if (body.splats.empty()) continue;
    const Frame place = places(share)[i];
    const Matrix body_from_world = glm::transpose(place.turn);
    const Vector scale(body.scale);
    const Vector from = body_from_world * (origin - place.at) / scale, way = body_from_world * direction / scale;
    for (std::size_t k = 0; k < body.splats.size(); ++k) {
      const test::FileSplat& splat = body.splats[k];
      const Vector sigma = sigma_of(splat);
      const Matrix splat_from_body = glm::transpose(turn_of(splat.rotation));
      // In standard deviations from the centre.
      const Vector start = splat_from_body * (from - Vector(splat.center_m)) / sigma,
                   along = splat_from_body * way / sigma;
      SplatHit seen;
      seen.hit.range_m = -glm::dot(start, along) / glm::dot(along, along);
      const Vector nearest = start + seen.hit.range_m * along;
      seen.alpha = std::min(Real(splat.opacity) * std::exp(-glm::dot(nearest, nearest) / 2), Real(0.99L));
      if (seen.alpha < (1 - kSplatShare) / 255 || !(seen.hit.range_m > 0)) continue;
      seen.hit.body = static_cast<int>(i);
      seen.hit.face = static_cast<int>(k);
      // Two roundings of a standard deviation and one of the turn, of up to ten times the smallest one, move the place
      // by at most 3.4 deviations (alpha is above 1/255) times both.
      seen.hit.rounding_m = Real(3.4L) * (4 + 2 * 10) * 0x1p-24L * std::max({sigma.x, sigma.y, sigma.z}) *
                            std::max({scale.x, scale.y, scale.z});
      all.push_back(seen);
    }
  }
  std::ranges::sort(all, {}, [](const SplatHit& each) { return each.hit.range_m; });
  return all;
}

Vector ExactWorld::way_per_frame(std::size_t body, const Vector& point) const {
  // The mean by one screw from its pose in the world to the next.
  const Frame before = this->body(body, 0), now = this->body(body, 1);
  const Twisting screw = screw_of(inverse(before) * now);
  const Matrix& turn = before.turn;
  if (screw.angle == 0) return turn * screw.shift;
  const Vector from_axis = point - (turn * screw.point + before.at), axis = turn * screw.axis;
  return screw.angle * glm::cross(axis, from_axis) + screw.way * axis;
}

Vector ExactWorld::turn_per_frame(std::size_t body) const {
  const Frame before = this->body(body, 0), now = this->body(body, 1);
  const Twisting screw = screw_of(inverse(before) * now);
  return screw.angle * (before.turn * screw.axis);
}

Real ExactWorld::pose_rounding_m(std::size_t sensor) const {
  Real largest = glm::length(this->sensor(sensor, 1).at);
  for (const Frame& each : places(1)) largest = std::max(largest, glm::length(each.at));
  // Products of up to sixteen rigid frames, four roundings each, of positions
  // and of turns over ten metres.
  return 64 * 0x1p-53L * (largest + 10);
}

double focal_px(const SensorDesc& camera) {
  return camera.width_px / 2.0 / std::tan(camera.hfov_deg / 2 * std::numbers::pi / 180);
}

std::optional<Vector> ray_of_pixel(const SensorDesc& camera, Real x_px, Real y_px) {
  const Real focal = camera.width_px / Real(2) / std::tan(Real(camera.hfov_deg) / 2 * kPi / 180);
  const Vector2 target((x_px - camera.width_px / Real(2)) / focal, (y_px - camera.height_px / Real(2)) / focal);
  if (camera.lens == "kannala_brandt") {
    Real low = 0, high = 2;
    const Real radius = glm::length(target);
    for (int i = 0; i < 70; ++i) {
      const Real theta = (low + high) / 2;
      (fisheye_radius(camera, theta) < radius ? low : high) = theta;
    }
    if (low > kFisheyeLimit_rad) return std::nullopt;
    return radius == 0 ? Vector(0, 0, 1) : Vector(target / radius * std::sin(low), std::cos(low));
  }
  const std::optional<Vector2> tangents =
      camera.lens == "brown_conrady" ? undistorted(camera, target) : std::optional(target);
  return tangents ? std::optional(glm::normalize(Vector(*tangents, 1))) : std::nullopt;
}

std::optional<Vector2> pixel_of_ray(const SensorDesc& camera, const Vector& ray) {
  const Real focal = camera.width_px / Real(2) / std::tan(Real(camera.hfov_deg) / 2 * kPi / 180);
  const Vector2 middle(camera.width_px / Real(2), camera.height_px / Real(2));
  if (camera.lens == "kannala_brandt") {
    const Real across = std::hypot(ray.x, ray.y), theta = std::atan2(across, ray.z);
    if (theta > kFisheyeLimit_rad) return std::nullopt;
    if (across == 0) return middle;
    return middle + focal * fisheye_radius(camera, theta) / across * Vector2(ray);
  }
  if (!(ray.z > 0)) return std::nullopt;
  const Vector2 tangents(ray.x / ray.z, ray.y / ray.z);
  return middle + focal * (camera.lens == "brown_conrady" ? distorted(camera, tangents) : tangents);
}

}  // namespace simvis::combined
