#include "effects/scanner/atmosphere.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <numbers>
#include <optional>

#include <simvis/scan_effect.h>
#include "effects/scanner/beam_axes.h"
#include "effects/scanner/particle_field.h"

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
     .text = "rain, snow, dust: diameter of the beam where it leaves; it grows by the divergence",
     .min = 0,
     .max = 10,
     .open_min = true},
};

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The share of light that remains after the way out and back.
double there_and_back(const Medium& medium, double range_m) {
  return std::exp(-2 * medium.laser_extinction_per_m * range_m);
}

// The air of one medium as a scanner meets it, with all that follows from both and not from the beam.
struct Air {
  Air(const Medium& of, const ParticleSight& sight, std::uint64_t seed)
      : medium(of),
        soft(of),
        reflectance(particle_reflectance(of)),
        single_from_m(sight.single_from_m(of)),
        field(seed, of, kParticlesFrom_m, [of, sight, from_m = single_from_m](double range_m) {
          return std::max(from_m, sight.min_diameter_m(of, range_m));
        }) {
    soft.backscatter_per_m_sr *= soft_share(of, single_from_m);
    open = air_echo(soft, kAirEchoEnd_m);
  }

  Medium medium, soft;  // soft: without the light of particles that have echoes of their own
  double reflectance, single_from_m;
  ParticleField field;
  AirEcho open;  // of a beam that goes on, which is the same for nearly all beams
};

class Atmosphere : public ScanEffect {
 public:
  Atmosphere(const ScanEffectContext& context, double least_power)
      : seed_(context.seed),
        sight_{.least_power = least_power,
               .beam_diameter_m = context.attributes.number("beam_diameter"),
               .spread = 2 * std::tan(glm::radians(context.attributes.number("divergence")) / 2)} {}

  bool traces() const override { return true; }

  // Keeps the axes of the beams for receive(): only particles need them.
  void aim(const ScanContext& context, std::vector<BeamRay>& rays) const override {
    axes_.clear();
    if (context.medium.particles_per_m3 > 0) axes_ = beam_axes(rays);
  }

  void receive(const ScanContext& context, std::uint32_t beam, std::vector<Echo>& echoes) const override {
    const double end_m = echoes.empty() ? context.range_max_m : echoes.back().range_m;
    for (Echo& echo : echoes) echo.power *= there_and_back(context.medium, echo.range_m);
    std::erase_if(echoes, [&](const Echo& echo) { return echo.power < sight_.least_power; });
    const Air& air = air_of(context.medium);
    add_soft(air, end_m, echoes);
    if (beam < axes_.size()) add_particles(air, context, axes_[beam], end_m, echoes);
    std::ranges::stable_sort(echoes, {}, &Echo::range_m);
  }

 private:
  const Air& air_of(const Medium& medium) const {
    if (!air_ || air_->medium != medium) air_.emplace(medium, sight_, seed_);
    return *air_;
  }

  void add_soft(const Air& air, double end_m, std::vector<Echo>& echoes) const {
    if (air.open.power < sight_.least_power) return;  // as is that of any shorter beam, which costs more to find
    const AirEcho echo = end_m < kAirEchoEnd_m ? air_echo(air.soft, end_m) : air.open;
    if (!(echo.power > 0) || echo.power < sight_.least_power) return;
    echoes.push_back({.range_m = echo.range_m, .power = echo.power});
  }

  void add_particles(const Air& air, const ScanContext& context, const BeamAxis& axis, double end_m,
                     std::vector<Echo>& echoes) const {
    const LitCylinder lit{.origin_m = glm::dvec3(context.world_from_sensor * glm::dvec4(axis.origin_m, 1)),
                          .direction = glm::dmat3(context.world_from_sensor) * axis.direction,
                          .from_m = kParticlesFrom_m,
                          .to_m = end_m,
                          .diameter_m = sight_.beam_diameter_m,
                          .spread = sight_.spread};
    air.field.meet(random_key(context.time), lit, [&](double range_m, double diameter_m) {
      const double share = diameter_m / sight_.diameter_m(range_m);
      const double power = air.reflectance * std::min(share * share, 1.0) * there_and_back(air.medium, range_m);
      echoes.push_back({.range_m = range_m, .power = power / (range_m * range_m)});
    });
  }

  std::uint64_t seed_;
  ParticleSight sight_;
  mutable std::vector<BeamAxis> axes_;  // by beam, of the scan that is being taken
  mutable std::optional<Air> air_;      // of the last medium
};

std::unique_ptr<ScanEffect> create_atmosphere(const ScanEffectContext& context) {
  const AttributeValues& a = context.attributes;
  return std::make_unique<Atmosphere>(
      context, a.is_set("least_power") ? a.number("least_power") : 0.1 / (context.range_max_m * context.range_max_m));
}

const ScanEffectRegistration kAtmosphereRegistration({
    .type =
        {.name = "atmosphere",
         .summary =
             "Echoes are weakened and lost in fog, rain, snow and dust; the air and its particles return false ones.",
         .notes = "An echo fades by exp(-2 extinction range). Weak echoes are lost. The air itself and single "
                  "drops, flakes and grains return false echoes. While there is weather every beam is cast, whatever "
                  "the method; "
                  "run.json says so in cast_for.",
         .source = "an element fog",
         .outputs = kShownInRanges,
         .reference = "Beer and Lambert; Koschmieder 1924, Kim et al. 2001, Marshall and Palmer 1948, Sekhon and "
                      "Srivastava 1970, "
                      "Rasshofer et al. 2011, Hahner et al. 2021",
         .needs = kCastsBeams,
         .attributes = kAtmosphereAttributes},
    .order = ScanOrder::medium,
    .create = create_atmosphere,
    .called_for = [](const DrawList& list) { return list.medium.laser_extinction_per_m > 0; },
});

}  // namespace

double particle_reflectance(const Medium& medium) {
  if (medium.particles_per_m3 == 0) return 0;
  const double diameter_m = medium.particle_diameter_m;
  return 2 * medium.backscatter_per_m_sr / (medium.particles_per_m3 * diameter_m * diameter_m);
}

double ParticleSight::min_diameter_m(const Medium& medium, double range_m) const {
  const double full = particle_reflectance(medium) * there_and_back(medium, range_m);  // a particle as wide as the beam
  const double share = least_power * range_m * range_m / full;
  return share <= 1 ? diameter_m(range_m) * std::sqrt(share) : kInfinity;
}

double ParticleSight::single_from_m(const Medium& medium) const {
  if (medium.particles_per_m3 == 0) return kInfinity;
  const double width_m = diameter_m(kParticlesFrom_m), pulse_m3 = std::numbers::pi / 4 * width_m * width_m * kPulse_m;
  const double many =
      std::ceil(std::log(medium.particles_per_m3 * pulse_m3 / kManyInPulse));  // exp(-D / D0) are larger
  return std::max(min_diameter_m(medium, kParticlesFrom_m), many * medium.particle_diameter_m);
}

double soft_share(const Medium& medium, double diameter_m) {
  if (medium.particles_per_m3 == 0 || std::isinf(diameter_m)) return 1;
  const double x = diameter_m / medium.particle_diameter_m;
  return 1 - std::exp(-x) * (1 + x + x * x / 2);
}

}  // namespace simvis
