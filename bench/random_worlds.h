// Random worlds, each kind difficult for range sensors in its own way, and sensor poses in them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <numbers>
#include <random>
#include <utility>

#include <simvis/draw_list.h>
#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "scenegraph/primitive_meshes.h"

namespace simvis {

struct RandomWorld {
  DrawList list;
  /// World from sensor, rigid: a random pose in the world's free space, often level.
  std::function<glm::dmat4(std::mt19937&)> somewhere;
};

struct WorldKind {
  const char* name;
  RandomWorld (*make)(std::mt19937&);
};

namespace random_worlds {

inline double between(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

inline double log_between(std::mt19937& random, double low, double high) {
  return std::exp(between(random, std::log(low), std::log(high)));
}

inline glm::dmat4 at(double x, double y, double z) { return glm::translate(glm::dmat4(1.0), {x, y, z}); }

inline glm::dmat4 turned(std::mt19937& random) {
  const glm::dvec3 axis(between(random, -1, 1), between(random, -1, 1), between(random, 0.1, 1));
  return glm::rotate(glm::dmat4(1.0), between(random, 0, 6), glm::normalize(axis));
}

inline std::uint32_t add_mesh(DrawList& list, Mesh mesh) {
  if (list.world_from_node.empty()) list.world_from_node.push_back(glm::dmat4(1.0));
  if (list.materials.empty()) {
    list.materials.push_back(std::make_shared<Material>());
    list.material_revision.push_back(0);
  }
  mesh.attributes.resize(mesh.positions.size());
  compute_bounds(mesh);
  list.meshes.push_back(std::make_shared<Mesh>(std::move(mesh)));
  return static_cast<std::uint32_t>(list.meshes.size() - 1);
}

inline void add_item(DrawList& list, std::uint32_t mesh, const glm::dmat4& world_from_mesh) {
  list.items.push_back({mesh, 0, static_cast<std::uint32_t>(list.world_from_node.size())});
  list.world_from_node.push_back(world_from_mesh);
}

inline void add(DrawList& list, Mesh mesh, const glm::dmat4& world_from_mesh) {
  add_item(list, add_mesh(list, std::move(mesh)), world_from_mesh);
}

/// The rectangle [0, width] x [0, height] of the plane z = 0, as columns x rows of pairs of triangles.
inline Mesh grid_mesh(double width_m, double height_m, int columns, int rows) {
  Mesh mesh;
  for (int r = 0; r <= rows; ++r) {
    for (int c = 0; c <= columns; ++c) {
      mesh.positions.emplace_back(glm::dvec3(width_m * c / columns, height_m * r / rows, 0));
      if (r == rows || c == columns) continue;
      const auto i = static_cast<std::uint32_t>(r * (columns + 1) + c), above = i + columns + 1;
      mesh.indices.insert(mesh.indices.end(), {i, i + 1, above, i + 1, above + 1, above});
    }
  }
  return mesh;
}

/// A disc about the origin in the plane z = 0: all triangles share the corner in the middle.
inline Mesh fan_mesh(double radius_m, int triangles) {
  Mesh mesh;
  mesh.positions.emplace_back(0);
  for (int i = 0; i < triangles; ++i) {
    const double a = 2 * std::numbers::pi * i / triangles;
    mesh.positions.emplace_back(glm::dvec3(radius_m * std::cos(a), radius_m * std::sin(a), 0));
    const auto next = static_cast<std::uint32_t>((i + 1) % triangles + 1);
    mesh.indices.insert(mesh.indices.end(), {0, static_cast<std::uint32_t>(i + 1), next});
  }
  return mesh;
}

/// Random poses in a box around `middle` with half sizes `reach`; half of them are level, the rest rotated at random.
inline std::function<glm::dmat4(std::mt19937&)> inside(const glm::dvec3& middle, const glm::dvec3& reach) {
  return [=](std::mt19937& random) {
    Pose pose;
    for (int i = 0; i < 3; ++i) pose.position_m[i] = middle[i] + reach[i] * between(random, -1, 1);
    pose.yaw_rad = std::numbers::pi * between(random, -1, 1);
    if (random() % 2 == 0) {
      pose.roll_rad = std::numbers::pi * between(random, -1, 1);
      pose.pitch_rad = std::numbers::pi / 2 * between(random, -1, 1);
    }
    return to_matrix(pose);
  };
}

/// 10 x 8 x 3 m, floor at z = 0, with boxes and spheres that leave the middle free.
inline RandomWorld room(std::mt19937& random) {
  RandomWorld world;
  add(world.list, box_mesh({10, 8, 3}), at(0, 0, 1.5));
  for (int thing = 0; thing < 60; ++thing) {
    const double angle = between(random, 0, 7), distance = between(random, 1, 3.5);
    const glm::dmat4 place =
        at(distance * std::cos(angle), distance * std::sin(angle), between(random, 0.2, 2.5)) * turned(random);
    if (thing % 2 == 0) {
      add(world.list, sphere_mesh(between(random, 0.1, 0.4)), place);
    } else {
      add(world.list, box_mesh({between(random, 0.1, 0.6), between(random, 0.1, 0.6), between(random, 0.1, 0.6)}),
          place);
    }
  }
  world.somewhere = inside({0, 0, 1}, {0.3, 0.3, 0.5});
  return world;
}

/// A corridor of 120 m, also seen from 5 cm above its floor or beside its wall; each side has triangles of its own
/// size.
inline RandomWorld corridor(std::mt19937& random) {
  constexpr double kLength = 120, kWidth = 2.4, kHeight = 2.8;
  RandomWorld world;
  const auto pieces = [&] { return 1 + static_cast<int>(random() % 60); };
  const glm::dmat4 lying = at(-kLength / 2, -kWidth / 2, 0);
  const glm::dmat4 upright = glm::rotate(glm::dmat4(1.0), std::numbers::pi / 2, glm::dvec3(1, 0, 0));
  add(world.list, grid_mesh(kLength, kWidth, pieces(), 1 + pieces() / 20), lying);
  add(world.list, grid_mesh(kLength, kWidth, pieces(), 1), at(0, 0, kHeight) * lying);
  add(world.list, grid_mesh(kLength, kHeight, pieces(), 1 + pieces() / 20), lying * upright);
  add(world.list, grid_mesh(kLength, kHeight, pieces(), 1), at(0, kWidth, 0) * lying * upright);
  for (int box = 0; box < 20; ++box) {
    add(world.list, box_mesh({between(random, 0.1, 1), 0.3, between(random, 0.1, 2)}),
        at(between(random, -50, 50), between(random, -1.1, 1.1), 0));
  }
  world.somewhere = inside({0, 0, 1.4}, {3, 1.1, 1.35});
  return world;
}

/// Poles of 1 mm to 6 cm in a room, many of them thinner than a pixel.
inline RandomWorld poles(std::mt19937& random) {
  RandomWorld world;
  add(world.list, box_mesh({20, 20, 4}), at(0, 0, 2));
  for (int pole = 0; pole < 120; ++pole) {
    const double angle = between(random, 0, 7), distance = between(random, 0.7, 9);
    const glm::dmat4 place = at(distance * std::cos(angle), distance * std::sin(angle), 2) *
                             (pole % 3 == 0 ? turned(random) : glm::dmat4(1.0));
    const double thickness = log_between(random, 1e-3, 0.06);
    add(world.list, pole % 2 == 0 ? box_mesh({thickness, thickness, 4}) : cylinder_mesh(thickness / 2, 4), place);
  }
  world.somewhere = inside({0, 0, 1.5}, {0.4, 0.4, 1});
  return world;
}

/// Walls and discs of triangles up to 10^4 times as long as wide.
inline RandomWorld slivers(std::mt19937& random) {
  RandomWorld world;
  add(world.list, box_mesh({12, 12, 12}), glm::dmat4(1.0));
  for (int thing = 0; thing < 40; ++thing) {
    const double angle = between(random, 0, 7), distance = between(random, 1.5, 5);
    const glm::dmat4 place =
        at(distance * std::cos(angle), distance * std::sin(angle), between(random, -2, 2)) * turned(random);
    const int pieces = static_cast<int>(log_between(random, 8, 3000));
    if (thing % 2 == 0) {
      add(world.list, fan_mesh(between(random, 0.3, 4), pieces), place);
    } else {
      add(world.list, grid_mesh(between(random, 0.5, 6), between(random, 0.5, 6), pieces, 1), place);
    }
  }
  world.somewhere = inside({0, 0, 0}, {0.4, 0.4, 1});
  return world;
}

/// A box, a sphere and a cylinder at a hundred poses each: mirrored, stretched, from meshes of a millimetre and of a
/// kilometre.
inline RandomWorld instances(std::mt19937& random) {
  RandomWorld world;
  add(world.list, box_mesh({10, 8, 3}), glm::scale(at(0, 0, 1.5), {1, -1, 1}));
  const double unit_m[] = {1e-3, 1, 1e3};
  std::array<std::uint32_t, 9> meshes{};
  for (std::size_t u = 0; u < 3; ++u) {
    meshes[3 * u] = add_mesh(world.list, box_mesh(glm::dvec3(unit_m[u])));
    meshes[3 * u + 1] = add_mesh(world.list, sphere_mesh(unit_m[u] / 2));
    meshes[3 * u + 2] = add_mesh(world.list, cylinder_mesh(unit_m[u] / 2, unit_m[u]));
  }
  for (int thing = 0; thing < 100; ++thing) {
    const std::size_t mesh = random() % meshes.size();
    const double angle = between(random, 0, 7), distance = between(random, 1, 3.5);
    glm::dvec3 scale(between(random, 0.1, 0.6), between(random, 0.1, 0.6), between(random, 0.1, 0.6));
    for (int i = 0; i < 3; ++i) scale[i] *= random() % 2 == 0 ? 1 : -1;
    const glm::dmat4 place = at(distance * std::cos(angle), distance * std::sin(angle), between(random, 0.2, 2.5));
    add_item(world.list, meshes[mesh], glm::scale(place * turned(random), scale / unit_m[mesh / 3]));
  }
  world.somewhere = inside({0, 0, 1}, {0.3, 0.3, 0.5});
  return world;
}

/// A room 10^3 to 10^7 m from the world's origin.
inline RandomWorld far_away(std::mt19937& random) {
  RandomWorld world = room(random);
  const double distance = log_between(random, 1e3, 1e7), angle = between(random, 0, 7);
  const glm::dmat4 away = at(distance * std::cos(angle), distance * std::sin(angle), distance * between(random, -1, 1));
  for (std::size_t t = 1; t < world.list.world_from_node.size(); ++t) {
    world.list.world_from_node[t] = away * world.list.world_from_node[t];
  }
  world.somewhere = [away, near = world.somewhere](std::mt19937& r) { return away * near(r); };
  return world;
}

/// The scene ravon, without randomness: ground, rocks, trees and grass with masked leaves.
inline RandomWorld foliage(std::mt19937&) {
  static const RandomWorld kWorld = [] {
    Simulation simulation = Simulation::load(std::filesystem::path(SIMVIS_SOURCE_DIR) / "scenes/ravon/ravon.xml");
    for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, false);
    simulation.step();
    return RandomWorld{simulation.diagnostics().draw_list(), inside({-11.2, -3.2, 1}, {6, 1.5, 0.8})};
  }();
  return kWorld;
}

}  // namespace random_worlds

inline constexpr WorldKind kWorldKinds[] = {
    {"room", random_worlds::room},       {"corridor", random_worlds::corridor},   {"poles", random_worlds::poles},
    {"slivers", random_worlds::slivers}, {"instances", random_worlds::instances}, {"far", random_worlds::far_away},
    {"foliage", random_worlds::foliage},
};

}  // namespace simvis
