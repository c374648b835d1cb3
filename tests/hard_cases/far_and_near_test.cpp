// Far from the world's origin, far from the sensor and close to it, and combinations.
#include <doctest/doctest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <string>
#include <vector>

#include <simvis/device.h>
#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "engine/render/renderer.h"
#include "sensors/camera/camera.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/hard_cases/part_file.h"
#include "tests/support/infinity.h"
#include "tests/support/measured_images.h"
#include "tests/support/random_room.h"
#include "tests/support/reference_directions.h"

TEST_SUITE_BEGIN("hard_cases");

using namespace simvis;

namespace {

glm::dmat4 at(const glm::dvec3& place) { return glm::translate(glm::dmat4(1.0), place); }

/// Range to an axis-aligned box from outside, or from inside to its inner side; infinite if the beam misses it.
double range_to_box(const glm::dvec3& d, const glm::dvec3& low, const glm::dvec3& high) {
  double first = -kInfinity, last = kInfinity;
  for (int axis = 0; axis < 3; ++axis) {
    if (d[axis] == 0 && (low[axis] > 0 || high[axis] < 0)) return kInfinity;
    if (d[axis] == 0) continue;
    first = std::max(first, std::min(low[axis] / d[axis], high[axis] / d[axis]));
    last = std::min(last, std::max(low[axis] / d[axis], high[axis] / d[axis]));
  }
  if (first > last || last <= 0) return kInfinity;
  return first > 0 ? first : last;
}

double range_to_box_at(const glm::dvec3& d, const glm::dvec3& middle, const glm::dvec3& half_m) {
  return range_to_box(d, middle - half_m, middle + half_m);
}

ScanPattern all_around() {
  return {.beams = 181,
          .rings = 21,
          .min_azimuth_rad = -kPi,
          .max_azimuth_rad = kPi,
          .min_elevation_rad = -kPi / 4,
          .max_elevation_rad = kPi / 4};
}

std::vector<const HardResult*> all_of(const HardResults& r) { return {&r.nearest, &r.planar, &r.hybrid, &r.raycast}; }

}  // namespace

// Scene and scanner are moved together. Sums of whole sixteenths are exact in double up to 2^48 m, so the scene and the
// truth are the same to the bit at every place.
TEST_CASE("offsets of 10^3 to 10^7 m") {
  const glm::dvec3 kRoomHalf_m(5, 4, 1.5), kCaseHalf_m(0.25, 0.5, 0.75), kCase_m(2.0625, 0.4375, -0.25),
      kSensor_m(0.3125, -0.6875, 0.125);
  const glm::dmat4 turned = matrix_from_degrees({0, 0, 0}, 3, -5, 77);
  const glm::dmat3 world_from_sensor_axes(turned);
  std::vector<float> home;
  for (const double offset_m : {0.0, 1e3, 1e4, 1e5, 1e6, 1e7}) {
    const glm::dvec3 offset = std::round(offset_m) * glm::dvec3(1, -0.6875, 0.0625);
    HardCase hard{.name = "a room, " + std::to_string(static_cast<long>(offset_m)) + " m from the world's origin"};
    add_item(hard.world, half_box_mesh(kRoomHalf_m), at(offset));
    add_item(hard.world, half_box_mesh(kCaseHalf_m), at(offset + kCase_m));
    hard.world_from_sensor = at(offset + kSensor_m) * turned;
    hard.scanner.pattern = all_around();
    hard.truth = [=](const glm::dvec3& d) {
      const glm::dvec3 world = world_from_sensor_axes * d;
      return std::min(range_to_box_at(world, -kSensor_m, kRoomHalf_m),
                      range_to_box_at(world, kCase_m - kSensor_m, kCaseHalf_m));
    };
    const HardResults results = measure(hard);
    if (home.empty()) home = results.raycast.scan.range_m;
    CHECK(results.raycast.scan.range_m == home);
  }
}

