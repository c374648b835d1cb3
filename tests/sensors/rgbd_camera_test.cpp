// Depth by two viewpoints: shadows, bands and errors of disparity against their formulas.
#include "sensors/depth_camera/rgbd_camera.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;

namespace {

constexpr std::uint32_t kRgbdWidth_px = 200, kRgbdHeight_px = 20;
constexpr double kRgbdFocal_px = 100;  // hfov 90 degrees

enum Why : std::uint8_t { kMeasured, kNothing, kHidden, kOutside, kBeyond };

// A wall whose front is at x = `wall_m`, a plate at x = 1 with edges at y = -0.302 and 0.302, and the camera.
std::string rgbd_scene(double wall_m, bool plate, const std::string& attributes) {
  std::string xml = R"(<simvis><part name="WALL" shape="box" size="0.2 80 40" insert_at="ROOT" pose_offset=")" +
                    format_number(wall_m + 0.1) + R"( 0 0 0 0 0"/>)";
  if (plate) {
    xml += R"(<part name="PLATE" shape="box" size="0.001 0.604 4" insert_at="ROOT" pose_offset="1.0005 0 0 0 0 0"/>)";
  }
  return xml + R"(<sensor type="rgbd_camera" name="D" insert_at="ROOT" width="200" height="20" hfov="90" )" +
         attributes + "/></simvis>";
}

struct RgbdImages {
  std::vector<float> depth;
  std::vector<std::uint8_t> state;
};

RgbdImages images_of(Simulation& simulation) {
  simulation.step();
  const Measurement measurement = simulation.measurement("D");
  const MeasuredArray* const state = measurement.find("depth_state");
  REQUIRE(state != nullptr);
  const auto& states = std::get<SharedArray<std::uint8_t>>(state->numbers);
  const Image depth = simulation.depth("D");
  REQUIRE(depth.pixels.size() == kRgbdWidth_px * kRgbdHeight_px);
  REQUIRE(states.size() == depth.pixels.size());
  return {{depth.pixels.begin(), depth.pixels.end()}, {states.begin(), states.end()}};
}

RgbdImages images_of(const std::string& xml) {
  Simulation simulation = Simulation::from_string(xml);
  return images_of(simulation);
}

const std::string kStates = R"(outputs="depth depth_state" )";

TEST_CASE("a plate before a wall casts a shadow of f B (1/Z1 - 1/Z2) pixels, and the left band has f B / Z") {
  // The plate's left edge is at column 100 - 100 x 0.305 = 69.5 of the first image. Seen from the second viewpoint, 0.2
  // to the right, the edge covers the wall at 4 m up to y = 0.305 + (0.305 + 0.2) x 3 = 1.82, column 54.5: the shadow
  // is f B (1/Z1 - 1/Z2) = 100 x 0.2 x (1 - 1/4) = 15 pixels wide. The band at the left edge is 100 x 0.2 / 4 = 5
  // pixels.
  const RgbdImages images = images_of(rgbd_scene(4, true, kStates + R"(baseline="0.2")"));
  for (std::uint32_t pixel = 0; pixel < images.state.size(); ++pixel) {
    const double x = pixel % kRgbdWidth_px + 0.5;
    CAPTURE(x);
    const bool on_plate = x > 69.8 && x < 130.2;
    const Why expected = x < 5 ? kOutside : x > 54.8 && x < 69.8 ? kHidden : kMeasured;
    REQUIRE(images.state[pixel] == expected);
    if (expected == kMeasured) {
      // The walls are floats at whole metres; a depth rounds to a float of up to 4 m.
      REQUIRE(images.depth[pixel] == doctest::Approx(on_plate ? 1 : 4).epsilon(0x1p-22));
    } else {
      REQUIRE(std::isinf(images.depth[pixel]));
    }
  }
}

TEST_CASE("a smaller image of the second viewpoint widens the band on both sides") {
  // tan(45 deg / 2) x 4 m = 1.657 m to each side of the second viewpoint: from y = 1.457 to -1.857 of the first one,
  // and a tenth of that upwards and downwards, 0.1657 m or 4.14 pixels.
  const RgbdImages images = images_of(rgbd_scene(4, false, kStates + R"(baseline="0.2" second_hfov="45")"));
  const double half_m = 4 * std::tan(std::numbers::pi / 8), left = 100 - 25 * (half_m - 0.2),
               right = 100 + 25 * (half_m + 0.2);
  for (std::uint32_t pixel = 0; pixel < images.state.size(); ++pixel) {
    const double x = pixel % kRgbdWidth_px + 0.5, y = pixel / kRgbdWidth_px + 0.5 - 10;
    CAPTURE(x);
    CAPTURE(y);
    REQUIRE(images.state[pixel] == (x > left && x < right && std::abs(y) < 4.14 ? kMeasured : kOutside));
  }
}

