// Infrared distance sensors (PSD) in front of surfaces whose light spot follows from geometry; the voltage curve; the
// noise.
#include "sensors/psd/psd.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <optional>

#include <simvis/device.h>
#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "engine/render/renderer.h"
#include "tests/support/infinity.h"
#include "tests/support/random_room.h"
#include "tests/support/run_process.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;

namespace {

// Vertices within 2 m are rounded to 2 * 2^-24 several times; depth is set up and stored in float32.
constexpr double kDepthTolerance_m = 16 * 2 * 0x1p-24;

Device& shared_device() {
  static Device device;
  return device;
}

struct PsdStage {
  Renderer renderer{shared_device()};
  DrawList list;

  void take(Psd& psd, const glm::dmat4& world_from_sensor = glm::dmat4(1.0)) {
    FramePlan plan;
    if (list.world_from_node.empty()) list.world_from_node.push_back(glm::dmat4(1.0));
    psd.plan(world_from_sensor, list, plan);
    psd.collect({}, plan, renderer.render(list, plan));
  }
};

glm::dmat4 psd_at(double x, double y, double z) { return glm::translate(glm::dmat4(1.0), {x, y, z}); }

/// A plate perpendicular to x whose front is at x = range_m, from y_min to y_max and z_min to z_max.
void add_plate(DrawList& list, double range_m, double y_min, double y_max, double z_min, double z_max) {
  constexpr double kHalfThickness_m = 0.005;
  add_item(list, half_box_mesh(glm::dvec3(kHalfThickness_m, (y_max - y_min) / 2, (z_max - z_min) / 2)),
           psd_at(range_m + kHalfThickness_m, (y_min + y_max) / 2, (z_min + z_max) / 2));
}

const VoltageCurve& curve() {
  static const VoltageCurve instance = parse_voltage_curve("gp2y0a21yk").value();
  return instance;
}

double range_of(const Psd& psd) { return *psd.measurement().value("range_m"); }
double voltage_of(const Psd& psd) { return *psd.measurement().value("voltage_v"); }

const PsdDesc kAnyRange{.opening_rad = glm::radians(5.0), .limits = {0, 100}};

struct Point {
  double range_m, voltage_v;
};
// A second copy of the datasheet's points: a typing error would have to be made twice.
constexpr Point kDatasheet[] = {{0.06, 3.1}, {0.1, 2.3}, {0.15, 1.65}, {0.2, 1.3},  {0.25, 1.08}, {0.3, 0.92},
                                {0.4, 0.74}, {0.5, 0.6}, {0.6, 0.51},  {0.7, 0.45}, {0.8, 0.4}};

}  // namespace

TEST_CASE("the voltage passes through the datasheet's points and is linear in 1 / range between them") {
  constexpr double kRounding_v = 8 * 3.1 * 0x1p-53;
  for (const Point& p : kDatasheet) CHECK(std::abs(curve().at(p.range_m) - p.voltage_v) <= kRounding_v);
  // The midpoint between 1/0.25 and 1/0.2 is 1/0.2222...
  CHECK(std::abs(curve().at(2 / 9.0) - (1.3 + 1.08) / 2) <= kRounding_v);
  // The last segment, from (1/0.7, 0.45) to (1/0.8, 0.40), continues with 0.28 V m.
  CHECK(std::abs(curve().at(1.6) - (0.40 - 0.28 / 1.6)) <= kRounding_v);
  CHECK(std::abs(curve().at(kInfinity) - 0.05) <= kRounding_v);
  // The voltage falls again before the first point: 3 cm read like a range between 15 and 20 cm.
  CHECK(std::abs(curve().at(0.03) - 1.55) <= kRounding_v);
  CHECK(curve().at(0) == 0);
}

TEST_CASE("a user's own curve") {
  const std::optional<VoltageCurve> own = parse_voltage_curve(" 0.5:2  1:1 2:0.8");
  REQUIRE(own);
  CHECK(own->at(0.5) == 2);
  CHECK(own->at(2.0 / 3) == 1.5);
  CHECK(own->at(1) == 1);
  CHECK(own->at(0.25) == 1);
  CHECK(own->at(2) == 0.8);
  for (const char* wrong : {"", "0.5:2", "0.5:2 0.5:1", "1:1 0.5:2", "0:1 1:2", "-1:1 1:2", "1:1 2", "1:1 2:", "1:1 :2",
                            "1:1 2:nan", "1:1 inf:2", "1:1,2:2", "gp2y0a21", "1:1:1 2:2"}) {
    INFO(wrong);
    CHECK_FALSE(parse_voltage_curve(wrong));
  }
  CHECK_THROWS_WITH_AS(Simulation::from_string(R"(<sensor type="psd" name="IR" insert_at="ROOT" curve="sharp"/>)"),
                       R"(<string>:1:47: error: attribute "curve": "sharp" is not allowed, expected gp2y0a21yk or two )"
                       "points or more, as RANGE_M:VOLT, with increasing ranges above 0",
                       InputError);
}

