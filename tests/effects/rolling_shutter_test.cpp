// A camera that moves past a vertical edge while its rows are exposed: the slant of the edge.
#include "effects/camera/rolling_shutter.h"

#include <doctest/doctest.h>

#include <cmath>

#include <simvis/pose.h>
#include "effects/camera/lens.h"
#include "sensors/camera/camera.h"
#include "tests/support/measured_images.h"
#include "tests/support/renderer_scene.h"

TEST_SUITE_BEGIN("effects");

using namespace simvis;

namespace {

constexpr std::uint32_t kWidth_px = 200, kHeight_px = 120;
constexpr double kShutterFocal_px = 150, kFar_m = 3, kSpeed_m_s = 4, kPeriod_s = 0.1, kRow_s = 6e-4;
// Vertices are snapped to 1/256 pixel, after some rounding. A pixel closer to the edge than this may be on either side.
constexpr double kSnap_px = 0.01;

// A bright plate. Its vertical left edge is straight ahead of the camera's position half way along its path.
const double kEdge_m = kSpeed_m_s * kPeriod_s / 2;

test::RendererScene plate() {
  test::RendererScene scene;
  scene.list.environment.background = glm::vec3(0);
  Material bright;
  bright.unlit = bright.double_sided = true;
  scene.add(test::rectangle(0, -20, 20, 20), bright, sensor_from_view() * test::at(kEdge_m, 0, kFar_m));
  return scene;
}

CameraDesc desc(std::vector<ChosenCameraEffect> effects) {
  return {.pinhole = {.width_px = kWidth_px,
                      .height_px = kHeight_px,
                      .hfov_rad = 2 * std::atan(kWidth_px / (2 * kShutterFocal_px))},
          .color = true,
          .depth = true,
          .effects = std::move(effects)};
}

ChosenCameraEffect shutter(std::uint32_t rows_per_pose) {
  return {find_effect_type("rolling_shutter"), std::make_shared<RollingShutter>(kRow_s, rows_per_pose)};
}

// The lens as a layout, without its attributes.
struct Barrel : CameraEffect {
  static constexpr double kOversampling = 2;

  static Lens lens() {
    constexpr double kCoefficients[] = {-0.2, 0.03, 0, 0, 0};
    return lens_of({kShutterFocal_px, kShutterFocal_px, kWidth_px / 2.0, kHeight_px / 2.0}, "plumb_bob", kCoefficients)
        .value();
  }

  void configure_rays(CameraLayout& layout) const override {
    layout.oversampling = kOversampling;
    for (std::uint32_t y = 0; y < layout.height_px; ++y) {
      for (std::uint32_t x = 0; x < layout.width_px; ++x) {
        layout.rays.push_back(lens().direction({x + 0.5, y + 0.5}).value());
      }
    }
  }
};

// The camera is at rest at time 0 and has moved to the right at time kPeriod_s.
struct Journey {
  test::RendererScene scene = plate();
  Renderer renderer{test::device()};

  void take(Camera& camera, std::uint64_t frame) {
    FramePlan plan;
    const double time_s = static_cast<double>(frame) * kPeriod_s;
    const FrameTime time{frame, std::llround(time_s * 1e9), std::llround(kPeriod_s * 1e9)};
    camera.begin(time);
    camera.plan(to_matrix({{0, -kSpeed_m_s * time_s, 0}}), scene.list, plan);
    camera.collect(time, plan, renderer.render(scene.list, plan));
  }
};

// Displacement of the camera to the right when a row of the frame at kPeriod_s is exposed.
double moved_m(std::uint32_t row, std::uint32_t rows_per_pose) {
  const std::uint32_t first = row / rows_per_pose * rows_per_pose;
  const std::uint32_t last = std::min(first + rows_per_pose, kHeight_px) - 1;
  return kSpeed_m_s * (kPeriod_s - (kHeight_px - 1 - (first + last) / 2.0) * kRow_s);
}

double first_bright(const Image& image, std::uint32_t row) {
  std::uint32_t x = 0;
  while (x < kWidth_px && image.pixels[4 * (std::size_t{row} * kWidth_px + x)] < 0.5f) ++x;
  return x;
}

}  // namespace

