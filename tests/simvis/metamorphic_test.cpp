// What does not change what is measured, or changes it in a known way, on random triangles: everything moves rigidly,
// is twice as large, is mirrored, or has its triangles split. (hard_cases/order_test has the order of commands and
// further sensors.) SIMVIS_TEST_SCENES=1000 tries so many scenes, SIMVIS_TEST_SEED=7 others.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/simulation.h>
#include "tests/support/long_count.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/random_numbers.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

using Triangle = std::array<glm::vec3, 3>;
using Triangles = std::vector<Triangle>;

constexpr int kBeams = 61, kRings = 9, kTriangles = 40;
// A beam counts as one at an edge if turning it by this much changes its range by more than a surface that is seen at
// this grazing angle would: 10 m * 2e-6 / tan(0.1 deg) = 1.2e-2 m.
constexpr double kEdgeTurn_deg = 1e-4, kEdgeStep_m = 0.012;

// Coordinates are multiples of 1/64 m within 8 m, and so are those of midpoints and of twice as large triangles: float
// holds all of them exactly.
float coordinate(test::Random& random, int low, int high) {
  return static_cast<float>(low * 32 + static_cast<int>(random.below(static_cast<std::uint64_t>(high - low) * 32))) /
         32;
}

Triangles random_triangles(test::Random& random) {
  Triangles all(kTriangles);
  for (Triangle& triangle : all) {
    const glm::vec3 at(coordinate(random, 2, 7), coordinate(random, -4, 4), coordinate(random, -2, 2));
    for (glm::vec3& corner : triangle) {
      corner = at + glm::vec3(coordinate(random, -1, 1), coordinate(random, -1, 1), coordinate(random, -1, 1));
    }
  }
  return all;
}

void write_triangles(const std::filesystem::path& file, const Triangles& triangles) {
  std::vector<float> corners;
  for (const Triangle& triangle : triangles) {
    for (const glm::vec3& corner : triangle) corners.insert(corners.end(), {corner.x, corner.y, corner.z});
  }
  test::GltfBuilder builder;
  builder.primitive({{"POSITION", builder.accessor<float>("VEC3", corners)}})["material"] = 0;
  builder.append("materials", {{"doubleSided", true}});
  write_text(file, builder.text());
}

struct MeasuredWorld {
  const Triangles& triangles;
  std::string pose = "0 0 0 0 0 0";                ///< of the part and of the sensors
  double turn_deg = 0, size = 1, range_max_m = 6;  ///< turn: of the sensors alone, about their own z and y
};

class MetamorphicWorld {
 public:
  /// The scans of the two methods, one behind the other.
  std::vector<Scan> measure(const MeasuredWorld& world) {
    write_triangles(folder_ / "soup.gltf", world.triangles);
    const std::string turn = format_number(world.turn_deg);
    std::string scene = "<scene><part name='FRAME' insert_at='ROOT' pose_offset='" + world.pose +
                        "'/><part file='soup.gltf' up='z' name='SOUP' insert_at='FRAME'/>";
    for (const char* method : {"method='raycast'", "max_error_m='1e-4'"}) {
      scene += std::string("<sensor type='laser_scanner' name='") + (method[0] == 'm' && method[1] == 'e' ? "R" : "H") +
               "' insert_at='FRAME' " + method + " samples='" + std::to_string(kBeams) +
               "' min_angle='-40' max_angle='40' vertical_samples='" + std::to_string(kRings) +
               "' vertical_min_angle='-20' vertical_max_angle='20' range_min='" + format_number(0.05 * world.size) +
               "' range_max='" + format_number(world.range_max_m * world.size) + "' pose_offset='0 0 0 0 " + turn +
               " " + turn + "'/>";
    }
    write_text(folder_ / "scene.xml", scene + "</scene>");
    SimulationDesc desc;
    desc.device.cache_dir = (folder_ / "cache").string();
    Simulation simulation = Simulation::load(folder_ / "scene.xml", desc);
    simulation.step();
    return {simulation.scan("R"), simulation.scan("H")};
  }

