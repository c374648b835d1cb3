// Small worlds for tests of elements: plates perpendicular to x, with materials from the test, and the results of
// sensors.
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "tests/support/error_of.h"
#include "tests/support/parts/gltf_fixture.h"

namespace simvis::test {

/// A plate at x with edges at y and z, facing -x; texture u runs from its left edge (+y) to the right, v down. In the
/// project's own axes: insert the part with up="z".
struct Plate {
  float x = 4, left = 10, right = -10, bottom = -10, top = 10;
};

void add_plate(GltfBuilder& file, const Plate& p, int material);

/// A matte material of this base colour.
json painted(const std::string& name, const glm::vec4& color);

/// The same, unlit.
json unlit(const std::string& name, const glm::vec4& color);

/// Wide enough for a middle pixel, whose centre lies on the optical axis.
inline constexpr int kSide_px = 9;
inline const std::string kCamera =
    R"(<sensor type="camera" name="CAM" insert_at="ROOT" width="9" height="9" hfov="60" outputs="color depth"/>)";
inline const std::string kDark =
    R"(<element type="sky" name="SKY" insert_at="ROOT" ambient_red="0" ambient_green="0" ambient_blue="0"/>)";

/// A simulation of part files and commands. Any message of the validation layers fails the test.
class World {
 public:
  explicit World(const std::vector<std::pair<std::string, GltfBuilder>>& files, const std::string& commands);
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  Simulation& operator*() { return *simulation_; }
  Simulation* operator->() { return &*simulation_; }

  /// The pixel of the camera CAM after a change; by default the centre one.
  glm::dvec3 color(int x = kSide_px / 2, int y = kSide_px / 2);
  glm::dvec3 color_with(std::string_view element, std::string_view parameter, double value);

 private:
  TemporaryFolder folder_;
  std::optional<Simulation> simulation_;
};

/// Relative: normals are stored in 16 bits (1.5e-5 each way), the rest is some dozens of float32 operations of 6e-8.
inline constexpr double kShading = 4e-5;

void check_color(const glm::dvec3& seen, const glm::dvec3& expected, double relative = kShading);

}  // namespace simvis::test
