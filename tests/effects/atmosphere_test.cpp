// The effect atmosphere against the physics that its header states, computed here for echoes without a cast.
#include "effects/scanner/atmosphere.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tests/support/reference_directions.h"
#include "tests/support/scan_effects.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("effects");

namespace simvis {
namespace {

const std::uint32_t kFewerDraws = sanitized() ? 16 : 1;

constexpr double kUnit = 0x1p-53;
// A count of mean m is off by more than 5 sqrt(m) with a probability of 6e-7.
constexpr double kDrawSigmas = 5;

std::shared_ptr<const ScanEffect> atmosphere(const std::string& attributes, const std::string& sensor = "S",
                                             std::uint64_t seed = 0) {
  return effects_of(attributes, "atmosphere", sensor, seed).at(0).effect;
}

ScanContext moment_in(const Medium& medium, double range_max_m = 80) {
  ScanContext moment;
  moment.range_max_m = range_max_m;
  moment.medium = medium;
  return moment;
}

// Particles with exponential diameters that return light as matte discs of this reflectance do. The sum of D^2 over a
// cubic metre is 2 N D0^2, a disc returns p (pi D^2 / 4) / pi to each steradian.
Medium medium_of(double per_m3, double d0_m, double reflectance) {
  return {.laser_extinction_per_m = kPi * per_m3 * d0_m * d0_m,
          .backscatter_per_m_sr = reflectance * 2 * per_m3 * d0_m * d0_m / 4,
          .particles_per_m3 = per_m3,
          .particle_diameter_m = d0_m};
}
constexpr double kOfDrop = 0.024, kOfFlake = 2 * kPi / 25;

// Rain of 20 mm/h: 8000 drops per m3 and mm of diameter, exp(-D / D0).
Medium heavy_rain() {
  const double d0_mm = std::pow(20.0, 0.21) / 4.1;
  return medium_of(8000 * d0_mm, d0_mm * 1e-3, kOfDrop);
}
// Snow of 1 mm/h: 1,092 flakes with a mean of 1.73 mm.
Medium snowfall() { return medium_of(1092, 1.73e-3, kOfFlake); }

constexpr double kMinPower = 2e-5, kBeam_m = 0.012;
const std::string kSight = "least_power='2e-5' beam_diameter='0.012'";

// A beam that grows by `spread` per metre.
double beam_diameter(double r, double spread) { return kBeam_m + spread * r; }

// Diameter of a drop at r, solved from the law of its echo.
double reflectance_of(const Medium& medium) {
  return 2 * medium.backscatter_per_m_sr / (medium.particles_per_m3 * std::pow(medium.particle_diameter_m, 2));
}
double diameter_of(double power, const Medium& medium, double r, double spread) {
  return beam_diameter(r, spread) * r * std::sqrt(power / reflectance_of(medium)) *
         std::exp(medium.laser_extinction_per_m * r);
}
double min_diameter(const Medium& medium, double r, double spread) { return diameter_of(kMinPower, medium, r, spread); }
double rate(const Medium& rain, double r, double spread) {
  const double diameter = min_diameter(rain, r, spread), beam = beam_diameter(r, spread);
  if (diameter > beam) return 0;
  return rain.particles_per_m3 * kPi * beam * beam / 4 * std::exp(-diameter / rain.particle_diameter_m);
}

// Simpson's rule; the rate is smooth on the scale of metres, so that steps of a centimetre leave less than 1e-9 of it.
double expected_drops(const Medium& rain, double from_m, double to_m, double spread) {
  const int steps = 2 * static_cast<int>(50 * (to_m - from_m));
  const double h = (to_m - from_m) / steps;
  double sum = rate(rain, from_m, spread) + rate(rain, to_m, spread);
  for (int i = 1; i < steps; ++i) sum += (i % 2 == 0 ? 2 : 4) * rate(rain, from_m + i * h, spread);
  return sum * h / 3;
}

}  // namespace

TEST_CASE("echoes are weakened by the law of Beer and Lambert, within rounding") {
  const auto effect = atmosphere("least_power='1e-30'");
  for (const double extinction : {1e-5, 3e-3, 0.1}) {
    std::vector<Echo> echoes;
    for (double r = 0.25; r < 200; r *= 1.7) echoes.push_back({.range_m = r, .power = 0.4 / (r * r)});
    const std::vector<Echo> before = echoes;
    effect->receive(moment_in({.laser_extinction_per_m = extinction}), 0, echoes);
    REQUIRE(echoes.size() == before.size());
    for (std::size_t i = 0; i < echoes.size(); ++i) {
      const double depth = 2 * extinction * before[i].range_m, expected = before[i].power * std::exp(-depth);
      // Three roundings of the exponent in the effect and in the test, and a few of the result.
      CHECK(std::abs(echoes[i].power - expected) <= (6 * depth + 6) * kUnit * expected);
      CHECK(echoes[i].range_m == before[i].range_m);
    }
  }
}

TEST_CASE("echoes weaker than least_power are lost; its default is the power of reflectance 0.1 at range_max") {
  const Medium fog{.laser_extinction_per_m = 0.05};
  // A wall of reflectance 0.5 at r returns the least power if 0.5 exp(-2 k r) / r^2 equals it.
  const auto detected = [&](const std::string& attributes, double r) {
    std::vector<Echo> echoes{{.range_m = r, .power = 0.5 / (r * r)}};
    atmosphere(attributes)->receive(moment_in(fog), 0, echoes);
    return !echoes.empty();
  };
  for (const auto& [attributes, least] :
       {std::pair("least_power='1e-4'", 1e-4), std::pair("", 0.1 / 6400), std::pair("range_max='20'", 0.1 / 400)}) {
    double low = 0.1, high = 1000;
    for (int i = 0; i < 200; ++i) {
      const double middle = (low + high) / 2;
      (0.5 * std::exp(-0.1 * middle) / (middle * middle) > least ? low : high) = middle;
    }
    CAPTURE(low);
    // The power falls by a share of more than 0.1 per metre, so rounding moves the place by far less than this share.
    constexpr double kPlace = 1e-12;
    CHECK(detected(attributes, low * (1 - kPlace)));
    CHECK(!detected(attributes, low * (1 + kPlace)));
  }
}

namespace {

// Simpson's rule on each side of the kink of the overlap at 1 m, with steps of at most 0.4 mm: its error is below
// (step / length)^4 of the integral, with lengths above 0.1 m on which the integrand varies, or 3e-10.
double air_by_simpson(const Medium& fog, double end_m, double range_m) {
  const auto light = [&](double r) {
    const double overlap = r < 1 ? (r - 0.9) / 0.1 : 1, pulse = std::pow(std::cos(kPi * (r - range_m) / 1.5), 2);
    return overlap * pulse * std::exp(-2 * fog.laser_extinction_per_m * r) / (r * r);
  };
  const auto integral = [&](double from, double to) {
    constexpr int kSteps = 4000;
    if (!(from < to)) return 0.0;
    const double h = (to - from) / kSteps;
    double sum = light(from) + light(to);
    for (int i = 1; i < kSteps; ++i) sum += (i % 2 == 0 ? 2 : 4) * light(from + i * h);
    return sum * h / 3;
  };
  const double first = std::max(0.9, range_m - 0.75), last = std::min(end_m, range_m + 0.75);
  return kPi * fog.backscatter_per_m_sr * (integral(first, std::min(1.0, last)) + integral(std::max(1.0, first), last));
}

}  // namespace

TEST_CASE("the echo of the air is the largest integral of the pulse over what it meets, to 1e-6") {
  constexpr double kQuadrature = 1e-6;
  for (const double extinction : {1e-4, 0.01, 0.0782, 0.5, 3.9}) {
    for (const double end_m : {0.95, 1.1, 1.5, 2.2, 80.0}) {
      CAPTURE(extinction);
      CAPTURE(end_m);
      const Medium fog{.laser_extinction_per_m = extinction, .backscatter_per_m_sr = extinction / 18.8};
      for (double range_m = 0.4; range_m < 2; range_m += 0.0701) {
        const double expected = air_by_simpson(fog, end_m, range_m);
        CHECK(std::abs(air_power(fog, end_m, range_m) - expected) <= kQuadrature * expected);
      }
      const AirEcho echo = air_echo(fog, end_m);
      CHECK(std::abs(echo.power - air_by_simpson(fog, end_m, echo.range_m)) <= kQuadrature * echo.power);
      for (double range_m = 0.3; range_m < 2.5; range_m += 0.0013) {
        REQUIRE(air_by_simpson(fog, end_m, range_m) <= (1 + kQuadrature) * echo.power);
      }
    }
  }
  const Medium fog{.laser_extinction_per_m = 0.2, .backscatter_per_m_sr = 0.01};
  CHECK(air_echo(fog, kAirEchoEnd_m).power == doctest::Approx(air_echo(fog, 80).power).epsilon(1e-12));
  CHECK(air_echo(fog, 0.9).power == 0);
}

TEST_CASE("the echo of the air competes with that of a surface, and is lost below least_power") {
  const Medium fog{.laser_extinction_per_m = 0.2, .backscatter_per_m_sr = 0.01};
  const AirEcho air = air_echo(fog, 3);
  const auto echoes_with = [&](double least_power, double wall_m) {
    std::vector<Echo> echoes{{.range_m = wall_m, .power = 1 / (wall_m * wall_m)}};
    atmosphere("least_power='" + format_number(least_power) + "'")->receive(moment_in(fog), 0, echoes);
    return echoes;
  };
  const std::vector<Echo> both = echoes_with(1e-6, 3);
  REQUIRE(both.size() == 2);
  CHECK(both[0].range_m == air.range_m);
  CHECK(both[0].power == air.power);
  CHECK(both[1].range_m == 3);
  CHECK(echoes_with(0.999 * air.power, 3).size() == 2);
  CHECK(echoes_with(1.001 * air.power, 3).size() == 1);
  CHECK(echoes_with(1e-6, 0.89).size() == 1);  // the wall is nearer than what the receiver sees of the beam
}

namespace {

// Beams in many directions: beyond the first metre, where drops are met, none has space in common with another.
constexpr std::uint32_t kApart = 64;
std::vector<BeamRay> beams_apart() {
  std::vector<BeamRay> rays;
  for (std::uint32_t beam = 0; beam < kApart; ++beam) {
    const double z = 1 - (2 * beam + 1.0) / kApart, angle = beam * 2.399963229728653;  // the golden angle
    const double across = std::sqrt(1 - z * z);
    rays.push_back({.beam = beam, .direction = {across * std::cos(angle), across * std::sin(angle), z}});
  }
  return rays;
}

// The echoes of drops alone, of each beam.
std::vector<std::vector<Echo>> drops_of(const ScanEffect& effect, const ScanContext& moment,
                                        std::vector<BeamRay> rays = beams_apart(), double wall_m = 0) {
  effect.aim(moment, rays);
  std::vector<std::vector<Echo>> all(rays.size());
  for (const BeamRay& ray : rays) {
    std::vector<Echo>& echoes = all[ray.beam];
    if (wall_m > 0) echoes.push_back({.range_m = wall_m, .power = 1});
    effect.receive(moment, ray.beam, echoes);
    std::erase_if(echoes, [&](const Echo& echo) { return echo.range_m == wall_m; });
  }
  return all;
}

std::vector<std::vector<double>> ranges_of(const std::vector<std::vector<Echo>>& beams) {
  std::vector<std::vector<double>> all;
  for (const std::vector<Echo>& echoes : beams) {
    all.emplace_back();
    for (const Echo& echo : echoes) all.back().push_back(echo.range_m);
  }
  return all;
}

}  // namespace

TEST_CASE("the number, places and sizes of drops and flakes in many beams are those of a Poisson process in space") {
  const std::uint32_t kScans = 1600 / kFewerDraws, kBeams = kScans * kApart;
  constexpr double kEnd_m = 15;
  for (const auto& [rain, divergence_deg] :
       {std::pair(heavy_rain(), 0.0), std::pair(heavy_rain(), 0.1), std::pair(snowfall(), 0.05)}) {
    const double per_m3 = rain.particles_per_m3, spread_deg = divergence_deg;
    CAPTURE(per_m3);
    CAPTURE(spread_deg);
    const double spread = 2 * std::tan(divergence_deg / 2 * kPi / 180);
    const auto effect = atmosphere(kSight + " divergence='" + format_number(divergence_deg) + "'");
    ScanContext moment = moment_in(rain, kEnd_m);
    std::array<std::uint64_t, 4> beams_with{};  // no drop, one, two, more
    std::array<std::uint64_t, 7> in_stretch{};  // of 2 m
    std::uint64_t drops = 0, large = 0;
    double sum_of_sizes = 0;
    for (moment.time.index = 0; moment.time.index < kScans; ++moment.time.index) {
      for (const std::vector<Echo>& echoes : drops_of(*effect, moment)) {
        ++beams_with[std::min<std::size_t>(echoes.size(), 3)];
        for (const Echo& echo : echoes) {
          ++drops;
          ++in_stretch.at(static_cast<std::size_t>((echo.range_m - 1) / 2));
          const double r = echo.range_m;
          if (echo.power < kMinPower * (1 - 1e-12)) FAIL("a drop too weak to be detected");
          // The diameter follows from the power. It is measured from the smallest diameter, in units of the mean.
          const double diameter = diameter_of(echo.power, rain, r, spread);
          const double size = (diameter - min_diameter(rain, r, spread)) / rain.particle_diameter_m;
          sum_of_sizes += size;
          large += size > 1;
        }
      }
    }
    const double mean = expected_drops(rain, 1, kEnd_m, spread), all = kBeams * mean;
    MESSAGE(mean << " drops per beam expected, " << static_cast<double>(drops) / kBeams << " met");
    CHECK(mean > 0.1);
    CHECK(std::abs(static_cast<double>(drops) - all) <= kDrawSigmas * std::sqrt(all));
    const double none = std::exp(-mean);
    const std::array<double, 4> shares{none, none * mean, none * mean * mean / 2,
                                       1 - none * (1 + mean + mean * mean / 2)};
    for (std::size_t k = 0; k < 4; ++k) {
      const double expected = kBeams * shares[k];
      CAPTURE(k);
      CHECK(std::abs(static_cast<double>(beams_with[k]) - expected) <=
            kDrawSigmas * std::sqrt(expected * (1 - shares[k])));
    }
    for (std::size_t k = 0; k < 7; ++k) {
      const double from_m = 1 + 2 * static_cast<double>(k);
      const double expected = kBeams * expected_drops(rain, from_m, from_m + 2, spread);
      CAPTURE(from_m);
      CHECK(std::abs(static_cast<double>(in_stretch[k]) - expected) <= kDrawSigmas * std::sqrt(expected));
    }
    // Unit exponentials: mean 1, variance 1, above 1 with probability 1 / e. Drops wider than the beam count as if they
    // were as wide as it: e^-10 of them, and less of their mean.
    const double n = static_cast<double>(drops), above = 1 / std::numbers::e;
    CHECK(std::abs(sum_of_sizes / n - 1) <= kDrawSigmas / std::sqrt(n));
    CHECK(std::abs(static_cast<double>(large) - n * above) <= kDrawSigmas * std::sqrt(n * above * (1 - above)));
  }
}

TEST_CASE("drops depend on seed and frame but not on sensor or order, and none lies beyond a surface") {
  ScanContext moment = moment_in(heavy_rain(), 15);
  moment.time.index = 1;
  const auto effect = atmosphere(kSight);
  const auto first = ranges_of(drops_of(*effect, moment));
  std::size_t count = 0;
  for (const auto& ranges : first) count += ranges.size();
  REQUIRE(count > 5);
  CHECK(ranges_of(drops_of(*atmosphere(kSight, "T"), moment)) == first);
  CHECK(ranges_of(drops_of(*atmosphere(kSight, "S", 1), moment)) != first);
  std::vector<BeamRay> backwards = beams_apart();
  std::ranges::reverse(backwards);
  CHECK(ranges_of(drops_of(*effect, moment, backwards)) == first);
  moment.time.index = 2;
  CHECK(ranges_of(drops_of(*effect, moment)) != first);
  // A surface removes the drops beyond it and does not move those in front of it.
  moment.time.index = 1;
  auto before_wall = first;
  for (auto& ranges : before_wall) std::erase_if(ranges, [](double range_m) { return range_m > 6; });
  CHECK(ranges_of(drops_of(*effect, moment, beams_apart(), 6)) == before_wall);
}

TEST_CASE("drops stand in the world: a scanner farther along its own beam meets them that much nearer") {
  const Medium rain = heavy_rain();
  ScanContext behind = moment_in(rain, 15);
  // Far from the world's origin and turned, so that the beam crosses cubes askew.
  const double angle = 0.7;
  behind.world_from_sensor = glm::dmat4(std::cos(angle), std::sin(angle), 0, 0, -std::sin(angle), std::cos(angle), 0, 0,
                                        0, 0, 1, 0, -1234.5, 678.9, 12.3, 1);
  ScanContext ahead = behind;
  constexpr double kAhead_m = 0.5;
  ahead.world_from_sensor[3] += kAhead_m * behind.world_from_sensor[0];
  const auto effect = atmosphere(kSight);
  const std::vector<BeamRay> forward = {{.beam = 0}};
  // Places near 1235 m have steps of 2e-13 m, of which a few add up.
  constexpr double kPlace_m = 1e-11;
  std::size_t met = 0;
  for (std::uint64_t frame = 0; frame < 2000; ++frame) {
    behind.time.index = ahead.time.index = frame;
    const auto far = ranges_of(drops_of(*effect, behind, forward))[0],
               near = ranges_of(drops_of(*effect, ahead, forward))[0];
    for (const double range_m : far) {
      if (range_m < 1 + kAhead_m + kPlace_m) continue;  // too near for the other
      ++met;
      // The scanner ahead detects whatever the other one does.
      CHECK(std::ranges::any_of(near, [&](double each) { return std::abs(each + kAhead_m - range_m) < kPlace_m; }));
    }
  }
  CHECK(met > 100);
}

TEST_CASE("the number of echoes of flakes per beam is Poisson's, by chi-square") {
  const std::uint32_t kScans = 800 / kFewerDraws;
  const Medium snow = snowfall();
  const auto effect = atmosphere(kSight);
  ScanContext moment = moment_in(snow, 15);
  constexpr std::size_t kBins = 6;  // no echo, one, ..., five or more
  std::array<double, kBins> seen{};
  for (moment.time.index = 0; moment.time.index < kScans; ++moment.time.index) {
    for (const std::vector<Echo>& echoes : drops_of(*effect, moment)) ++seen.at(std::min(echoes.size(), kBins - 1));
  }
  const double mean = expected_drops(snow, 1, 15, 0), beams = kApart * static_cast<double>(kScans);
  double chi_square = 0, share = std::exp(-mean), below = 0;
  for (std::size_t k = 0; k < kBins; ++k) {
    const double expected = beams * (k + 1 < kBins ? share : 1 - below);
    REQUIRE(expected > 5);
    chi_square += (seen.at(k) - expected) * (seen.at(k) - expected) / expected;
    below += share;
    share *= mean / static_cast<double>(k + 1);
  }
  MESSAGE(mean << " flakes per beam expected, chi-square " << chi_square << " with 5 degrees of freedom");
  CHECK(chi_square < 35.9);  // exceeded with a probability of 1e-6
}

TEST_CASE("particles below the size of echoes of their own leave their share of the light to the air, to 1e-6") {
  constexpr double kQuadrature = 1e-6;
  const Medium dust = medium_of(3e6, 2e-4, 2 * kPi / 69);
  for (const double x : {0.01, 0.5, 1.0, 3.0, 12.0}) {
    // The integral of (D / D0)^2 exp(-D / D0) / 2 up to x, by the midpoint rule.
    constexpr int kSteps = 20'000;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
      const double d = x * (i + 0.5) / kSteps;
      sum += d * d * std::exp(-d) / 2 * x / kSteps;
    }
    CHECK(std::abs(soft_share(dust, x * dust.particle_diameter_m) - sum) <= kQuadrature * sum + 1e-15);
  }
  CHECK(soft_share(Medium{.backscatter_per_m_sr = 1}, 0.1) == 1);
  CHECK(std::abs(particle_reflectance(dust) - 2 * kPi / 69) <= 8 * kUnit);
}

