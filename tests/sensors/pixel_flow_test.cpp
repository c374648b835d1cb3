// Optical flow, scene flow and occlusion against geometry by hand, and what they cost.
#include "sensors/camera/pixel_flow.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include <simvis/diagnostics.h>
#include <simvis/simulation.h>
#include <simvis/simulation_desc.h>
#include "tests/sensors/flow_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/animated_part.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

TEST_CASE("flow before a wall is that of a thin lens by hand") {
  // The camera goes 0.1 m to the left of a wall 5 m away, then turns by 3 degrees to the left.
  for (const std::string more : {"", " occlusion"}) {
    Simulation simulation = Simulation::from_string(
        "<simvis><part name='WALL' insert_at='ROOT' shape='box' size='0.2 20 2' pose_offset='5.1 0 0 0 0 0'/>"
        "<part name='CAR' insert_at='ROOT'/><element type='pose' name='DRIVE' insert_at='CAR'/>" +
        flow_camera("depth flow_backward" + more) + "</simvis>");
    simulation.step(kFlowStep);
    simulation.set("DRIVE", "y", 0.1);
    simulation.step(kFlowStep);
    const auto flow_at = [&](std::size_t pixel) {
      const Measurement measurement = simulation.measurement("CAM");
      const MeasuredArray& flow = *measurement.find("flow_backward");
      return glm::dvec2(flow.number(2 * pixel), flow.number(2 * pixel + 1));
    };
    int wall = 0, sky = 0;
    std::vector<double> depth = flow_numbers(simulation.measurement("CAM"), "depth");
    for (std::size_t i = 0; i < depth.size(); ++i) {
      const bool is_sky = std::isinf(depth[i]);
      ++(is_sky ? sky : wall);
      // What is 5 m away was further to the left by f 0.1 / 5 pixels; the sky was where it is.
      CHECK(std::abs(flow_at(i).x - (is_sky ? 0 : -kFlowFocal_px * 0.1 / 5)) <= kFlow_px);
      CHECK(std::abs(flow_at(i).y) <= kFlow_px);
    }
    CHECK(wall > 1000);
    CHECK(sky > 1000);
    simulation.set("DRIVE", "yaw", 3);
    simulation.step(kFlowStep);
    const double turn = 3 * std::numbers::pi / 180;
    for (std::size_t i = 0; i < depth.size(); ++i) {
      // A turn moves all directions alike, whatever their depth. To the left of the image by the angle before.
      const glm::dvec2 at = flow_centre(static_cast<int>(i));
      const double x = (at.x - kFlowMiddle.x) / kFlowFocal_px, y = (at.y - kFlowMiddle.y) / kFlowFocal_px;
      const double z = std::cos(turn) + std::sin(turn) * x, then_x = (std::cos(turn) * x - std::sin(turn)) / z;
      CHECK(std::abs(flow_at(i).x - kFlowFocal_px * (then_x - x)) <= kFlow_px);
      CHECK(std::abs(flow_at(i).y - kFlowFocal_px * (y / z - y)) <= kFlow_px);
    }
  }
}

TEST_CASE("a band beside a near thing is hidden in the other image, as wide as the difference of the parallaxes") {
  // A post 2 m away before a wall 5 m away; the camera goes 0.2 m to the left.
  Simulation simulation = Simulation::from_string(
      "<simvis><part name='WALL' insert_at='ROOT' shape='box' size='0.2 20 20' pose_offset='5.1 0 0 0 0 0'/>"
      "<part name='POST' insert_at='ROOT' shape='box' size='0.2 0.4 20' pose_offset='2.1 0 0 0 0 0'/>"
      "<part name='CAR' insert_at='ROOT'/><element type='pose' name='DRIVE' insert_at='CAR'/>" +
      flow_camera("flow_backward flow_forward occlusion") + "</simvis>");
  simulation.step(kFlowStep);
  for (const double number : flow_numbers(simulation.measurement("CAM"), "occlusion_backward")) CHECK(number == 1);
  simulation.set("DRIVE", "y", 0.2);
  simulation.step(kFlowStep);
  const auto hidden_in_row = [&](const char* name) {
    const std::vector<double> all = flow_numbers(simulation.measurement("CAM"), name);
    return static_cast<double>(std::count(all.begin() + kFlowWidth * 36, all.begin() + kFlowWidth * 37, 1.0));
  };
  // The band, and what left the image at its side: f 0.2 / 5 pixels. Each edge is off by less than a pixel.
  const double band_px = kFlowFocal_px * 0.2 * (1 / 2.0 - 1 / 5.0), gone_px = kFlowFocal_px * 0.2 / 5;
  CHECK(std::abs(hidden_in_row("occlusion_backward") - (band_px + gone_px)) < 2);
  CHECK(std::abs(hidden_in_row("occlusion_forward") - (band_px + gone_px)) < 2);
}

