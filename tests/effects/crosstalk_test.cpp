// The effect `crosstalk` against all pairs of beams of two scanners, which this test goes through without any search.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <simvis/simulation.h>
#include "tests/support/error_of.h"
#include "tests/support/infinity.h"
#include "tests/support/scan_effects.h"

TEST_SUITE_BEGIN("effects");

namespace simvis::disturbed {
namespace {

constexpr double kLight_mps = 299'792'458, kWall_m = 10, kRangeMax_m = 60, kSweep_s = 2e-6, kBeam_m = 0.3;
constexpr std::uint32_t kBeams = 181;
constexpr std::uint64_t kSeed = 7;
const std::string kAttributes = "crosstalk='OTHER' sweep='2e-6' beam_diameter='0.3' range_max='60'";

// A scanner with beams every half degree, in the plane z = 0 of its frame.
std::vector<glm::dvec3> fan() {
  std::vector<glm::dvec3> directions;
  for (std::uint32_t i = 0; i < kBeams; ++i) {
    directions.push_back(beam_direction(glm::radians(-45 + 90.0 * i / (kBeams - 1)), 0));
  }
  return directions;
}
double fired_s(std::uint32_t beam) { return kSweep_s * beam / (kBeams - 1); }

glm::dmat4 pose(const glm::dvec3& place_m, double yaw_deg) {
  const double a = glm::radians(yaw_deg);
  return {std::cos(a), std::sin(a), 0, 0, -std::sin(a), std::cos(a), 0,         0,
          0,           0,           1, 0, place_m.x,    place_m.y,   place_m.z, 1};
}

struct FalseEcho {
  std::uint32_t beam;
  double range_m, power, way_m = 0;
};

// A screen across the light of the other scanner: a plate at this x.
struct Screen {
  double x, y_low, y_high;
  bool between(const glm::dvec3& a, const glm::dvec3& b) const {
    const double share = (x - a.x) / (b.x - a.x), y = a.y + share * (b.y - a.y);
    return share > 0 && share < 1 && y > y_low && y < y_high;
  }
};

bool in_cone(const glm::dvec3& origin, const glm::dvec3& direction, const glm::dvec3& point) {
  const double along = glm::dot(point - origin, direction);
  return along > 0 && glm::length(point - origin - along * direction) < kBeam_m / 2;
}

std::vector<FalseEcho> expected(const glm::dmat4& other, std::uint32_t number, std::uint64_t frame,
                                const std::vector<Screen>& screens = {}) {
  const std::vector<glm::dvec3> directions = fan();
  const double turn_s = kSweep_s * kBeams / (kBeams - 1);
  const double begins_s = turn_s * SensorRandom(kSeed, "S/crosstalk").uniform(frame, number, 0);
  const glm::dvec3 place(other[3]);
  std::vector<FalseEcho> echoes;
  for (std::uint32_t i = 0; i < kBeams; ++i) {
    const glm::dvec3 end = kWall_m / directions[i].x * directions[i];
    const bool reaches = std::ranges::none_of(screens, [&](const Screen& each) { return each.between({}, end); });
    const bool lit = std::ranges::none_of(screens, [&](const Screen& each) { return each.between(end, place); });
    for (std::uint32_t j = 0; j < kBeams; ++j) {
      const glm::dvec3 fired(glm::dmat3(other) * directions[j]);
      for (int turn = -3; turn <= 3; ++turn) {
        const double after_s = begins_s + turn * turn_s + fired_s(j) - fired_s(i);
        const double back_m = glm::length(end), way_m = glm::length(end - place);
        const double scattered_m = (kLight_mps * after_s + way_m + back_m) / 2;
        if (reaches && lit && place.x < kWall_m && in_cone(place, fired, end) && scattered_m > 0 &&
            scattered_m <= kRangeMax_m) {
          echoes.push_back(
              {i, scattered_m, directions[i].x / (back_m * back_m), way_m + back_m});  // both beams are equally wide
        }
        const double direct_m = (kLight_mps * after_s + glm::length(place)) / 2;
        if (in_cone({}, directions[i], place) && place.x < kWall_m && in_cone(place, fired, {}) && direct_m > 0 &&
            direct_m <= kRangeMax_m) {
          echoes.push_back({i, direct_m, 4 / (kBeam_m * kBeam_m), glm::length(place)});
        }
      }
    }
  }
  return echoes;
}

DrawList wall_and(const std::vector<Screen>& screens) {
  DrawList list;
  Material white;
  white.reflectance = 1;
  add_item(list, plate_mesh({0, 40, 0}, {0, 0, 5}), glm::translate(glm::dmat4(1), {kWall_m, 0, 0}), white);
  for (const Screen& each : screens) {
    add_item(list, plate_mesh({0, (each.y_high - each.y_low) / 2, 0}, {0, 0, 5}),
             glm::translate(glm::dmat4(1), {each.x, (each.y_high + each.y_low) / 2, 0}), white);
  }
  return list;
}

std::vector<FalseEcho> measured(const DrawList& list, const std::vector<OtherScanner>& others, std::uint64_t frame,
                                const std::string& attributes = kAttributes, double extinction_per_m = 0) {
  std::vector<ChosenScanEffect> effects = effects_of(attributes, "crosstalk", "S", kSeed);
  const auto log = std::make_shared<EchoLog>();
  effects.push_back({nullptr, log});
  ScanContext moment{.time = {.index = frame}, .rings = 1, .beams = kBeams, .range_max_m = kRangeMax_m};
  moment.others = others;
  moment.medium.laser_extinction_per_m = extinction_per_m;
  const auto caster = make_host_ray_caster();
  caster->set_world(list);
  TracedScan(fan(), effects).trace(moment, list, *caster);
  std::vector<FalseEcho> echoes;
  const std::vector<glm::dvec3> directions = fan();
  for (std::uint32_t beam = 0; beam < kBeams; ++beam) {
    REQUIRE(std::ranges::is_sorted(log->log()[beam], {}, &Echo::range_m));
    for (const Echo& echo : log->log()[beam]) {
      if (echo.error_bound_m == 0)
        echoes.push_back({beam, echo.range_m, echo.power});  // those of surfaces have a bound
    }
  }
  return echoes;
}

void check_same(std::vector<FalseEcho> seen, std::vector<FalseEcho> wanted) {
  // Times of microseconds have roundings of 2e-22 s, or 1e-13 m; the way of a ray some more.
  constexpr double kRange_m = 1e-9, kPower = 1e-9;
  const auto order = [](const FalseEcho& a, const FalseEcho& b) {
    return std::pair(a.beam, a.range_m) < std::pair(b.beam, b.range_m);
  };
  std::ranges::sort(seen, order);
  std::ranges::sort(wanted, order);
  REQUIRE(seen.size() == wanted.size());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    CHECK(seen[i].beam == wanted[i].beam);
    CHECK(std::abs(seen[i].range_m - wanted[i].range_m) <= kRange_m);
    CHECK(std::abs(seen[i].power - wanted[i].power) <= kPower * wanted[i].power);
  }
}

}  // namespace

