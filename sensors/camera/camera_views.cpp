#include "sensors/camera/camera_views.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace simvis {

namespace {

// Every Vulkan device can render to targets of this size.
constexpr std::uint32_t kMaxSide = 4096;

// F from V for views along the axes; the rows are the axes of F in V.
glm::dmat3 rows(const glm::dvec3& x, const glm::dvec3& y, const glm::dvec3& z) {
  return glm::transpose(glm::dmat3(x, y, z));
}

constexpr std::size_t kFaces = 6;
const std::array<glm::dmat3, kFaces> kCube{
    rows({1, 0, 0}, {0, 1, 0}, {0, 0, 1}),  rows({0, 0, -1}, {0, 1, 0}, {1, 0, 0}),
    rows({0, 0, 1}, {0, 1, 0}, {-1, 0, 0}), rows({1, 0, 0}, {0, 0, -1}, {0, 1, 0}),
    rows({1, 0, 0}, {0, 0, 1}, {0, -1, 0}), rows({-1, 0, 0}, {0, 1, 0}, {0, 0, -1})};

// The cube face whose axis is nearest to the ray.
std::size_t face_of(const glm::dvec3& ray) {
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < kFaces; ++i) {
    if ((kCube[i] * ray).z > (kCube[nearest] * ray).z) nearest = i;
  }
  return nearest;
}

glm::dvec2 tangents(const glm::dmat3& face_from_view, const glm::dvec3& ray) {
  const glm::dvec3 seen = face_from_view * ray;
  return glm::dvec2(seen) / seen.z;
}

struct Extent {
  glm::dvec2 least{std::numeric_limits<double>::infinity()}, most{-std::numeric_limits<double>::infinity()};

  void add(const glm::dvec2& point) {
    least = glm::min(least, point);
    most = glm::max(most, point);
  }
  bool empty() const { return least.x > most.x; }
};

class Resampling {
 public:
  explicit Resampling(const CameraLayout& layout)
      : layout_(layout),
        focal_px_(layout.oversampling * glm::dvec2(layout.pinhole.fx_px, layout.pinhole.fy_px)),
        one_view_(fits_one_view()) {
    made_.taps.resize(layout.rays.size());
  }

  // Adds the views of the rows [first, last), at the pose of this time.
  void add_rows(std::uint32_t first, std::uint32_t last, double time_s) {
    std::array<Extent, kFaces> extents;
    for_rays(first, last, [&](std::size_t, std::size_t face, const glm::dvec2& at) { extents[face].add(at); });
    std::array<std::uint32_t, kFaces> view_of{};
    for (std::size_t face = 0; face < kFaces; ++face) {
      if (extents[face].empty()) continue;
      view_of[face] = static_cast<std::uint32_t>(made_.views.size());
      made_.views.push_back(view_around(extents[face]));
      CameraView& view = made_.views.back();
      view.face_from_view = kCube[face];
      view.first_row = first;
      view.rows = last - first;
      view.time_s = time_s;
    }
    for_rays(first, last, [&](std::size_t pixel, std::size_t face, const glm::dvec2& at) {
      const Pinhole& p = made_.views[view_of[face]].pinhole;
      made_.taps[pixel] = {view_of[face], p.cx_px + p.fx_px * at.x, p.cy_px + p.fy_px * at.y};
    });
  }

  // Packs the views side by side, in rows, into as few passes as possible.
  CameraViews packed(std::uint32_t supersampling) {
    glm::uvec2 next(0);
    std::uint32_t row_height = 0;
    const std::uint32_t limit = kMaxSide / supersampling;
    for (CameraView& view : made_.views) {
      if (next.x > 0 && next.x + view.width_px > limit) {
        next = {0, next.y + row_height};
        row_height = 0;
      }
      if (made_.pass_size_px.empty() || (next != glm::uvec2(0) && next.y + view.height_px > limit)) {
        made_.pass_size_px.emplace_back(0);
        next = glm::uvec2(0);
        row_height = 0;
      }
      view.pass = made_.pass_size_px.size() - 1;
      view.x_px = next.x;
      view.y_px = next.y;
      next.x += view.width_px;
      row_height = std::max(row_height, view.height_px);
      glm::uvec2& size = made_.pass_size_px.back();
      size = glm::max(size, glm::uvec2(next.x, next.y + row_height));
    }
    return std::move(made_);
  }