TEST_CASE("an image that is warped by its flow is the other one where nothing is hidden") {
  Simulation simulation = Simulation::from_string(
      "<simvis>" + kMovingThings + flow_camera("instance object_coordinates flow_backward occlusion") + "</simvis>");
  move_flow_scene(simulation, 0);
  const Measurement then = simulation.measurement("CAM");
  move_flow_scene(simulation, 1);
  const Measurement now = simulation.measurement("CAM");
  const std::vector<double> flow = flow_numbers(now, "flow_backward"), hidden = flow_numbers(now, "occlusion_backward"),
                            instance = flow_numbers(now, "instance"), other = flow_numbers(then, "instance"),
                            place = flow_numbers(now, "object_coordinates"),
                            other_place = flow_numbers(then, "object_coordinates");
  int compared = 0, inside = 0, differ = 0;
  for (int pixel = 0; pixel < kFlowPixels; ++pixel) {
    const auto i = static_cast<std::size_t>(pixel);
    if (hidden[i] != 0) continue;
    ++compared;
    const glm::dvec2 at = flow_centre(pixel) + glm::dvec2(flow[2 * i], flow[2 * i + 1]) - 0.5;
    const int x = static_cast<int>(std::floor(at.x)), y = static_cast<int>(std::floor(at.y));
    if (x < 0 || y < 0 || x + 1 >= kFlowWidth || y + 1 >= kFlowHeight) continue;
    // Between four pixels of one thing its coordinates are those of the point, to within their spread.
    const std::size_t corners[] = {
        static_cast<std::size_t>(y * kFlowWidth + x), static_cast<std::size_t>(y * kFlowWidth + x + 1),
        static_cast<std::size_t>((y + 1) * kFlowWidth + x), static_cast<std::size_t>((y + 1) * kFlowWidth + x + 1)};
    const auto same = std::ranges::count_if(corners, [&](std::size_t c) { return other[c] == instance[i]; });
    if (same == 0) ++differ;
    if (same < 4 || instance[i] == 0) continue;
    ++inside;
    glm::dvec3 low(INFINITY), high(-INFINITY);
    for (const std::size_t c : corners) {
      const glm::dvec3 each(other_place[3 * c], other_place[3 * c + 1], other_place[3 * c + 2]);
      low = glm::min(low, each);
      high = glm::max(high, each);
    }
    // A flat side is between its corners; a round one may stand out by no more than they are apart.
    const glm::dvec3 spread = high - low, point(place[3 * i], place[3 * i + 1], place[3 * i + 2]);
    const double most = std::max({spread.x, spread.y, spread.z}) + 1e-6;
    for (int c = 0; c < 3; ++c) {
      CHECK(point[c] >= low[c] - most);
      CHECK(point[c] <= high[c] + most);
    }
  }
  CHECK(compared > kFlowPixels / 2);
  CHECK(inside > kFlowPixels / 3);
  CHECK(differ == 0);
}