TEST_CASE("false echoes come from surfaces that both scanners light up while a beam listens, and from nowhere else") {
  std::size_t all = 0;
  for (const auto& [place, yaw_deg] : {std::pair(glm::dvec3(0, 3, 0), 0.0), std::pair(glm::dvec3(2, -4, 0), 25.0),
                                       std::pair(glm::dvec3(-5, 1, 0), -10.0)}) {
    const glm::dmat4 other = pose(place, yaw_deg);
    for (std::uint64_t frame = 0; frame < 5; ++frame) {
      const std::vector<FalseEcho> wanted = expected(other, 4, frame);
      all += wanted.size();
      check_same(measured(wall_and({}), {{4, other}}, frame), wanted);
    }
  }
  CHECK(all > 100);
  const glm::dmat4 away = pose({0, 3, 0}, 180);
  CHECK(measured(wall_and({}), {{0, away}}, 0).empty());
  CHECK(measured(wall_and({}), {}, 0).empty());
  // A scanner where this one stands is this one.
  CHECK(measured(wall_and({}), {{0, pose({0, 0.1, 0}, 0)}}, 0).empty());
}

TEST_CASE("what stands between the other scanner and a surface hides what it lights up there") {
  // The screen shades a part of the wall from the other scanner and no beam of this one.
  const Screen screen{8, 9, 14};
  const glm::dmat4 other = pose({0, 12, 0}, -30);
  std::size_t open = 0, hidden = 0;
  for (std::uint64_t frame = 0; frame < 10; ++frame) {
    const std::vector<FalseEcho> wanted = expected(other, 0, frame, {screen});
    open += expected(other, 0, frame).size();
    hidden += wanted.size();
    check_same(measured(wall_and({screen}), {{0, other}}, frame), wanted);
  }
  CHECK(hidden > 10);
  CHECK(hidden < open);
}

TEST_CASE("light from one scanner straight into the other needs both beams, and no surface between") {
  const glm::dmat4 facing = pose({6, 1, 0}, 180);
  std::size_t all = 0;
  for (std::uint64_t frame = 0; frame < 40; ++frame) {
    const std::vector<FalseEcho> wanted = expected(facing, 1, frame);
    all += wanted.size();
    check_same(measured(wall_and({}), {{1, facing}}, frame), wanted);
    CHECK(measured(wall_and({{3, -5, 5}}), {{1, facing}}, frame).empty());
  }
  CHECK(all > 10);
}

