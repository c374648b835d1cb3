// Rays and worlds for the tests of the ray caster.
#pragma once

#include <doctest/doctest.h>

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include <simvis/device.h>
#include <simvis/pose.h>
#include <simvis/ray_caster.h>
#include "tests/support/random_room.h"
#include "tests/support/renderer_scene.h"

namespace simvis {

using test::at;

inline glm::dvec3 random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random), z = normal(random);
  return glm::normalize(glm::dvec3(x, y, z));
}

inline glm::dmat4 random_pose(std::mt19937& random, double reach_m) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Pose pose;
  pose.position_m = {reach_m * unit(random), reach_m * unit(random), reach_m * unit(random)};
  pose.roll_rad = std::numbers::pi * unit(random);
  pose.pitch_rad = std::numbers::pi * unit(random) / 2;
  pose.yaw_rad = std::numbers::pi * unit(random);
  return to_matrix(pose);
}

/// A ray caster of one kind.
struct RayEngine {
  std::shared_ptr<RayCaster> caster;

  bool on_device() const { return caster->engine() != "the host"; }

  std::vector<RayHit> cast(const DrawList& list, const glm::dmat4& world_from_sensor,
                           const std::vector<glm::dvec3>& directions) const {
    std::vector<RayHit> hits(directions.size());
    caster->set_world(list);
    caster->cast(world_from_sensor, directions, hits);
    return hits;
  }

  RayHit cast_one(const DrawList& list, const glm::dvec3& direction, const glm::dmat4& pose = glm::dmat4(1.0)) const {
    return cast(list, pose, {direction}).front();
  }
};

inline Device& ray_device() {
  static Device device;
  return device;
}

inline RayEngine host_engine() { return {make_host_ray_caster()}; }
inline RayEngine device_engine() { return {make_device_ray_caster(ray_device())}; }

/// Runs the rest of a test case once for every engine.
inline RayEngine each_engine() {
  RayEngine engine;
  SUBCASE("host") { engine = host_engine(); }
  SUBCASE("compute shader") { engine = device_engine(); }
  return engine;
}

/// A sphere whose poles are points: sphere_mesh() leaves holes 10^-16 m wide there, and a beam finds them.
inline Mesh closed_sphere_mesh(double radius_m, int segments) {
  Mesh mesh = sphere_mesh(radius_m, segments);
  for (glm::vec3& p : mesh.positions) p = glm::mix(p, glm::vec3(0), glm::lessThan(glm::abs(p), glm::vec3(1e-9f)));
  return mesh;
}

}  // namespace simvis