TEST_CASE("a wall perpendicular to the cone reads its distance and the datasheet's voltage") {
  for (const Point& p : kDatasheet) {
    PsdStage stage;
    add_plate(stage.list, p.range_m, -1, 1, -1, 1);
    Psd psd("P", kAnyRange, curve());
    CHECK(std::isnan(range_of(psd)));
    stage.take(psd);
    CHECK(std::abs(range_of(psd) - p.range_m) <= kDepthTolerance_m);
    // The curve is nowhere steeper than its segment below 6 cm.
    CHECK(std::abs(voltage_of(psd) - p.voltage_v) <= kDepthTolerance_m * 3.1 / 0.06);
  }
}

TEST_CASE("a tilted wall reads the centroid of the returned light") {
  constexpr double kDistance_m = 0.3, kTilt_rad = 1.0, kOpening_rad = 0.35;
  constexpr std::uint32_t kResolution_px = 256;
  PsdStage stage;
  add_item(stage.list, half_box_mesh({0.005, 1, 1}),
           glm::rotate(psd_at(kDistance_m, 0, 0), kTilt_rad, {0, 0, 1}) * psd_at(0.005, 0, 0));
  Psd psd("P", {.opening_rad = kOpening_rad, .resolution_px = kResolution_px, .limits = {0, 100}}, curve());
  stage.take(psd);

  // The wall is x cos(tilt) + y sin(tilt) = D cos(tilt). Rings and sectors of the cone by the midpoint rule; the range
  // of the ray is r, its depth along the axis r cos(a).
  double light = 0, moment = 0;
  constexpr int kSteps = 1000;
  for (int i = 0; i < kSteps; ++i) {
    const double a = (i + 0.5) / kSteps * kOpening_rad / 2;
    for (int j = 0; j < kSteps; ++j) {
      const double phi = (j + 0.5) / kSteps * 2 * std::numbers::pi;
      const double r = kDistance_m * std::cos(kTilt_rad) /
                       (std::cos(a) * std::cos(kTilt_rad) + std::sin(a) * std::cos(phi) * std::sin(kTilt_rad));
      const double returned = std::sin(a) / (r * r);
      light += returned;
      moment += returned / (r * std::cos(a));
    }
  }
  const double expected_m = light / moment;
  // Effect of the slant: to first order 1 / range is (1 + 2 s^2 q) / D, with the slope s of the wall and q = rim^2 / 4,
  // the mean square of the tangent across the cone.
  const double slope = std::tan(kTilt_rad), rim = std::tan(kOpening_rad / 2);
  const double slant = 2 * slope * slope * rim * rim / 4;
  CHECK(slant > 0.03);
  CHECK(std::abs(kDistance_m / expected_m - 1 - slant) < slant / 4);
  // The disc of pixels differs from that of the cone by at most half a pixel's diagonal at the rim, and q by its
  // square. The error of the integral is far below. A factor of 2 covers the higher orders.
  const double rim_error = std::numbers::sqrt2 / 2 / (kResolution_px / 2.0);
  CHECK(std::abs(range_of(psd) - expected_m) <= kDistance_m * slant * 2 * rim_error * 2 + kDepthTolerance_m);
}

TEST_CASE("a target that fills a part of the cone counts by its area and its inverse squared distance") {
  constexpr double kNear_m = 0.2, kFar_m = 0.5;
  const auto mixed = [](double share) {
    const double light = share / (kNear_m * kNear_m) + (1 - share) / (kFar_m * kFar_m);
    return light / (share / std::pow(kNear_m, 3) + (1 - share) / std::pow(kFar_m, 3));
  };
  // Edges on the axis divide the even number of pixels equally, and the angular weights on both sides are the same.
  for (const bool quarter : {false, true}) {
    PsdStage stage;
    add_plate(stage.list, kNear_m, 0, 1, quarter ? 0 : -1, 1);
    Psd psd("P", kAnyRange, curve());
    stage.take(psd);
    CHECK(std::abs(range_of(psd) - kNear_m) <= kDepthTolerance_m);  // no surface behind it, so no light from there
    add_plate(stage.list, kFar_m, -1, 1, -1, 1);
    stage.take(psd);
    CHECK(std::abs(range_of(psd) - mixed(quarter ? 0.25 : 0.5)) <= kDepthTolerance_m);
  }
}

TEST_CASE("only surfaces in the cone count") {
  PsdStage stage;
  add_plate(stage.list, 0.5, -1, 1, -1, 1);
  // A pole beside the cone: at 0.25 m the cone of 5 degrees has a radius of 1.09 cm.
  add_plate(stage.list, 0.25, 0.0115, 0.1, -1, 1);
  Psd narrow("P", kAnyRange, curve());
  stage.take(narrow);
  CHECK(std::abs(range_of(narrow) - 0.5) <= kDepthTolerance_m);
  PsdDesc wide = kAnyRange;
  wide.opening_rad = glm::radians(8.0);
  Psd other("P", wide, curve());
  stage.take(other);
  CHECK(range_of(other) < 0.49);
}

