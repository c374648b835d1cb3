// Lamps with a size: the light that a point of a wall gets past the edge of a board, against the sum over the lamp's
// points and against the whole lamp, both computed here.
#include "elements/lamp.h"

#include <cmath>

#include "elements/color_temperature.h"
#include "engine/base/even_points.h"
#include "simvis/scene_builder.h"
#include "tests/support/element_scene.h"
#include "tests/support/reference_directions.h"

TEST_SUITE_BEGIN("elements");

namespace simvis::test {
namespace {

constexpr double kAway_m = 4, kBoard_m = 2, kEdge_m = 0.5, kCandela = 30, kLux = 5;
constexpr double kRadius_m = 0.2, kSunRadius_deg = 2;
// A shadow map of 1024 texels over a cone of 2 x 40 degrees has texels of 3.3 mm on the board, which is 2 m away; an
// edge is off by at most their half diagonal. Seen from the wall, that is twice as much at the lamp.
constexpr double kUnclear_m = 2 * 0.5 * std::numbers::sqrt2 * 3.3e-3;

// The wall at x = 4 m, and a board at 2 m whose lower edge is at z = 0.5 m, above what the camera looks at.
World behind_board(const std::string& light) {
  GltfBuilder file;
  add_plate(file, {}, file.append("materials", painted("Paint", glm::vec4(1))));
  return World(
      {{"wall.gltf", file}},
      R"(<part file="wall.gltf" name="WALL" insert_at="ROOT" up="z"/>)" + kDark + kCamera +
          R"(<part shape="box" size="0.001 30 20" name="BOARD" insert_at="ROOT" pose_offset="2 0 10.5 0 0 0"/>)"
          R"(<element type="light" name="LAMP" insert_at="ROOT" )" +
          light + "/>");
}

// How far a point lies below the plane through the point that the camera sees and the board's edge, along z.
double below_edge_m(const glm::dvec3& point) { return kEdge_m * (kAway_m - point.x) / (kAway_m - kBoard_m) - point.z; }

// Radiance of the wall by a candela at `point`.
double by_candela(const glm::dvec3& point) {
  const glm::dvec3 way = point - glm::dvec3(kAway_m, 0, 0);
  return -way.x / std::pow(glm::length(way), 3) / kPi;
}

// The mean over the surface of the ball at (0, 0, z) of the light that passes below the board: slices of equal area
// perpendicular to z, in steps around it.
double by_whole_ball(double z_m) {
  constexpr int kSlices = 200, kSteps = 200;
  double sum = 0;
  for (int i = 0; i < kSlices; ++i) {
    const double z = 2 * (i + 0.5) / kSlices - 1, around = std::sqrt(1 - z * z);
    for (int k = 0; k < kSteps; ++k) {
      const double angle = 2 * kPi * (k + 0.5) / kSteps;
      const glm::dvec3 point =
          glm::dvec3(0, 0, z_m) + kRadius_m * glm::dvec3(around * std::cos(angle), around * std::sin(angle), z);
      if (below_edge_m(point) > 0) sum += by_candela(point);
    }
  }
  return kCandela * sum / (kSlices * kSteps);
}

// The sum over the points of a lamp, and whether the shadow maps decide it without doubt.
struct PointSum {
  double light = 0;
  bool clear = true;
};

PointSum by_points_of_ball(std::uint32_t points, double z_m) {
  PointSum sum;
  for (std::uint32_t i = 0; i < points; ++i) {
    const glm::dvec3 point = glm::dvec3(0, 0, z_m) + place_of_point({kRadius_m, points}, i);
    sum.clear = sum.clear && std::abs(below_edge_m(point)) > kUnclear_m;
    if (below_edge_m(point) > 0) sum.light += kCandela / points * by_candela(point);
  }
  return sum;
}

TEST_CASE("a ball's light falls behind an edge as its visible part does, within the bound of its number of points") {
  for (const std::uint32_t points : {8u, 32u}) {
    CAPTURE(points);
    World world = behind_board(
        R"(kind="spot" inner_cone="40" outer_cone="40" shadows="yes" intensity="30" radius="0.2" lamp_points=")" +
        std::to_string(points) + '"');
    double squares = 0;
    int steps = 0, clear = 0;
    for (double z_m = 0.78; z_m < 1.23; z_m += 0.03, ++steps) {  // the ball's middle passes the plane at z = 1
      CAPTURE(z_m);
      const double seen = world.color_with("LAMP", "z", z_m).x, exact = by_whole_ball(z_m);
      const PointSum sum = by_points_of_ball(points, z_m);
      clear += sum.clear;
      if (sum.clear) CHECK(seen == doctest::Approx(sum.light).epsilon(kShading));
      squares += std::pow(seen - exact, 2);
    }
    CHECK(clear > 0);
    const double full = kCandela * by_candela({0, 0, 1});
    CHECK(std::sqrt(squares / steps) < full / (2 * std::sqrt(points)));
  }
}

// The share of a disc of radius 1 on the far side of a straight line at the distance d from its centre.
double disc_beyond(double d) {
  if (d >= 1) return 0;
  if (d <= -1) return 1;
  return (std::acos(d) - d * std::sqrt(1 - d * d)) / kPi;
}

TEST_CASE("the sun's light falls behind an edge as the visible segment of its disc does") {
  constexpr std::uint32_t kPoints = 32;
  World world = behind_board(
      R"(azimuth="180" shadows="yes" shadow_resolution="2048" intensity="5" angular_radius="2" lamp_points="32")");
  const double edge_deg = glm::degrees(std::atan(kEdge_m / (kAway_m - kBoard_m)));
  double squares = 0;
  int steps = 0;
  for (double off = -1.2; off < 1.21; off += 0.2, ++steps) {  // of the disc's radius
    CAPTURE(off);
    const double elevation_deg = edge_deg + off * kSunRadius_deg;
    const double seen = world.color_with("LAMP", "elevation", elevation_deg).x;
    const double full = kLux / kPi * std::cos(glm::radians(elevation_deg));
    // The disc's cosines differ from that of its middle by their slope, 0.25, times 2 degrees, evenly to both sides.
    const double exact = full * disc_beyond(off);
    if (off > 1.1) CHECK(seen == 0);
    if (off < -1.1) CHECK(std::abs(seen / full - 1) < 0.25 * glm::radians(kSunRadius_deg));
    squares += std::pow(seen - exact, 2);
  }
  CHECK(std::sqrt(squares / steps) < kLux / kPi / (2 * std::sqrt(double{kPoints})));
}

TEST_CASE("beside a long board a wall gets the share of the sky's light that the board leaves") {
  // A board of this depth stands out of the wall, 1 m to the left of what the camera sees.
  constexpr double kBeside_m = 1;
  constexpr std::uint32_t kPoints = 32;
  for (const double depth_m : {0.5, 3.0}) {
    CAPTURE(depth_m);
    GltfBuilder file;
    add_plate(file, {.left = 300, .right = -300, .bottom = -300, .top = 300},
              file.append("materials", painted("Paint", glm::vec4(1))));
    World world(
        {{"wall.gltf", file}},
        R"(<part file="wall.gltf" name="WALL" insert_at="ROOT" up="z"/>)" + kDark + kCamera +
            R"(<part shape="box" size=")" + std::to_string(depth_m) +
            R"( 0.001 500" name="BOARD" insert_at="ROOT" pose_offset=")" + std::to_string(kAway_m - depth_m / 2) +
            R"( 1 0 0 0 0"/><element type="sky_light" name="DAY" insert_at="ROOT" red="1" green="0.5" blue="0" )"
            R"(sky_points="32" shadow_resolution="512"/>)");
    const glm::dvec3 seen = world.color();
    CHECK(seen.z == 0);
    CHECK(seen.y == doctest::Approx(seen.x / 2).epsilon(kShading));
    // What the board hides: directions whose shadow of its edge lies beyond what the camera sees. Maps cover less than
    // 8 m of the wall and the board, so a texel has 16 mm; where a caster touches the wall, an edge is off by less than
    // two half diagonals, and that much longer on a slanted surface.
    constexpr double kTexels_m = std::numbers::sqrt2 * 8.0 / 512;
    double sum = 0, unclear = 0;
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      const glm::dvec3 way = even_point_of_ball(i, kPoints);
      if (way.x >= 0) continue;
      const double light = 4.0 / kPoints * -way.x, edge_m = depth_m * way.y / -way.x;
      if (std::abs(edge_m - kBeside_m) < kTexels_m / -way.x) unclear += light;
      if (edge_m < kBeside_m) sum += light;
    }
    CHECK(std::abs(seen.x - sum) <= unclear + kShading);
    // A plane of infinite length that ends at the angle a above the surface leaves (1 + cos a) / 2 of its light.
    const double exact = (1 + std::cos(std::atan(depth_m / kBeside_m))) / 2;
    CHECK(std::abs(seen.x - exact) < std::sqrt(5.0 / (3 * kPoints)));
  }
}