// A whole simulation with a pose element and offsets that no double represents exactly.
TEST_CASE("a simulation 10^7 m from the origin") {
  TemporaryFolder folder;
  write_part(folder / "room.gltf", half_box_mesh({5, 4, 1.5}));
  const std::vector<std::string> methods{"nearest", "planar", "hybrid", "raycast"};
  for (const double offset_m : {0.1, 1e3 + 0.1, 1e5 + 0.1, 1e7 + 0.1}) {
    const std::string x = std::to_string(offset_m), y = std::to_string(-0.7 * offset_m);
    std::string xml = "<element type=\"pose\" name=\"AWAY\" insert_at=\"ROOT\" x=\"" + x + "\" y=\"" + y +
                      "\"/><part file=\"room.gltf\" name=\"ROOM\" insert_at=\"ROOT\" up=\"z\"/>";
    for (const std::string& method : methods) {
      xml += "<sensor type=\"laser_scanner\" name=\"" + method + "\" " + method_attributes(method) +
             " insert_at=\"ROOM\" ignore=\"none\" pose_offset=\"0.3 -0.2 0.1 0 0 0\" min_angle=\"-180\" "
             "max_angle=\"180\"/>";
    }
    Simulation simulation = Simulation::from_string(xml, {}, folder.path());
    simulation.step();
    // The sensor's position is the sum of its offset and the room's, rounded once to double in each component: half a
    // unit in the last place of a sum of up to 2^24 m. The range changes by this distance over the cosine of the
    // incidence, which is at least 0.5 in a corner of 10 x 8 m.
    const double place_m = 0.5 * std::sqrt(2.0) * (std::nextafter(offset_m, kInfinity) - offset_m) / 0.5;
    for (const std::string& method : methods) {
      CAPTURE(method);
      CAPTURE(offset_m);
      const Scan& scan = simulation.scan(method);
      std::size_t beyond = 0;
      for (std::size_t beam = 0; beam < scan.beams; ++beam) {
        const double a = scan.azimuth_rad[beam];
        const double truth_m = range_to_box_at({std::cos(a), std::sin(a), 0}, {-0.3, 0.2, -0.1}, {5, 4, 1.5});
        const double error = std::abs(scan.range_m[beam] - truth_m);
        beyond += !(error <= scan.error_bound_m[beam] + place_m);
        if (method == "raycast") CHECK(error <= kCastError * truth_m + place_m);
      }
      CHECK(beyond == 0);
    }
  }
  add_line("a simulation 10^7 m from the origin, offsets that are no doubles", "within the bounds");
}

TEST_CASE("0.01 m and 10 km in one scan") {
  HardCase hard{.name = "walls 0.01 m and 10 km away"};
  // The corner of a box beside the sensor, surrounded by mountains.
  const glm::dvec3 near_half_m(0.02, 0.02, 0.02), near_place(0.03, 0.03, 0), far_half_m(1e4, 1e4, 1e4);
  add_item(hard.world, half_box_mesh(near_half_m), at(near_place));
  add_item(hard.world, half_box_mesh(far_half_m), glm::dmat4(1.0));
  hard.scanner.pattern = {.beams = 361,
                          .rings = 21,
                          .min_azimuth_rad = -kPi,
                          .max_azimuth_rad = kPi,
                          .min_elevation_rad = -kPi / 4,
                          .max_elevation_rad = kPi / 4};
  hard.scanner.range_min_m = 0.005;
  hard.scanner.range_max_m = 2e4;
  // float32 rounds the mesh, and its position is exact. The truth is computed for the rounded mesh.
  hard.truth = [=](const glm::dvec3& d) {
    return std::min(range_to_box_at(d, near_place, glm::dvec3(glm::vec3(near_half_m))),
                    range_to_box_at(d, {0, 0, 0}, far_half_m));
  };
  measure(hard);
  hard.name = "the same by one level ring";
  hard.scanner.pattern = {.beams = 1001, .min_azimuth_rad = -kPi, .max_azimuth_rad = kPi};
  measure(hard);
}

TEST_CASE("closer than range_min, at the sensor and around it") {
  const glm::dvec3 room_half_m(5, 4, 3);
  const auto with_room = [&](const std::string& name) {
    HardCase hard{.name = name};
    add_item(hard.world, half_box_mesh(room_half_m), glm::dmat4(1.0));
    hard.scanner.pattern = all_around();
    return hard;
  };
  const auto measure_box = [&](const std::string& name, const glm::dvec3& middle, const glm::dvec3& half,
                               double turned_rad = 0) {
    HardCase hard = with_room(name);
    hard.scanner.pattern.min_azimuth_rad += turned_rad;
    hard.scanner.pattern.min_elevation_rad += turned_rad;
    const glm::dvec3 half_m(glm::vec3{half});
    add_item(hard.world, half_box_mesh(half_m), at(middle));
    hard.truth = [=](const glm::dvec3& d) {
      return std::min(range_to_box_at(d, middle, half_m), range_to_box_at(d, {0, 0, 0}, room_half_m));
    };
    return measure(hard);
  };
  const HardResults before =
      measure_box("a box 0.03 m before the sensor, range_min 0.05 m", {0.08, 0, 0}, {0.05, 0.05, 0.05});
  for (const HardResult* result : all_of(before)) {
    CHECK(std::ranges::count(result->scan.range_m, 0.0f) > 100);
  }
  const HardResults inside = measure_box("within a box of 0.04 m", {0.005, 0.003, -0.002}, {0.02, 0.02, 0.02});
  for (const HardResult* result : all_of(inside)) {
    CHECK(std::ranges::count(result->scan.range_m, 0.0f) == static_cast<std::ptrdiff_t>(result->scan.range_m.size()));
  }
  measure_box("within a box of 0.2 m", {0.02, -0.03, 0.01}, {0.1, 0.1, 0.1});
  measure_box("a wall 0.2 mm from the sensor", {1.0002, 0, 0}, {1, 1, 1});
  // A side that contains the sensor is met at range 0 or edge-on, so it is not hit. The others are hit from inside. No
  // beam runs along a side of the box at the corner, where the result would be undefined.
  measure_box("on the side of a box of 1 m", {0.5, 0, 0}, {0.5, 0.5, 0.5});
  measure_box("on the corner of a box of 1 m", {0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}, 0.01);
}

