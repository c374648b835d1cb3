// Directions of a picture of the sky, distributed as its light.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include <simvis/sky_picture.h>
#include "engine/draw/sky_sphere.h"

namespace simvis {

/// Frames  that of the picture, see SkyPicture.
class SkySampler {
 public:
  explicit SkySampler(std::shared_ptr<const SkyPicture> picture);

  const std::shared_ptr<const SkyPicture>& picture() const { return picture_; }
  glm::dvec3 radiance(const glm::dvec3& direction) const;
  /// Whether any pixel shines.
  bool shines() const { return sums_.back() > 0; }
  /// A direction with the density of density(), for three numbers in [0, 1): a pixel by its luminance and its solid
  /// angle, and a point of the pixel by the solid angle. The picture shines.
  glm::dvec3 sample(const glm::dvec3& random) const;
  /// Per steradian.
  double density(const glm::dvec3& direction) const;

 private:
  std::size_t pixel_of(const glm::dvec3& direction) const;

  std::shared_ptr<const SkyPicture> picture_;
  SkySphere sphere_;
  std::vector<double> sums_;  // of luminance x solid angle, of all pixels up to this one
};

/// The sampler of this picture that lives in the process, else a new one: simulations of one sky share its sums.
/// Threads  any; samplers are only read.
std::shared_ptr<const SkySampler> shared_sky_sampler(const std::shared_ptr<const SkyPicture>& picture);

}  // namespace simvis
