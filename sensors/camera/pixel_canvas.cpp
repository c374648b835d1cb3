#include "sensors/camera/pixel_canvas.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace simvis {
namespace {

constexpr int kTile_px = 32;

// Covers the rounding of the cosines of a tile's cone.
constexpr double kConeRounding_rad = 1e-7;

/// The lens of a layout with rays.
std::optional<Lens> lens_of_rays(const CameraLayout& layout) {
  if (layout.rays.empty()) return std::nullopt;
  return lens_of(layout.pinhole, layout.distortion_model, layout.distortion_coefficients);
}

}  // namespace

PixelCanvas::PixelCanvas(const CameraLayout& layout, const CameraViews& views, double near_m)
    : layout_(layout),
      views_(views),
      near_m_(near_m),
      width_(static_cast<int>(layout.width_px)),
      height_(static_cast<int>(layout.height_px)),
      canvas_{-width_, -height_, 2 * width_, 2 * height_},
      is_flat_(std::ranges::all_of(views.views,
                                   [](const CameraView& view) { return view.face_from_view == glm::dmat3(1.0); })),
      lens_(lens_of_rays(layout)) {
  if (!layout.rays.empty() && !lens_) canvas_ = picture();
  // Tiles do not cross the border of the picture, which directions are computed differently beyond.
  const auto steps = [](int begin, int middle, int last, int end) {
    std::vector<int> all;
    for (const auto& [from, to] : {std::pair(begin, middle), {middle, last}, {last, end}}) {
      for (int at = from; at < to; at += kTile_px) all.push_back(at);
    }
    all.push_back(end);
    return all;
  };
  const std::vector<int> xs = steps(canvas_.x_begin, 0, width_, canvas_.x_end),
                         ys = steps(canvas_.y_begin, 0, height_, canvas_.y_end);
  for (std::size_t row = 0; row + 1 < ys.size(); ++row) {
    for (std::size_t column = 0; column + 1 < xs.size(); ++column) {
      add_tile({xs[column], ys[row], xs[column + 1], ys[row + 1]});
    }
  }
}

glm::dvec3 PixelCanvas::direction(int x, int y) const {
  if (!layout_.rays.empty() && picture().has(x, y)) {
    return layout_.rays[static_cast<std::size_t>(y) * layout_.width_px + static_cast<std::size_t>(x)];
  }
  const glm::dvec2 centre(x + 0.5, y + 0.5);
  if (lens_) return lens_->direction(centre).value_or(glm::dvec3(0));
  const Pinhole& p = layout_.pinhole;
  return glm::normalize(glm::dvec3((centre.x - p.cx_px) / p.fx_px, (centre.y - p.cy_px) / p.fy_px, 1));
}

// A lens has no view of what lies beyond the picture. If all views of the picture look along the optical axis, so does
// that of what lies beyond, as far as it is before the camera. Otherwise the faces of a cube stand for it, as the views
// of a wide lens do.
double PixelCanvas::near_range_m(int x, int y, const glm::dvec3& direction) const {
  if (layout_.rays.empty() || (is_flat_ && direction.z > 0)) return near_m_ / direction.z;
  if (picture().has(x, y)) {
    const std::size_t pixel = static_cast<std::size_t>(y) * layout_.width_px + static_cast<std::size_t>(x);
    const std::uint32_t view = views_.taps[pixel].view;
    if (view != PixelTap::kNone) return near_m_ / (views_.views[view].face_from_view * direction).z;
  }
  return near_m_ / std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
}

// Projected points of a hull in front of the pinhole lie in the hull of the projected points. One pixel more covers all
// rounding.
CanvasRect PixelCanvas::around(std::span<const glm::dvec3> points) const {
  if (!layout_.rays.empty()) return canvas_;
  const Pinhole& p = layout_.pinhole;
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const glm::dvec3& point : points) {
    if (point.z <= 0) return canvas_;
    const glm::dvec2 pixel(p.cx_px + p.fx_px * point.x / point.z, p.cy_px + p.fy_px * point.y / point.z);
    low = glm::min(low, pixel);
    high = glm::max(high, pixel);
  }
  const auto within = [](double at, int begin, int end) {
    return static_cast<int>(std::clamp(at, static_cast<double>(begin), static_cast<double>(end)));
  };
  return {within(std::floor(low.x) - 1, canvas_.x_begin, canvas_.x_end),
          within(std::floor(low.y) - 1, canvas_.y_begin, canvas_.y_end),
          within(std::ceil(high.x) + 1, canvas_.x_begin, canvas_.x_end),
          within(std::ceil(high.y) + 1, canvas_.y_begin, canvas_.y_end)};
}

// A cone around the directions of the border contains those inside. Where some pixels of the border see nothing, the
// others do not enclose the tile, and every object may be in it.
void PixelCanvas::add_tile(const CanvasRect& pixels) {
  std::vector<glm::dvec3> border;
  std::size_t blind = 0;
  const auto add = [&](int x, int y) {
    const glm::dvec3 each = direction(x, y);
    each == glm::dvec3(0) ? static_cast<void>(++blind) : border.push_back(each);
  };
  for (int x = pixels.x_begin; x < pixels.x_end; ++x) {
    add(x, pixels.y_begin);
    add(x, pixels.y_end - 1);
  }
  for (int y = pixels.y_begin; y < pixels.y_end; ++y) {
    add(pixels.x_begin, y);
    add(pixels.x_end - 1, y);
  }
  glm::dvec3 sum(0);
  for (const glm::dvec3& each : border) sum += each;
  Tile tile{.pixels = pixels, .angle_rad = std::numbers::pi};
  if (blind == 0 && glm::length(sum) > 0) {
    tile.axis = glm::normalize(sum);
    double least = 1;
    for (const glm::dvec3& each : border) least = std::min(least, glm::dot(each, tile.axis));
    tile.angle_rad = std::acos(std::clamp(least, -1.0, 1.0)) + kConeRounding_rad;
  }
  tiles_.push_back(tile);
}

}  // namespace simvis