TEST_CASE("distant objects do not affect the depth of close ones") {
  DrawList near;
  add_item(near, half_box_mesh({0.3, 0.9, 0.55}), matrix_from_degrees({3, 0.2, 0.1}, 10, 20, 30));
  add_item(near, sphere_mesh(0.5, 32), at({2, -1.5, 0.3}));
  DrawList far = near;
  add_item(far, half_box_mesh({3e3, 3e3, 3e3}), matrix_from_degrees({1e4, 2e3, 0}, 5, 5, 5));
  add_item(far, half_box_mesh({3e5, 3e5, 3e5}), matrix_from_degrees({1e6, -4e5, 1e5}, 15, 25, 35));
  Device device;
  Renderer renderer(device);
  const std::unique_ptr<RayCaster> caster = make_ray_caster(device);
  const auto scan_of = [&](const DrawList& world, ScanMethod method, double range_max_m) {
    LaserScannerDesc desc;
    desc.pattern = {.beams = 181,
                    .rings = 41,
                    .min_azimuth_rad = -kPi / 4,
                    .max_azimuth_rad = kPi / 4,
                    .min_elevation_rad = -kPi / 8,
                    .max_elevation_rad = kPi / 8};
    desc.method = method;
    desc.max_error_rel = kHybridError;
    desc.range_max_m = range_max_m;
    LaserScanner scanner("SCANNER", desc);
    FramePlan plan;
    scanner.plan(glm::dmat4(1.0), world, plan);
    scanner.collect({}, plan, renderer.render(world, plan));
    caster->set_world(world);
    scanner.cast(*caster);
    return *scanner.scan();
  };
  std::size_t compared = 0;
  for (const ScanMethod method : {ScanMethod::nearest, ScanMethod::planar, ScanMethod::hybrid, ScanMethod::raycast}) {
    CAPTURE(static_cast<int>(method));
    const Scan alone = scan_of(near, method, 80);
    for (const double range_max_m : {80.0, 1e7}) {
      const Scan beside = scan_of(far, method, range_max_m);
      for (std::size_t beam = 0; beam < alone.range_m.size(); ++beam) {
        if (!(alone.range_m[beam] < 80)) continue;
        // Distant objects have edges of their own. Beside them a rendered beam may become uncertain, and hybrid then
        // casts it.
        const double bound_m = alone.error_bound_m[beam] + beside.error_bound_m[beam];
        const bool rendered = method == ScanMethod::planar || method == ScanMethod::hybrid;
        if (rendered && std::isinf(bound_m)) continue;
        ++compared;
        if (method == ScanMethod::hybrid) {
          CHECK(std::abs(alone.range_m[beam] - beside.range_m[beam]) <= bound_m);
        } else {
          CHECK(alone.range_m[beam] == beside.range_m[beam]);
        }
      }
    }
  }
  CHECK(compared > 5000);

  const auto depth_seen_in = [&](const DrawList& world) {
    Camera camera("CAMERA",
                  {.pinhole = {.width_px = 320, .height_px = 240, .hfov_rad = kPi / 3}, .color = false, .depth = true});
    FramePlan plan;
    camera.plan(glm::dmat4(1.0), world, plan);
    camera.collect({}, plan, renderer.render(world, plan));
    return depth_of(camera).pixels;
  };
  const std::vector<float> alone = depth_seen_in(near), beside = depth_seen_in(far);
  std::size_t pixels = 0;
  for (std::size_t i = 0; i < alone.size(); ++i) {
    if (std::isinf(alone[i])) continue;
    ++pixels;
    CHECK(alone[i] == beside[i]);
  }
  CHECK(pixels > 5000);
  CHECK(std::ranges::count_if(beside, [](float depth_m) { return std::isfinite(depth_m) && depth_m > 1e5; }) > 100);
  add_line("things 10 km and 1000 km away: ranges and depth of near ones", "the same to the bit");
}

TEST_SUITE_END();
