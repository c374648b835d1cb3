#include "sensors/camera/depth_error_bound.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace simvis {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Relative error of w from rounding Z to float32.
constexpr double kStored = 0x1p-24;

// The largest share of its slope that a smooth curved surface may lose from one pixel to the next; steps and poles lose
// more.
constexpr double kSmooth = 0.5;

// w = 1 / Z of an image, 0 where nothing is hit and outside it.
class InverseDepth {
 public:
  explicit InverseDepth(const Image& depth) : width_(depth.width), height_(depth.height), w_(depth.pixels.size()) {
    std::ranges::transform(depth.pixels, w_.begin(), [](float z) { return 1 / static_cast<double>(z); });
  }

  double at(std::int64_t x, std::int64_t y) const {
    const bool inside = x >= 0 && y >= 0 && x < width_ && y < height_;
    return inside ? w_[static_cast<std::size_t>(y * width_ + x)] : 0;
  }

  // The largest difference to a neighbour along (dx, dy).
  double step(std::int64_t x, std::int64_t y, std::int64_t dx, std::int64_t dy) const {
    double largest = 0;
    for (const double neighbour : {at(x - dx, y - dy), at(x + dx, y + dy)}) {
      if (neighbour != 0) largest = std::max(largest, std::abs(neighbour - at(x, y)));
    }
    return largest;
  }

  // Whether (x, y) and its four neighbours may show one convex shape, no two points of which are farther apart than
  // size_m: w is then concave in the image, but for a second difference of at most `rounding`.
  bool may_be_inside(std::int64_t x, std::int64_t y, double size_m, double rounding) const {
    const double w = at(x, y);
    const auto is_near = [&](double other) { return other > 0 && std::abs(1 / other - 1 / w) <= size_m; };
    for (const auto& [dx, dy] : {std::pair{1, 0}, {0, 1}}) {
      const double before = at(x - dx, y - dy), after = at(x + dx, y + dy);
      if (!is_near(before) || !is_near(after) || before - 2 * w + after > rounding) return false;
    }
    return true;
  }

  // The steepest slope of w per pixel along (dx, dy), over the lines of three pixels that contain (x, y) and whose
  // second difference is at most `straight`. If there is none, the steepest slope over lines that bend smoothly; if
  // there is none either, 0. In a convex shape, where no line is straight, it is at least the steps to both neighbours.
  double slope(std::int64_t x, std::int64_t y, std::int64_t dx, std::int64_t dy, double straight,
               bool in_convex_shape) const {
    double of_straight = -1, of_smooth = in_convex_shape ? step(x, y, dx, dy) : 0;
    for (int first = -2; first <= 0; ++first) {
      const double a = at(x + first * dx, y + first * dy), b = at(x + (first + 1) * dx, y + (first + 1) * dy),
                   c = at(x + (first + 2) * dx, y + (first + 2) * dy);
      if (a == 0 || b == 0 || c == 0) continue;
      const double steepest = std::max(std::abs(b - a), std::abs(c - b)), bend = std::abs(a - 2 * b + c);
      if (bend <= straight) of_straight = std::max(of_straight, steepest);
      if (bend <= kSmooth * steepest) of_smooth = std::max(of_smooth, steepest);
    }
    return of_straight >= 0 ? of_straight : of_smooth;
  }

 private:
  std::int64_t width_, height_;
  std::vector<double> w_;
};

double pixel_bound(const InverseDepth& image, std::int64_t x, std::int64_t y, const DepthView& view) {
  const double w = image.at(x, y);
  if (w == 0) return 0;
  const Pinhole& k = view.pinhole;
  const double tx = std::abs((static_cast<double>(x) + 0.5 - k.cx_px) / k.fx_px);
  const double ty = std::abs((static_cast<double>(y) + 0.5 - k.cy_px) / k.fy_px);
  const double range_m = std::sqrt(1 + tx * tx + ty * ty) / w;
  const double displacement_m = view.rounding.at(range_m);
  // |m| <= w + |mx| (1 + |tx|) + |my| (1 + |ty|) with mx = gx fx and my = gy fy, so dw <= flat + rx |gx| + ry |gy|. The
  // slopes are each off by 2 dw; the divisor accounts for that.
  const PlaneRounding rounding(view.reach);
  const double flat = w * displacement_m * w + (rounding.per_w + kStored) * w;
  const double rx = w * displacement_m * k.fx_px * (1 + tx) + rounding.per_gx;
  const double ry = w * displacement_m * k.fy_px * (1 + ty) + rounding.per_gy;
  const double divisor = 1 - 2 * (rx + ry);
  if (!(divisor > 0)) return kInfinity;
  // The steps to the neighbours include the surface's own slopes; its second difference is at most four dw.
  const double straight = 4 * (flat + rx * image.step(x, y, 1, 0) + ry * image.step(x, y, 0, 1)) / divisor;
  const double deviation_m = view.deviation.at(range_m);
  const bool in_shape = deviation_m > 0 && image.may_be_inside(x, y, view.deviation.size_at(range_m), straight);
  const double gx = image.slope(x, y, 1, 0, straight, in_shape), gy = image.slope(x, y, 0, 1, straight, in_shape);
  double dw = (flat + rx * gx + ry * gy) / divisor;
  if (deviation_m > 0) {
    const double steepness = w + k.fx_px * (gx + 2 * dw) * (1 + tx) + k.fy_px * (gy + 2 * dw) * (1 + ty);
    dw += change_of_inverse_depth(w, deviation_m, steepness);
  }
  return dw < w ? dw / (w * (w - dw)) : kInfinity;
}

}  // namespace

DepthView depth_view(const View& view, const DrawList& list) {
  return {.pinhole = view.pinhole,
          .rounding = VertexRounding(list, view.view_from_world),
          .reach = raster_reach(view, 0),
          .deviation = ShapeDeviation(list, view)};
}

std::vector<double> depth_error_bounds(const Image& depth, const DepthView& view) {
  const InverseDepth image(depth);
  std::vector<double> bounds_m;
  bounds_m.reserve(depth.pixels.size());
  for (std::uint32_t y = 0; y < depth.height; ++y) {
    for (std::uint32_t x = 0; x < depth.width; ++x) {
      bounds_m.push_back(image.at(x, y) == 0 ? kInfinity : pixel_bound(image, x, y, view));
    }
  }
  return bounds_m;
}

double depth_error_bound(const Image& depth, const DepthView& view, std::span<const std::uint32_t> others) {
  const InverseDepth image(depth);
  double bound_m = 0;
  auto other = others.begin();
  for (std::uint32_t y = 0; y < depth.height; ++y) {
    for (std::uint32_t x = 0; x < depth.width; ++x) {
      if (other != others.end() && *other == y * depth.width + x) {
        ++other;
      } else {
        bound_m = std::max(bound_m, pixel_bound(image, x, y, view));
      }
    }
  }
  return bound_m;
}

}  // namespace simvis