TEST_CASE("dense dust is a soft medium: of its grains few have echoes of their own, and no light counts twice") {
  // 3 million grains per cubic metre: 240 in a pulse of 0.75 m at 1 m, in a beam of 12 mm.
  const Medium dust = medium_of(3e6, 2e-4, 2 * kPi / 69);
  const ParticleSight sight{.least_power = kMinPower, .beam_diameter_m = kBeam_m};
  const double pulse_m3 = kPi / 4 * kBeam_m * kBeam_m * 0.75, from_m = sight.single_from_m(dust);
  const double in_pulse = dust.particles_per_m3 * pulse_m3 * std::exp(-from_m / dust.particle_diameter_m);
  CHECK(in_pulse <= kManyInPulse);
  CHECK(in_pulse >= kManyInPulse / std::numbers::e);
  const auto effect = atmosphere(kSight);
  const ScanContext moment = moment_in(dust, 15);
  std::vector<BeamRay> rays = beams_apart();
  effect->aim(moment, rays);
  std::vector<Echo> echoes;
  effect->receive(moment, 0, echoes);
  Medium soft = dust;
  soft.backscatter_per_m_sr *= soft_share(dust, from_m);
  const AirEcho air = air_echo(soft, kAirEchoEnd_m);
  REQUIRE(air.power > kMinPower);
  CHECK(std::ranges::count(echoes, air.power, &Echo::power) == 1);
  CHECK(echoes.size() > 1);
  CHECK(echoes.size() < 100);
  // Grains that no laser detects by themselves are a soft medium alone.
  const Medium fine = medium_of(3e12, 2e-7, 2 * kPi / 69);
  CHECK(soft_share(fine, sight.single_from_m(fine)) == 1);
}

}  // namespace simvis

TEST_SUITE_END();