TEST_CASE("all points of a lamp have its colour temperature, and give it back") {
  World world = behind_board(R"(kind="point" x="1" radius="0.1" lamp_points="8")");
  const glm::dvec3 white = world.color();
  REQUIRE(white.x > 0);
  world->execute(R"(<element type="color_temperature" name="T" insert_at="ROOT" light="LAMP" kelvin="3000"/>)");
  check_color(world.color(), white * black_body_color(3000));
  CHECK(world->diagnostics().draw_list().lights.size() == 8);
  world->execute(R"(<remove name="T"/>)");
  check_color(world.color(), white);
}

TEST_CASE("a size that a light cannot have is refused, and so are more shadows than a view takes") {
  const auto refused = [](const std::string& lights) {
    return error_of([&] { build_scene(parse_commands(lights, "s.xml", "")); });
  };
  const std::string lamp = "<element type='light' name='L' insert_at='ROOT' ";
  CHECK(contains(refused(lamp + "radius='0.1'/>"), R"("radius" is allowed only for a point or spot light)"));
  CHECK(contains(refused(lamp + "kind='spot' angular_radius='1'/>"),
                 R"("angular_radius" is allowed only for a directional light)"));
  CHECK(contains(refused(lamp + "lamp_points='8'/>"),
                 R"("lamp_points" is allowed only with a radius or an angular_radius)"));
  CHECK(contains(refused(lamp + "kind='point' radius='-1'/>"), "radius"));
  CHECK(contains(refused(lamp + "angular_radius='2' lamp_points='65'/>"), "lamp_points"));
  const std::string other = "<element type='light' name='M' insert_at='ROOT' shadows='yes'/>";
  CHECK(contains(refused(other + lamp + "angular_radius='2' lamp_points='64' shadows='yes'/>"),
                 "too many lights have shadows, expected at most 64, where each of a lamp's points counts"));
  const std::string sky = "<element type='sky_light' name='S' insert_at='ROOT' ";
  CHECK(contains(refused(other + sky + "sky_points='64'/>"), "too many lights have shadows"));
  CHECK(contains(refused(sky + "sky_points='65'/>"), "16, 32, 64"));
  CHECK(contains(refused(sky + "shadows='no' shadow_resolution='64'/>"), "is allowed only with shadows"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
