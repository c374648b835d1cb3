#include "effects/scanner/atmosphere.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <simvis/scan_effect.h>

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
     .text = "rain: diameter of the beam in which drops are hit",
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
      : random_(context.random("atmosphere")),
        sight_{.least_power = least_power, .beam_diameter_m = context.attributes.number("beam_diameter")} {}

  bool traces() const override { return true; }

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
    const AirEcho air = end_m < kAirEchoEnd_m ? air_echo(medium, end_m) : open_air(medium);
    if (!(air.power > 0) || air.power < sight_.least_power) return;
    echoes.push_back({.range_m = air.range_m, .power = air.power});
  }

  // The echo of a beam that goes on, which is the same for nearly all beams.
  const AirEcho& open_air(const Medium& medium) const {
    if (!open_air_ || open_air_->medium != medium) open_air_ = {medium, air_echo(medium, kAirEchoEnd_m)};
    return open_air_->echo;
  }

  // The Poisson process is sampled by thinning (Lewis and Shedler, Naval Res. Logist. Q. 26, 1979). The rate falls with
  // range, so within a segment it never exceeds its value at the beginning. Segments grow with range, and the rate
  // within a segment does not fall so much that many candidates are rejected.
  void add_drops(const ScanContext& context, std::uint32_t beam, double end_m, std::vector<Echo>& echoes) const {
    constexpr double kGrowth = 1.4142135623730951;
    const Medium& medium = context.medium;
    if (medium.particles_per_m3 == 0) return;
    std::uint32_t draws = 0;
    const auto uniform = [&] { return random_.uniform(context.time.index, beam, draws++); };
    const auto exponential = [&] { return -std::log1p(-uniform()); };
    double wait = exponential();
    for (double from_m = kDropsFrom_m; from_m < end_m; from_m *= kGrowth) {
      const double rate = sight_.rate_per_m(medium, from_m), to_m = std::min(from_m * kGrowth, end_m);
      if (rate == 0) return;
      double range_m = from_m + wait / rate;
      for (; range_m < to_m; range_m += (wait = exponential()) / rate) {
        if (uniform() * rate >= sight_.rate_per_m(medium, range_m)) continue;
        const double share = (sight_.min_diameter_m(medium, range_m) + medium.particle_diameter_m * exponential()) /
                             sight_.beam_diameter_m;
        const double power = kDropReflectance * std::min(share * share, 1.0) * there_and_back(medium, range_m);
        echoes.push_back({.range_m = range_m, .power = power / (range_m * range_m)});
      }
      wait = (range_m - to_m) * rate;
    }
  }

  struct OpenAir {
    Medium medium;
    AirEcho echo;
  };

  SensorRandom random_;
  DropSight sight_;
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
  return share <= 1 ? beam_diameter_m * std::sqrt(share) : std::numeric_limits<double>::infinity();
}

double DropSight::rate_per_m(const Medium& medium, double range_m) const {
  const double area_m2 = std::numbers::pi / 4 * beam_diameter_m * beam_diameter_m;
  return medium.particles_per_m3 * area_m2 * std::exp(-min_diameter_m(medium, range_m) / medium.particle_diameter_m);
}

}  // namespace simvis