 private:
  bool fits_one_view() const {
    Extent extent;
    for (const glm::dvec3& ray : layout_.rays) {
      if (ray == glm::dvec3(0)) continue;
      if (ray.z <= 0) return false;
      extent.add(tangents(kCube[0], ray));
    }
    if (extent.empty()) return true;
    const glm::dvec2 size = (extent.most - extent.least) * focal_px_ / layout_.oversampling;
    return size.x * size.y <= kMaxSpread * layout_.width_px * layout_.height_px;
  }

  template <typename Action>
  void for_rays(std::uint32_t first, std::uint32_t last, const Action& action) const {
    const std::size_t end = std::size_t{last} * layout_.width_px;
    for (std::size_t pixel = std::size_t{first} * layout_.width_px; pixel < end; ++pixel) {
      const glm::dvec3& ray = layout_.rays[pixel];
      if (ray == glm::dvec3(0)) continue;
      const std::size_t face = one_view_ ? 0 : face_of(ray);
      action(pixel, face, tangents(kCube[face], ray));
    }
  }

  // The pixels of the view have the same offset from the optical axis as the image's: without distortion and
  // oversampling they are the same pixels.
  CameraView view_around(const Extent& extent) const {
    const auto along = [&](double least, double most, double focal, double image_centre, double& centre) {
      const double fraction = image_centre - std::floor(image_centre);
      centre = kPixelsBefore - std::floor(focal * least + fraction - 0.5) + fraction;
      if (focal * least + centre - 0.5 < kPixelsBefore) centre += 1;  // the two sums round differently
      return static_cast<std::uint32_t>(std::floor(focal * most + centre - 0.5)) + kPixelsAfter + 1;
    };
    CameraView view;
    Pinhole& p = view.pinhole;
    p.fx_px = focal_px_.x;
    p.fy_px = focal_px_.y;
    view.width_px = along(extent.least.x, extent.most.x, p.fx_px, layout_.pinhole.cx_px, p.cx_px);
    view.height_px = along(extent.least.y, extent.most.y, p.fy_px, layout_.pinhole.cy_px, p.cy_px);
    return view;
  }

  const CameraLayout& layout_;
  glm::dvec2 focal_px_;
  bool one_view_;
  CameraViews made_;
};

void add_direct(const CameraLayout& layout, std::uint32_t first, std::uint32_t last, double time_s, CameraViews& made) {
  CameraView view;
  view.pinhole = layout.pinhole;
  view.pinhole.cy_px -= first;
  view.y_px = first;
  view.width_px = layout.width_px;
  view.height_px = last - first;
  view.first_row = first;
  view.rows = last - first;
  view.time_s = time_s;
  made.views.push_back(view);
}

// Calls add(first, last, time_s) for each group of rows that share a pose.
template <typename Add>
void for_groups(const CameraLayout& layout, const Add& add) {
  const std::uint32_t height = layout.height_px;
  const std::uint32_t step = layout.row_time_s == 0 ? height : layout.rows_per_pose;
  for (std::uint32_t first = 0; first < height; first += std::min(step, height - first)) {
    const std::uint32_t last = first + std::min(step, height - first);
    add(first, last, ((first + last - 1) / 2.0 - (height - 1)) * layout.row_time_s);
  }
}

}  // namespace

BeamTap beam_tap(const PixelTap& tap, const Pinhole& pinhole) {
  const double x = tap.x_px - 0.5, y = tap.y_px - 0.5;
  BeamTap beam;
  beam.x = static_cast<std::uint32_t>(x);
  beam.y = static_cast<std::uint32_t>(y);
  beam.fraction_x = x - beam.x;
  beam.fraction_y = y - beam.y;
  beam.tangent_x = (tap.x_px - pinhole.cx_px) / pinhole.fx_px;
  beam.tangent_y = (tap.y_px - pinhole.cy_px) / pinhole.fy_px;
  beam.ray_per_depth = std::sqrt(1 + beam.tangent_x * beam.tangent_x + beam.tangent_y * beam.tangent_y);
  return beam;
}

CameraViews camera_views(const CameraLayout& layout, std::uint32_t supersampling) {
  if (layout.rays.empty()) {
    CameraViews made;
    made.pass_size_px.emplace_back(layout.width_px, layout.height_px);
    for_groups(layout, [&](auto... group) { add_direct(layout, group..., made); });
    return made;
  }
  Resampling resampling(layout);
  for_groups(layout, [&](auto... group) { resampling.add_rows(group...); });
  return resampling.packed(supersampling);
}

}  // namespace simvis
