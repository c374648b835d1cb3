// Motion blur and depth of field: edges against the share of the time, or of the lens, in which a pixel sees them.
// Chromatic aberration: edges where each colour has them.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "effects/camera/chromatic_aberration.h"
#include "effects/camera/depth_of_field.h"
#include "effects/camera/motion_blur.h"
#include "sensors/camera/camera.h"
#include "sensors/camera/color_samples.h"
#include "tests/support/error_of.h"
#include "tests/support/measured_images.h"
#include "tests/support/renderer_scene.h"

TEST_SUITE_BEGIN("effects");

namespace simvis {
namespace {

constexpr std::uint32_t kBlurWidth_px = 160, kBlurHeight_px = 3;
constexpr double kBlurFocal_px = 150;
// Vertices are snapped to 1/256 pixel, after some rounding. A pixel closer to an edge than this may be on either side.
constexpr double kBlurSnap_px = 0.01;
// The mean of a picture's numbers 0 and 1 is rounded once to float32.
constexpr double kRounded = 0x1p-24;

// A bright plate at this depth, whose left edge is at x. White everywhere to the right of it.
test::RendererScene edge_scene(double edge_m, double depth_m) {
  test::RendererScene scene;
  scene.list.environment.background = glm::vec3(0);
  Material bright;
  bright.unlit = bright.double_sided = true;
  scene.add(test::rectangle(0, -20, 20, 20), bright, sensor_from_view() * test::at(edge_m, 0, depth_m));
  return scene;
}

CameraDesc blurred(std::shared_ptr<const CameraEffect> effect, const char* name) {
  return {.pinhole = {.width_px = kBlurWidth_px,
                      .height_px = kBlurHeight_px,
                      .hfov_rad = 2 * std::atan(kBlurWidth_px / (2 * kBlurFocal_px))},
          .color = true,
          .depth = true,
          .effects = {{find_effect_type(name), std::move(effect)}}};
}

struct Taken {
  Image color, depth;
  std::size_t passes = 0;
};

// A camera takes a frame at time 0, and one at 0.1 s after it has moved to the right.
Taken taken(Camera& camera, const test::RendererScene& scene, double moved_m) {
  Renderer renderer{test::device()};
  Taken last;
  for (std::uint64_t frame = 0; frame < 2; ++frame) {
    FramePlan plan;
    const FrameTime time{frame, static_cast<std::int64_t>(frame) * 100'000'000, 100'000'000};
    camera.begin(time);
    camera.plan(to_matrix({{0, frame == 0 ? 0 : -moved_m, 0}}), scene.list, plan);
    camera.collect(time, plan, renderer.render(scene.list, plan));
    last = {color_of(camera), depth_of(camera), plan.passes.size()};
  }
  return last;
}

float channel(const Image& image, std::uint32_t x, std::size_t c) {
  return image.pixels[4 * (std::size_t{1} * kBlurWidth_px + x) + c];
}
float red(const Image& image, std::uint32_t x) { return channel(image, x, 0); }

TEST_CASE("an edge that crosses pixels during the exposure covers its share of their time") {
  // The camera moves by 0.4 m in 0.1 s; the exposure is the last 0.06 s. In that time the edge at 2 m goes from 12 px
  // to 30 px left of the middle.
  constexpr double kMoved_m = 0.4, kDepth_m = 2, kExposure_s = 0.06, kPeriod_s = 0.1;
  const auto edge_px = [&](double share) {  // of the way
    return kBlurWidth_px / 2.0 - kBlurFocal_px * kMoved_m * share / kDepth_m;
  };
  const test::RendererScene scene = edge_scene(0, kDepth_m);
  std::vector<double> errors;
  for (const std::uint32_t samples : {4u, 16u, 64u}) {
    CAPTURE(samples);
    Camera camera("C", blurred(std::make_shared<MotionBlur>(kExposure_s, samples), "motion_blur"));
    const Taken picture = taken(camera, scene, kMoved_m);
    CHECK(picture.passes == samples + 1);
    double squares = 0;
    int unclear = 0;
    for (std::uint32_t x = 0; x < kBlurWidth_px; ++x) {
      CAPTURE(x);
      const double centre = x + 0.5;
      // The share of the exposure in which the edge is left of the pixel's centre, and that of the samples.
      const double first = edge_px(1 - kExposure_s / kPeriod_s), last = edge_px(1);
      const double exact = std::clamp((centre - last) / (first - last), 0.0, 1.0);
      double sampled = 0;
      bool clear = true;
      for (std::uint32_t i = 0; i < samples; ++i) {
        const double at = edge_px(1 - kExposure_s / kPeriod_s * (i + 0.5) / samples);
        clear = clear && std::abs(at - centre) > kBlurSnap_px;
        sampled += (at < centre ? 1.0 : 0.0) / samples;
      }
      unclear += !clear;
      if (clear) CHECK(std::abs(red(picture.color, x) - sampled) < kRounded);
      CHECK(std::abs(red(picture.color, x) - exact) <= 1.0 / samples + kRounded);
      squares += std::pow(red(picture.color, x) - exact, 2);
      // Depth is that of the frame's time.
      if (std::abs(last - centre) > kBlurSnap_px) {
        CHECK(std::isinf(picture.depth.pixels[kBlurWidth_px + x]) == (last > centre));
      }
    }
    CHECK(unclear < static_cast<int>(kBlurWidth_px) / 4);
    errors.push_back(std::sqrt(squares / kBlurWidth_px));
  }
  CHECK(errors[1] < errors[0] / 2);  // it falls as 1 / samples: by 4 each time
  CHECK(errors[2] < errors[1] / 2);
}

TEST_CASE("a camera that sees nothing move takes one picture, that without blur") {
  const test::RendererScene scene = edge_scene(0.1, 2);
  Camera camera("C", blurred(std::make_shared<MotionBlur>(0.06, 16), "motion_blur"));
  CameraDesc plain_desc = blurred(nullptr, "motion_blur");
  plain_desc.effects.clear();
  Camera plain("C", plain_desc);
  const Taken still = taken(camera, scene, 0), without = taken(plain, scene, 0);
  CHECK(still.color.pixels == without.color.pixels);
  CHECK(still.depth.pixels == without.depth.pixels);
  CHECK(still.passes == 2);  // colour, and depth apart
}

// The share of a disc of radius 1 beyond a straight line at the distance d from its centre.
double disc_beyond(double d) {
  if (d >= 1) return 0;
  if (d <= -1) return 1;
  return (std::acos(d) - d * std::sqrt(1 - d * d)) / std::numbers::pi;
}

TEST_CASE("an edge out of focus is spread over the circle of its blur") {
  constexpr double kAperture_m = 0.05, kFocus_m = 2;
  for (const double depth_m : {1.0, 2.0, 5.0}) {
    CAPTURE(depth_m);
    const double radius_px = kBlurFocal_px * kAperture_m / 2 * std::abs(1 / depth_m - 1 / kFocus_m);
    const double edge_px = kBlurWidth_px / 2.0 + 0.3;
    const test::RendererScene scene = edge_scene(0.3 * depth_m / kBlurFocal_px, depth_m);
    for (const std::uint32_t samples : {16u, 64u, 256u}) {
      CAPTURE(samples);
      const ThinLens lens{.aperture_m = kAperture_m, .focus_m = kFocus_m, .samples = samples};
      Camera camera("C", blurred(std::make_shared<DepthOfField>(lens), "depth_of_field"));
      const Taken picture = taken(camera, scene, 0);
      CHECK(picture.passes == samples + 1);
      double squares = 0;
      int within = 0;
      for (std::uint32_t x = 0; x < kBlurWidth_px; ++x) {
        const double distance_px = edge_px - (x + 0.5);
        const double exact = radius_px == 0 ? (distance_px < 0 ? 1 : 0) : disc_beyond(distance_px / radius_px);
        if (std::abs(distance_px) > radius_px + kBlurSnap_px) CHECK(red(picture.color, x) == exact);
        if (std::abs(distance_px) > radius_px) continue;
        ++within;
        squares += std::pow(red(picture.color, x) - exact, 2);
      }
      if (depth_m == kFocus_m) continue;
      REQUIRE(within >= 2);
      // The header's bound: the standard deviation of a mean of random points.
      CHECK(std::sqrt(squares / within) < 0.5 / std::sqrt(samples));
    }
  }
}

TEST_CASE("samples fill time and lens evenly, and each picture is sharp at the focus") {
  const std::vector<ColorSample> samples =
      color_samples({.time_s = 0.02, .aperture_m = 0.01, .focus_m = 3, .samples = 50});
  REQUIRE(samples.size() == 50);
  std::vector<double> times_s;
  double area = 0, together = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    times_s.push_back(samples[i].time_s);
    const double share = std::pow(glm::length(samples[i].lens_m) / 0.01, 2);
    CHECK(share == doctest::Approx((static_cast<double>(i) + 0.5) / 50));
    area += share / 50;
    together += (share - 0.5) * (samples[i].time_s / 0.02 + 0.5) / 50;
    const Pinhole pinhole{100, 110, 20, 30}, moved = pinhole_of(samples[i], pinhole, 3);
    for (const glm::dvec3& point : {glm::dvec3(0.4, -0.2, 3), glm::dvec3(-1, 1, 3)}) {
      const glm::dvec2 before(pinhole.cx_px + 100 * point.x / 3, pinhole.cy_px + 110 * point.y / 3);
      const glm::dvec2 after(moved.cx_px + 100 * (point.x - samples[i].lens_m.x) / 3,
                             moved.cy_px + 110 * (point.y - samples[i].lens_m.y) / 3);
      CHECK(glm::length(after - before) < 1e-12);
    }
  }
  CHECK(area == doctest::Approx(0.5));
  std::sort(times_s.begin(), times_s.end());
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    CHECK(times_s[i] == doctest::Approx(-0.02 * (50 - static_cast<double>(i) - 0.5) / 50));
  }
  // Correlation of lens and time: that of random pairs has the standard deviation (1 / 12) / sqrt(50).
  CHECK(std::abs(together) < 1.0 / 12 / std::sqrt(50));
  CHECK(color_samples({}).size() == 1);
  CHECK(color_samples({})[0].time_s == 0);
}

