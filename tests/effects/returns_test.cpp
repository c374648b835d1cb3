// The effect `returns`: which echoes are merged, and what a scanner reports of a fence and of leaves.
#include "effects/scanner/returns.h"

#include <doctest/doctest.h>

#include <random>

#include "effects/scanner/beam_divergence.h"
#include "tests/support/traced_beams.h"

TEST_SUITE_BEGIN("effects");

namespace simvis {
namespace {

const glm::dvec3 kForward(1, 0, 0);

Echo echo(double range_m, double power, double bound_m = 0) {
  return {.range_m = range_m, .error_bound_m = bound_m, .power = power};
}

std::vector<Echo> merged(std::vector<Echo> echoes, double pulse_length_m) {
  merge_pulses(pulse_length_m, echoes);
  return echoes;
}

std::shared_ptr<const Returns> returns(ReturnChoice choice, double pulse_length_m = kPulseLength_m) {
  return std::make_shared<Returns>(choice, pulse_length_m);
}

TEST_CASE("echoes without a gap become one pulse with the mean by power and the sum of powers") {
  const std::vector<Echo> two = merged({echo(5, 1), echo(6, 3)}, 1);
  REQUIRE(two.size() == 1);
  CHECK(two[0].range_m == 5.75);  // exact in double
  CHECK(two[0].power == 4);
  CHECK(merged({echo(5, 1), echo(6.001, 3)}, 1).size() == 2);
  // A chain without gaps between neighbours is one pulse of any length. One more echo lies farther away.
  const std::vector<Echo> chain = merged({echo(5, 1), echo(5.5, 1), echo(6, 1), echo(6.5, 1), echo(8, 2)}, 0.5);
  REQUIRE(chain.size() == 2);
  CHECK(chain[0].range_m == 5.75);
  CHECK(chain[1].range_m == 8);
  // Surfaces that return nothing: all of them, and one among others.
  CHECK(merged({echo(5, 0), echo(6, 0)}, 1)[0].range_m == 5.5);
  CHECK(merged({echo(5, 0), echo(6, 2)}, 1)[0].range_m == 6);
  // Single echoes stay unchanged to the bit for every pulse length. No length merges separate echoes.
  const std::vector<Echo> lone = merged({echo(0.1, 0.3, 1e-9)}, 1e9);
  CHECK(lone[0].range_m == 0.1);
  CHECK(lone[0].error_bound_m == 1e-9);
  CHECK(merged({echo(5, 1), echo(5, 1), echo(5 + 1e-15, 1)}, 0).size() == 2);
  CHECK(merged({}, 1).empty());
}

// True ranges and powers, and echoes that deviate by up to their bounds: the mean of the deviating echoes stays within
// its bound.
TEST_CASE("the bound of a pulse covers all allowed errors of its echoes") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  double worst = 0;
  for (int turn = 0; turn < 20000; ++turn) {
    std::vector<Echo> echoes;
    double power = 0, moment = 0;
    const double start_m = 0.5 + 20 * unit(random), error_m = start_m * std::pow(10, -12 + 10 * unit(random));
    const std::size_t count = 2 + random() % 8;
    for (std::size_t i = 0; i < count; ++i) {
      const double true_m = start_m + unit(random), reflectance = unit(random);
      power += reflectance / (true_m * true_m);
      moment += reflectance / true_m;
      // The worst case is near echoes off in one direction and far ones in the other: all corners are tried.
      const double off_m = error_m * (static_cast<int>(random() % 3) - 1);
      const double seen = reflectance * (1 + 0x1p-24 * (static_cast<int>(random() % 3) - 1));
      echoes.push_back(echo(true_m + off_m, seen / std::pow(true_m + off_m, 2), error_m));
    }
    std::ranges::sort(echoes, {}, &Echo::range_m);
    const std::vector<Echo> pulse = merged(echoes, 2);
    REQUIRE(pulse.size() == 1);
    const double use = std::abs(pulse[0].range_m - moment / power) / pulse[0].error_bound_m;
    worst = std::max(worst, use);
  }
  MESSAGE("error at most " << worst << " of the bound");
  CHECK(worst <= 1);
}

TEST_CASE("which return is reported, and the number of returns") {
  const std::vector<Echo> echoes{echo(3, 1), echo(5, 4), echo(9, 2)};
  const ScanContext moment = moment_of(2);
  const auto choice = [&](ReturnChoice choice) {
    Echo detected;
    CHECK(returns(choice)->detect(moment, 0, echoes, detected));
    CHECK(detected.returns == 3);
    return detected.range_m;
  };
  CHECK(choice(ReturnChoice::first) == 3);
  CHECK(choice(ReturnChoice::strongest) == 5);
  CHECK(choice(ReturnChoice::last) == 9);
  Echo none;
  CHECK_FALSE(returns(ReturnChoice::first)->detect(moment, 0, {}, none));
  CHECK(std::isinf(none.range_m));
  // Surfaces beyond range_max count only if there is no other surface, and then as a miss.
  DrawList list;
  add_item(list, plate_mesh(50, {-5, -5}, {5, 5}), glm::dmat4(1));
  ScanContext near = moment;
  near.range_max_m = 40;
  const std::shared_ptr<RayCaster> caster = make_host_ray_caster();
  const auto seen = [&] {
    const std::vector<Echo> detected = trace(list, {kForward, -kForward}, {returns(ReturnChoice::last)}, near, *caster);
    Scan scan;
    returns(ReturnChoice::last)->finish(near, detected, scan);
    CHECK(scan.channels().front().name == "return_count");
    CHECK(scan.channel("return_count")[1] == 0);
    return std::pair(detected[0].range_m, scan.channel("return_count")[0]);
  };
  CHECK(seen() == std::pair(50.0, 0.0));
  near.range_max_m = 60;
  CHECK(seen() == std::pair(50.0, 1.0));
}

// Bars of 2 cm every 6 cm, 5 m away, in front of a wall at 9 m. The footprint of the beam is 20 cm wide and covers
// several bars.
TEST_CASE("through a fence, the first return is the bars and the last one the wall, in shares of the closed form") {
  constexpr double kBars_m = 5, kWall_m = 9, kWidth_m = 0.02, kPitch_m = 0.06, kSpread = 0.02;
  constexpr std::uint32_t kSamples = 512;
  const std::size_t kBeams = 300 / kFewer;
  DrawList list;
  double covered = 0;
  for (int bar = -5; bar <= 5; ++bar) {
    const double low = kPitch_m * bar + 0.005, high = low + kWidth_m;
    add_item(list, plate_mesh(kBars_m, {low, -1}, {high, 1}), glm::dmat4(1));
    const double radius_m = kBars_m * kSpread;
    covered += disc_share_above(low / radius_m) - disc_share_above(high / radius_m);
  }
  add_item(list, plate_mesh(kWall_m, {-3, -3}, {3, 3}), glm::dmat4(1));
  const auto spread =
      std::make_shared<BeamDivergence>(2 * std::atan(kSpread), kSamples, SensorRandom(0, "S/beam_divergence"));
  const double longer = std::sqrt(1 + kSpread * kSpread);
  const auto check = [&](ReturnChoice choice, double expected_m) {
    Moments powers;
    const double share = expected_m == kBars_m ? covered : 1 - covered;
    for (const Echo& each : trace(list, std::vector(kBeams, kForward), {spread, returns(choice)})) {
      CHECK(each.returns == 2);
      CHECK(each.range_m >= expected_m);
      CHECK(each.range_m <= expected_m * longer);
      powers.add(each.power * expected_m * expected_m);
    }
    // The mean over turns is that of the midpoint rule, once for each edge of every bar in the footprint (see
    // beam_divergence_test). At most 7 bars are in it.
    const double tolerance = 7.0 / kSamples + kSigmas * powers.standard_error() + (1 - std::pow(longer, -3));
    MESSAGE("at " << expected_m << " m: share " << powers.mean() << ", expected " << share);
    CHECK(std::abs(powers.mean() - share) <= tolerance);
  };
  check(ReturnChoice::first, kBars_m);
  check(ReturnChoice::last, kWall_m);
  // 0.33 / 25 is more than 0.67 / 81.
  CHECK(covered / (kBars_m * kBars_m) > (1 - covered) / (kWall_m * kWall_m));
  check(ReturnChoice::strongest, kBars_m);
}

constexpr double kLeaves_m = 3, kBehind_m = 6;
constexpr int kTexels = 16;

/// A curtain of 2 m x 2 m in front of a wall. Equal numbers of texels have the alphas 1, 0.6, 0.4 and 0. Texels of 0.5
/// and more form a checkerboard.
DrawList leaves(float opacity, float cutoff) {
  DrawList list;
  add_item(list, plate_mesh(kBehind_m, {-4, -4}, {4, 4}), glm::dmat4(1));
  auto texture = std::make_shared<Texture>();
  texture->width = texture->height = kTexels;
  for (int y = 0; y < kTexels; ++y) {
    for (int x = 0; x < kTexels; ++x) {
      const int alpha[2][2] = {{255, 102}, {153, 0}};
      for (int c = 0; c < 3; ++c) texture->rgba.push_back(255);
      texture->rgba.push_back(static_cast<std::uint8_t>(alpha[y % 2][(x + y) % 2]));
    }
  }
  texture->sampler = {.magnify = Filter::nearest, .minify = Filter::nearest, .mipmapped = false};
  Material material;
  material.alpha_mode = AlphaMode::mask;
  material.alpha_cutoff = cutoff;
  material.opacity = opacity;
  material.base_color_texture = texture;
  Mesh curtain = plate_mesh(kLeaves_m, {-1, -1}, {1, 1});
  add_item(list, curtain, glm::dmat4(1));
  curtain.attributes.resize(4);
  compute_bounds(curtain);
  const glm::vec2 uvs[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (std::size_t i = 0; i < 4; ++i) curtain.attributes[i].uv[0] = uvs[i];
  list.meshes[1] = std::make_shared<Mesh>(curtain);
  list.materials.push_back(std::make_shared<Material>(material));
  list.material_revision.push_back(0);
  list.items[1].material = 1;
  return list;
}

/// Directions to random points of the curtain, uniformly distributed.
std::vector<glm::dvec3> into_leaves(std::size_t count, double half_m) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-half_m, half_m);
  std::vector<glm::dvec3> directions(count);
  for (glm::dvec3& direction : directions) {
    const double y = place(random), z = place(random);
    direction = glm::normalize(glm::dvec3(kLeaves_m, y, z));
  }
  return directions;
}

