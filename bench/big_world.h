// Writes a world with a given number of triangles as a glTF file: bumpy ground with bumpy balls on it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <glm/glm.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace simvis::bench {

/// A closed or open grid of columns x rows quads, two triangles each.
struct GridMesh {
  std::vector<glm::vec3> positions, normals;
  std::vector<std::uint32_t> indices;
};

/// `at(u, v)` with u and v from 0 to 1 is the surface; normals are computed from its differences.
template <class Surface>
GridMesh grid_mesh(std::uint32_t columns, std::uint32_t rows, const Surface& at) {
  GridMesh mesh;
  for (std::uint32_t row = 0; row <= rows; ++row) {
    for (std::uint32_t column = 0; column <= columns; ++column) {
      const double u = static_cast<double>(column) / columns, v = static_cast<double>(row) / rows, step = 1e-4;
      const glm::dvec3 across = glm::cross(at(u + step, v) - at(u - step, v), at(u, v + step) - at(u, v - step));
      const double length = glm::length(across);
      mesh.positions.emplace_back(at(u, v));
      mesh.normals.emplace_back(length > 0 ? across / length : glm::dvec3(0, 0, 1));
    }
  }
  for (std::uint32_t row = 0; row < rows; ++row) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      const std::uint32_t a = row * (columns + 1) + column, b = a + 1, c = a + columns + 1, d = c + 1;
      mesh.indices.insert(mesh.indices.end(), {a, b, d, a, d, c});
    }
  }
  return mesh;
}

/// Half of the triangles form a ground of 100 x 100 m, the rest `kBalls` balls of 2 m, each with its own mesh.
inline constexpr int kBalls = 10;

inline std::vector<GridMesh> big_world_meshes(std::uint64_t triangles) {
  const auto side = [](double quads) {
    return static_cast<std::uint32_t>(std::max(2.0, std::round(std::sqrt(quads))));
  };
  const double ground_quads = static_cast<double>(triangles) / 4, ball_quads = ground_quads / kBalls;
  std::vector<GridMesh> meshes;
  meshes.push_back(grid_mesh(side(ground_quads), side(ground_quads), [](double u, double v) {
    const double x = 100 * (u - 0.5), y = 100 * (v - 0.5);
    return glm::dvec3(x, y, 0.2 * std::sin(0.7 * x) * std::cos(0.9 * y) + 0.01 * std::sin(23 * x + 11 * y));
  }));
  for (int i = 0; i < kBalls; ++i) {
    const double around = 6.283185307179586 * i / kBalls;
    meshes.push_back(grid_mesh(side(2 * ball_quads), side(ball_quads / 2), [&](double u, double v) {
      const double azimuth = 6.283185307179586 * u, polar = 3.141592653589793 * (1 - v);
      const double radius = 2 + 0.1 * std::sin((5 + i) * azimuth) * std::sin(polar) * std::sin(9 * polar);
      return glm::dvec3(8 * std::cos(around), 8 * std::sin(around), 2) +
             radius *
                 glm::dvec3(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar));
    }));
  }
  return meshes;
}

/// Writes FILE.glb, z up: insert it with up="z". Returns its number of triangles.
inline std::uint64_t write_big_world(const std::filesystem::path& file, std::uint64_t triangles) {
  const std::vector<GridMesh> meshes = big_world_meshes(triangles);
  std::string views, accessors, nodes, roots, shapes;
  std::uint64_t bytes = 0, written = 0;
  int view = 0;
  const auto add = [&](std::uint64_t size, std::uint64_t count, const std::string& kind) {
    const std::string comma = view == 0 ? "" : ",", number = std::to_string(view++);
    views += comma + R"({"buffer":0,"byteOffset":)" + std::to_string(bytes) + R"(,"byteLength":)" +
             std::to_string(size) + "}";
    accessors += comma + R"({"bufferView":)" + number + R"(,"count":)" + std::to_string(count) + "," + kind + "}";
    bytes += size;
    return number;
  };
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const GridMesh& mesh = meshes[i];
    glm::vec3 low = mesh.positions[0], high = low;
    for (const glm::vec3& p : mesh.positions) low = glm::min(low, p), high = glm::max(high, p);
    const auto numbers = [](const glm::vec3& v) {
      return "[" + std::to_string(v.x) + "," + std::to_string(v.y) + "," + std::to_string(v.z) + "]";
    };
    const std::string vec3 = R"("componentType":5126,"type":"VEC3")";
    const std::string position = add(mesh.positions.size() * 12, mesh.positions.size(),
                                     vec3 + R"(,"min":)" + numbers(low) + R"(,"max":)" + numbers(high));
    const std::string normal = add(mesh.normals.size() * 12, mesh.normals.size(), vec3);
    const std::string index =
        add(mesh.indices.size() * 4, mesh.indices.size(), R"("componentType":5125,"type":"SCALAR")");
    const std::string comma = i == 0 ? "" : ",", number = std::to_string(i);
    shapes += comma + R"({"primitives":[{"attributes":{"POSITION":)" + position + R"(,"NORMAL":)" + normal +
              R"(},"indices":)" + index + "}]}";
    nodes += comma + R"({"mesh":)" + number + "}";
    roots += comma + number;
    written += mesh.indices.size() / 3;
  }
  std::string json = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[)" + roots + R"(]}],"nodes":[)" +
                     nodes + R"(],"meshes":[)" + shapes + R"(],"accessors":[)" + accessors + R"(],"bufferViews":[)" +
                     views + R"(],"buffers":[{"byteLength":)" + std::to_string(bytes) + "}]}";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::ofstream out(file, std::ios::binary);
  const auto word = [&](std::uint64_t value) {
    const auto narrow = static_cast<std::uint32_t>(value);
    out.write(reinterpret_cast<const char*>(&narrow), 4);
  };
  const auto array = [&](const auto& values) {
    out.write(reinterpret_cast<const char*>(values.data()),
              static_cast<std::streamsize>(values.size() * sizeof values[0]));
  };
  word(0x46546C67), word(2), word(12 + 8 + json.size() + 8 + bytes);
  word(json.size()), word(0x4E4F534A), array(json);
  word(bytes), word(0x004E4942);
  for (const GridMesh& mesh : meshes) array(mesh.positions), array(mesh.normals), array(mesh.indices);
  if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
  return written;
}

}  // namespace simvis::bench