TEST_CASE("an empty scene, and surfaces outside the limits") {
  PsdStage stage;
  Psd psd("P", {}, curve());
  stage.take(psd);
  CHECK(range_of(psd) == kInfinity);
  CHECK(voltage_of(psd) == curve().at(kInfinity));
  add_plate(stage.list, 0.9, -1, 1, -1, 1);
  stage.take(psd);
  CHECK(range_of(psd) == kInfinity);
  CHECK(std::abs(voltage_of(psd) - curve().at(0.9)) <= kDepthTolerance_m * 1);  // 0.28 V m / 0.9^2 m^2 is below 1 V/m
  // Seen from 0.82 m farther forward: 8 cm away.
  stage.take(psd, psd_at(0.82, 0, 0));
  CHECK(range_of(psd) == 0);
  CHECK(std::abs(voltage_of(psd) - curve().at(0.08)) <= kDepthTolerance_m * 3.1 / 0.06);
}

TEST_CASE("noise has the given standard deviation and does not change the range") {
  constexpr double kNoise_v = 0.02, kSigmas = 5;
  constexpr std::uint64_t kFrames = 100'000;
  PsdStage stage;
  add_plate(stage.list, 0.3, -1, 1, -1, 1);
  PsdDesc desc = kAnyRange;
  Psd exact("P", desc, curve());
  stage.take(exact);
  desc.noise_v = kNoise_v;
  Psd psd("P", desc, curve()), twin("P", desc, curve());
  FramePlan plan;
  psd.plan(glm::dmat4(1.0), stage.list, plan);
  const std::span<const PassResult> results = stage.renderer.render(stage.list, plan);
  double mean = 0, square = 0;
  for (std::uint64_t frame = 0; frame < kFrames; ++frame) {
    psd.collect({.index = frame}, plan, results);
    const double off = voltage_of(psd) - voltage_of(exact);
    mean += off / kFrames;
    square += off * off / kFrames;
  }
  CHECK(range_of(psd) == range_of(exact));
  // The mean of n draws has a deviation of sigma / sqrt(n), their variance one of sigma^2 sqrt(2 / n).
  CHECK(std::abs(mean) <= kSigmas * kNoise_v / std::sqrt(kFrames));
  CHECK(std::abs(square - kNoise_v * kNoise_v) <= kSigmas * kNoise_v * kNoise_v * std::sqrt(2.0 / kFrames));
  // The noise of a frame does not depend on earlier frames.
  twin.collect({.index = kFrames - 1}, plan, results);
  CHECK(voltage_of(twin) == voltage_of(psd));
}

namespace {

// 30 cm in front of the wall at x = 4 m.
const std::string kPsd = R"(<sensor type="psd" name="IR" insert_at="ROOT" pose_offset="3.7 0 0 0 0 0" noise="0.01"/>)";
}  // namespace

TEST_CASE("a psd has a voltage from its first frame on, and no other value than its own") {
  const TemporaryFolder folder;
  write_text(folder / "wall.gltf", wall_gltf());
  Simulation simulation = Simulation::from_string(std::string(kWallPart) + kPsd, {}, folder.path());
  CHECK(std::isnan(simulation.value("IR", "voltage_v")));
  simulation.step();
  CHECK(std::abs(simulation.value("IR", "range_m") - 0.3) <= 16 * 10 * 0x1p-24);  // the wall's corners are 10 m away
  CHECK_THROWS_WITH_AS(simulation.value("IR", "volts"), R"(sensor "IR", a psd, has no value "volts")", InputError);
}

TEST_CASE("simvis-run writes a table, and its --seed changes the noise") {
  const TemporaryFolder folder;
  const std::filesystem::path scene = write_wall_scene(folder.path(), kPsd);
  const auto table = [&](const std::string& out, const std::string& seed) {
    const ProcessResult result = Process({tested_build() + "/bin/simvis-run", "--quiet", "--frames", "2", "--out",
                                          (folder / out).string(), "--seed", seed, scene.string()})
                                     .wait();
    INFO(result.err);
    CHECK(result.exit_code == 0);
    return read_text(folder / out / "IR.csv");
  };
  const std::string one = table("one", "1");
  CHECK(one.starts_with("frame,time_s,range_m,voltage_v\n0,0.000000000,"));
  CHECK(table("again", "1") == one);
  CHECK(table("two", "2") != one);
}

TEST_CASE("limits that contradict each other are refused") {
  const std::string wrong = R"(<sensor type="psd" name="IR" insert_at="ROOT" range_min="0.5" range_max="0.4"/>)";
  CHECK_THROWS_WITH_AS(Simulation::from_string(wrong),
                       R"(<string>:1:63: error: attribute "range_max": 0.4 is not allowed with range_min="0.5", )"
                       "expected that or more",
                       InputError);
}

TEST_SUITE_END();