TEST_CASE("each colour shows an edge at its distance from the middle times its magnification") {
  constexpr double kDepth_m = 2;
  struct Magnified {
    glm::dvec3 magnification;
    std::size_t pictures;
  };
  for (const Magnified& each : {Magnified{{1.1, 1, 0.9}, 3}, Magnified{{1.05, 0.95, 1.05}, 2}}) {
    for (const double edge_px : {-60.3, -7.4, 55.7}) {  // right of the middle
      CAPTURE(edge_px);
      const test::RendererScene scene = edge_scene(edge_px * kDepth_m / kBlurFocal_px, kDepth_m);
      Camera camera(
          "C", blurred(std::make_shared<ChromaticAberration>(each.magnification, Location{}), "chromatic_aberration"));
      const Taken picture = taken(camera, scene, 0);
      CHECK(picture.passes == each.pictures + 1);  // depth apart
      for (std::uint32_t x = 0; x < kBlurWidth_px; ++x) {
        CAPTURE(x);
        const double centre_px = x + 0.5 - kBlurWidth_px / 2.0;
        for (int c = 0; c < 3; ++c) {
          CAPTURE(c);
          const double at_px = edge_px * each.magnification[c];
          if (std::abs(at_px - centre_px) < kBlurSnap_px) continue;
          CHECK(channel(picture.color, x, static_cast<std::size_t>(c)) == (at_px < centre_px ? 1 : 0));
        }
        CHECK(channel(picture.color, x, 3) == 1);
        CHECK(std::isinf(picture.depth.pixels[kBlurWidth_px + x]) == (edge_px > centre_px));
      }
    }
  }
}

