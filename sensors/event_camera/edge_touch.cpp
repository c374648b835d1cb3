#include "sensors/event_camera/edge_touch.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

namespace simvis {
namespace {

constexpr double kHalfPixel = 0.5;

// The larger of the gaps between bounds and the square in x and in y; below 0 they overlap.
double gap_beside(const glm::dvec2& low, const glm::dvec2& high) {
  return std::max({low.x, low.y, -high.x, -high.y}) - kHalfPixel;
}

// The gap between points and the square along a direction of any length, in pixels; below 0 they overlap.
double gap_along(const glm::dvec2& direction, std::initializer_list<glm::dvec2> points) {
  const double length = glm::length(direction);
  if (length == 0) return -INFINITY;
  double low = INFINITY, high = -INFINITY;
  for (const glm::dvec2& point : points) {
    low = std::min(low, glm::dot(direction, point));
    high = std::max(high, glm::dot(direction, point));
  }
  const double square = kHalfPixel * (std::abs(direction.x) + std::abs(direction.y));
  return (std::max(low, -high) - square) / length;
}

glm::dvec2 across(const glm::dvec2& way) { return {-way.y, way.x}; }

}  // namespace

EdgeTouch::EdgeTouch(const Pinhole& pinhole, double near_m, std::uint32_t column, std::uint32_t row)
    : pinhole_(pinhole),
      near_m_(near_m),
      centre_px_(column + kHalfPixel - pinhole.cx_px, row + kHalfPixel - pinhole.cy_px) {}

std::optional<EdgeTouch::Seen> EdgeTouch::seen(const Ends& ends) const {
  if (ends[0].z < near_m_ || ends[1].z < near_m_) return std::nullopt;
  const auto place = [&](const glm::dvec3& end) {
    return glm::dvec2(pinhole_.fx_px * end.x / end.z, pinhole_.fy_px * end.y / end.z) - centre_px_;
  };
  return Seen{place(ends[0]), place(ends[1])};
}

double EdgeTouch::depth_px(const Ends& ends) const {
  const std::optional<Seen> edge = seen(ends);
  if (!edge) return -INFINITY;
  const auto& [a, b] = *edge;
  return -std::max(gap_beside(glm::min(a, b), glm::max(a, b)), gap_along(across(b - a), {a, b}));
}

// A place that is moved by d leaves its image by less than f d (1 + (|x| + |y|) / z) / (z - d).
double EdgeTouch::sag_px(const Ends& begin, const Ends& end, double sag_m) const {
  if (sag_m == 0) return 0;
  double nearest_m = INFINITY, aside_m = 0;
  for (const Ends* const ends : {&begin, &end}) {
    for (const glm::dvec3& each : *ends) {
      nearest_m = std::min(nearest_m, each.z);
      aside_m = std::max(aside_m, std::abs(each.x) + std::abs(each.y));
    }
  }
  if (nearest_m <= sag_m) return INFINITY;
  return std::max(pinhole_.fx_px, pinhole_.fy_px) * sag_m * (1 + aside_m / nearest_m) / (nearest_m - sag_m);
}

bool EdgeTouch::stays_out(const Ends& begin, const Ends& end, double sag_m) const {
  const std::optional<Seen> first = seen(begin), last = seen(end);
  if (!first || !last) return true;
  const auto& [a, b] = *first;
  const auto& [c, d] = *last;
  const double enough_px = sag_px(begin, end, sag_m) - kTouch_px;
  const glm::dvec2 low = glm::min(glm::min(a, b), glm::min(c, d)), high = glm::max(glm::max(a, b), glm::max(c, d));
  if (gap_beside(low, high) >= enough_px) return true;
  for (const glm::dvec2& direction : {across(b - a), across(d - c), across(c - a), across(d - b)}) {
    if (gap_along(direction, {a, b, c, d}) >= enough_px) return true;
  }
  return false;
}

std::optional<double> EdgeTouch::deepest(const std::function<Ends(double)>& ends, double acceleration_m, double begin,
                                         double end) const {
  const Ends at_begin = ends(begin), at_end = ends(end);
  if (depth_px(at_begin) > kTouch_px || depth_px(at_end) > kTouch_px) return std::nullopt;
  // The first time at which it is in the square, by halves.
  const auto search = [&](const auto& self, double from, const Ends& at_from, double to,
                          const Ends& at_to) -> std::optional<std::pair<double, double>> {
    const double sag_m = acceleration_m * (to - from) * (to - from) / 8;
    if (stays_out(at_from, at_to, sag_m)) return std::nullopt;
    const double middle = (from + to) / 2;
    const Ends at_middle = ends(middle);
    if (depth_px(at_middle) > kTouch_px) return std::pair(from, to);
    const std::optional<Seen> first = seen(at_from), last = seen(at_to);
    const double way_px = std::max(glm::length(last->a - first->a), glm::length(last->b - first->b));
    if (way_px + 2 * sag_px(at_from, at_to, sag_m) <= kTouch_px || middle <= from || middle >= to) return std::nullopt;
    const auto found = self(self, from, at_from, middle, at_middle);
    return found ? found : self(self, middle, at_middle, to, at_to);
  };
  const auto touch = search(search, begin, at_begin, end, at_end);
  if (!touch) return std::nullopt;
  // It is outside at both ends of this time and inside in its middle.
  constexpr int kSteps = 24;
  constexpr double kGolden = 0.6180339887498949;
  auto [low, high] = *touch;
  for (int i = 0; i < kSteps; ++i) {
    const double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
    if (depth_px(ends(left)) < depth_px(ends(right))) {
      low = left;
    } else {
      high = right;
    }
  }
  return (low + high) / 2;
}

}  // namespace simvis
