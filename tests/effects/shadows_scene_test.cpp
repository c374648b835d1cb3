// The attribute shadows of the element light in whole scenes: errors, and its cost where no shadow is visible.
#include <doctest/doctest.h>

#include "program/report/explain.h"
#include "simvis/scene_builder.h"
#include "tests/support/element_scene.h"

TEST_SUITE_BEGIN("effects");

namespace simvis::test {
namespace {

// A wall at x = 4 with a plate in front of it, and these sensors.
World shaded_wall(const std::string& light, const std::string& sensors) {
  GltfBuilder file;
  const int paint = file.append("materials", painted("Paint", glm::vec4(1)));
  add_plate(file, {}, paint);
  add_plate(file, {.x = 2, .left = 0.5, .right = -0.5, .bottom = -0.5, .top = 0.5}, paint);
  return World({{"wall.gltf", file}}, R"(<part file="wall.gltf" name="WALL" insert_at="ROOT" up="z"/>)" + kDark +
                                          R"(<element type="light" name="LAMP" insert_at="ROOT" kind="point" )" +
                                          light + "/>" + sensors);
}

const std::string kShadowScanner =
    R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="31" min_angle="-40" max_angle="40"
          method="planar"/>)";
const std::string kDepthCamera =
    R"(<sensor type="camera" name="CAM" insert_at="ROOT" width="9" height="9" hfov="60" outputs="depth"/>)";

TEST_CASE("a plate shades the wall behind it") {
  // Seen from (0, 3, 0), the plate (y from -0.5 to 0.5 m, half way to the wall) shades y from -4 to -2 m there.
  World world = shaded_wall(R"(y="3" intensity="50" shadows="yes" shadow_resolution="256")", kCamera);
  World bright = shaded_wall(R"(y="3" intensity="50")", kCamera);
  // At 4 m the pixels of the middle row are 4 * tan(30 deg) * 2 / 9 = 0.513 m apart; pixel 8 is at y = -2.05 m.
  CHECK(world.color(8, 4) == glm::dvec3(0));
  CHECK(bright.color(8, 4).r > 0);
  for (const int x : {0, 4, 7}) CHECK(world.color(x, 4) == bright.color(x, 4));
  CHECK(contains(explain(world->diagnostics().frame_plan(), {.counters = world->diagnostics().counters()}),
                 "pass shadow maps: 768 x 512, shadow maps"));
}

TEST_CASE("no round shape shades itself, whichever of its meshes the picture and the shadow map show") {
  // From 30 m the picture shows meshes of fewer sides than the shadow map of a lamp 3 m away.
  for (const char* const shape :
       {R"(shape="sphere" radius="0.5")", R"(shape="capsule" radius="0.4" length="0.5")",
        R"(shape="cylinder" radius="0.5" length="1")", R"(shape="cone" radius="0.5" length="1")"}) {
    CAPTURE(std::string(shape));
    const auto scene = [&](const std::string& lamp) {
      return World(
          {}, kDark + R"(<part )" + shape + R"( name="THING" insert_at="ROOT" pose_offset="30 0 0 20 30 0"/>
        <element type="light" name="LAMP" insert_at="ROOT" kind="point" x="28" y="1" z="2" intensity="50" )" +
                  lamp + R"(/><sensor type="camera" name="CAM" insert_at="ROOT" width="640" height="640" hfov="20"/>)");
    };
    World shaded = scene(R"(shadows="yes" shadow_resolution="2048")"), bright = scene("");
    shaded->step();
    bright->step();
    const Image& with = shaded->color("CAM");
    const Image& without = bright->color("CAM");
    const float brightest = *std::ranges::max_element(without.pixels);
    std::size_t lit = 0, differing = 0;
    for (std::size_t i = 0; i < with.pixels.size(); ++i) {
      // Where light grazes, single triangles face away from it.
      if (without.pixels[i] < 0.25F * brightest) continue;
      ++lit;
      differing += with.pixels[i] != without.pixels[i] ? 1 : 0;
    }
    CHECK(lit > 1000);
    CHECK(differing == 0);
  }
}

TEST_CASE("shadows cost nothing and change nothing where only depth and ranges are measured") {
  const std::string lamp = R"(y="3" intensity="50")";
  World with = shaded_wall(lamp + R"( shadows="yes")", kShadowScanner + kDepthCamera);
  World without = shaded_wall(lamp, kShadowScanner + kDepthCamera);
  for (int frame = 0; frame < 2; ++frame) {
    with->step();
    without->step();
    CHECK(with->diagnostics().counters() == without->diagnostics().counters());
    CHECK(with->diagnostics().frame_plan().passes.size() == without->diagnostics().frame_plan().passes.size());
    CHECK(with->scan("SCAN").range_m == without->scan("SCAN").range_m);
    CHECK(with->depth("CAM").pixels == without->depth("CAM").pixels);
  }
}

TEST_CASE("shadows=\"no\" equals no attribute") {
  World off = shaded_wall(R"(y="3" intensity="50" shadows="no")", kCamera);
  World unsaid = shaded_wall(R"(y="3" intensity="50")", kCamera);
  off->step();
  unsaid->step();
  CHECK(off->diagnostics().counters() == unsaid->diagnostics().counters());
  CHECK(off->color("CAM").pixels == unsaid->color("CAM").pixels);
  CHECK(content_hash(off->diagnostics().draw_list()) == content_hash(unsaid->diagnostics().draw_list()));
}

TEST_CASE("mistakes are refused with their place") {
  const auto build = [](const std::string& commands) { build_scene(parse_commands(commands, "s.xml", "")); };
  const std::string lamp = "<element type='light' insert_at='ROOT' ";
  CHECK(error_of([&] { build(lamp + "name='L' shadow_resolution='64'/>"); }) ==
        "s.xml:1:49: error: attribute \"shadow_resolution\" is allowed only with shadows");
  CHECK(contains(error_of([&] { build(lamp + "name='L' shadows='yes' shadow_resolution='8'/>"); }), "16"));
  CHECK(contains(error_of([&] { build(lamp + "name='L' shadows='maybe'/>"); }), "no, yes"));
  std::string many;
  for (int i = 0; i < 65; ++i) many += lamp + "name='L" + std::to_string(i) + "' shadows='yes'/>\n";
  CHECK(error_of([&] { build(many); }) ==
        "s.xml:65:51: error: attribute \"shadows\": too many lights have shadows, expected at most 64, where each of a "
        "lamp's points counts");
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