TEST_CASE("with an open lens each of its points has a picture for each magnification, and green is as it was") {
  constexpr std::uint32_t kSamples = 16;
  const test::RendererScene scene = edge_scene(0.4, 1);
  const ThinLens lens{.aperture_m = 0.05, .focus_m = 2, .samples = kSamples};
  CameraDesc desc = blurred(std::make_shared<DepthOfField>(lens), "depth_of_field");
  Camera alike("C", desc);
  desc.effects.push_back({find_effect_type("chromatic_aberration"),
                          std::make_shared<ChromaticAberration>(glm::dvec3(1.1, 1, 0.9), Location{})});
  Camera unlike("C", desc);
  const Taken without = taken(alike, scene, 0), with = taken(unlike, scene, 0);
  CHECK(with.passes == 3 * kSamples + 1);
  int fringed = 0;
  for (std::uint32_t x = 0; x < kBlurWidth_px; ++x) {
    CHECK(channel(with.color, x, 1) == channel(without.color, x, 1));
    fringed += channel(with.color, x, 0) != channel(with.color, x, 2);
  }
  CHECK(fringed >= 10);  // the edge, 60 px from the middle, is 66 and 54 px away in red and blue
  CHECK(with.depth.pixels == without.depth.pixels);
}

TEST_CASE("wrong exposures are refused where they are wrong") {
  const auto refused = [](const std::string& attributes) {
    return error_of([&] {
      Simulation::from_string("<simvis><sensor type='camera' name='C' insert_at='ROOT' " + attributes + "/></simvis>");
    });
  };
  CHECK(contains(refused("exposure_time='-1'"), "exposure_time"));
  CHECK(contains(refused("exposure_time='nan'"), "exposure_time"));
  CHECK(contains(refused("exposure_time='0.01' motion_samples='0'"), "motion_samples"));
  CHECK(contains(refused("aperture='0.01' focus_distance='0'"), "focus_distance"));
  CHECK(contains(refused("aperture='0.01' width='160' distortion='kannala_brandt' fx='50'"),
                 "expected a lens of one view"));
  CHECK(refused("aperture='0.01' width='64' height='48' distortion='brown_conrady' k1='-0.1'") == "nothing was thrown");
  CHECK(contains(refused("aperture='0.01' lens_samples='256' width='1920' height='1080'"),
                 "256 samples of 1920 x 1080 pixels are too many, expected at most 16"));
  CHECK(contains(refused("color_magnification='1 1 1.2'"), "color_magnification"));
  CHECK(contains(refused("color_magnification='1 1'"), "color_magnification"));
  CHECK(contains(refused("color_magnification='1.01 1 1' width='160' distortion='kannala_brandt' fx='50'"),
                 "expected a lens of one view, or no color_magnification"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
