// The profile is a Chrome trace: hand-made events, and those of a run, whose times must nest on each track.
#include "program/report/profile.h"

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include <simvis/simulation.h>
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

using Json = nlohmann::json;

Json parsed(const std::filesystem::path& file) { return Json::parse(read_text(file)); }

/// The trace counts microseconds with three decimals: whole nanoseconds.
std::int64_t nanoseconds(const Json& microseconds) { return std::llround(microseconds.get<double>() * 1e3); }

/// Spans of one name, or of all.
std::vector<Json> spans(const Json& trace, std::string_view category = {}, std::string_view name = {}) {
  std::vector<Json> found;
  for (const Json& event : trace["traceEvents"]) {
    if (event["ph"] != "X") continue;
    if ((category.empty() || event["cat"] == category) && (name.empty() || event["name"] == name))
      found.push_back(event);
  }
  return found;
}

TEST_CASE("times are microseconds from the first frame's start, with one event per line") {
  const TemporaryFolder folder;
  const FrameCounters counters{.draws = 7};
  const StageTime first[] = {{"elements", 5'000, 6'500}, {"flatten", 6'500, 9'000}};
  const StageTime second[] = {{"elements", 15'000, 15'100}};
  const SensorCost sensors[] = {{"A\xff", 7'000, 7'500, 8'000, 361, 5, 6}};
  {
    Profile profile(folder / "p.json", "a device");
    profile.add({.index = 0, .stages = first, .written_ns = 11'000, .sensors = sensors, .counters = counters});
    profile.add({.index = 1, .stages = second, .counters = counters});
    CHECK(!std::filesystem::exists(folder / "p.json"));
    profile.commit();
  }
  const Json trace = parsed(folder / "p.json");
  const std::vector<Json> frames = spans(trace, "frame"), stages = spans(trace, "stage");
  REQUIRE(frames.size() == 2);
  CHECK(frames[0]["ts"] == 0);
  CHECK(frames[0]["dur"] == 6);  // with the writing
  CHECK(frames[1]["ts"] == 10);
  CHECK(frames[1]["dur"] == 0.1);
  REQUIRE(stages.size() == 4);
  CHECK(stages[1]["name"] == "flatten");
  CHECK(stages[1]["ts"] == 1.5);
  CHECK(stages[1]["dur"] == 2.5);
  CHECK(stages[2]["name"] == "write");
  CHECK(stages[2]["ts"] == 4);
  CHECK(stages[3]["args"]["frame"] == 1);
  const std::vector<Json> cast = spans(trace, "sensor", "cast");
  REQUIRE(cast.size() == 1);
  CHECK(cast[0]["args"]["rays"] == 361);
  CHECK(cast[0]["dur"] == 0.5);

  std::istringstream lines(read_text(folder / "p.json"));
  std::string line;
  std::size_t events = 0;
  std::getline(lines, line);
  while (std::getline(lines, line) && line != "]}") {
    if (line.ends_with(',')) line.pop_back();
    CHECK(Json::parse(line)["ph"].is_string());
    ++events;
  }
  CHECK(line == "]}");
  CHECK(events == trace["traceEvents"].size());
}

TEST_CASE("device events are placed after the submission of the frame") {
  const TemporaryFolder folder;
  const StageTime stages[] = {{"render", 1'000, 9'000}};
  FramePlan plan;
  plan.passes = {{.name = "CAM", .width_px = 8, .height_px = 8, .color = true, .views = {{}}}};
  plan.passes[0].views[0].name = "CAM/view";
  plan.passes[0].views[0].reason = "because";
  plan.passes[0].views[0].pipelines = {{.variant = "colour", .reason = "test", .shades = true}};
  FrameCosts costs{.timed = true, .counted = true, .submitted_ns = 2'000, .finished_ns = 8'000, .uploads = {0, 500}};
  costs.passes = {{.time = {500, 3'000},
                   .readback = {3'000, 4'000},
                   .bytes_read_back = 1024,
                   .views = {{{500, 2'500}, {.vertex_invocations = 12, .fragment_invocations = 64}}}}};
  Profile profile(folder / "p.json", "a device");
  profile.add({.index = 0, .stages = stages, .counters = {}});
  profile.add(plan, costs);
  costs.timed = false;
  profile.add(plan, costs);  // a device without a clock has no track
  profile.commit();
  const std::vector<Json> device = spans(parsed(folder / "p.json"), "device");
  REQUIRE(device.size() == 4);
  CHECK(device[0]["name"] == "uploads");
  CHECK(device[0]["ts"] == 1);
  CHECK(device[1]["name"] == "pass CAM");
  CHECK(device[1]["ts"] == 1.5);
  CHECK(device[1]["dur"] == 2.5);
  CHECK(device[2]["name"] == "view CAM/view");
  CHECK(device[2]["args"]["vertex_invocations"] == 12);
  CHECK(device[2]["args"]["fragment_invocations"] == 64);
  CHECK(device[2]["args"]["reason"] == "because");
  CHECK(device[3]["name"] == "readback CAM");
  CHECK(device[3]["args"]["bytes"] == 1024);
}

TEST_CASE("the spans of a run nest on each track, and the device works while its frame is rendered") {
  // Device and host may have separate clocks, which deviate by about 100 ppm at most and round to whole nanoseconds.
  constexpr double kClockRatio = 1e-4;
  constexpr std::int64_t kRounding_ns = 2;
  const TemporaryFolder folder;
  write_text(folder / "wall.gltf", wall_gltf());
  SimulationDesc desc;
  desc.device.cache_dir = tested_build() + "/test_cache";
  desc.device.instrumented = true;
  Simulation simulation = Simulation::from_string(std::string(kWallPart) + R"(
      <sensor type="camera" name="CAM" insert_at="ROOT" outputs="color depth" supersampling="4"/>
      <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" method="planar"/>
      <sensor type="laser_scanner" name="CAST" insert_at="ROOT" method="raycast"/>)",
                                                  desc, folder.path());
  constexpr std::uint64_t kFrames = 3;
  bool timed = false;
  {
    Profile profile(folder / "p.json", simulation.diagnostics().device()->name);
    for (std::uint64_t frame = 0; frame < kFrames; ++frame) {
      simulation.step();
      profile.add({.index = frame,
                   .stages = simulation.diagnostics().stages(),
                   .sensors = simulation.diagnostics().sensor_costs(),
                   .counters = simulation.diagnostics().counters(),
                   .device_memory_bytes = simulation.diagnostics().device_memory_bytes()});
      profile.add(simulation.diagnostics().frame_plan(), *simulation.diagnostics().frame_costs());
      timed = simulation.diagnostics().frame_costs()->timed;
    }
    profile.commit();
  }
  const Json trace = parsed(folder / "p.json");
  for (const int track : {1, 2}) {
    std::vector<std::pair<std::int64_t, std::int64_t>> times;
    for (const Json& span : spans(trace)) {
      const std::int64_t start_ns = nanoseconds(span["ts"]);
      if (span["tid"] == track) times.emplace_back(start_ns, start_ns + nanoseconds(span["dur"]));
    }
    for (const auto& [a, a_end] : times) {
      CHECK(a <= a_end);
      for (const auto& [b, b_end] : times) {
        const bool apart = a_end <= b || b_end <= a, within = (b <= a && a_end <= b_end) || (a <= b && b_end <= a_end);
        CHECK((apart || within));
      }
    }
  }
  CHECK(spans(trace, "sensor", "cast").size() == kFrames);
  CHECK(spans(trace, "stage", "render").size() == kFrames);
  for (const Json& stage : spans(trace, "stage", "render")) {
    const std::int64_t start_ns = nanoseconds(stage["ts"]), length_ns = nanoseconds(stage["dur"]);
    std::size_t within = 0;
    for (const Json& span : spans(trace, "device")) {
      if (span["args"]["frame"] != stage["args"]["frame"]) continue;
      const std::int64_t end_ns = nanoseconds(span["ts"]) + nanoseconds(span["dur"]);
      const auto slack_ns = static_cast<std::int64_t>(kClockRatio * static_cast<double>(length_ns)) + kRounding_ns;
      CHECK(nanoseconds(span["ts"]) >= start_ns);
      CHECK(end_ns <= start_ns + length_ns + slack_ns);
      ++within;
    }
    // Uploads; passes of CAM's colour, of its depth and of SCAN; their views, two of SCAN; their readbacks.
    if (timed) CHECK(within == 1 + 3 + 4 + 3);
  }
  std::map<std::string, std::size_t> samples;
  for (const Json& event : trace["traceEvents"]) samples[event["name"]] += event["ph"] == "C";
  for (const char* name : {"draws", "triangles", "bytes uploaded", "bytes read back", "bytes on the device"}) {
    CHECK(samples[name] == kFrames);
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
