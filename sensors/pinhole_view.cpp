#include "sensors/pinhole_view.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace simvis {

namespace {

void resize(Image& image, const View& view, std::uint32_t channels) {
  image.width = view.width_px;
  image.height = view.height_px;
  image.channels = channels;
  image.pixels.resize(std::size_t{view.width_px} * view.height_px * channels);
}

std::size_t first_of_row(const Pass& pass, const View& view, std::uint32_t row) {
  return std::size_t{view.y_px + row} * pass.width_px + view.x_px;
}

}  // namespace

Pinhole centred_pinhole(std::uint32_t width_px, std::uint32_t height_px, double hfov_rad) {
  const double focal_px = width_px / (2 * std::tan(hfov_rad / 2));
  return {focal_px, focal_px, width_px / 2.0, height_px / 2.0};
}

void take_color(const Pass& pass, const View& view, const PassResult& result, Image& image) {
  resize(image, view, 4);
  for (std::uint32_t row = 0; row < view.height_px; ++row) {
    const auto seen = result.color.subspan(first_of_row(pass, view, row), view.width_px);
    std::memcpy(image.pixels.data() + std::size_t{row} * view.width_px * 4, seen.data(), seen.size_bytes());
  }
}

void take_depth(const Pass& pass, const View& view, const PassResult& result, Image& image) {
  resize(image, view, 1);
  for (std::uint32_t row = 0; row < view.height_px; ++row) {
    const auto seen = result.depth.subspan(first_of_row(pass, view, row), view.width_px);
    std::ranges::transform(seen, image.pixels.begin() + std::ptrdiff_t{row} * view.width_px,
                           [near_m = view.near_m](float d) {
                             return d > 0 ? static_cast<float>(near_m / d) : std::numeric_limits<float>::infinity();
                           });
  }
}

}  // namespace simvis
