#include "effects/scanner/blooming.h"

#include <cmath>
#include <cstddef>
#include <numbers>

#include "effects/scanner/beam_divergence.h"
#include "effects/scanner/returns.h"

namespace simvis {
namespace {

constexpr AttributeSpec kBloomingAttributes[] = {
    {.name = "bloom",
     .default_value = "0",
     .text = "share of the light that is scattered around each beam; 0: none",
     .min = 0,
     .max = 0.5},
    {.name = "bloom_angle",
     .default_value = "3",
     .unit = "deg",
     .text = "full angle of the cone of the scattered light",
     .min = 0,
     .max = 60,
     .open_min = true},
    {.name = "bloom_samples",
     .kind = AttributeKind::integer,
     .default_value = "32",
     .text = "rays over the cross-section of that cone",
     .min = 1,
     .max = 65536},
    {.name = "bloom_power",
     .unit = "1/m^2",
     .text = "with bloom, weaker pulses are lost; default: a surface of reflectance 0.1 at range_max",
     .min = 0},
};

const ScanEffectRegistration kBloomingRegistration(
    {.type = {.name = "blooming",
              .summary = "Light that is scattered around each beam makes retro-reflectors look larger.",
              .notes =
                  "Beams that pass a retro-reflector within half of bloom_angle read its range. Data sheets do not "
                  "state the share: measure it, for example as the power that returns beside a traffic sign over "
                  "that on it. Each beam has bloom_samples more rays.",
              .source = "attribute bloom above 0",
              .outputs = kShownInRanges,
              .knob = "bloom_samples",
              .reference = "area ratio of a sign in the cone of a halo",
              .needs = kCastsBeams,
              .attributes = kBloomingAttributes},
     .order = ScanOrder::spread,
     .create = [](const ScanEffectContext& context) -> std::unique_ptr<ScanEffect> {
       if (context.attributes.number("bloom") == 0) return nullptr;
       return std::make_unique<Blooming>(context);
     }});

}  // namespace

Blooming::Blooming(const ScanEffectContext& context)
    : share_(context.attributes.number("bloom")),
      spread_(std::tan(glm::radians(context.attributes.number("bloom_angle")) / 2)),
      least_power_(context.attributes.is_set("bloom_power") ? context.attributes.number("bloom_power")
                                                            : 0.1 / (context.range_max_m * context.range_max_m)),
      pulse_length_m_(context.attributes.is_set("pulse_length") ? context.attributes.number("pulse_length")
                                                                : kPulseLength_m),
      samples_(disc_samples(static_cast<std::uint32_t>(context.attributes.integer("bloom_samples")))),
      random_(context.random("blooming")) {}

void Blooming::aim(const ScanContext&, std::vector<BeamRay>& rays) const {
  std::vector<BeamRay> all;
  all.reserve(rays.size() * (1 + samples_.size()));
  for (const BeamRay& ray : rays) {
    all.push_back(ray);
    all.back().share = ray.share * (1 - share_);
    add_cone(ray, {samples_, spread_, 2 * std::numbers::pi * random_.uniform(0, ray.beam, 0), share_}, all);
  }
  rays.swap(all);
}

// The halo's rays return one pulse together, so the pulses are compared, not the echoes of single rays.
void Blooming::receive(const ScanContext&, std::uint32_t, std::vector<Echo>& echoes) const {
  std::vector<Echo> kept;
  for (std::size_t first = 0, end = 0; first < echoes.size(); first = end) {
    double power = 0;
    for (; end < echoes.size(); ++end) {
      if (end > first && echoes[end].range_m - echoes[end - 1].range_m > pulse_length_m_) break;
      power += echoes[end].power;
    }
    if (power < least_power_) continue;
    kept.insert(kept.end(), echoes.begin() + static_cast<std::ptrdiff_t>(first),
                echoes.begin() + static_cast<std::ptrdiff_t>(end));
  }
  echoes.swap(kept);
}

}  // namespace simvis