TEST_CASE("without errors depths are the bytes of a camera that casts them") {
  const std::string camera =
      R"(<sensor type="camera" name="C" insert_at="ROOT" width="200" height="20" hfov="90" outputs="depth normal"/></simvis>)";
  std::string xml = rgbd_scene(3, true, kStates + R"(baseline="0.01")");
  xml = xml.substr(0, xml.rfind("</simvis>")) + camera;
  Simulation simulation = Simulation::from_string(xml);
  const RgbdImages images = images_of(simulation);
  const Image depth = simulation.depth("C");
  std::size_t measured = 0;
  for (std::size_t pixel = 0; pixel < images.depth.size(); ++pixel) {
    if (images.state[pixel] != kMeasured) continue;
    REQUIRE(images.depth[pixel] == depth.pixels[pixel]);
    ++measured;
  }
  CHECK(measured > images.depth.size() * 9 / 10);
  CHECK(simulation.value("D", "depth_error_bound_m") == simulation.value("C", "depth_error_bound_m"));
  const std::string off = kStates + R"(baseline="0.01" disparity_noise="0" disparity_step="0" depth_min="0")";
  CHECK(images_of(rgbd_scene(3, true, off)).depth == images.depth);
}

TEST_CASE("what is nearer than near hides nothing from either viewpoint") {
  std::string covered = rgbd_scene(4, true, kStates + R"(baseline="0.05" near="0.05")");
  const RgbdImages without = images_of(covered);
  covered.insert(
      covered.rfind("<sensor"),
      R"(<part name="COVER" shape="box" size="0.002 0.4 0.4" insert_at="ROOT" pose_offset="0.02 0 0 0 0 0"/>)");
  const RgbdImages with = images_of(covered);
  CHECK(with.state == without.state);
  CHECK(with.depth == without.depth);
  CHECK(std::ranges::count(with.state, kMeasured) > 0);
}

TEST_CASE("depths are those of disparities that are rounded") {
  // f B / Z = 100 x 0.2 / 3 = 6.667 pixels: in steps of 0.25 it is 6.75, and depth 20 / 6.75.
  const RgbdImages images = images_of(rgbd_scene(3, false, kStates + R"(baseline="0.2" disparity_step="0.25")"));
  CHECK(images.state[kRgbdWidth_px - 1] == kMeasured);
  CHECK(images.depth[kRgbdWidth_px - 1] == static_cast<float>(20 / 6.75));
  // Steps of 16 pixels round it to 0, and there is no depth.
  const RgbdImages coarse = images_of(rgbd_scene(3, false, kStates + R"(baseline="0.2" disparity_step="16")"));
  CHECK(coarse.state[kRgbdWidth_px - 1] == kBeyond);
  CHECK(std::isinf(coarse.depth[kRgbdWidth_px - 1]));
}

TEST_CASE("limits of depth") {
  const auto state_at = [](double wall_m) {
    return images_of(rgbd_scene(wall_m, false, kStates + R"(depth_min="1" depth_max="5")")).state[kRgbdWidth_px / 2];
  };
  CHECK(state_at(0.9) == kBeyond);
  CHECK(state_at(1.1) == kMeasured);
  CHECK(state_at(4.9) == kMeasured);
  CHECK(state_at(5.1) == kBeyond);
}

TEST_CASE("noise of depth has the variance of Z^2 s / (f B)") {
  // 195 pixels in each of 20 rows and 20 frames have a depth. The sum of squares over the variance is chi-square with n
  // degrees of freedom; beyond 6 standard deviations, sqrt(2 n) each, it is by chance once in 10^9. The next term of
  // Z(d) = f B / d changes the variance by a share of 3 (s / d)^2 x 5 / 2 < 1e-4 of itself, with s / d = 0.02 / 5.
  constexpr double kNoise_px = 0.02, kZ_m = 4, kBaseline_m = 0.2;
  const double sigma_m = kZ_m * kZ_m * kNoise_px / (kRgbdFocal_px * kBaseline_m);
  Simulation simulation =
      Simulation::from_string(rgbd_scene(kZ_m, false, kStates + R"(baseline="0.2" disparity_noise="0.02")"));
  double n = 0, chi_square = 0, sum = 0;
  std::vector<float> first;
  for (int frame = 0; frame < 20; ++frame) {
    const RgbdImages images = images_of(simulation);
    if (frame == 0) first = images.depth;
    CHECK((frame == 0 || images.depth != first));
    for (std::size_t pixel = 0; pixel < images.depth.size(); ++pixel) {
      if (images.state[pixel] != kMeasured) continue;
      const double error = (images.depth[pixel] - kZ_m) / sigma_m;
      n += 1;
      sum += error;
      chi_square += error * error;
    }
  }
  CHECK(n == 20 * 20 * 195);
  CHECK(std::abs(chi_square - n) < 6 * std::sqrt(2 * n) + 1e-4 * n);
  // The mean of Z is larger by s^2 / d^2 of itself: 4 x 1.6e-5 m, or 0.004 of a standard deviation.
  CHECK(std::abs(sum / n) < 6 / std::sqrt(n) + 0.005);
}

TEST_CASE("presets name devices, and wrong limits are refused") {
  const auto with = [](const std::string& attributes) {
    return R"(<simvis><sensor type="rgbd_camera" name="D" insert_at="ROOT" )" + attributes + "/></simvis>";
  };
  Simulation d435 = Simulation::from_string(with(R"(preset="realsense_d435" outputs="depth")"));
  d435.step();
  CHECK(d435.depth("D").width == 848);
  const std::string error = error_of([&] { Simulation::from_string(with(R"(depth_min="2" depth_max="1")")); });
  CHECK(error.find("\"depth_max\": 1 is not allowed with depth_min=\"2\"") != error.npos);
}

}  // namespace

TEST_SUITE_END();
