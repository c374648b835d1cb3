// The elements light and color_temperature: what a camera sees of a wall, compared with photometry computed here.
#include <algorithm>

#include <simvis/pose.h>
#include "elements/color_temperature.h"
#include "scenegraph/clone_graph.h"
#include "simvis/scene_builder.h"
#include "tests/support/element_scene.h"
#include "tests/support/reference_directions.h"

TEST_SUITE_BEGIN("elements");

namespace simvis::test {
namespace {

constexpr double kWall_m = 4;
const glm::dvec3 kAlbedo(0.8, 0.4, 0.2);

// The wall at x = 4 m without ambient light, a camera that looks at (4, 0, 0), and a light.
World lit_wall(const std::string& light, const std::string& before = "") {
  GltfBuilder file;
  add_plate(file, {}, file.append("materials", painted("Paint", glm::vec4(kAlbedo, 1))));
  return World({{"wall.gltf", file}}, R"(<part file="wall.gltf" name="WALL" insert_at="ROOT" up="z"/>)" + kDark +
                                          kCamera + before + R"(<element type="light" name="LAMP" insert_at="ROOT" )" +
                                          light + "/>");
}

double radians(double deg) { return deg * kPi / 180; }

TEST_CASE("a directional light comes from its azimuth and elevation and lights by Lambert's law") {
  World world = lit_wall(R"(azimuth="180" elevation="0" intensity="3")");
  // The light comes from behind the camera, which the wall faces.
  check_color(world.color(), kAlbedo / kPi * 3.0);
  check_color(world.color_with("LAMP", "intensity", 5), kAlbedo / kPi * 5.0);
  check_color(world.color_with("LAMP", "elevation", 35), kAlbedo / kPi * 5.0 * std::cos(radians(35)));
  const double cosine = std::cos(radians(35)) * std::cos(radians(20));
  check_color(world.color_with("LAMP", "azimuth", 160), kAlbedo / kPi * 5.0 * cosine);
  check_color(world.color_with("LAMP", "red", 0.5), kAlbedo / kPi * 5.0 * cosine * glm::dvec3(0.5, 1, 1));
  check_color(world.color_with("LAMP", "green", 2), kAlbedo / kPi * 5.0 * cosine * glm::dvec3(0.5, 2, 1));
  check_color(world.color_with("LAMP", "blue", 0.25), kAlbedo / kPi * 5.0 * cosine * glm::dvec3(0.5, 2, 0.25));
  CHECK(world.color_with("LAMP", "azimuth", 0) == glm::dvec3(0));  // from beyond the wall
  CHECK(world->diagnostics().draw_list().lights.size() == 1);      // the built-in light is out
}

TEST_CASE("a sun in the zenith lights the floor, not the wall") {
  World world = lit_wall(R"(elevation="90")");
  // The sine of 90 degrees is 1 to the bit, and its cosine is 0.
  CHECK(world.color() == glm::dvec3(0));
  const LightItem& item = world->diagnostics().draw_list().lights.at(0);
  CHECK(glm::dmat3(world->diagnostics().draw_list().world_from_node[item.transform]) * item.light.direction ==
        glm::dvec3(0, 0, -1));
}

// Radiance of the wall's point (4, 0, 0) from a light of 1 candela at `place`, KHR_lights_punctual.
glm::dvec3 by_lamp(const glm::dvec3& place, double range_m = 0) {
  const glm::dvec3 to_light = place - glm::dvec3(kWall_m, 0, 0);
  const double d = glm::length(to_light);
  const double window = range_m > 0 ? std::max(0.0, 1 - std::pow(d / range_m, 4)) : 1;
  return kAlbedo / kPi * window * (-to_light.x / d) / (d * d);
}

TEST_CASE("a point light falls off with the square of its distance, up to its range") {
  World world = lit_wall(R"(kind="point" intensity="7" x="1")");
  check_color(world.color(), 7.0 * by_lamp({1, 0, 0}));
  check_color(world.color_with("LAMP", "x", 2), 7.0 * by_lamp({2, 0, 0}));
  check_color(world.color_with("LAMP", "y", -1), 7.0 * by_lamp({2, -1, 0}));
  check_color(world.color_with("LAMP", "z", 0.5), 7.0 * by_lamp({2, -1, 0.5}));
  check_color(world.color_with("LAMP", "intensity", 20), 20.0 * by_lamp({2, -1, 0.5}));
  // At 2.29 m of 3 m the window is 0.66, and its rounding counts by the fourth power.
  check_color(world.color_with("LAMP", "range", 3), 20.0 * by_lamp({2, -1, 0.5}, 3), 4 * kShading);
  CHECK(world.color_with("LAMP", "range", 2) == glm::dvec3(0));
  world->set("LAMP", "range", 0);
  check_color(world.color_with("LAMP", "green", 0.5), 20.0 * by_lamp({2, -1, 0.5}) * glm::dvec3(1, 0.5, 1));
}

TEST_CASE("a spot light shines along +x, is aimed by yaw and pitch, and fades between its cones") {
  World world = lit_wall(R"(kind="spot" x="1" intensity="9" inner_cone="10" outer_cone="30")");
  const glm::dvec3 full = 9.0 * by_lamp({1, 0, 0});
  // After a rotation by an angle, the wall's point is that far from the axis. The ramp is a difference of cosines of
  // 0.12: rounding counts eight times, and twice that for the square.
  const auto ramp = [&](double away_deg, double inner_deg, double outer_deg) {
    const double outer = std::cos(radians(outer_deg));
    const double t = (std::cos(radians(away_deg)) - outer) / (std::cos(radians(inner_deg)) - outer);
    return std::pow(std::clamp(t, 0.0, 1.0), 2);
  };
  constexpr double kRamp = 16 * kShading;
  check_color(world.color(), full);
  check_color(world.color_with("LAMP", "yaw", 9), full);
  check_color(world.color_with("LAMP", "yaw", 20), full * ramp(20, 10, 30), kRamp);
  CHECK(world.color_with("LAMP", "yaw", -31) == glm::dvec3(0));
  world->set("LAMP", "yaw", 0);
  check_color(world.color_with("LAMP", "pitch", 25), full * ramp(25, 10, 30), kRamp);
  check_color(world.color_with("LAMP", "outer_cone", 40), full * ramp(25, 10, 40), kRamp);
  check_color(world.color_with("LAMP", "inner_cone", 20), full * ramp(25, 20, 40), kRamp);
  // An inner cone as wide as the outer one gives a sharp edge at the outer one.
  check_color(world.color_with("LAMP", "inner_cone", 60), full);
  CHECK(world.color_with("LAMP", "pitch", 41) == glm::dvec3(0));
  check_color(world.color_with("LAMP", "pitch", 39), full);
}

TEST_CASE("spots rotate like poses, and a pose in front of a light moves it") {
  World world = lit_wall(R"(kind="spot" outer_cone="20" x="1" yaw="30" pitch="-10")");
  world->step();
  const LightItem& item = world->diagnostics().draw_list().lights.at(0);
  const glm::dmat4 frame = matrix_from_degrees({1, 0, 0}, 0, -10, 30);
  CHECK(world->diagnostics().draw_list().world_from_node[item.transform] == frame);
  CHECK(item.light.direction == glm::dvec3(1, 0, 0));

  World carried = lit_wall(R"(kind="point")", R"(<element type="pose" name="AT" insert_at="ROOT" x="2.5"/>)");
  check_color(carried.color(), by_lamp({2.5, 0, 0}));
  check_color(carried.color_with("AT", "y", 1), by_lamp({2.5, 1, 0}));
}

BuiltScene build_lights(const std::string& commands) { return build_scene(parse_commands(commands, "s.xml", "")); }
const std::string kLamp = "<element type='light' name='L' insert_at='ROOT' ";

TEST_CASE("each kind of light has its own attributes and refuses the others") {
  CHECK(error_of([] { build_lights(kLamp + "kind='point' yaw='3'/>"); }) ==
        "s.xml:1:62: error: attribute \"yaw\" is allowed only for a spot light");
  CHECK(contains(error_of([] { build_lights(kLamp + "range='3'/>"); }),
                 "\"range\" is allowed only for a point or spot light"));
  CHECK(contains(error_of([] { build_lights(kLamp + "kind='spot' azimuth='3'/>"); }),
                 "\"azimuth\" is allowed only for a directional light"));
  BuiltScene sun = build_lights(kLamp + "/>"), lamp = build_lights(kLamp + "kind='spot'/>");
  CHECK(sun.parameters.elements()[0].parameters.size() == 6);
  CHECK(lamp.parameters.elements()[0].parameters.size() == 12);
  CHECK(sun.parameters.spec(sun.parameters.index("L", "intensity")).unit == "lux");
  CHECK(lamp.parameters.spec(lamp.parameters.index("L", "intensity")).unit == "cd");
  CHECK(contains(error_of([&] { sun.parameters.index("L", "yaw"); }), "yaw"));
}

// Chromaticity of a linear sRGB colour: the inverse of the matrix in the code, as IEC 61966-2-1 gives it.
glm::dvec2 chromaticity(const glm::dvec3& rgb) {
  const double x = 0.4124 * rgb.r + 0.3576 * rgb.g + 0.1805 * rgb.b;
  const double y = 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b;
  const double z = 0.0193 * rgb.r + 0.1192 * rgb.g + 0.9505 * rgb.b;
  return {x / (x + y + z), y / (x + y + z)};
}

TEST_CASE("a black body has the chromaticity in tables") {
  struct Known {
    double temperature_k;
    glm::dvec2 xy;
  };
  // CIE illuminant A (CIE 15), and the Planckian locus of the CIE 1931 observer.
  const Known known[] = {{2856, {0.4476, 0.4074}}, {6500, {0.3135, 0.3237}}, {10000, {0.2807, 0.2883}}};
  // The smallest major semi-axis of MacAdam's ellipses near these whites (at x = 0.305, y = 0.323): differences below
  // it are not visible. The fit of the colour matching functions need not be better.
  constexpr double kJustNoticeable_xy = 0.0023;
  for (const Known& each : known) {
    CAPTURE(each.temperature_k);
    const glm::dvec2 seen = chromaticity(black_body_color(each.temperature_k));
    CHECK(glm::length(seen - each.xy) <= kJustNoticeable_xy);
  }
}

TEST_CASE("the colour of a black body has luminance 1; parts outside sRGB are clipped; 6500 K is nearly white") {
  // The matrices of the code and the test have four and seven digits: 1e-4 each.
  constexpr double kDigits = 2e-4;
  for (const double temperature_k : {2000.0, 2856.0, 6500.0, 12000.0, 40000.0}) {
    const glm::dvec3 rgb = black_body_color(temperature_k);
    CHECK(std::abs(0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b - 1) <= kDigits);
  }
  const glm::dvec3 red = black_body_color(1000);
  CHECK(red.b == 0);
  CHECK(red.r > red.g);
  CHECK(red.g > 0);
  // The Planckian locus passes D65, x = 0.3127 y = 0.3290, at a distance of 0.0054 in (x, y). The steepest channel
  // there is red, 3.24 X - 1.54 - 0.50 Z with X = x / y, Z = (1 - x - y) / y: its gradient is (11.4, -6.2), of
  // length 13.
  constexpr double kFromWhite = 0.0054 * 13 + kDigits;
  for (int c = 0; c < 3; ++c) CHECK(std::abs(black_body_color(6500)[c] - 1) <= kFromWhite);
}

TEST_CASE("a lamp multiplies its own colour with that of its temperature") {
  World world = lit_wall(R"(azimuth="180" elevation="0" red="0.5")");
  const glm::dvec3 white = kAlbedo / kPi * glm::dvec3(0.5, 1, 1);
  check_color(world.color(), white);
  world->execute(R"(<element type="color_temperature" name="T" insert_at="ROOT" light="LAMP" kelvin="2856"/>)");
  check_color(world.color(), white * black_body_color(2856));
  check_color(world.color_with("T", "kelvin", 9000), white * black_body_color(9000));
  check_color(world.color_with("LAMP", "red", 1), kAlbedo / kPi * black_body_color(9000));
}

TEST_CASE("mistakes in a colour temperature leave the light as it is") {
  const std::string pose = "<element type='pose' name='P' insert_at='ROOT'/>";
  const auto coloured = [](const std::string& name, const std::string& light) {
    return "<element type='color_temperature' name='" + name + "' insert_at='ROOT' light='" + light + "'/>";
  };
  CHECK(contains(error_of([&] { build_lights(kLamp + "/>" + coloured("T", "M")); }), "there is no element \"M\""));
  CHECK(contains(error_of([&] { build_lights(pose + coloured("T", "P")); }), "the element \"P\" is not a light"));
  CHECK(contains(error_of([&] { build_lights(kLamp + "/>" + coloured("T", "L") + coloured("U", "L")); }),
                 "\"L\" already has a colour temperature"));
  CHECK(contains(error_of([&] { build_lights("<element type='color_temperature' name='T' insert_at='ROOT'/>"); }),
                 "light"));
  BuiltScene built;
  SceneBuilder builder(built, {});
  builder.execute(parse_commands(kLamp + "/>", "s.xml", ""));
  const std::vector<Command> wrong = parse_commands(coloured("T", "L") + coloured("T", "L"), "s.xml", "");
  CHECK_THROWS_AS(builder.execute(wrong), InputError);
  for (const NodePtr& node : nodes_of(built.scene.root())) {
    if (node->kind() == NodeKind::light) CHECK(static_cast<const LightNode&>(*node).tint() == glm::vec3(1));
  }
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
