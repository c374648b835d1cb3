#include "bench/scenes/lab.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include "bench/scenes/glb_file.h"
#include "bench/scenes/solids.h"

namespace simvis::bench {

namespace {

constexpr glm::dvec3 kRoom_m(16, 12, 3);
constexpr double kFree_m = 2;  // around the middle, for the robot
constexpr double kWallShare = 0.1;
constexpr std::size_t kMaxItems = 200, kMinPerItem = 45;

constexpr const char* kScanners = R"(
  <sensor type="laser_scanner" name="FRONT_SCANNER" insert_at="ROBOT" pose_offset="0.33 0 0.1 0 0 0"/>
  <sensor type="laser_scanner" name="REAR_SCANNER" insert_at="ROBOT" pose_offset="-0.33 0 0.1 0 0 180"/>
  <sensor type="laser_scanner" name="TILT_SCANNER" insert_at="ROBOT" pose_offset="0.24 0 1 0 10 0"/>)";

/// Meshes and their poses, to be written into a file.
struct Furniture {
  std::vector<Mesh> meshes;
  std::vector<PlacedMesh> placed;

  void add(Mesh mesh, const glm::dvec3& position_m, const glm::dquat& turn = {1, 0, 0, 0}) {
    placed.push_back({meshes.size(), position_m, turn});
    meshes.push_back(std::move(mesh));
  }
};

/// The rotation that takes z to `to`, a unit vector.
glm::dquat turn_of_z(const glm::dvec3& to) {
  return to.z < -0.5 ? glm::dquat(0, 1, 0, 0) : glm::normalize(glm::dquat(1 + to.z, glm::cross({0, 0, 1}, to)));
}

void add_walls(Furniture& lab, double triangles) {
  const glm::dvec3 middle(0, 0, kRoom_m.z / 2);
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2;
    glm::dvec3 inwards(0);
    inwards[axis] = side % 2 == 0 ? 1 : -1;
    const glm::dvec3 width_m = glm::abs(glm::inverse(turn_of_z(inwards)) * kRoom_m);
    lab.add(wall_of(glm::dvec2(width_m), triangles / 6), middle - inwards * kRoom_m / 2.0, turn_of_z(inwards));
  }
}

class Chance {
 public:
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

  /// A random position on the floor of the room, outside of the robot's circle.
  glm::dvec3 place(double keep_m) {
    for (;;) {
      const glm::dvec3 at(between(-1, 1) * (kRoom_m.x / 2 - keep_m), between(-1, 1) * (kRoom_m.y / 2 - keep_m), 0);
      if (std::hypot(at.x, at.y) > kFree_m + keep_m) return at;
    }
  }

 private:
  std::mt19937 random_{20091};
};

void add_item(Furniture& lab, std::size_t kind, double triangles, Chance& chance) {
  const double reach_m = chance.between(0.12, 0.4), height_m = chance.between(0.3, 1.6);
  glm::dvec3 at = chance.place(1.5 * reach_m);
  const glm::dquat yaw = glm::angleAxis(chance.between(-std::numbers::pi, std::numbers::pi), glm::dvec3(0, 0, 1));
  if (kind % 3 == 0) {
    at.z = height_m / 2;
    lab.add(box_of({2 * reach_m, chance.between(0.5, 2) * reach_m, height_m}, triangles), at, yaw);
  } else if (kind % 3 == 1) {
    at.z = reach_m;
    lab.add(sphere_of(reach_m, triangles), at, yaw);
  } else {
    at.z = height_m / 2;
    lab.add(cylinder_of(reach_m, height_m, triangles), at, yaw);
  }
}

Furniture furnished(std::size_t triangles, double wall_triangles) {
  Furniture lab;
  Chance chance;
  const auto all = static_cast<double>(triangles);
  add_walls(lab, wall_triangles);
  const std::size_t items = std::min(kMaxItems, triangles / kMinPerItem);
  for (std::size_t i = 0; i < items; ++i) {
    add_item(lab, i, (1 - kWallShare) * all / static_cast<double>(items), chance);
  }
  return lab;
}

void write_robot(const std::filesystem::path& file) {
  Furniture robot;
  robot.add(box_of({0.6, 0.4, 0.8}, 48), {0, 0, 0.45});
  write_glb(file, robot.meshes, robot.placed);
}

std::filesystem::path write_scene(const std::filesystem::path& folder, const Furniture& lab,
                                  const std::string& sensors) {
  write_glb(folder / "lab.glb", lab.meshes, lab.placed);
  write_robot(folder / "robot.glb");
  const std::filesystem::path scene = folder / "lab.xml";
  std::ofstream out(scene);
  out << "<simvis>\n"
         "  <part file=\"lab.glb\" name=\"LAB\" insert_at=\"ROOT\" up=\"z\"/>\n"
         "  <part file=\"robot.glb\" name=\"ROBOT\" insert_at=\"LAB\" up=\"z\"/>\n"
         "  <element type=\"pose\" name=\"R_POSE\" insert_at=\"ROBOT\" x=\"1\"/>\n"
      << sensors << "\n</simvis>\n";
  if (!out.flush()) throw std::runtime_error("cannot write " + scene.string());
  return scene;
}

}  // namespace

std::filesystem::path write_lab(const std::filesystem::path& folder, std::size_t triangles) {
  return write_lab(folder, triangles, kScanners);
}

std::filesystem::path write_lab(const std::filesystem::path& folder, std::size_t triangles,
                                const std::string& sensors) {
  return write_scene(folder, furnished(triangles, kWallShare * static_cast<double>(triangles)), sensors);
}

std::filesystem::path write_store(const std::filesystem::path& folder, std::size_t instances) {
  return write_store(folder, instances, kScanners);
}

std::filesystem::path write_store(const std::filesystem::path& folder, std::size_t instances,
                                  const std::string& sensors) {
  constexpr std::size_t kBase = 10000, kWalls = 12, kStanding = 100, kAcross = 100;
  constexpr double kSize_m = 0.25, kSpacing_m = 0.5, kAbove_m = 6;
  Furniture store = furnished(kBase, kWalls);
  Chance chance;
  const std::size_t box = store.meshes.size();
  store.meshes.push_back(box_of(glm::dvec3(kSize_m), 192));
  for (std::size_t i = 0; i < instances; ++i) {
    if (i < kStanding) {
      store.placed.push_back({box, chance.place(kSize_m) + glm::dvec3(0, 0, kSize_m / 2)});
      continue;
    }
    const std::size_t n = i - kStanding;
    const glm::dvec3 cell(n % kAcross, n / kAcross % kAcross, n / kAcross / kAcross);
    const glm::dvec3 middle(kAcross / 2.0, kAcross / 2.0, 0);
    store.placed.push_back({box, (cell - middle) * kSpacing_m + glm::dvec3(0, 0, kAbove_m)});
  }
  return write_scene(folder, store, sensors);
}

void drive_lab(Simulation& simulation, int frame) {
  const double angle_deg = frame % 360, angle = angle_deg * std::numbers::pi / 180;
  simulation.set("R_POSE", "x", std::cos(angle));
  simulation.set("R_POSE", "y", std::sin(angle));
  simulation.set("R_POSE", "yaw", angle_deg + 90);
}

std::size_t triangles_of(const DrawList& list) {
  std::size_t triangles = 0;
  for (const DrawItem& item : list.items) {
    const Mesh& mesh = *list.meshes[item.mesh];
    if (mesh.topology == Topology::triangles) triangles += mesh.indices.size() / 3;
  }
  return triangles;
}

}  // namespace simvis::bench