struct Cover {
  float opacity, cutoff;
  double share;  // of texels that are hit
};
constexpr Cover kCovers[] = {{1, 0.3f, 0.75}, {1, 0.5f, 0.5}, {0.6f, 0.5f, 0.5}, {1, 0.7f, 0.25}, {0.4f, 0.3f, 0}};

TEST_CASE("the share of a million beams that pass through leaves is the area of the holes") {
  const std::size_t beams = 1000000 / kFewer;
  const std::vector<glm::dvec3> directions = into_leaves(beams, 1);
  const Cover cover = kCovers[1];
  std::size_t met = 0;
  for (const Echo& each : trace(leaves(cover.opacity, cover.cutoff), directions, {returns(ReturnChoice::last)})) {
    REQUIRE(each.returns == 1);
    met += each.range_m < 4;
  }
  const double share = static_cast<double>(met) / static_cast<double>(beams);
  const double tolerance = kSigmas * std::sqrt(cover.share * (1 - cover.share) / static_cast<double>(beams));
  MESSAGE("share that is met " << share << ", expected " << cover.share << ", tolerance " << tolerance);
  CHECK(std::abs(share - cover.share) <= tolerance);
}

// Brute force: independent random rays over the same cones, cast by the plain caster.
TEST_CASE("wide beams through leaves agree with counts by the plain caster at several opacities") {
  constexpr double kSpread =
      0.01;  // 6 cm wide at the leaves, whose texels are 12.5 cm wide: some beams hit one kind only
  constexpr std::uint32_t kSamples = 32;
  const std::size_t beams = 4000 / kFewer;
  const std::vector<glm::dvec3> axes = into_leaves(beams, 0.85);
  const std::shared_ptr<RayCaster> caster = make_host_ray_caster();
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const Cover& cover : kCovers) {
    CAPTURE(cover.opacity);
    CAPTURE(cover.cutoff);
    const DrawList list = leaves(cover.opacity, cover.cutoff);
    Moments brute_met, brute_both;
    caster->set_world(list);
    for (const glm::dvec3& axis : axes) {
      const glm::dvec3 x = glm::normalize(glm::cross(axis, glm::dvec3(0, 0, 1))), y = glm::cross(x, axis);
      std::vector<glm::dvec3> rays;
      while (rays.size() < kSamples) {
        const double a = unit(random), b = unit(random);
        if (a * a + b * b < 1) rays.push_back(glm::normalize(axis + kSpread * (a * x + b * y)));
      }
      std::vector<RayHit> hits(rays.size());
      caster->cast(glm::dmat4(1), rays, hits);
      const auto met = std::ranges::count_if(hits, [](const RayHit& hit) { return hit.item == 1; });
      brute_met.add(static_cast<double>(met) / kSamples);
      // The number of beams with two returns: beams whose rays do not all hit the same. Random rays find slightly
      // fewer.
      brute_both.add(met > 0 && met < kSamples);
    }
    const auto probe = std::make_shared<Probe>();
    const auto spread =
        std::make_shared<BeamDivergence>(2 * std::atan(kSpread), kSamples, SensorRandom(0, "S/beam_divergence"));
    const std::vector<Echo> first = trace(list, axes, {spread, probe, returns(ReturnChoice::first)});
    const std::vector<Echo> last = trace(list, axes, {spread, returns(ReturnChoice::last)});
    Moments met, both;
    for (std::size_t beam = 0; beam < beams; ++beam) {
      const auto near = std::ranges::count_if(probe->echoes[beam], [](const Echo& e) { return e.range_m < 4.5; });
      met.add(static_cast<double>(near) / kSamples);
      both.add(first[beam].returns == 2);
      // The distance of 3 m or more between leaves and wall is longer than a pulse.
      CHECK((first[beam].range_m < 4.5) == (near > 0));
      CHECK((last[beam].range_m > 4.5) == (near < static_cast<std::ptrdiff_t>(kSamples)));
      CHECK(first[beam].returns == last[beam].returns);
    }
    MESSAGE("opacity " << cover.opacity << ", cutoff " << cover.cutoff << ": met " << met.mean() << ", counted "
                       << brute_met.mean() << "; two returns " << both.mean() << ", counted " << brute_both.mean());
    // Both use the same axes but are treated as independent, which only widens the tolerance.
    const double tolerance = kSigmas * std::hypot(met.standard_error(), brute_met.standard_error());
    CHECK(std::abs(met.mean() - brute_met.mean()) <= tolerance);
    // An evenly spread pattern finds slivers more often than random rays do, which miss an area share a with
    // probability (1 - a)^32. It finds them never less often, apart from chance.
    CHECK(both.mean() >= brute_both.mean() - kSigmas * std::hypot(both.standard_error(), brute_both.standard_error()));
    // The axes cover equal areas of each kind of texel.
    CHECK(std::abs(brute_met.mean() - cover.share) <= kSigmas * brute_met.standard_error());
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
