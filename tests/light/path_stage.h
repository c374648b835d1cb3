// Scenes of rectangles, and cameras that see them by paths of light, without a device.
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <numbers>
#include <vector>

#include <simvis/pose.h>
#include <simvis/ray_caster.h>
#include "sensors/camera/camera.h"
#include "tests/support/measured_images.h"
#include "tests/support/random_room.h"
#include "tests/support/reference_directions.h"

namespace simvis::test {

/// Whether a mean is where it must be: a normal number is beyond five of its standard deviations once in 1.7 million
/// times. `rounding` bounds the errors of numbers that are not random.
inline bool agree(double mean, double expected, double stddev, double rounding = 0) {
  constexpr double kDeviations = 5;
  return std::abs(mean - expected) <= kDeviations * stddev + rounding;
}

/// Colours are stored as float32: of a number up to 4.
constexpr double kStored = 4 * 0x1p-24;

/// A rectangle from a corner along two sides, whose front is where side x other points.
inline Mesh rectangle_mesh(const glm::dvec3& corner, const glm::dvec3& side, const glm::dvec3& other) {
  Mesh mesh;
  for (const glm::dvec3& at : {corner, corner + side, corner + side + other, corner + other}) {
    mesh.positions.push_back(glm::vec3(at));
  }
  mesh.attributes.resize(4);
  for (VertexAttributes& vertex : mesh.attributes) vertex.normal = glm::vec3(glm::normalize(glm::cross(side, other)));
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

inline Material matte(double base) {
  Material material;
  material.base_color = glm::vec4(glm::vec3(static_cast<float>(base)), 1);
  return material;
}
inline Material lamp(double radiance) {
  Material material = matte(0);
  material.emissive = glm::vec3(static_cast<float>(radiance));
  return material;
}

struct PathStage {
  DrawList list;
  std::unique_ptr<RayCaster> caster = make_host_ray_caster();

  PathStage() {
    list.world_from_node.push_back(glm::dmat4(1));
    list.environment = {.ambient = glm::vec3(0), .background = glm::vec3(0)};
  }

  void add(const Mesh& mesh, const Material& material, const glm::dmat4& world_from_mesh = glm::dmat4(1)) {
    add_item(list, mesh, world_from_mesh);
    list.items.back().material = static_cast<std::uint32_t>(list.materials.size());
    list.materials.push_back(std::make_shared<Material>(material));
    list.material_revision.push_back(0);
  }

  void take(Camera& camera, const glm::dmat4& world_from_sensor, std::uint64_t frame = 0) {
    FramePlan plan;
    const FrameTime time{
        .index = frame, .time_ns = static_cast<std::int64_t>(frame) * 1'000'000, .period_ns = 1'000'000};
    camera.begin(time);
    camera.plan(world_from_sensor, list, plan);
    CHECK(plan.passes.empty());
    camera.collect(time, plan, {});
    caster->set_world(list);
    camera.cast(*caster);
  }
};

/// A camera of so many pixels along each side.
inline CameraDesc path_camera(std::uint32_t samples, std::uint32_t bounces, std::uint32_t size_px = 1,
                              double hfov_rad = 1e-8) {
  return {.pinhole = {.width_px = size_px, .height_px = size_px, .hfov_rad = hfov_rad, .near_m = 1e-3},
          .paths = {.light = CameraLight::path, .samples = samples, .bounces = bounces, .stddev = true}};
}

/// One that stands at a place and looks at another.
inline glm::dmat4 looking(const glm::dvec3& from, const glm::dvec3& at) {
  const glm::dvec3 x = glm::normalize(at - from);
  const glm::dvec3 up = std::abs(x.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
  const glm::dvec3 y = glm::normalize(glm::cross(up, x));
  return {glm::dvec4(x, 0), glm::dvec4(y, 0), glm::dvec4(glm::cross(x, y), 0), glm::dvec4(from, 1)};
}

/// The radiance of one pixel, and its standard deviation.
struct SeenRadiance {
  glm::dvec3 mean{0}, stddev{0};
};

inline SeenRadiance radiance_at(PathStage& stage, const glm::dvec3& from, const glm::dvec3& at, std::uint32_t samples,
                                std::uint32_t bounces) {
  Camera camera("C", path_camera(samples, bounces));
  stage.take(camera, looking(from, at));
  const Image color = color_of(camera), stddev = image_of(camera, "color_stddev");
  REQUIRE(color.pixels.size() == 4);
  REQUIRE(stddev.pixels.size() == 3);
  SeenRadiance seen;
  for (int c = 0; c < 3; ++c) {
    const auto channel = static_cast<std::size_t>(c);
    seen.mean[c] = static_cast<double>(color.pixels[channel]);
    seen.stddev[c] = static_cast<double>(stddev.pixels[channel]);
  }
  return seen;
}

}  // namespace simvis::test
