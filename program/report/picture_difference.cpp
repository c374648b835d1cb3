#include "program/report/picture_difference.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/assert.h"

namespace simvis {

namespace {

/// A mask over the pixels of a view.
struct PixelMask {
  int width = 0, height = 0;
  std::vector<char> set;

  bool at(int x, int y) const {
    return x >= 0 && y >= 0 && x < width && y < height &&
           set[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] != 0;
  }
};

bool differ(float a, float b, double share) {
  return std::abs(static_cast<double>(a) - static_cast<double>(b)) > share * static_cast<double>(std::max(a, b));
}

/// The pixels that have a silhouette between them and the pixel to their right or below them.
PixelMask silhouettes(const ComparedView& view) {
  PixelMask mask{static_cast<int>(view.width_px), static_cast<int>(view.height_px), {}};
  mask.set.resize(view.depth.size());
  for (std::size_t i = 0; i < view.depth.size(); ++i) {
    const bool last_column = (i + 1) % view.width_px == 0, last_row = i + view.width_px >= view.depth.size();
    mask.set[i] = (!last_column && differ(view.depth[i], view.depth[i + 1], kSilhouetteStep)) ||
                  (!last_row && differ(view.depth[i], view.depth[i + view.width_px], kSilhouetteStep));
  }
  return mask;
}

/// From a pixel to the nearest one of the mask, at most kFarSilhouette_px.
double distance_px(const PixelMask& mask, int x, int y) {
  double nearest = kFarSilhouette_px;
  for (int reach = 0; reach < nearest; ++reach) {  // squares around the pixel, one after the other
    for (int step = -reach; step <= reach; ++step) {
      if (mask.at(x + step, y - reach) || mask.at(x + step, y + reach) || mask.at(x - reach, y + step) ||
          mask.at(x + reach, y + step)) {
        nearest = std::min(nearest, std::hypot(reach, step));
      }
    }
  }
  return nearest;
}

void add_distances(const PixelMask& from, const PixelMask& to, std::vector<double>& distances_px) {
  for (int y = 0; y < from.height; ++y) {
    for (int x = 0; x < from.width; ++x) {
      if (from.at(x, y)) distances_px.push_back(distance_px(to, x, y));
    }
  }
}

void compare_silhouettes(const ComparedView& a, const ComparedView& b, PictureDifference& result) {
  const PixelMask in_a = silhouettes(a), in_b = silhouettes(b);
  std::vector<double> distances_px;
  add_distances(in_a, in_b, distances_px);
  add_distances(in_b, in_a, distances_px);
  if (distances_px.empty()) return;
  std::ranges::sort(distances_px);
  result.silhouette_largest_px = distances_px.back();
  result.silhouette_p99_px = distances_px[(distances_px.size() - 1) * 99 / 100];
}

}  // namespace

PictureDifference difference(const ComparedView& a, const ComparedView& b) {
  const std::size_t pixels = std::size_t{a.width_px} * a.height_px;
  SIMVIS_ASSERT(pixels > 0 && a.width_px == b.width_px && a.height_px == b.height_px);
  SIMVIS_ASSERT(a.color.size() == pixels && b.color.size() == pixels);
  SIMVIS_ASSERT(a.depth.size() == pixels && b.depth.size() == pixels);
  PictureDifference result;
  double squares = 0, others = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    const glm::dvec3 change = glm::dvec3(a.color[i]) - glm::dvec3(b.color[i]);
    squares += glm::dot(change, change);
    others += differ(a.depth[i], b.depth[i], kOtherSurface);
  }
  const auto count = static_cast<double>(pixels);
  result.rms_color = std::sqrt(squares / (3 * count));
  result.other_surface_share = others / count;
  compare_silhouettes(a, b, result);
  return result;
}

}  // namespace simvis
