// Mirrors and glass in scenes: the element material, glTF files, and scanners with and without path_depth.
#include "tests/support/element_scene.h"
#include "tests/support/scan_frame.h"

TEST_SUITE_BEGIN("effects");

namespace simvis::test {
namespace {

GltfBuilder plate(const Plate& shape, json material) {
  GltfBuilder file;
  add_plate(file, shape, file.append("materials", std::move(material)));
  return file;
}
// A plate at 2 m and a wall at 5 m behind it.
const std::string kParts = R"(<part file="plate.gltf" name="PLATE" insert_at="ROOT" up="z"/>
  <part file="wall.gltf" name="WALL" insert_at="ROOT" up="z"/>)";
std::string scanner(const std::string& attributes) {
  return R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="3" min_angle="-10" max_angle="10" )" +
         attributes + "/>";
}
std::string material(const std::string& attributes, const std::string& name = "M") {
  return "<element type='material' name='" + name + "' insert_at='ROOT' part='PLATE' " + attributes + "/>";
}

std::vector<std::pair<std::string, GltfBuilder>> files(json of_plate = painted("Plate", glm::vec4(1))) {
  return {{"plate.gltf", plate({.x = 2}, std::move(of_plate))},
          {"wall.gltf", plate({.x = 5}, painted("White", glm::vec4(1)))}};
}

TEST_CASE("shares of several elements multiply; the index is a factor; unset attributes change nothing") {
  World world(files(), kParts + material("mirror='0.5' transmission='0.25'", "A") +
                           material("mirror='0.5' refractive_index='1.2'", "B"));
  world->step();
  const auto of_plate = [&]() -> const Material& {
    return *world->diagnostics().draw_list().materials.at(world->diagnostics().draw_list().items.at(0).material);
  };
  CHECK(of_plate().mirror == 0.75f);
  CHECK(of_plate().transmission == 0.25f);
  CHECK(of_plate().refractive_index == static_cast<float>(1.5 * static_cast<double>(1.2f)));
  world->set("A", "mirror", 0);
  world->set("A", "transmission", 1);
  world->step();
  CHECK(of_plate().mirror == 0.5f);
  CHECK(of_plate().transmission == 1);
  World plain(files(), kParts), same(files(), kParts + material(""));
  plain->step();
  same->step();
  CHECK(*plain->diagnostics().draw_list().materials.at(0) == *same->diagnostics().draw_list().materials.at(0));
}

TEST_CASE("glTF: transmission and index of refraction") {
  const auto of_plate = [](const json& extensions) {
    json glass = painted("Glass", glm::vec4(1));
    glass["extensions"] = extensions;
    World world(files(glass), kParts);
    world->step();
    return *world->diagnostics().draw_list().materials.at(world->diagnostics().draw_list().items.at(0).material);
  };
  const json transmission = {{"transmissionFactor", 0.75}};
  CHECK(of_plate(json::object()).transmission == 0);
  const Material pane = of_plate({{"KHR_materials_transmission", transmission}});
  CHECK(pane.transmission == 0.75f);
  CHECK(pane.refractive_index == 1.5f);
  CHECK(of_plate({{"KHR_materials_transmission", json::object()}}).transmission == 0);
  CHECK(of_plate({{"KHR_materials_ior", {{"ior", 1.33}}}}).refractive_index == 1.33f);
  CHECK(of_plate({{"KHR_materials_ior", {{"ior", 0}}}}).refractive_index == 1e6f);
  const auto error = [&](const json& extensions) { return error_of([&] { of_plate(extensions); }); };
  CHECK(contains(error({{"KHR_materials_ior", {{"ior", 0.5}}}}),
                 "materials/0/extensions/KHR_materials_ior/ior is 0.5; expected 0, or 1 to 1e6"));
  CHECK(contains(error({{"KHR_materials_transmission", {{"transmissionFactor", 2}}}}), "transmissionFactor"));
}

TEST_CASE("path_depth costs nothing without mirrors, and mirrors cost nothing without path_depth") {
  for (const char* method : {"", "method='planar' ", "method='hybrid' ", "method='raycast' "}) {
    CAPTURE(method);
    World plain(files(), kParts + kCamera + scanner(method));
    World deep(files(), kParts + kCamera + scanner(method + std::string("path_depth='4'")));
    World named(files(), kParts + kCamera + scanner(method + std::string("path_depth='0'")));
    // An element gives its part its own material, which is uploaded, so the comparison is with an element that changes
    // nothing.
    World changeable(files(), kParts + kCamera + scanner(method) + material(""));
    World mirrored(files(), kParts + kCamera + scanner(method) + material("mirror='0.5' transmission='0.5'"));
    for (int frame = 0; frame < 3; ++frame) {
      const ScanFrame expected = frame_of(plain);
      CHECK((frame_of(deep) == expected));
      CHECK((frame_of(named) == expected));
      CHECK((frame_of(mirrored) == frame_of(changeable)));
      CHECK(mirrored->color("CAM").pixels == changeable->color("CAM").pixels);
    }
  }
}

TEST_CASE("while a plate is glass its beams pass through it, and the plan gives the reason") {
  World world(files(), kParts + material("") + scanner("path_depth='2'"));
  const ScanFrame opaque = frame_of(world);
  const auto range = [&](double share, std::size_t beam) {
    world->set("M", "transmission", share);
    world->step();
    return world->scan("SCAN").range_m[beam];
  };
  constexpr double kStored_m = 8 * 0x1p-24;  // float32 of up to 8 m
  CHECK(std::abs(range(0.95, 1) - 5) <= kStored_m);
  CHECK(std::abs(range(0.95, 0) - 5 / std::cos(10 * std::numbers::pi / 180)) <= kStored_m);
  REQUIRE(world->diagnostics().frame_plan().effects.size() == 1);
  CHECK(world->diagnostics().frame_plan().effects[0].effect == "specular_path");
  CHECK(contains(world->diagnostics().frame_plan().casts.at(0).reason, "for specular_path"));
  // The return of the pane is (1 - s) / 4, that of the wall (0.923 s)^2 / 25: they are equal at s = 0.892.
  CHECK(std::abs(range(0.88, 1) - 2) <= kStored_m);
  CHECK(std::abs(range(0.9, 1) - 5) <= kStored_m);
  world->set("M", "transmission", 0);
  CHECK(frame_of(world).range_m == opaque.range_m);
  CHECK(world->diagnostics().frame_plan().effects.empty());
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
