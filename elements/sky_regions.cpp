#include "elements/sky_regions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/draw/luminance.h"
#include "engine/draw/sky_sphere.h"

namespace simvis {
namespace {

struct Rect {
  std::uint32_t left, top, right, bottom;  // right and bottom are one past the end
  double light = 0;                        // integral of the luminance

  std::uint32_t columns() const { return right - left; }
  std::uint32_t rows() const { return bottom - top; }
  bool can_be_cut() const { return light > 0 && (columns() > 1 || rows() > 1); }
};

class SkyCutter {
 public:
  explicit SkyCutter(const SkyPicture& picture) : picture_(picture), sphere_(picture) {}

  Rect whole() const {
    Rect all{0, 0, picture_.width, picture_.height};
    for (const double light : lights(all, false)) all.light += light;
    return all;
  }

  // Cuts off and returns the right or lower part.
  Rect cut(Rect& rect) const {
    const double middle_rad = (sphere_.elevation_rad(rect.top) + sphere_.elevation_rad(rect.bottom)) / 2;
    const double wide = 2 * std::cos(middle_rad) * rect.columns() / picture_.width,
                 high = static_cast<double>(rect.rows()) / picture_.height;
    const bool across_columns = rect.rows() == 1 || (rect.columns() > 1 && wide >= high);
    const std::vector<double> parts = lights(rect, across_columns);
    std::size_t first = 1;  // of the part that is cut off
    double before = parts[0];
    while (first + 1 < parts.size() &&
           std::abs(before + parts[first] - rect.light / 2) < std::abs(before - rect.light / 2)) {
      before += parts[first++];
    }
    Rect other = rect;
    (across_columns ? other.left : other.top) += static_cast<std::uint32_t>(first);
    (across_columns ? rect.right : rect.bottom) = across_columns ? other.left : other.top;
    rect.light = before;
    other.light = 0;
    for (std::size_t i = first; i < parts.size(); ++i) other.light += parts[i];
    return other;
  }

  SkyRegion region(const Rect& rect) const {
    SkyRegion region;
    glm::dvec3 towards(0);
    for (std::uint32_t row = rect.top; row < rect.bottom; ++row) {
      glm::dvec3 sum(0);
      for (std::uint32_t column = rect.left; column < rect.right; ++column) {
        const glm::dvec3 seen = radiance(column, row);
        sum += seen;
        towards += luminance(seen) * sphere_.direction_integral(column, row);
      }
      region.irradiance += sphere_.solid_angle_sr(row) * sum;
    }
    if (glm::length(towards) > 0) region.towards = glm::normalize(towards);
    return region;
  }

 private:
  glm::dvec3 radiance(std::uint32_t column, std::uint32_t row) const {
    return glm::dvec3(picture_.radiance[std::size_t{row} * picture_.width + column]);
  }

  // Integrals of the luminance over the columns or the rows of a region.
  std::vector<double> lights(const Rect& rect, bool of_columns) const {
    std::vector<double> lights(of_columns ? rect.columns() : rect.rows());
    for (std::uint32_t row = rect.top; row < rect.bottom; ++row) {
      for (std::uint32_t column = rect.left; column < rect.right; ++column) {
        lights[of_columns ? column - rect.left : row - rect.top] +=
            sphere_.solid_angle_sr(row) * luminance(radiance(column, row));
      }
    }
    return lights;
  }

  const SkyPicture& picture_;
  SkySphere sphere_;
};

}  // namespace

std::vector<SkyRegion> cut_sky(const SkyPicture& picture, std::uint32_t most) {
  const SkyCutter cutter(picture);
  std::vector<Rect> rects{cutter.whole()};
  const auto less_to_cut = [](const Rect& a, const Rect& b) {
    return (a.can_be_cut() ? a.light : -1) < (b.can_be_cut() ? b.light : -1);
  };
  while (rects.size() < most) {
    const auto next = std::ranges::max_element(rects, less_to_cut);
    if (!next->can_be_cut()) break;
    const Rect other = cutter.cut(*next);
    if (next->light <= 0) {
      *next = other;  // without its black part
    } else if (other.light > 0) {
      rects.push_back(other);
    }
  }
  std::vector<SkyRegion> regions;
  regions.reserve(rects.size());
  for (const Rect& rect : rects) regions.push_back(cutter.region(rect));
  return regions;
}

}  // namespace simvis
