#include "bench/scenes/dense.h"

#include <cmath>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "bench/scenes/glb_file.h"
#include "bench/scenes/solids.h"

namespace simvis::bench {

namespace {

constexpr double kTrianglesOfPart = 4000;  // of a robot's six
constexpr double kLand_m = 400;

std::filesystem::path write_world(const std::filesystem::path& folder, const std::string& name,
                                  const std::vector<Mesh>& meshes, const std::vector<PlacedMesh>& placed,
                                  const std::string& sensors) {
  write_glb(folder / (name + ".glb"), meshes, placed);
  const std::filesystem::path scene = folder / (name + ".xml");
  std::ofstream out(scene);
  out << "<simvis>\n  <part file=\"" << name << ".glb\" name=\"WORLD\" insert_at=\"ROOT\" up=\"z\"/>\n"
      << sensors << "\n</simvis>\n";
  if (!out.flush()) throw std::runtime_error("cannot write " + scene.string());
  return scene;
}

double land_height_m(double x_m, double y_m) {
  const auto hills = [](double x, double y) {
    return 3 * std::sin(0.021 * x + 0.3) * std::cos(0.017 * y) + 0.8 * std::sin(0.093 * x) * std::sin(0.081 * y + 0.5) +
           0.05 * std::sin(1.3 * x) * std::cos(1.1 * y);
  };
  return hills(x_m, y_m) - hills(0, 0);
}

}  // namespace

std::filesystem::path write_fleet(const std::filesystem::path& folder, std::size_t robots, const std::string& sensors) {
  constexpr std::size_t kAcross = 10;
  constexpr double kFirst_m = 8, kRow_m = 4.5, kColumn_m = 2.5;
  std::vector<Mesh> meshes{wall_of({2 * kLand_m, 2 * kLand_m}, 2)};
  std::vector<PlacedMesh> placed{{0, {0, 0, 0}}};
  struct Part {
    Mesh mesh;
    glm::dvec3 position_m;
  };
  std::vector<Part> parts{{cylinder_of(0.35, 0.7, kTrianglesOfPart), {0, 0, 0.55}},
                          {sphere_of(0.25, kTrianglesOfPart), {0, 0, 1.1}}};
  for (const glm::dvec2& wheel : {glm::dvec2(0.3, 0.3), {0.3, -0.3}, {-0.3, 0.3}, {-0.3, -0.3}}) {
    parts.push_back({sphere_of(0.12 + 0.01 * static_cast<double>(parts.size()), kTrianglesOfPart), {wheel, 0.12}});
  }
  for (const Part& part : parts) {
    for (std::size_t i = 0; i < robots; ++i) {
      const auto row = static_cast<double>(i / kAcross), column = static_cast<double>(i % kAcross);
      const glm::dvec3 at(kFirst_m + kRow_m * row, kColumn_m * (column - (kAcross - 1) / 2.0), 0);
      placed.push_back({meshes.size(), at + part.position_m});
    }
    meshes.push_back(part.mesh);
  }
  return write_world(folder, "fleet", meshes, placed, sensors);
}

std::filesystem::path write_terrain(const std::filesystem::path& folder, std::size_t triangles,
                                    const std::string& sensors) {
  Mesh land = wall_of({kLand_m, kLand_m}, static_cast<double>(triangles));
  constexpr double kStep_m = 0.01;  // of the derivatives
  for (std::size_t i = 0; i < land.positions.size(); ++i) {
    glm::vec3& p = land.positions[i];
    const auto height = [&](double dx_m, double dy_m) { return land_height_m(p.x + dx_m, p.y + dy_m); };
    const glm::dvec3 normal((height(-kStep_m, 0) - height(kStep_m, 0)) / (2 * kStep_m),
                            (height(0, -kStep_m) - height(0, kStep_m)) / (2 * kStep_m), 1);
    p.z = static_cast<float>(height(0, 0));
    land.attributes[i].normal = glm::vec3(glm::normalize(normal));
  }
  compute_bounds(land);
  return write_world(folder, "terrain", {land}, {{0, {0, 0, 0}}}, sensors);
}

}  // namespace simvis::bench