TEST_CASE("each scan and each other scanner has a phase of its own, the same in every run; false ranges are even") {
  const glm::dmat4 other = pose({0, 3, 0}, 0);
  const DrawList list = wall_and({});
  // Beams of 8 cm, so that the middle one of this scanner has its place on the wall in common with one of the other.
  const auto ranges = [&](std::uint32_t number, std::uint64_t scans) {
    std::vector<double> all;
    for (std::uint64_t frame = 0; frame < scans; ++frame) {
      for (const FalseEcho& each : measured(list, {{number, other}}, frame,
                                            "crosstalk='OTHER' sweep='2e-6' beam_diameter='0.08' range_max='60'")) {
        if (each.beam == kBeams / 2) all.push_back(each.range_m);
      }
    }
    return all;
  };
  CHECK(ranges(0, 50) == ranges(0, 50));
  CHECK(ranges(0, 50) != ranges(1, 50));
  constexpr double kScans = 1200, kSigmas = 5, kTurn_s = kSweep_s * kBeams / (kBeams - 1);
  const std::vector<double> all = ranges(0, static_cast<std::uint64_t>(kScans));
  const double share = 2 * kRangeMax_m / kLight_mps / kTurn_s, count = static_cast<double>(all.size());
  CHECK(std::abs(count - kScans * share) <= kSigmas * std::sqrt(kScans * share * (1 - share)));
  constexpr std::size_t kBins = 6;
  std::array<double, kBins> bins{};
  for (const double range_m : all) ++bins.at(static_cast<std::size_t>(range_m / kRangeMax_m * kBins));
  double chi_square = 0;
  for (const double bin : bins) chi_square += (bin - count / kBins) * (bin - count / kBins) / (count / kBins);
  MESSAGE(count << " false echoes, chi-square " << chi_square << " with 5 degrees of freedom");
  CHECK(chi_square < 35.9);  // exceeded with a probability of 1e-6
}

TEST_CASE("the air dims pulses by their way, and the mistakes of a scene are named") {
  const glm::dmat4 other = pose({0, 3, 0}, 0);
  constexpr double kExtinction = 0.03;
  std::uint64_t frame = 0;
  while (expected(other, 0, frame).empty()) ++frame;
  std::vector<FalseEcho> dimmed = expected(other, 0, frame);
  for (FalseEcho& each : dimmed) each.power *= std::exp(-kExtinction * each.way_m);
  check_same(measured(wall_and({}), {{0, other}}, frame, kAttributes, kExtinction), dimmed);
  const std::string none = "crosstalk='OTHER' ";
  CHECK(contains(error_of([&] { effects_of(none); }), "all beams leave at the same time, expected a sweep above 0"));
  CHECK(contains(error_of([&] {
                   measured(wall_and({}), {{0, other}}, 0, none + "sweep='1e-7' range_max='60'");
                 }),
                 "is shorter than the way of light to range_max and back, expected a longer sweep"));
}

TEST_CASE("a scanner asks its scene for the others, and only for those that its pattern names") {
  const auto scans_with = [](const std::string& attributes) {
    Simulation simulation = Simulation::from_string(R"(<simvis>
  <part shape="box" size="0.02 80 20" name="WALL" insert_at="ROOT" pose_offset="10.01 0 0 0 0 0"/>
  <part name="OTHER_A" insert_at="ROOT" pose_offset="0 3 0 0 0 0"/>
  <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="181" min_angle="-45" max_angle="45"
          sweep="2e-6" beam_diameter="0.3" return="last" )" +
                                                    attributes + "/>\n</simvis>\n");
    std::vector<float> all;
    for (int frame = 0; frame < 20; ++frame) {
      simulation.step();
      const auto& ranges_m = simulation.scan("SCAN").range_m;
      all.insert(all.end(), ranges_m.begin(), ranges_m.end());
    }
    return all;
  };
  const std::vector<float> plain = scans_with("");
  CHECK(scans_with("crosstalk=\"NOBODY_*\"") == plain);
  const std::vector<float> disturbed = scans_with("crosstalk=\"OTHER_*\"");
  // Most of the even ranges up to 80 m are behind the wall.
  std::size_t farther = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) farther += disturbed[i] > plain[i];
  CHECK(farther > 20);
  CHECK(farther < plain.size() / 2);
}

}  // namespace simvis::disturbed

TEST_SUITE_END();
