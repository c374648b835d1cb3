// Automatic exposure against its closed form, in scenes that stay, saturate, change and go dark.
#include "effects/camera/auto_exposure.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include <simvis/simulation.h>
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("effects");

namespace simvis {
namespace {

Image grey(double light) {
  const auto value = static_cast<float>(light);
  return {2, 1, 4, std::vector<float>{value, value, value, 1, value, value, value, 1}};
}

FrameTime at(std::uint64_t frame) { return {.index = frame, .time_ns = static_cast<std::int64_t>(frame) * 50'000'000}; }

// The exposure that an image of this light was taken with. The light is a float32, and so is the product.
double exposure_of(const AutoExposure& effect, std::uint64_t frame, double light) {
  Image image = grey(light);
  effect.post_process(at(frame), {}, image);
  CHECK(image.pixels[3] == 1);
  return static_cast<double>(image.pixels[0]) / static_cast<double>(static_cast<float>(light));
}
constexpr double kExposureRounding = 4 * 0x1p-24;  // relative, of a few powers of nearby numbers and one product

TEST_CASE("the exposure of a scene that stays approaches the target exponentially") {
  const AutoExposure effect({.target = 0.2, .time_constant_s = 0.1});
  const double light = static_cast<double>(static_cast<float>(0.05)), end = 0.2 / light;
  for (std::uint64_t frame = 0; frame < 20; ++frame) {
    CAPTURE(frame);
    const double expected = end * std::pow(1 / end, std::exp(-0.05 * static_cast<double>(frame) / 0.1));
    CHECK(std::abs(exposure_of(effect, frame, light) / expected - 1) < kExposureRounding);
    CHECK(std::abs(exposure_of(effect, frame, light) / expected - 1) < kExposureRounding);  // the frame is repeated
  }
}

TEST_CASE("without a time constant the next image has the exposure, saturated images step down") {
  const AutoExposure at_once({.target = 0.2});
  CHECK(exposure_of(at_once, 0, 0.05) == 1);
  CHECK(std::abs(exposure_of(at_once, 1, 0.8) / 4 - 1) < kExposureRounding);
  // At four times 0.8 the meter shows 1: the exposure falls by 0.2 to 0.8, and is then right.
  CHECK(std::abs(exposure_of(at_once, 2, 0.8) / 0.8 - 1) < kExposureRounding);
  CHECK(std::abs(exposure_of(at_once, 3, 0.8) / 0.25 - 1) < kExposureRounding);
}

TEST_CASE("limits hold, and black images lead to the largest exposure") {
  const AutoExposure limited({.target = 0.2, .least = 0.5, .most = 8});
  CHECK(exposure_of(limited, 0, 1e-3) == 1);
  CHECK(std::abs(exposure_of(limited, 1, 10) / 8 - 1) < kExposureRounding);
  for (std::uint64_t frame = 2; frame < 6; ++frame) exposure_of(limited, frame, 10);
  CHECK(std::abs(exposure_of(limited, 6, 10) / 0.5 - 1) < kExposureRounding);
  Image black = grey(0);
  limited.post_process(at(7), {}, black);
  CHECK(black.pixels[0] == 0);
  CHECK(std::abs(exposure_of(limited, 8, 1) / 8 - 1) < kExposureRounding);
}

TEST_CASE("no frame of a camera with automatic exposure is left out") {
  Simulation simulation = Simulation::from_string(
      "<simvis><sensor type='camera' name='C' insert_at='ROOT' width='4' height='3' auto_exposure='0.1'/></simvis>");
  CHECK(contains(error_of([&] { simulation.skip_frame(); }), "sensor \"C\" of type camera"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
