#include "effects/scanner/beam_divergence.h"

#include <cmath>
#include <numbers>

namespace simvis {
namespace {

constexpr AttributeSpec kBeamDivergenceAttributes[] = {
    {.name = "divergence",
     .default_value = "0",
     .unit = "deg",
     .text = "full angle of the cone of light; 0: the beam is a line",
     .min = 0,
     .max = 30},
    {.name = "divergence_samples",
     .kind = AttributeKind::integer,
     .default_value = "32",
     .text = "rays over the cross-section of each beam",
     .min = 1,
     .max = 65536},
};

std::unique_ptr<ScanEffect> create_beam_divergence(const ScanEffectContext& context) {
  const AttributeValues& a = context.attributes;
  if (a.number("divergence") == 0) return nullptr;
  return std::make_unique<BeamDivergence>(glm::radians(a.number("divergence")),
                                          static_cast<std::uint32_t>(a.integer("divergence_samples")),
                                          context.random("beam_divergence"));
}

const ScanEffectRegistration kBeamDivergenceRegistration(
    {.type = {.name = "beam_divergence",
              .summary = "Beams are cones of light: each one meets a patch, and ranges mix at edges.",
              .notes = "Rays of equal shares sample the disc evenly. Ranges mix at edges because the beam is wide, "
                       "never by interpolation. The pattern differs from beam to beam and stays the same from frame to "
                       "frame. Four times as many samples leave about a third of the error.",
              .source = "attribute divergence above 0",
              .outputs = kShownInRanges,
              .knob = "divergence_samples",
              .reference = "area ratios of a disc cut by a line",
              .needs = kCastsBeams,
              .attributes = kBeamDivergenceAttributes},
     .order = ScanOrder::spread,
     .create = create_beam_divergence});

}  // namespace

std::vector<glm::dvec2> disc_samples(std::uint32_t count) {
  std::vector<glm::dvec2> places;
  if (count % 2 == 1) places.emplace_back(0, 0);
  for (std::uint32_t pair = 0; places.size() < count; ++pair) {
    // The radius that halves the area of the ring of this pair.
    const double radius = std::sqrt((static_cast<double>(places.size()) + 1) / count);
    const double angle = std::numbers::pi * std::fmod(pair * (std::numbers::phi - 1), 1.0);
    const glm::dvec2 place = radius * glm::dvec2(std::cos(angle), std::sin(angle));
    places.push_back(place);
    places.push_back(-place);
  }
  return places;
}

void add_cone(const BeamRay& ray, const DivergenceCone& cone, std::vector<BeamRay>& rays) {
  // No point of the disc is farther from the nearest sample than 1.9 / sqrt(count), for any count.
  const double reach = 2 / std::sqrt(static_cast<double>(cone.samples.size()));
  const glm::dvec3& axis = ray.direction;
  const glm::dvec3 across =
      glm::normalize(glm::cross(std::abs(axis.z) < 0.75 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0), axis));
  const glm::dvec3 x = std::cos(cone.turn_rad) * across + std::sin(cone.turn_rad) * glm::cross(axis, across);
  const glm::dvec3 y = glm::cross(axis, x);
  for (const glm::dvec2& place : cone.samples) {
    BeamRay& part = rays.emplace_back(ray);
    part.direction = glm::normalize(axis + cone.spread * (place.x * x + place.y * y));
    part.share = ray.share * cone.share / static_cast<double>(cone.samples.size());
    part.half_angle_rad = ray.half_angle_rad + reach * cone.spread;
  }
}

BeamDivergence::BeamDivergence(double full_angle_rad, std::uint32_t samples, SensorRandom random)
    : spread_(std::tan(full_angle_rad / 2)), samples_(disc_samples(samples)), random_(random) {}

void BeamDivergence::aim(const ScanContext&, std::vector<BeamRay>& rays) const {
  std::vector<BeamRay> split;
  split.reserve(rays.size() * samples_.size());
  for (const BeamRay& ray : rays) {
    add_cone(ray, {samples_, spread_, 2 * std::numbers::pi * random_.uniform(0, ray.beam, 0)}, split);
  }
  rays.swap(split);
}

}  // namespace simvis
