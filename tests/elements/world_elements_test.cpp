// The elements visibility, scale and sky: what sensors see after each of their parameters is set.
#include <algorithm>

#include "tests/support/element_scene.h"

TEST_SUITE_BEGIN("elements");

namespace simvis::test {
namespace {

const glm::dvec3 kPaint(0.8, 0.4, 0.2);
// Depth is float32 throughout, in about 16 operations.
constexpr double kDepth = 16 * 0x1p-24;

GltfBuilder plate(const Plate& shape, const json& material) {
  GltfBuilder file;
  add_plate(file, shape, file.append("materials", material));
  return file;
}
const std::string kPlate = R"(<part file="plate.gltf" name="PLATE" insert_at="ROOT" up="z"/>)";
const std::string kScanner =
    R"(<sensor type="laser_scanner" name="SCAN" insert_at="PLATE" samples="1" min_angle="0" method="planar"/>)";

TEST_CASE("visibility hides following shapes and lights; sensors continue to measure") {
  World world({{"plate.gltf", plate({}, painted("Paint", glm::vec4(kPaint, 1)))},
               {"wall.gltf", plate({.x = 6}, painted("White", glm::vec4(1)))}},
              kPlate + R"(<part file="wall.gltf" name="WALL" insert_at="ROOT" up="z"/>
                <element type="visibility" name="SHOW" insert_at="PLATE"/>
                <element type="light" name="SUN" insert_at="PLATE" azimuth="180" elevation="0" intensity="2"/>)" +
                  kDark + kScanner + kCamera);
  check_color(world.color(), kPaint / std::numbers::pi * 2.0);
  CHECK(std::abs(world->scan("SCAN").range_m[0] - 4) <= world->scan("SCAN").error_bound_m[0]);
  // The plate is hidden, and so is the light on the wall behind it: the built-in light does not replace it.
  CHECK(world.color_with("SHOW", "visible", 0) == glm::dvec3(0));
  CHECK(std::abs(world->scan("SCAN").range_m[0] - 6) <= world->scan("SCAN").error_bound_m[0]);
  const auto seen = [&] { return std::ranges::count_if(world->diagnostics().draw_list().items, &DrawItem::visible); };
  CHECK(seen() == 1);
  CHECK(world->diagnostics().draw_list().lights.empty());
  check_color(world.color_with("SHOW", "visible", 0.5), kPaint / std::numbers::pi * 2.0);
  CHECK(world.color_with("SHOW", "visible", 0.49) == glm::dvec3(0));
}

// Number of pixels in the middle row or column that see the plate.
int seen_across(World& world, bool column) {
  world->step();
  const Image& depth = world->depth("CAM");
  int count = 0;
  for (std::uint32_t i = 0; i < depth.width; ++i) {
    const std::uint32_t middle = depth.width / 2, x = column ? middle : i, y = column ? i : middle;
    count += std::isfinite(depth.pixels[y * depth.width + x]);
  }
  return count;
}

TEST_CASE("scale stretches following parts along each axis") {
  World world({{"plate.gltf", plate({.left = 1, .right = -1, .bottom = -1, .top = 1}, unlit("Paint", glm::vec4(1)))}},
              kPlate + R"(<element type="scale" name="S" insert_at="PLATE"/>
                <sensor type="camera" name="CAM" insert_at="ROOT" width="101" height="101" hfov="90" outputs="depth"/>)");
  const auto depth = [&] { return world->depth("CAM").pixels[101 * 101 / 2]; };
  // Half an edge h at z m spans 50.5 h / z pixels from the centre of the middle pixel: 2 floor(50.5 h / z) + 1 centres.
  const auto expected = [](double h, double z) { return 2 * static_cast<int>(50.5 * h / z) + 1; };
  CHECK(seen_across(world, false) == expected(1, 4));
  CHECK(depth() == doctest::Approx(4).epsilon(kDepth).scale(0));
  world->set("S", "y", 2.5);
  CHECK(seen_across(world, false) == expected(2.5, 4));
  CHECK(seen_across(world, true) == expected(1, 4));
  world->set("S", "z", 0.25);
  CHECK(seen_across(world, true) == expected(0.25, 4));
  world->set("S", "x", 0.75);
  CHECK(seen_across(world, false) == expected(2.5, 3));
  CHECK(depth() == doctest::Approx(3).epsilon(kDepth).scale(0));
  CHECK(contains(error_of([&] { world->set("S", "x", 0); }), "S.x: 0 is not allowed, expected a number from"));
  CHECK(contains(error_of([&] { world->set("S", "x", -1); }), "S.x: -1 is not allowed, expected a number from"));
}

TEST_CASE("the sky is background and ambient light") {
  // The plate covers the left half of the picture. The light is off, so only the sky lights.
  World world({{"plate.gltf", plate({.right = 0}, painted("Paint", glm::vec4(kPaint, 1)))}},
              kPlate + kCamera + R"(<element type="light" name="OFF" insert_at="ROOT" intensity="0"/>)");
  const auto background = [&] { return world.color(kSide_px - 1); };
  const auto plate = [&] { return world.color(0); };
  const glm::dvec3 unset = background(), unset_plate = plate();
  world->execute(R"(<element type="sky" name="SKY" insert_at="ROOT"/>)");
  CHECK(background() == unset);
  CHECK(plate() == unset_plate);
  glm::dvec3 sky = unset, ambient(0.3);
  constexpr std::string_view kNames[3] = {"red", "green", "blue"};
  for (int c = 0; c < 3; ++c) {
    sky[c] = 0.1 + 2 * c;
    ambient[c] = 0.7 + c;
    world->set("SKY", kNames[c], sky[c]);
    world->set("SKY", "ambient_" + std::string(kNames[c]), ambient[c]);
    check_color(background(), sky);
    check_color(plate(), kPaint * ambient);
  }
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
