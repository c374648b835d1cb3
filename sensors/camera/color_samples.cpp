#include "sensors/camera/color_samples.h"

#include <cmath>
#include <numbers>
#include <numeric>

#include "engine/base/assert.h"

namespace simvis {
namespace {

// A step through n samples that visits all of them, close to n times the golden section.
std::uint32_t spread_step(std::uint32_t n) {
  auto step = static_cast<std::uint32_t>(std::lround(n / std::numbers::phi));
  while (std::gcd(step, n) != 1) ++step;
  return step;
}

}  // namespace

std::vector<ColorSample> color_samples(const ColorExposure& exposure) {
  if (exposure.instant()) return {{}};
  const std::uint32_t n = exposure.samples, step = spread_step(n);
  const double turn = 2 * std::numbers::pi / (std::numbers::phi * std::numbers::phi);
  std::vector<ColorSample> samples;
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t part = static_cast<std::uint32_t>(std::uint64_t{i} * step % n);
    const double radius_m = exposure.aperture_m * std::sqrt((i + 0.5) / n), angle = turn * i;
    samples.push_back({.time_s = -exposure.time_s * (part + 0.5) / n,
                       .lens_m = {radius_m * std::cos(angle), radius_m * std::sin(angle)}});
  }
  return samples;
}

Pinhole sheared(const Pinhole& pinhole, const glm::dvec2& lens_m, double focus_m) {
  Pinhole moved = pinhole;
  moved.cx_px += pinhole.fx_px * lens_m.x / focus_m;
  moved.cy_px += pinhole.fy_px * lens_m.y / focus_m;
  return moved;
}

void ColorMean::add(const Image& picture) {
  if (count_ == 0) sum_.assign(picture.pixels.size(), 0);
  SIMVIS_ASSERT(sum_.size() == picture.pixels.size());
  for (std::size_t i = 0; i < sum_.size(); ++i) sum_[i] += static_cast<double>(picture.pixels[i]);
  ++count_;
}

void ColorMean::finish(Image& image) const {
  SIMVIS_ASSERT(count_ > 0 && image.pixels.size() == sum_.size());
  std::vector<float>& pixels = image.pixels.edit();
  for (std::size_t i = 0; i < sum_.size(); ++i) pixels[i] = static_cast<float>(sum_[i] / count_);
}

}  // namespace simvis
