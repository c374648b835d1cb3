// Rendered pictures of worlds whose pixels follow from geometry.
#include "sensors/camera/camera.h"

#include <doctest/doctest.h>

#include <glm/gtc/matrix_transform.hpp>

#include <simvis/device.h>
#include <simvis/pose.h>
#include "engine/render/renderer.h"
#include "tests/support/measured_images.h"
#include "tests/support/random_room.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;

namespace {

struct CameraStage {
  Device device;
  Renderer renderer{device};
  DrawList list;

  void take(Camera& camera, const glm::dmat4& world_from_sensor = glm::dmat4(1.0)) {
    FramePlan plan;
    camera.plan(world_from_sensor, list, plan);
    camera.collect({}, plan, renderer.render(list, plan));
  }
};

glm::dmat4 camera_at(double x, double y, double z) { return glm::translate(glm::dmat4(1.0), {x, y, z}); }

}  // namespace

TEST_CASE("depth is in metres along the optical axis and constant over a wall that faces the camera") {
  CameraStage stage;
  add_item(stage.list, half_box_mesh({0.5, 30, 30}), camera_at(4.5, 0, 0));
  Camera camera(
      "C",
      {.pinhole = {.width_px = 64, .height_px = 48, .hfov_rad = glm::radians(90.0)}, .color = false, .depth = true});
  stage.take(camera);
  CHECK(camera.measurement().find("color") == nullptr);
  REQUIRE(depth_of(camera).pixels.size() == 64 * 48);
  // Vertices at 30 m are rounded to 30 * 2^-24 several times; the plane is set up and stored in float32.
  constexpr double kTolerance_m = 16 * 30 * 0x1p-24;
  for (const float z : depth_of(camera).pixels) CHECK(std::abs(z - 4) <= kTolerance_m);
}

TEST_CASE("image x goes to the right, y down, and hfov spans the width") {
  CameraStage stage;
  // The right and upper edges of the plate lie on the optical axis: left is +y, up is +z.
  add_item(stage.list, half_box_mesh({0.1, 1, 1}), camera_at(3.1, 1, 1));
  Camera camera(
      "C",
      {.pinhole = {.width_px = 40, .height_px = 20, .hfov_rad = glm::radians(90.0)}, .color = false, .depth = true});
  stage.take(camera);
  const Image depth = depth_of(camera);
  const auto seen = [&](int x, int y) { return std::isfinite(depth.pixels[y * 40 + x]); };
  CHECK(seen(19, 9));
  CHECK_FALSE(seen(20, 9));
  CHECK_FALSE(seen(19, 10));
  // The left edge of the plate, 2 m at 3 m, is 20 * 2/3 = 13.3 pixels left of the centre.
  CHECK(seen(7, 5));
  CHECK_FALSE(seen(6, 5));
}

TEST_CASE("an empty scene shows the background at infinite depth") {
  CameraStage stage;
  stage.list.world_from_node.push_back(glm::dmat4(1.0));
  Camera camera("C", {.pinhole = {.width_px = 8, .height_px = 8}, .color = true, .depth = true});
  stage.take(camera);
  const Image color = color_of(camera);
  REQUIRE(color.channels == 4);
  REQUIRE(color.pixels.size() == 8 * 8 * 4);
  for (int c = 0; c < 3; ++c) CHECK(color.pixels[c] == stage.list.environment.background[c]);
  CHECK(color.pixels[3] == 1);
  CHECK(depth_of(camera).pixels[0] == std::numeric_limits<float>::infinity());
}

TEST_CASE("a rotated and moved camera sees the picture that follows from geometry") {
  CameraStage stage;
  add_item(stage.list, sphere_mesh(0.5, 128), camera_at(2, 3, 1));
  Camera camera(
      "C",
      {.pinhole = {.width_px = 101, .height_px = 101, .hfov_rad = glm::radians(40.0)}, .color = false, .depth = true});
  const glm::dvec3 eye(-1, -1, 1);
  stage.take(camera, to_matrix({eye, 0, 0, std::atan2(4.0, 3.0)}));
  // The middle pixel looks at the sphere's centre, 5 m away. Its tessellation has a sagitta of r (1 - cos(pi / 128)).
  constexpr double kSagitta_m = 0.5 * 3.1e-4 * 2;
  CHECK(std::abs(depth_of(camera).pixels[50 * 101 + 50] - 4.5) <= kSagitta_m);
}

TEST_SUITE_END();