TEST_CASE("a vertical edge is slanted by the exposure time of each row") {
  for (const std::uint32_t rows_per_pose : {1u, 7u}) {
    CAPTURE(rows_per_pose);
    Camera camera("C", desc({shutter(rows_per_pose)}));
    Journey journey;
    journey.take(camera, 0);
    for (std::uint32_t row = 0; row < kHeight_px; ++row) {  // at rest
      CHECK(first_bright(color_of(camera), row) ==
            std::ceil(kWidth_px / 2.0 + kShutterFocal_px * kEdge_m / kFar_m - 0.5));
    }
    journey.take(camera, 1);
    int wrong = 0, unclear = 0, deep = 0;
    for (std::uint32_t row = 0; row < kHeight_px; ++row) {
      const double edge_px = kWidth_px / 2.0 + kShutterFocal_px * (kEdge_m - moved_m(row, rows_per_pose)) / kFar_m;
      const double expected = std::ceil(edge_px - 0.5);
      if (std::abs(edge_px - 0.5 - std::round(edge_px - 0.5)) < kSnap_px) {
        ++unclear;
        continue;
      }
      const double seen = first_bright(color_of(camera), row);
      wrong += seen != expected;
      // Depth in metres along Z: corners up to 30 m away, in float32, with several roundings.
      const float depth_m = depth_of(camera).pixels[row * kWidth_px + static_cast<std::size_t>(seen) + 1];
      deep += std::abs(static_cast<double>(depth_m) - kFar_m) > 16 * 30 * 0x1p-24;
    }
    CHECK(wrong == 0);
    CHECK(deep == 0);
    CHECK(unclear < kHeight_px / 10);
    // Over the image the edge moves by the motion during all rows.
    const double slant_px = kShutterFocal_px * kSpeed_m_s * (kHeight_px - 1) * kRow_s / kFar_m;
    const double seen_px = first_bright(color_of(camera), 0) - first_bright(color_of(camera), kHeight_px - 1);
    CHECK(std::abs(seen_px - slant_px) <= 1 + (rows_per_pose - 1) * slant_px / (kHeight_px - 1));
  }
}

TEST_CASE("a lens bends the slanted edge as well") {
  Camera camera("C", desc({{find_effect_type("lens_distortion"), std::make_shared<Barrel>()}, shutter(4)}));
  Journey journey;
  journey.take(camera, 0);
  journey.take(camera, 1);
  const Lens lens = Barrel::lens();
  int wrong = 0;
  for (std::uint32_t row = 0; row < kHeight_px; ++row) {
    // Where the edge crosses the row: along the edge, pixels go down with its height.
    const double x_m = kEdge_m - moved_m(row, 4);
    double low = -5, high = 5;
    for (int i = 0; i < 60; ++i) {
      const double y_m = (low + high) / 2;
      (lens.pixel({x_m, y_m, kFar_m}).y < row + 0.5 ? low : high) = y_m;
    }
    const double edge_px = lens.pixel({x_m, low, kFar_m}).x;
    // The brightness of a pixel is interpolated between the two rendered pixels beside the edge: an error of half a
    // rendered pixel, and half an image pixel for its position.
    wrong += std::abs(first_bright(color_of(camera), row) - (edge_px - 0.5) - 0.5) > 0.5 + 0.75 / Barrel::kOversampling;
  }
  CHECK(wrong == 0);
}

TEST_CASE("a frame that is repeated is not its own predecessor") {
  Camera camera("C", desc({shutter(8)}));
  Journey journey;
  journey.take(camera, 0);
  journey.take(camera, 1);
  const Image first = color_of(camera);
  journey.take(camera, 1);
  CHECK(color_of(camera).pixels == first.pixels);
}

TEST_SUITE_END();
