// The effect `beam_divergence`: the shares of a beam's footprint on either side of an edge, their convergence, and the
// ranges that are mixed.
#include "effects/scanner/beam_divergence.h"

#include <doctest/doctest.h>

#include "effects/scanner/returns.h"
#include "tests/support/traced_beams.h"

TEST_SUITE_BEGIN("effects");

namespace simvis {
namespace {

constexpr double kFull_rad = 0.04;  // from side to side
const double kSpread = std::tan(kFull_rad / 2);
const glm::dvec3 kAhead(1, 0, 0);

std::shared_ptr<const BeamDivergence> divergence(std::uint32_t samples, std::uint64_t seed = 0) {
  return std::make_shared<BeamDivergence>(kFull_rad, samples, SensorRandom(seed, "S/beam_divergence"));
}

constexpr double kNear_m = 4, kFar_m = 10;

/// A plate in front of a wall. Its edge cuts the footprint of a forward beam at `c` of the radius.
DrawList edge(double c) {
  DrawList list;
  add_item(list, plate_mesh(kNear_m, {c * kNear_m * kSpread, -2}, {2, 2}), glm::dmat4(1));
  add_item(list, plate_mesh(kFar_m, {-5, -5}, {5, 5}), glm::dmat4(1));
  return list;
}

/// For each of many beams, the share of its rays that hit the plate in front.
std::vector<double> shares_in_front(double c, std::uint32_t samples, std::size_t beams) {
  const auto probe = std::make_shared<Probe>();
  trace(edge(c), std::vector(beams, kAhead), {divergence(samples), probe});
  std::vector<double> shares;
  for (const std::vector<Echo>& echoes : probe->echoes) {
    const auto near = std::ranges::count_if(echoes, [](const Echo& echo) { return echo.range_m < 7; });
    shares.push_back(static_cast<double>(near) / samples);
  }
  return shares;
}

TEST_CASE(
    "rays over a footprint have equal shares, lie within the cone and are symmetric; a single ray is the beam itself") {
  for (const std::uint32_t samples : {1u, 2u, 5u, 32u, 101u}) {
    CAPTURE(samples);
    const auto probe = std::make_shared<Probe>();
    const glm::dvec3 axis = glm::normalize(glm::dvec3(1, -2, 2));
    trace(edge(0), {kAhead, axis}, {divergence(samples), probe});
    REQUIRE(probe->rays.size() == 2 * samples);
    double energy = 0;
    glm::dvec3 middle(0);
    std::size_t within_half_area = 0;
    for (std::size_t i = samples; i < 2 * samples; ++i) {
      const BeamRay& ray = probe->rays[i];
      CHECK(ray.beam == 1);
      energy += ray.share;
      middle += ray.direction / glm::dot(ray.direction, axis);
      const double tangent = glm::length(glm::cross(axis, ray.direction)) / glm::dot(axis, ray.direction);
      CHECK(tangent < kSpread);
      within_half_area += tangent < kSpread * std::sqrt(0.5);
    }
    // Rounding of sums of this many doubles.
    const double rounding = 4 * samples * 0x1p-53;
    CHECK(std::abs(energy - 1) <= rounding);
    CHECK(glm::distance(middle / static_cast<double>(samples), axis) <= rounding);
    // The two rays of a ring may lie on that circle, and an odd ray may lie on its inner side.
    CHECK(std::abs(static_cast<double>(within_half_area) - samples / 2.0) <= 1);
    if (samples == 1) CHECK(glm::distance(probe->rays[1].direction, axis) <= rounding);
  }
}

// Averaged over turns, rays at radius r lie above c with probability f(r^2) = acos(c / r) / pi. The pattern integrates
// f over r^2 by the midpoint rule in steps of 2 / N (of 1 / N about the axis, where N is odd). f is monotone and at
// most 1, so the error is at most 1 / N. The errors of single turns average out.
TEST_CASE("the footprint at an edge has the shares of the closed form and beats the same number of random rays") {
  const std::size_t kBeams = 1000 / kFewer;
  // The relative error of the root of a mean square is at most 1 / sqrt(kBeams) where the kurtosis is below 5, as it is
  // for one ray in seven at the far edge.
  const double chance = 1 + kSigmas / std::sqrt(kBeams);
  for (const double c : {-0.7, 0.0, 0.3, 0.9}) {
    CAPTURE(c);
    const double expected = disc_share_above(c);
    double before = 1;
    for (const std::uint32_t samples : {8u, 32u, 33u, 128u, 512u}) {
      CAPTURE(samples);
      Moments shares, errors;
      for (const double share : shares_in_front(c, samples, kBeams)) {
        shares.add(share);
        errors.add((share - expected) * (share - expected));
      }
      CHECK(std::abs(shares.mean() - expected) <= 1.0 / samples + kSigmas * shares.standard_error());
      const double rms = std::sqrt(errors.mean()), at_random = std::sqrt(expected * (1 - expected) / samples);
      MESSAGE("edge at " << c << ", " << samples << " rays: share off by " << rms << " (at random " << at_random
                         << ")");
      CHECK(rms <= at_random * chance);
      if (samples % 2 == 0) {
        // Four times as many rays reduce the error at least to half, which is the reduction for random rays.
        if (samples > 8) CHECK(rms <= before / 2 * chance);
        before = rms;
      }
    }
  }
}

TEST_CASE("mixed ranges: the power-weighted mean if the pulse spans both walls, one of the two ranges if it does not") {
  const std::size_t kBeams = 2000 / kFewer;
  constexpr std::uint32_t kSamples = 256;
  const double longer = std::sqrt(1 + kSpread * kSpread);  // distance of a ray at the rim
  for (const double c : {-0.5, 0.0, 0.7}) {
    CAPTURE(c);
    const double share = disc_share_above(c);
    const double near_power = share / (kNear_m * kNear_m), far_power = (1 - share) / (kFar_m * kFar_m);
    const double mixed_m = (near_power * kNear_m + far_power * kFar_m) / (near_power + far_power);
    // d range / d share, and half the second derivative for what the variance of the shares adds to the mean.
    const double a = 1 / (kNear_m * kNear_m), b = 1 / (kFar_m * kFar_m), power = near_power + far_power;
    const double slope_m = a * b * (kFar_m - kNear_m) / (power * power), curve_m = slope_m * (a - b) / power;
    Moments ranges, shares;
    for (const Echo& echo : trace(edge(c), std::vector(kBeams, kAhead),
                                  {divergence(kSamples), std::make_shared<Returns>(ReturnChoice::strongest, 6.1)})) {
      ranges.add(echo.range_m);
      // Powers of the two walls for rays that are up to `longer` long and inclined accordingly.
      CHECK(echo.power < a);
      CHECK(echo.power > b / std::pow(longer, 3));
    }
    for (const double each : shares_in_front(c, kSamples, kBeams)) shares.add(each);
    const double tolerance_m = kSigmas * ranges.standard_error() + slope_m / kSamples +
                               2 * curve_m * shares.variance() + kFar_m * (std::pow(longer, 4) - 1);
    MESSAGE("edge at " << c << ": range " << ranges.mean() << " m, expected " << mixed_m << " m, tolerance "
                       << tolerance_m << " m");
    CHECK(std::abs(ranges.mean() - mixed_m) <= tolerance_m);
    // By default, pulses are shorter than that distance.
    const double strongest_m = near_power > far_power ? kNear_m : kFar_m;
    for (const Echo& echo : trace(edge(c), {kAhead, kAhead}, {divergence(kSamples)})) {
      CHECK(echo.range_m >= strongest_m);
      CHECK(echo.range_m <= strongest_m * longer);
    }
  }
}

// Rays in opposite pairs: at a plane of slope s their distances along the axis are h / (1 -+ s t).
TEST_CASE("the middle of a slanted plane has its own range, up to the second order of the cone") {
  DrawList list;
  const double slope = 3;  // x falls by 3 m per metre of y
  Mesh wall;
  wall.positions = {{10, 0, -4}, {10, 0, 4}, {7, 1, 4}, {7, 1, -4}, {13, -1, 4}, {13, -1, -4}};
  wall.indices = {0, 1, 2, 0, 2, 3, 0, 1, 4, 0, 4, 5};
  add_item(list, wall, glm::dmat4(1));
  for (const std::uint32_t samples : {2u, 3u, 16u}) {
    const std::vector<Echo> echoes =
        trace(list, std::vector(50, kAhead), {divergence(samples), std::make_shared<Returns>(ReturnChoice::first, 2)});
    for (const Echo& echo : echoes) {
      // With u = s t, the mixture of range u^2, power 1/range^2 and cosine changes by a few u^2. The factor 8 is above
      // the sum of them.
      const double u = slope * kSpread;
      CHECK(std::abs(echo.range_m - 10) <= 10 * 8 * u * u);
      CHECK(std::abs(echo.range_m - 10) <= echo.error_bound_m);
      // The rays of a pulse are at most 2 u apart, as a share of the range, and each may differ from its part of the
      // beam by 2 u / sqrt(samples): below 4 u with the second order.
      CHECK(echo.error_bound_m <= 10 * 4 * u);
    }
  }
}

// The light of the whole cone, for which very many rays stand: theirs differ from it by the sample of one of them.
TEST_CASE("the bound of a beam that is a cone covers what few rays leave out of a plane") {
  constexpr std::uint32_t kVeryMany = 16384;
  double worst = 0;
  for (const double incidence_deg : {0.0, 30.0, 60.0, 80.0, 84.0, 88.0}) {
    for (const double spread_deg : {0.05, 0.5, 2.0}) {
      CAPTURE(incidence_deg);
      CAPTURE(spread_deg);
      DrawList list;
      const double slope = std::tan(glm::radians(incidence_deg)), reach = 900;
      Mesh wall;  // through (10, 0, 0)
      wall.positions = {{10 - reach * slope, reach, -reach},
                        {10 - reach * slope, reach, reach},
                        {10 + reach * slope, -reach, reach},
                        {10 + reach * slope, -reach, -reach}};
      wall.indices = {0, 1, 2, 0, 2, 3, 0, 2, 1, 0, 3, 2};
      add_item(list, wall, glm::dmat4(1));
      const auto echoes_with = [&](std::uint32_t samples) {
        return trace(list, std::vector(samples == kVeryMany ? 1 : 20, kAhead),
                     {std::make_shared<BeamDivergence>(glm::radians(spread_deg), samples, SensorRandom(1, "S")),
                      std::make_shared<Returns>(ReturnChoice::first, 1e9)});
      };
      const double whole_m = echoes_with(kVeryMany)[0].range_m;
      for (const std::uint32_t samples : {1u, 2u, 7u, 32u}) {
        for (const Echo& echo : echoes_with(samples)) {
          const double error_m = std::abs(echo.range_m - whole_m);
          CHECK(error_m <= echo.error_bound_m);
          if (std::isfinite(echo.error_bound_m)) worst = std::max(worst, error_m / echo.error_bound_m);
        }
      }
    }
  }
  MESSAGE("an error up to " << worst << " of its bound");
}

TEST_CASE("patterns depend on seed and beam, not on the frame") {
  const auto places = [](std::uint64_t seed, std::uint64_t frame, std::size_t beams) {
    const auto probe = std::make_shared<Probe>();
    ScanContext moment = moment_of(beams);
    moment.time.index = frame;
    const std::shared_ptr<RayCaster> caster = make_host_ray_caster();
    trace(edge(0), std::vector(beams, kAhead), {divergence(2, seed), probe}, moment, *caster);
    std::vector<glm::dvec3> directions;
    for (const BeamRay& ray : probe->rays) directions.push_back(ray.direction);
    return directions;
  };
  const std::vector<glm::dvec3> here = places(1, 0, 3);
  CHECK(places(1, 7, 3) == here);
  CHECK(places(2, 0, 3) != here);
  CHECK(here[0] != here[2]);
  CHECK(std::vector(here.begin(), here.begin() + 2) == places(1, 0, 1));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
