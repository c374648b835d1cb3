// Rays and worlds for the tests of the ray caster.
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <numbers>
#include <random>
#include <utility>
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

/// A masked material with random opaque texels.
inline std::shared_ptr<Material> leaves(std::mt19937& random) {
  auto texture = std::make_shared<Texture>();
  texture->width = texture->height = 16;
  for (int i = 0; i < 4 * 16 * 16; ++i) texture->rgba.push_back(static_cast<std::uint8_t>(random() % 256));
  auto material = std::make_shared<Material>();
  material->alpha_mode = AlphaMode::mask;
  material->base_color_texture = texture;
  return material;
}

/// A square of 2 x 2 m perpendicular to x whose texture repeats every half metre.
inline Mesh leaf_mesh() {
  Mesh mesh;
  mesh.positions = {{0, 1, 1}, {0, -1, 1}, {0, -1, -1}, {0, 1, -1}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.attributes.resize(4);
  const glm::vec2 uvs[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
  for (std::size_t i = 0; i < 4; ++i) mesh.attributes[i].uv[0] = uvs[i];
  return mesh;
}

/// Half of the directions are random, half point to corners, edges or inner points of the list's triangles.
inline std::vector<glm::dvec3> directions_into(const DrawList& list, const glm::dmat4& pose, std::size_t count,
                                               std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  const glm::dmat4 sensor_from_world = rigid_inverse(pose);
  std::vector<glm::dvec3> directions;
  while (directions.size() < count) {
    directions.push_back(random_direction(random));
    const DrawItem& item = list.items[random() % list.items.size()];
    const Mesh& mesh = *list.meshes[item.mesh];
    if (mesh.topology != Topology::triangles || mesh.indices.size() < 3) continue;
    const std::size_t triangle = random() % (mesh.indices.size() / 3);
    double weights[3] = {unit(random), unit(random), unit(random)};
    for (double& weight : weights) weight = random() % 3 == 0 ? 0 : weight;
    const double sum = weights[0] + weights[1] + weights[2];
    glm::dvec3 point(0);
    for (std::size_t k = 0; k < 3 && sum > 0; ++k) {
      point += weights[k] / sum * glm::dvec3(mesh.positions[mesh.indices[3 * triangle + k]]);
    }
    const glm::dvec3 way(sensor_from_world * (list.world_from_node[item.transform] * glm::dvec4(point, 1)));
    if (glm::length(way) > 0) directions.push_back(glm::normalize(way));
  }
  return directions;
}

struct RoomWithSensor {
  DrawList list;
  glm::dmat4 world_from_sensor;
};

/// A random room with masked leaves and with mirrored, stretched, tiny and flattened items. Rooms with other numbers
/// stand up to 10^7 m away from the origin.
inline RoomWithSensor room_of_hard_cases(int room, std::mt19937& random) {
  DrawList list = random_room(static_cast<std::uint32_t>(room), 40, room % 4 == 0 ? 64 : 16);
  list.materials.push_back(leaves(random));
  list.material_revision.push_back(0);
  for (int i = 0; i < 12; ++i) {
    add_item(list, leaf_mesh(), at(0, 0, 1.2) * random_pose(random, 2));
    list.items.back().material = 1;
  }
  const glm::dvec3 scales[] = {{1, 1, 1},    {-1, 1, 1},    {1, 2, 0.01},       {1e-6, 1e-6, 1e-6},
                               {1, 1, 0},    {1, 1e-9, 1},  {1, 1e-3, 1},       {-2, -2, -2},
                               {1, 1e-5, 1}, {0.1, 10, 10}, {1e-3, 1e-3, 1e-3}, {1, 1, 1}};
  for (std::size_t i = 1; i < list.items.size(); ++i) {
    glm::dmat4& pose = list.world_from_node[list.items[i].transform];
    pose = glm::scale(pose, scales[i % std::size(scales)]);
  }
  const double offset_m = room % 5 == 0 ? 0 : std::pow(10, 2 + room % 6);
  const glm::dmat4 offset = at(0.9 * offset_m, -0.7 * offset_m, 0.2 * offset_m);
  for (std::size_t t = 1; t < list.world_from_node.size(); ++t) {
    list.world_from_node[t] = offset * list.world_from_node[t];
  }
  const glm::dmat4 pose = offset * at(0, 0, 1.2) * random_pose(random, 0.5);
  return {std::move(list), pose};
}

}  // namespace simvis