 private:
  TemporaryFolder folder_;
};

/// Whether both ranges are near one true range. Infinite ranges are the same.
bool agree(const Scan& a, std::size_t i, const Scan& b, std::size_t j) {
  if (!std::isfinite(a.range_m[i]) || !std::isfinite(b.range_m[j])) return a.range_m[i] == b.range_m[j];
  return std::abs(double{a.range_m[i]} - b.range_m[j]) <= double{a.error_bound_m[i]} + b.error_bound_m[j];
}

class Edges {
 public:
  Edges(MetamorphicWorld& world, const Triangles& triangles, const Scan& base) : base_(base) {
    for (const double turn_deg : {-kEdgeTurn_deg, kEdgeTurn_deg}) {
      turned_.push_back(world.measure({.triangles = triangles, .turn_deg = turn_deg}).front());
    }
  }
  bool contain(std::size_t i) const {
    for (const Scan& turned : turned_) {
      const double before = base_.range_m[i], after = turned.range_m[i];
      if (std::isfinite(before) != std::isfinite(after)) return true;
      if (std::isfinite(before) && std::abs(before - after) > kEdgeStep_m) return true;
    }
    return false;
  }

 private:
  const Scan& base_;
  std::vector<Scan> turned_;
};

TEST_CASE("rigid motion, double size, mirrors and split triangles change ranges as they should") {
  MetamorphicWorld world;
  std::size_t hits = 0, at_edges = 0, beams = 0;
  test::Random random(static_cast<std::uint64_t>(count_of("SIMVIS_TEST_SEED", 1)));
  for (int scene = count_of("SIMVIS_TEST_SCENES", 3); scene > 0; --scene) {
    CAPTURE(scene);
    const Triangles triangles = random_triangles(random);
    const std::vector<Scan> base = world.measure({.triangles = triangles});
    const Edges edges(world, triangles, base.front());
    Triangles doubled, mirrored, split;
    for (const Triangle& t : triangles) {
      doubled.push_back({t[0] * 2.0f, t[1] * 2.0f, t[2] * 2.0f});
      const glm::vec3 mirror(1, -1, 1), middle = (t[0] + t[1]) * 0.5f;
      mirrored.push_back({t[0] * mirror, t[2] * mirror, t[1] * mirror});
      split.push_back({t[0], middle, t[2]});
      split.push_back({middle, t[1], t[2]});
    }
    const std::vector<Scan> moved = world.measure({.triangles = triangles, .pose = "3 -2 1 10 -20 70"});
    const std::vector<Scan> large = world.measure({.triangles = doubled, .size = 2});
    const std::vector<Scan> turned_over = world.measure({.triangles = mirrored});
    const std::vector<Scan> pieces = world.measure({.triangles = split});
    for (std::size_t method = 0; method < base.size(); ++method) {
      CAPTURE(method);
      for (std::size_t i = 0; i < base[method].range_m.size(); ++i, ++beams) {
        CAPTURE(i);
        const std::size_t mirrored_beam = i / kBeams * kBeams + (kBeams - 1 - i % kBeams);
        hits += std::isfinite(base[method].range_m[i]) ? 1 : 0;
        if (edges.contain(i)) {
          ++at_edges;
          continue;
        }
        CHECK(agree(base[method], i, moved[method], i));
        CHECK(agree(base[method], i, turned_over[method], mirrored_beam));
        CHECK(agree(base[method], i, pieces[method], i));
        // A factor of two rounds nothing that is cast; a rendered depth is bounded.
        if (method == 0) CHECK(large[0].range_m[i] == 2 * base[0].range_m[i]);
        if (method == 0 || !std::isfinite(base[1].range_m[i])) continue;
        CHECK(std::abs(large[1].range_m[i] - 2.0 * base[1].range_m[i]) <=
              large[1].error_bound_m[i] + 2.0 * base[1].error_bound_m[i]);
      }
    }
  }
  CHECK(hits > beams / 10);
  CHECK(at_edges < beams / 50);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
