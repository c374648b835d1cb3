// Places and visibility of keypoints, which are the frames of all bodies.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "tests/combinations/pixel_rays.h"

namespace simvis::combined {
namespace {

using Place = glm::vec<2, Real>;

// A range that is so many roundings from a limit, and a direction that is so many from an edge, are certain. Each is
// the difference of two places, which both programs round.
constexpr Real kCertain = 8;

/// A point where it is at one time.
struct PointThen {
  Real share = 1;
  Frame eye{};
  Vector at_m{0};       ///< sensor frame
  Real rounding_m = 0;  ///< of at_m
  std::optional<Place> at_px{};
  Real rounding_px = 0;
};

class PointComparison {
 public:
  explicit PointComparison(const Comparison& comparison)
      : with_(comparison), desc_(comparison.desc()), rays_(comparison, 0) {}

  void run() {
    const std::size_t rows = with_.measurement().find("point")->count();
    with_.count("keypoints");
    if (rows != with_.scene.bodies.size()) {
      return with_.fail("keypoints", "rows", Real(rows), Real(with_.scene.bodies.size()), 0);
    }
    for (std::size_t body = 0; body < rows; ++body) compare(body);
  }

 private:
  Real got(const std::string& column, std::size_t body) const { return with_.measurement().find(column)->number(body); }

  void check(const std::string& column, std::size_t body, Real expected, Real allowed) const {
    with_.count("keypoints, " + column);
    const Real value = got(column, body);
    const bool right = std::isnan(expected) ? std::isnan(value) : std::abs(value - expected) <= allowed;
    if (!right) with_.fail("keypoints, " + column, "B" + std::to_string(body), value, expected, allowed);
  }

  PointThen point(std::size_t body, Real share) const {
    PointThen point{.share = share, .eye = rays_.eye(share)};
    point.at_m = glm::transpose(point.eye.turn) * (with_.world.body(body, share).at - point.eye.at);
    point.rounding_m = with_.world.pose_rounding_m(with_.sensor) + kDoubles * glm::length(point.at_m);
    const auto place = [&](const Vector& at_m) { return pixel_of_ray(desc_, ViewRays::optical_of_sensor(at_m)); };
    point.at_px = place(point.at_m);
    if (!point.at_px) return point;
    point.rounding_px = kDoubles * glm::length(*point.at_px);
    for (glm::length_t axis = 0; axis < 3; ++axis) {
      Vector beside = point.at_m;
      beside[axis] += point.rounding_m;
      if (const std::optional<Place> other = place(beside)) {
        point.rounding_px += 2 * glm::distance(*other, *point.at_px);  // of both signs
      }
    }
    return point;
  }

  bool shows(const PointThen& point) const { return combined::shows(desc_, ViewRays::optical_of_sensor(point.at_m)); }

  void compare(std::size_t body) const {
    if (desc_.row_time_s == 0 || with_.frame == 0) return compare(body, point(body, 1));
    // Where the point is while each row is exposed.
    const auto row_of = [&](Real y_px) {
      return static_cast<int>(std::clamp(std::floor(y_px), Real(0), Real(desc_.height_px - 1)));
    };
    std::optional<PointThen> met;
    for (int row = 0; row < desc_.height_px; ++row) {
      const PointThen then = point(body, rays_.share_of_row(row));
      if (!shows(then)) return;
      const Real y_px = then.at_px->y;
      if (row_of(y_px - then.rounding_px) != row_of(y_px + then.rounding_px)) return count_doubtful();
      if (row_of(y_px) != row) continue;
      // It may be in several rows' height at their times; any of these places is right.
      if (!met || std::abs(y_px - got("y_px", body)) < std::abs(met->at_px->y - got("y_px", body))) met = then;
    }
    if (met) return compare(body, *met);
    check("in_picture", body, 0, 0);
    check("visible", body, 0, 0);
  }

  void compare(std::size_t body, const PointThen& point) const {
    check("distance_m", body, glm::length(point.at_m), 2 * point.rounding_m);
    check("x_m", body, point.at_m.x, point.rounding_m);
    check("y_m", body, point.at_m.y, point.rounding_m);
    check("z_m", body, point.at_m.z, point.rounding_m);
    if (!shows(point) && point.at_px) return;
    check("x_px", body, point.at_px ? point.at_px->x : kNone, point.rounding_px);
    check("y_px", body, point.at_px ? point.at_px->y : kNone, point.rounding_px);
    const auto is_within = [&](Real room_px) {
      return point.at_px && point.at_px->x >= -room_px && point.at_px->y >= -room_px &&
             point.at_px->x < desc_.width_px + room_px && point.at_px->y < desc_.height_px + room_px;
    };
    if (is_within(point.rounding_px) != is_within(-point.rounding_px)) return count_doubtful();
    check("in_picture", body, is_within(0) ? 1 : 0, 0);
    const std::optional<bool> visible = is_within(0) ? is_visible(point) : false;
    if (!visible) return count_doubtful();
    check("visible", body, *visible ? 1 : 0, 0);
  }

  /// Whether no surface stands before the point; empty: rounding decides.
  std::optional<bool> is_visible(const PointThen& point) const {
    const Real range = glm::length(point.at_m);
    const Vector direction = point.at_m / range;
    const Real near = rays_.near_m(ViewRays::optical_of_sensor(direction));
    if (std::abs(range - near) < kCertain * point.rounding_m) return std::nullopt;
    if (range < near) return false;
    const auto outcome = [&](const Vector& towards) -> std::optional<bool> {
      const auto hits = rays_.surfaces(point.eye.at, point.eye.turn * towards, point.share);
      const ExactHit first = first_of(with_.scene, hits, rays_.seen(), near);
      const Real free_m = first.range_m - (range - desc_.radius_m);
      if (std::abs(free_m) < kCertain * (point.rounding_m + with_.rounding_m(first))) return std::nullopt;
      return free_m > 0;
    };
    std::optional<bool> visible = outcome(direction);
    const Real spread = kCertain * (point.rounding_m / range + kDoubles);
    const Vector across =
        glm::normalize(glm::cross(direction, std::abs(direction.x) < Real(0.5L) ? Vector(1, 0, 0) : Vector(0, 1, 0)));
    const Vector up = glm::cross(direction, across);
    around(spread, [&](Real dx, Real dy) {
      if (visible && outcome(glm::normalize(direction + dx * across + dy * up)) != visible) visible.reset();
    });
    return visible;
  }

  void count_doubtful() const { ++with_.tally.at_edges; }

  const Comparison& with_;
  const SensorDesc& desc_;
  const ViewRays rays_;
};

}  // namespace

void compare_keypoints(const Comparison& comparison) { PointComparison(comparison).run(); }

}  // namespace simvis::combined
