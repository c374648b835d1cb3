#include "engine/light/sky_sampler.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <unordered_map>
#include <utility>

#include "engine/draw/luminance.h"

namespace simvis {

SkySampler::SkySampler(std::shared_ptr<const SkyPicture> picture) : picture_(std::move(picture)), sphere_(*picture_) {
  sums_.reserve(picture_->radiance.size());
  double sum = 0;
  for (std::uint32_t row = 0; row < picture_->height; ++row) {
    for (std::uint32_t column = 0; column < picture_->width; ++column) {
      const glm::dvec3 radiance(picture_->radiance[std::size_t{row} * picture_->width + column]);
      sum += luminance(radiance) * sphere_.solid_angle_sr(row);
      sums_.push_back(sum);
    }
  }
}

// As shaders/sky.frag.
std::size_t SkySampler::pixel_of(const glm::dvec3& direction) const {
  const double azimuth = std::atan2(direction.y, direction.x),
               elevation = std::atan2(direction.z, std::hypot(direction.x, direction.y));
  const auto pixel = [](double share, std::uint32_t count) {
    return static_cast<std::size_t>(std::clamp(std::floor(share * count), 0.0, count - 1.0));
  };
  const std::size_t column = pixel(0.5 - azimuth / (2 * std::numbers::pi), picture_->width);
  return pixel(0.5 - elevation / std::numbers::pi, picture_->height) * picture_->width + column;
}

glm::dvec3 SkySampler::radiance(const glm::dvec3& direction) const {
  return glm::dvec3(picture_->radiance[pixel_of(direction)]);
}

glm::dvec3 SkySampler::sample(const glm::dvec3& random) const {
  const auto chosen = std::ranges::upper_bound(sums_, random.z * sums_.back());
  const std::size_t pixel = std::min(static_cast<std::size_t>(chosen - sums_.begin()), sums_.size() - 1);
  const std::size_t row_of_pixel = pixel / picture_->width;
  const auto column = static_cast<double>(pixel % picture_->width), row = static_cast<double>(row_of_pixel);
  const double azimuth = glm::mix(sphere_.azimuth_rad(column), sphere_.azimuth_rad(column + 1), random.x);
  const double sine =
      glm::mix(std::sin(sphere_.elevation_rad(row)), std::sin(sphere_.elevation_rad(row + 1)), random.y);
  const double across = std::sqrt(std::max(0.0, 1 - sine * sine));
  return {across * std::cos(azimuth), across * std::sin(azimuth), sine};
}

double SkySampler::density(const glm::dvec3& direction) const {
  const glm::dvec3 radiance = this->radiance(direction);
  return shines() ? luminance(radiance) / sums_.back() : 0;
}

// A sampler keeps its picture, so that the address of a picture names no other one while the sampler lives.
std::shared_ptr<const SkySampler> shared_sky_sampler(const std::shared_ptr<const SkyPicture>& picture) {
  static std::mutex mutex;
  static std::unordered_map<const SkyPicture*, std::weak_ptr<const SkySampler>> samplers;
  const std::lock_guard lock(mutex);
  std::erase_if(samplers, [](const auto& entry) { return entry.second.expired(); });
  std::weak_ptr<const SkySampler>& known = samplers[picture.get()];
  std::shared_ptr<const SkySampler> sampler = known.lock();
  if (!sampler) known = sampler = std::make_shared<const SkySampler>(picture);
  return sampler;
}

}  // namespace simvis
