// Pictures of the sky for tests, and their integrals, written out independently of the library.
#pragma once

#include <cmath>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <string>

#include <simvis/image.h>
#include <simvis/sky_picture.h>
#include "program/output/exr_file.h"
#include "tests/support/reference_directions.h"

namespace simvis::test {

/// The direction of a place in the picture, in pixels from its upper left corner: +x in the middle, +y at a quarter of
/// the width from the left, +z above.
inline glm::dvec3 sky_direction(const SkyPicture& picture, double column, double row) {
  return reference::beam_direction(kPi - 2 * kPi * column / picture.width, kPi / 2 - kPi * row / picture.height);
}

/// A picture with the radiance of a function of the column and the row.
inline SkyPicture sky_picture(std::uint32_t height,
                              const std::function<glm::vec3(std::uint32_t, std::uint32_t)>& radiance) {
  SkyPicture picture{2 * height, height, {}};
  for (std::uint32_t row = 0; row < height; ++row) {
    for (std::uint32_t column = 0; column < picture.width; ++column) {
      picture.radiance.push_back(radiance(column, row));
    }
  }
  return picture;
}

/// The sum over the picture of its radiance times a function of the direction: each pixel in `parts` x `parts` parts.
inline glm::dvec3 sky_integral(const SkyPicture& picture, const std::function<double(const glm::dvec3&)>& weight,
                               std::uint32_t parts = 1) {
  glm::dvec3 sum(0);
  const double wide = 2 * kPi / picture.width / parts, high = kPi / picture.height / parts;
  for (std::uint32_t i = 0; i < parts * picture.height; ++i) {
    const double row = (i + 0.5) / parts, top = kPi / 2 - i * high;
    const double solid_angle = wide * (std::sin(top) - std::sin(top - high));
    for (std::uint32_t k = 0; k < parts * picture.width; ++k) {
      const double column = (k + 0.5) / parts;
      sum += solid_angle * weight(sky_direction(picture, column, row)) *
             glm::dvec3(picture.radiance[std::size_t{i / parts} * picture.width + k / parts]);
    }
  }
  return sum;
}

/// The bytes of an EXR.
inline std::string sky_exr(const SkyPicture& picture) {
  Image image{.width = picture.width, .height = picture.height, .channels = 4, .pixels = {}};
  std::vector<float>& pixels = image.pixels.overwrite();
  for (const glm::vec3& seen : picture.radiance) pixels.insert(pixels.end(), {seen.r, seen.g, seen.b, 1});
  return encode_exr(&image, nullptr, {});
}

}  // namespace simvis::test
