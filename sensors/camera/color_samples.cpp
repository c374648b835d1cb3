#include "sensors/camera/color_samples.h"

#include <cmath>
#include <numbers>
#include <numeric>

#include "engine/base/assert.h"
#include "engine/base/even_points.h"

namespace simvis {
namespace {

// A step through n samples that visits all of them, close to n times the golden section.
std::uint32_t spread_step(std::uint32_t n) {
  auto step = static_cast<std::uint32_t>(std::lround(n / std::numbers::phi));
  while (std::gcd(step, n) != 1) ++step;
  return step;
}

std::vector<ColorSample> times_and_points(const ColorExposure& exposure) {
  const std::uint32_t n = exposure.samples, step = spread_step(n);
  std::vector<ColorSample> samples;
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t part = static_cast<std::uint32_t>(std::uint64_t{i} * step % n);
    samples.push_back(
        {.time_s = -exposure.time_s * (part + 0.5) / n, .lens_m = exposure.aperture_m * even_point_of_disc(i, n)});
  }
  return samples;
}

// Colours of equal magnification share a picture.
std::vector<ColorSample> in_each_color(const std::vector<ColorSample>& samples, const glm::dvec3& magnification) {
  std::vector<ColorSample> pictures;
  for (const ColorSample& sample : samples) {
    const std::size_t first = pictures.size();
    for (int c = 0; c < 3; ++c) {
      std::size_t i = first;
      while (i < pictures.size() && pictures[i].magnification != magnification[c]) ++i;
      if (i == pictures.size()) {
        pictures.push_back(sample);
        pictures[i].magnification = magnification[c];
        pictures[i].colors = {};
      }
      pictures[i].colors[static_cast<std::size_t>(c)] = true;
    }
  }
  return pictures;
}

}  // namespace

std::vector<ColorSample> color_samples(const ColorExposure& exposure) {
  const bool at_once = exposure.samples == 1 && exposure.time_s == 0 && exposure.aperture_m == 0;
  return at_once ? still_samples(exposure) : in_each_color(times_and_points(exposure), exposure.magnification);
}

std::vector<ColorSample> still_samples(const ColorExposure& exposure) {
  return in_each_color({{}}, exposure.magnification);
}

Pinhole pinhole_of(const ColorSample& sample, const Pinhole& pinhole, double focus_m) {
  Pinhole seen = pinhole;
  seen.fx_px *= sample.magnification;
  seen.fy_px *= sample.magnification;
  seen.cx_px += seen.fx_px * sample.lens_m.x / focus_m;
  seen.cy_px += seen.fy_px * sample.lens_m.y / focus_m;
  return seen;
}

void ColorMean::add(const Image& picture, const std::array<bool, 3>& colors) {
  if (counts_.back() == 0) sum_.assign(picture.pixels.size(), 0);
  SIMVIS_ASSERT(sum_.size() == picture.pixels.size() && picture.channels == counts_.size());
  for (std::size_t c = 0; c < counts_.size(); ++c) {
    if (c < colors.size() && !colors[c]) continue;
    ++counts_[c];
    for (std::size_t i = c; i < sum_.size(); i += counts_.size()) sum_[i] += static_cast<double>(picture.pixels[i]);
  }
}

void ColorMean::finish(Image& image) const {
  SIMVIS_ASSERT(image.pixels.size() == sum_.size() && image.channels == counts_.size());
  std::vector<float>& pixels = image.pixels.edit();
  for (std::size_t c = 0; c < counts_.size(); ++c) {
    SIMVIS_ASSERT(counts_[c] > 0);
    for (std::size_t i = c; i < sum_.size(); i += counts_.size()) pixels[i] = static_cast<float>(sum_[i] / counts_[c]);
  }
}

}  // namespace simvis