TEST_CASE("a mesh that bends has the flow of its vertices") {
  TemporaryFolder folder;
  write_text(folder / "strip.gltf", test::bending_strip().text());
  for (const std::string more : {"", " occlusion"}) {
    Simulation simulation = Simulation::from_string(
        R"(<part file="strip.gltf" name="STRIP" insert_at="ROOT" up="z"/>
           <element type="animation" name="BEND" insert_at="ROOT" part="STRIP"/>
           <sensor type="camera" name="EYE" insert_at="ROOT" width="64" height="48" hfov="60" pose_offset="0 0 1 0 0 0"
                   outputs="range flow_backward flow_forward scene_flow)" +
            more + R"("/>)",
        {}, folder.path());
    simulation.set("BEND", "time", 0);
    simulation.step(kFlowStep);
    const std::vector<double> first_range = flow_numbers(simulation.measurement("EYE"), "range");
    simulation.set("BEND", "time", 0.5);
    simulation.step(kFlowStep);
    const Measurement measurement = simulation.measurement("EYE");
    const std::vector<double> range = flow_numbers(measurement, "range"),
                              flow = flow_numbers(measurement, "flow_backward"),
                              forward = flow_numbers(measurement, "flow_forward"),
                              scene = flow_numbers(measurement, "scene_flow");
    const double f_px = 32 / std::tan(30 * std::numbers::pi / 180), angle = 0.5 * std::numbers::pi / 4;
    int bent = 0, straight = 0;
    for (int pixel = 0; pixel < 64 * 48; ++pixel) {
      const auto i = static_cast<std::size_t>(pixel);
      if (std::isinf(range[i])) continue;
      const double x = (pixel % 64 + 0.5 - 32) / f_px, y = (pixel / 64 + 0.5 - 24) / f_px;
      // Upper rows look above the hinge, which is at the height of the camera, 3 m before it; y is down. The point lies
      // h along the strip from the hinge: 3 + h sin a ahead and h cos a up; before it was 3 ahead and h up.
      const double h = -y * 3 / (std::cos(angle) + y * std::sin(angle));
      const bool above = y < 0;
      const double ahead = above ? 3 + h * std::sin(angle) : 3;
      const double then_x = above ? x * ahead / 3 : x, then_y = above ? -h / 3 : y;
      CHECK(std::abs(flow[2 * i] - f_px * (then_x - x)) <= kFlow_px);
      CHECK(std::abs(flow[2 * i + 1] - f_px * (then_y - y)) <= kFlow_px);
      CHECK(std::abs(scene[3 * i + 2] - (ahead - 3)) <= 1e-5);
      CHECK(std::abs(scene[3 * i + 1] - (above ? h - h * std::cos(angle) : 0)) <= 1e-5);
      ++(above ? bent : straight);
    }
    CHECK(bent > 500);
    CHECK(straight > 500);
    // Forward: in the first image the point lies 3 m ahead, and h up.
    int bends = 0;
    for (int pixel = 0; pixel < 64 * 48; ++pixel) {
      const auto i = static_cast<std::size_t>(pixel);
      if (std::isinf(first_range[i])) continue;
      const double x = (pixel % 64 + 0.5 - 32) / f_px, y = (pixel / 64 + 0.5 - 24) / f_px, h = -3 * y;
      const bool above = y < 0;
      const double ahead = above ? 3 + h * std::sin(angle) : 3, up = above ? h * std::cos(angle) : h;
      CHECK(std::abs(forward[2 * i] - f_px * (3 * x / ahead - x)) <= kFlow_px);
      CHECK(std::abs(forward[2 * i + 1] - f_px * (-up / ahead - y)) <= kFlow_px);
      bends += above;
    }
    CHECK(bends > 500);
  }
}

std::vector<std::uint64_t> bits_of(const Simulation& simulation) {
  std::vector<std::uint64_t> bits;
  for (const MeasuredArray& array : simulation.measurement("CAM").arrays) {
    for (std::size_t i = 0; i < array.count(); ++i) bits.push_back(std::bit_cast<std::uint64_t>(array.number(i)));
  }
  return bits;
}

// Simulations of one scene: `every` measures every frame, `some` skips some of them.
struct TwoRuns {
  explicit TwoRuns(const std::string& outputs, const std::string& attributes = "", double rate_hz = 0)
      : every(made(outputs, attributes, rate_hz)), some(made(outputs, attributes, rate_hz)) {}

