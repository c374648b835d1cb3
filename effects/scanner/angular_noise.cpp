#include "effects/scanner/angular_noise.h"

#include <algorithm>
#include <cmath>

namespace simvis {
namespace {

constexpr AttributeSpec kAngularNoiseAttributes[] = {
    {.name = "angular_noise",
     .default_value = "0",
     .unit = "deg",
     .text = "standard deviation of azimuth and of elevation",
     .min = 0,
     .max = 90},
};

std::unique_ptr<ScanEffect> create_angular_noise(const ScanEffectContext& context) {
  const double deviation_deg = context.attributes.number("angular_noise");
  if (deviation_deg == 0) return nullptr;
  return std::make_unique<AngularNoise>(glm::radians(deviation_deg), context.random("angular_noise"));
}

const ScanEffectRegistration kAngularNoiseRegistration(
    {.type = {.name = "angular_noise",
              .summary = "Beams leave at angles with Gaussian noise.",
              .notes = "The scan reports the nominal angles.",
              .source = "attribute angular_noise above 0",
              .outputs = kShownInRanges,
              .reference = "moments of the normal distribution",
              .needs = kCastsBeams,
              .attributes = kAngularNoiseAttributes},
     .order = ScanOrder::direction,
     .create = create_angular_noise});

}  // namespace

void AngularNoise::aim(const ScanContext& context, std::vector<BeamRay>& rays) const {
  for (BeamRay& ray : rays) {
    const glm::dvec3& d = ray.direction;
    const double azimuth =
        std::atan2(d.y, d.x) + deviation_rad_ * random_.gaussian(random_key(context.time), ray.beam, 0);
    const double elevation = std::asin(std::clamp(d.z, -1.0, 1.0)) +
                             deviation_rad_ * random_.gaussian(random_key(context.time), ray.beam, 1);
    ray.direction = beam_direction(azimuth, elevation);
  }
}

}  // namespace simvis
