// The effect `blooming`: a retro-reflector looks larger than it is.
//
//   <sensor type="laser_scanner" ... bloom="0.001" bloom_angle="3"/>
//
// Cause    Windows, lenses and mirrors of a scanner scatter a small share of its light around each beam. On matte
//          surfaces nothing of that is seen. A retro-reflector sends back thousands of times as much light, so that
//          beams that pass it at some distance still read its range.
// Model    Each beam has a halo: the share `bloom` of its light lies evenly in a cone of the full angle `bloom_angle`,
//          the rest in the beam itself. The halo is sampled by `bloom_samples` rays of equal shares, in the pattern of
//          beam_divergence. Pulses weaker than `bloom_power` are lost, as those of matte surfaces in the halo are.
// Limit    no light returns by scattering on the way back, which real receivers have too: it acts in the same way, so a
//          measured share contains both.
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <simvis/scan_effect.h>
#include "effects/scanner/beam_divergence.h"
#include "effects/scanner/returns.h"

namespace simvis {
namespace {

class Blooming : public ScanEffect {
 public:
  explicit Blooming(const ScanEffectContext& context);

  bool traces() const override { return true; }
  std::uint32_t rays_per_ray() const override { return 1 + static_cast<std::uint32_t>(samples_.size()); }
  void aim(const ScanContext& context, std::vector<BeamRay>& rays) const override;
  void receive(const ScanContext& context, std::uint32_t beam, std::vector<Echo>& echoes) const override;

 private:
  double share_, spread_, least_power_, pulse_length_m_;
  std::vector<glm::dvec2> samples_;
  SensorRandom random_;
};

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
