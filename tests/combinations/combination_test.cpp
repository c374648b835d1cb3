// Random scenes in which every feature meets every other, each value compared
// with geometry of the test's own. SIMVIS_TEST_SCENES=100000 tries so many,
// SIMVIS_TEST_SEED=7000000 those from that number on. A scene that fails is
// made as simple as it can be and written into a folder, which the message
// names.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include <simvis/device.h>
#include "tests/combinations/random_scene.h"
#include "tests/combinations/scene_checks.h"
#include "tests/support/long_count.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("combinations");

namespace simvis::combined {
namespace {

/// The failures of a scene; one that SimVis refuses is one, too.
std::vector<Failure> failures_of(const CombinedScene& scene, Tally& tally) {
  const TemporaryFolder folder;
  try {
    return check_scene(scene, folder.path(), tally);
  } catch (const std::exception& error) {
    return {{"exception", error.what()}};
  }
}

bool has_check(const std::vector<Failure>& failures, const std::string& check) {
  return std::ranges::find(failures, check, &Failure::check) != failures.end();
}

/// The simplest scene that fails the same check.
CombinedScene shrunk(CombinedScene scene, const std::string& check) {
  for (bool found = true; found;) {
    found = false;
    for (const CombinedScene& other : simpler(scene)) {
      Tally tally;
      if (!has_check(failures_of(other, tally), check)) continue;
      scene = other;
      found = true;
      break;
    }
  }
  return scene;
}

/// Writes the scene of a failure, and says where.
std::string report(const CombinedScene& scene, const std::string& check) {
  const CombinedScene small = shrunk(scene, check);
  Tally tally;
  const std::vector<Failure> failures = failures_of(small, tally);
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("simvis-combination-" + std::to_string(scene.seed));
  std::filesystem::create_directories(folder);
  write_scene(small, folder);
  std::string text = "scene " + std::to_string(scene.seed) + " fails; " + (folder / "scene.xml").string() + " shows it";
  for (std::size_t i = 0; i < failures.size() && i < 3; ++i) text += "\n  " + failures[i].text;
  return text + "\n  relation " + std::to_string(static_cast<int>(small.relation));
}

TEST_CASE("random scenes measure what geometry says") {
  const Device shared;  // all simulations use it, which is not opened again for each
  const auto seed = static_cast<std::uint64_t>(count_of("SIMVIS_TEST_SEED", 1));
  const auto scenes = static_cast<std::uint64_t>(count_of("SIMVIS_TEST_SCENES", 40));
  Tally tally;
  for (std::uint64_t i = 0; i < scenes; ++i) {
    const CombinedScene scene = random_scene(seed + i);
    const std::vector<Failure> failures = failures_of(scene, tally);
    if (failures.empty()) continue;
    MESSAGE("scene " << scene.seed << " fails, and is made simpler: " << failures.front().text);
    FAIL_CHECK(report(scene, failures.front().check));
  }
  std::size_t values = 0;
  for (const auto& [check, number] : tally.values) {
    std::printf("%10zu values, %s\n", number, check.c_str());
    values += number;
  }
  constexpr std::uint64_t kMany = 20;  // a few scenes may have single beams alone
  if (scenes >= kMany) {
    CHECK(values > 1000 * scenes);
    CHECK(tally.at_edges < values / 1000);
    CHECK(tally.narrow < values / 1000);
    CHECK(tally.unbounded < values / 100);
  }
  std::printf("%zu values: %zu beside edges, %zu of narrow surfaces, %zu without a bound\n", values, tally.at_edges,
              tally.narrow, tally.unbounded);
}

/// A lens in a box of 6 m, which the camera sees on all sides, a little farther than `near`.
CombinedScene lens_in_box(const std::string& lens, const std::array<double, 5>& lens_k, double hfov_deg) {
  CombinedScene scene;
  Body carrier, box;
  carrier.moves = true;
  carrier.move[1] = {{0, 0, 0, 0, 0, 40}};
  carrier.kind = ShapeKind::sphere;
  carrier.offset = {{0, 0, -5, 0, 0, 0}};
  box.size_m = glm::dvec3(6);
  scene.bodies = {carrier, box};
  SensorDesc camera;
  camera.kind = SensorKind::stereo_camera;
  camera.parent = 0;
  camera.offset = {{0, 0, 5, 0, 0, 0}};
  camera.hfov_deg = hfov_deg;
  camera.near_m = 2;
  camera.lens = lens;
  camera.lens_k = lens_k;
  camera.outputs = "depth disparity range instance layers flow_backward flow_forward";
  scene.sensors = {camera};
  return scene;
}

/// Whether an output of the last frame has a number like this.
template <class Is>
bool has_number(const Measured& measured, const std::string& output, const Is& is) {
  const MeasuredArray& array = *measured.frames.back()[0].find(output);
  for (std::size_t i = 0; i < array.count(); ++i) {
    if (is(array.number(i))) return true;
  }
  return false;
}

void check_geometry(const CombinedScene& scene, const Measured& measured) {
  Tally tally;
  const std::vector<Failure> failures = compare_with_geometry(scene, measured, tally);
  CHECK(failures.empty());
  for (std::size_t i = 0; i < failures.size() && i < 3; ++i) FAIL_CHECK(failures[i].text);
}

TEST_CASE("a fisheye measures what geometry says of surfaces beside and behind it") {
  const TemporaryFolder folder;
  const CombinedScene scene = lens_in_box("kannala_brandt", {}, 130);
  const Measured measured = measure(scene, folder.path());
  CHECK(has_number(measured, "left_depth", [](double depth_m) { return depth_m < 0; }));
  check_geometry(scene, measured);
}

TEST_CASE("places at the fold of a lens with a tangential part do not count") {
  const TemporaryFolder folder;
  const CombinedScene scene = lens_in_box("brown_conrady", {-0.09, 0, 0, 0.01, -0.01}, 60);
  const Measured measured = measure(scene, folder.path());
  CHECK(has_number(measured, "left_flow_forward", [](double way_px) { return std::isnan(way_px); }));
  check_geometry(scene, measured);
}

TEST_CASE("beside the image of a narrow lens, boxes leave out what is nearer along the optical axis than `near`") {
  // Parallel to the axis and farther than `near` beside it: only the part beyond `near` ahead counts.
  const TemporaryFolder folder;
  CombinedScene scene;
  Body board;
  board.offset = {{3.25, 2.25, 0, 0, 0, 0}};
  board.size_m = {5.5, 0.1, 1};
  board.has_class = true;
  scene.bodies = {board};
  SensorDesc camera;
  camera.kind = SensorKind::camera;
  camera.width_px = 16;
  camera.height_px = 12;
  camera.hfov_deg = 70;
  camera.near_m = 2;
  camera.lens = "brown_conrady";
  camera.lens_k = {-0.01};
  camera.outputs = "depth instance boxes";
  scene.sensors = {camera};
  const Measured measured = measure(scene, folder.path());
  const Measurement& first = measured.frames[0][0];
  REQUIRE(first.find("full_pixels")->count() == 1);
  CHECK(first.find("full_pixels")->number(0) > first.find("picture_pixels")->number(0));
  check_geometry(scene, measured);
}

/// Changes what was measured before it is checked.
using Fault = std::function<void(Measured&)>;

/// Changes the numbers of all outputs of this name.
template <class Change>
Fault changed(const std::string& output, const Change& change) {
  return [=](Measured& measured) {
    for (std::vector<Measurement>& frame : measured.frames) {
      for (Measurement& measurement : frame) {
        for (MeasuredArray& array : measurement.arrays) {
          if (array.name != output) continue;
          std::visit(
              [&](auto& numbers) {
                for (auto& number : numbers.edit())
                  number = static_cast<std::decay_t<decltype(number)>>(change(number));
              },
              array.numbers);
        }
      }
    }
  };
}

struct PlantedFault {
  std::string found_by;  ///< the check
  Fault fault;
};

TEST_CASE(
    "faults that are planted in what was measured are found by the check "
    "of their output") {
  const Device shared;
  const auto times = [](double factor) { return [=](double value) { return value * factor; }; };
  const PlantedFault faults[] = {
      {"raycast range", changed("error_bound_m", times(0.5))},
      {"raycast range", changed("range_m", times(1 + 1e-6))},
      {"drawn depth", changed("depth", times(1 + 1e-5))},
      {"cast depth", changed("depth", times(1 + 1e-6))},
      {"bound below the largest", changed("depth_error_bound", times(1.01))},
      {"instance", changed("instance", [](double id) { return id == 0 ? id : id + 1; })},
      {"true_instance", changed("true_instance", [](double id) { return id + 1; })},
      {"true_velocity_x_mps", changed("true_velocity_x_mps", times(1 + 1e-6))},
      {"normal", changed("normal", times(-1))},
      {"flow_backward", changed("flow_backward", [](double px) { return px + 1e-3; })},
      {"flow_forward", changed("flow_forward", [](double px) { return px + 1e-3; })},
      {"occlusion", changed("occlusion_backward", [](double hidden) { return 1 - hidden; })},
      {"occlusion", changed("occlusion_forward", [](double hidden) { return 1 - hidden; })},
      {"boxes", changed("visible_pixels", [](double pixels) { return pixels + 9; })},
      {"boxes", changed("full_pixels", times(1.5))},
      {"shares of boxes", changed("visible_fraction", times(0.999))},
      {"depth of splats", changed("depth", times(1 + 1e-4))},
      {"scene flow", changed("scene_flow", times(1 + 1e-5))},
      {"object coordinates", changed("object_coordinates", times(1 + 1e-4))},
      {"transmission of layers", changed("layer_transmission", times(0.999))},
      {"single beam", changed("range_m", times(1 + 1e-9))},
      {"keypoints, x_px", changed("x_px", times(1 + 1e-9))},
      {"keypoints, visible", changed("visible", [](double visible) { return 1 - visible; })},
      {"motion, specific_force_x_m_s2", changed("specific_force_x_m_s2", times(1 + 1e-9))},
      {"motion, velocity_y_m_s", changed("velocity_y_m_s", times(1 + 1e-9))},
      {"motion, orientation", changed("qw", times(-1))},
  };
  constexpr std::uint64_t kEnough = 200;
  std::set<std::size_t> missing;
  for (std::size_t i = 0; i < std::size(faults); ++i) missing.insert(i);
  const TemporaryFolder folder;
  for (std::uint64_t seed = 1; seed <= kEnough && !missing.empty(); ++seed) {
    const CombinedScene scene = random_scene(seed);
    const Measured measured = measure(scene, folder.path());
    std::erase_if(missing, [&](std::size_t i) {
      Measured faulty = measured;
      faults[i].fault(faulty);
      Tally tally;
      return has_check(compare_with_geometry(scene, faulty, tally), faults[i].found_by);
    });
  }
  CHECK(missing.empty());
  for (const std::size_t i : missing) {
    const std::string& check = faults[i].found_by;
    FAIL_CHECK("fault " << i << ", which the check of " << check << " should find, is not found");
  }
}

}  // namespace
}  // namespace simvis::combined

TEST_SUITE_END();
