#include "effects/scanner/atmosphere.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <optional>

#include <simvis/scan_effect.h>
#include "effects/scanner/drop_field.h"

namespace simvis {
namespace {

constexpr AttributeSpec kAtmosphereAttributes[] = {
    {.name = "least_power",
     .unit = "1/m^2",
     .text = "weather: weaker echoes are lost; a white matte wall at 1 m, perpendicular, has 1; default: a surface of "
             "reflectance 0.1 at range_max",
     .min = 0,
     .open_min = true},
    {.name = "beam_diameter",
     .default_value = "0.01",
     .unit = "m",
     .text = "rain: diameter of the beam where it leaves; it grows by the divergence",
     .min = 0,
     .max = 10,
     .open_min = true},
};

// The share of light that remains after the way out and back.
double there_and_back(const Medium& medium, double range_m) {
  return std::exp(-2 * medium.laser_extinction_per_m * range_m);
}

class Atmosphere : public ScanEffect {
 public:
  Atmosphere(const ScanEffectContext& context, double least_power)
      : seed_(context.seed),
        sight_{.least_power = least_power,
               .beam_diameter_m = context.attributes.number("beam_diameter"),
               .spread = 2 * std::tan(glm::radians(context.attributes.number("divergence")) / 2)} {}

  bool traces() const override { return true; }

  // Keeps the axes of the beams for receive(): only drops need them.
  void aim(const ScanContext& context, std::vector<BeamRay>& rays) const override {
    axes_.clear();
    if (context.medium.particles_per_m3 == 0) return;
    for (const BeamRay& ray : rays) {
      if (ray.beam >= axes_.size()) axes_.resize(ray.beam + 1);
      Axis& axis = axes_[ray.beam];
      axis.origin_m = ray.origin_m;
      axis.direction += ray.direction;
    }
  }

  void receive(const ScanContext& context, std::uint32_t beam, std::vector<Echo>& echoes) const override {
    const double end_m = echoes.empty() ? context.range_max_m : echoes.back().range_m;
    for (Echo& echo : echoes) echo.power *= there_and_back(context.medium, echo.range_m);
    std::erase_if(echoes, [&](const Echo& echo) { return echo.power < sight_.least_power; });
    add_air(context.medium, end_m, echoes);
    add_drops(context, beam, end_m, echoes);
    std::ranges::stable_sort(echoes, {}, &Echo::range_m);
  }

 private:
  void add_air(const Medium& medium, double end_m, std::vector<Echo>& echoes) const {
    const AirEcho& open = open_air(medium);
    if (open.power < sight_.least_power) return;  // as is that of any shorter beam, which costs more to find
    const AirEcho air = end_m < kAirEchoEnd_m ? air_echo(medium, end_m) : open;
    if (!(air.power > 0) || air.power < sight_.least_power) return;
    echoes.push_back({.range_m = air.range_m, .power = air.power});
  }

  // The echo of a beam that goes on, which is the same for nearly all beams.
  const AirEcho& open_air(const Medium& medium) const {
    if (!open_air_ || open_air_->medium != medium) open_air_ = {medium, air_echo(medium, kAirEchoEnd_m)};
    return open_air_->echo;
  }

  void add_drops(const ScanContext& context, std::uint32_t beam, double end_m, std::vector<Echo>& echoes) const {
    const Medium& medium = context.medium;
    if (medium.particles_per_m3 == 0 || beam >= axes_.size()) return;
    const Axis& axis = axes_[beam];
    const LitCylinder lit{.origin_m = glm::dvec3(context.world_from_sensor * glm::dvec4(axis.origin_m, 1)),
                          .direction = glm::dmat3(context.world_from_sensor) * glm::normalize(axis.direction),
                          .from_m = kDropsFrom_m,
                          .to_m = end_m,
                          .diameter_m = sight_.beam_diameter_m,
                          .spread = sight_.spread};
    const DropField field(seed_, medium, context.time.index);
    field.meet(
        lit, [&](double range_m) { return sight_.min_diameter_m(medium, range_m); },
        [&](double range_m, double diameter_m) {
          const double share = diameter_m / sight_.diameter_m(range_m);
          const double power = kDropReflectance * std::min(share * share, 1.0) * there_and_back(medium, range_m);
          echoes.push_back({.range_m = range_m, .power = power / (range_m * range_m)});
        });
  }

  struct Axis {
    glm::dvec3 origin_m{0}, direction{0};  // the sum of the directions of its rays
  };

  struct OpenAir {
    Medium medium;
    AirEcho echo;
  };

  std::uint64_t seed_;
  DropSight sight_;
  mutable std::vector<Axis> axes_;           // by beam, of the scan that is being taken
  mutable std::optional<OpenAir> open_air_;  // the last value of a function that is expensive
};

std::unique_ptr<ScanEffect> create_atmosphere(const ScanEffectContext& context) {
  const AttributeValues& a = context.attributes;
  return std::make_unique<Atmosphere>(
      context, a.is_set("least_power") ? a.number("least_power") : 0.1 / (context.range_max_m * context.range_max_m));
}

const ScanEffectRegistration kAtmosphereRegistration({
    .type =
        {.name = "atmosphere",
         .summary = "Echoes are weakened and lost in fog, rain and dust; air and drops return false ones.",
         .notes = "An echo fades by exp(-2 extinction range). Weak echoes are lost. The air itself and single "
                  "drops return false echoes. While there is weather every beam is cast, whatever the method; "
                  "run.json says so in cast_for.",
         .source = "an element fog",
         .outputs = kShownInRanges,
         .reference =
             "Beer and Lambert; Koschmieder 1924, Kim et al. 2001, Marshall and Palmer 1948, Rasshofer et al. 2011, "
             "Hahner et al. 2021",
         .needs = kCastsBeams,
         .attributes = kAtmosphereAttributes},
    .order = ScanOrder::medium,
    .create = create_atmosphere,
    .called_for = [](const DrawList& list) { return list.medium.laser_extinction_per_m > 0; },
});

}  // namespace

double DropSight::min_diameter_m(const Medium& medium, double range_m) const {
  const double share = least_power * range_m * range_m / (kDropReflectance * there_and_back(medium, range_m));
  return share <= 1 ? diameter_m(range_m) * std::sqrt(share) : std::numeric_limits<double>::infinity();
}

}  // namespace simvis