  static Simulation made(const std::string& outputs, const std::string& attributes, double rate_hz) {
    SimulationDesc desc;
    if (rate_hz > 0) desc.rate_hz = rate_hz;
    return Simulation::from_string("<simvis>" + kMovingThings + flow_camera(outputs, attributes) + "</simvis>", desc);
  }
  void advance(bool skips) {
    for (Simulation* const each : {&every, &some}) {
      each->set("DRIVE", "x", 0.1 * frame);
      each->set("MOVE", "y", 0.2 * frame);
      each == &some&& skips ? each->skip_frame() : static_cast<void>(each->step());
    }
    ++frame;
  }

  Simulation every, some;
  int frame = 0;
};

const std::string kAllFlows = "color instance flow_backward flow_forward scene_flow";

TEST_CASE("skipped frames, new things and other frames made again change no flow") {
  for (const char* const more : {"", " occlusion"}) {
    CAPTURE(more);
    TwoRuns runs(kAllFlows + more);
    for (const bool skips : {true, false, true, true, false, false, true, false}) {
      runs.advance(skips);
      if (!skips) CHECK(bits_of(runs.some) == bits_of(runs.every));
    }
    // A part in front of the others in the list gives items other numbers, and no flow. It comes after a skipped frame,
    // whose image does not have it.
    runs.advance(true);
    for (Simulation* const each : {&runs.every, &runs.some}) {
      each->execute("<part name='A' insert_at='ROOT' shape='sphere' radius='0.2' pose_offset='2 0 0 0 0 0'/>");
    }
    runs.advance(false);
    CHECK(bits_of(runs.some) == bits_of(runs.every));
    runs.every.step();
    for (const double number : flow_numbers(runs.every.measurement("CAM"), "flow_backward")) {
      CHECK(std::abs(number) <= kFlow_px);
    }
  }
}

TEST_CASE("skipped frames change no flow of a camera that measures in every other frame") {
  TwoRuns runs(kAllFlows, "rate='5'", 10);
  for (const bool skips : {false, false, true, false, false, true, true, true, false, true, false, false, true, true}) {
    runs.advance(skips);
    const bool is_due = (runs.frame - 1) % 2 == 0;
    if (!skips && is_due) CHECK(bits_of(runs.some) == bits_of(runs.every));
  }
}

TEST_CASE("a skipped frame stays without a measurement, whatever the next one needs of it") {
  TwoRuns runs(kAllFlows, "rate='5'", 10);
  runs.advance(false);
  const std::vector<std::uint64_t> first = bits_of(runs.some);
  runs.advance(true);
  runs.advance(true);   // due
  runs.advance(false);  // not due
  CHECK(bits_of(runs.some) == first);
  CHECK(bits_of(runs.every) != first);
}

TEST_CASE("flow that is not asked for costs nothing, and flow of what is drawn casts round shapes alone") {
  const auto work = [](const std::string& outputs) {
    Simulation simulation = Simulation::from_string("<simvis>" + kMovingThings + flow_camera(outputs) + "</simvis>");
    move_flow_scene(simulation, 0);
    move_flow_scene(simulation, 1);
    const Diagnostics diagnostics = simulation.diagnostics();
    return std::tuple(diagnostics.counters(), diagnostics.ray_counters().rays, diagnostics.motions_followed());
  };
  // Round shapes are cast, and only their outlines for ids.
  const auto ids = work("color instance");
  for (const char* const outputs : {"color flow_backward", "color instance flow_backward flow_forward scene_flow"}) {
    const auto flow = work(outputs);
    CHECK(std::get<0>(flow) == std::get<0>(ids));
    CHECK(std::get<2>(flow) == std::get<2>(ids));
    CHECK(std::get<1>(flow) > std::get<1>(ids));
    CHECK(std::get<1>(flow) < kFlowPixels);
  }
  CHECK(std::get<1>(work("color flow_backward occlusion")) >= kFlowPixels);
}

TEST_CASE("occlusion without flow is an error at its place") {
  const std::string error = error_of([&] {
    Simulation::from_string("<simvis>" + kMovingThings + "\n" + flow_camera("color occlusion") + "</simvis>", {}, ".",
                            "s");
  });
  CHECK(contains(error,
                 ": error: attribute \"outputs\": occlusion is that of a flow, expected flow_backward or "
                 "flow_forward beside it"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
