// The messages of a view: what a page gets when it opens, and what it gets when something changes.
#include "program/live/view_encoder.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>

#include "scenegraph/pictures/png_file.h"
#include "tests/support/made_up_scan.h"

TEST_SUITE_BEGIN("live");

namespace simvis::live {
namespace {

const std::string kScene = R"(
  <part name="BOX" insert_at="ROOT" shape="box" size="1 1 1" pose_offset="3 0 0 0 0 0"/>
  <part name="BODY" insert_at="ROOT" shape="sphere" radius="0.1"/>
  <element type="pose" name="MOVE" insert_at="BODY" x="0.5"/>
  <sensor type="laser_scanner" name="SCAN" insert_at="BODY" samples="9" min_angle="-40" max_angle="40" range_max="20"/>
  <sensor type="camera" name="CAM" insert_at="BODY" width="8" height="6" outputs="color depth"/>)";

template <typename T>
T at(const std::string& bytes, std::size_t place) {
  T value;
  REQUIRE(place + sizeof value <= bytes.size());
  std::memcpy(&value, bytes.data() + place, sizeof value);
  return value;
}

struct View {
  Simulation simulation = Simulation::from_string(kScene);
  ViewCopier copier;
  ViewFrame step(const ViewWants& wants = {.every_sensor = true}) {
    const FrameTime time = simulation.next_frame();
    simulation.step();
    return copier.copy(simulation, time, 1.5, wants);
  }
};

nlohmann::json json_of(const std::string& text) { return nlohmann::json::parse(text); }

TEST_CASE("a page that opens gets the scene, every transform, what was measured, and the frame") {
  View view;
  const ViewFrame frame = view.step();
  const std::vector<ViewMessage> messages = view_messages(nullptr, frame, {.speed = 1}, "scene.glb");
  REQUIRE(messages.size() == 10);
  const nlohmann::json scene = json_of(messages[0].bytes);
  CHECK(scene["op"] == "scene");
  CHECK(scene["structure"] == 1);
  CHECK(scene["list"]["parts"].size() == 3);
  CHECK(scene["sensors"][1]["name"] == "CAM");
  CHECK(scene["sensors"][1]["attributes"]["width"] == "8");
  CHECK(scene["parameters"][0]["element"] == "MOVE");
  CHECK(scene["parameters"][0]["unit"] == "m");
  CHECK(scene["parameters"][3]["min"].is_null());
  const std::string& transforms = messages[1].bytes;
  CHECK(messages[1].binary);
  CHECK(at<std::uint8_t>(transforms, 0) == 1);
  CHECK(at<std::uint64_t>(transforms, 16) == frame.world_from_node->size());
  CHECK(transforms.size() == 24 + frame.world_from_node->size() * 104);
  CHECK(json_of(messages[2].bytes)["op"] == "lights");
  CHECK(json_of(messages[3].bytes)["items"].empty());
  CHECK(json_of(messages[4].bytes)["op"] == "environment");
  CHECK(json_of(messages[5].bytes)["values"].size() == 6);
  const nlohmann::json last = json_of(messages.back().bytes);
  CHECK(last["op"] == "frame");
  CHECK(last["step_ms"] == 1.5);
  CHECK(last["host"] == "runs");
  CHECK(json_of(frame_message(frame, {.host = ViewTime::Host::stands}))["host"] == "stands");
}

TEST_CASE("numbers name what moves a thing") {
  View view;
  const ViewFrame frame = view.step();
  const NamedTransforms& named = frame.scene->transforms;
  const std::vector<SceneItem>& items = frame.scene->items;
  REQUIRE(items.size() == frame.scene->list.items.size());
  CHECK(items[0].part == "BOX");
  CHECK(items[1].part == "BODY");
  CHECK((*frame.world_from_node)[named.elements.at("MOVE")][3].x == 0.5);
  CHECK((*frame.world_from_node)[named.points.at("BODY")][3].x == 0.5);
  CHECK((*frame.world_from_node)[named.points.at("BOX")][3].x == 3);
  REQUIRE(named.sensors[0]);
  CHECK((*frame.world_from_node)[*named.sensors[0]][3].x == 0.5);
}

TEST_CASE("the next frame tells what has changed, and only what is looked at") {
  View view;
  const ViewFrame first = view.step();
  CHECK(view_messages(&first, view.step({}), {}, "").size() == 1);  // op frame
  view.simulation.set("MOVE", "x", 0.75);
  const ViewFrame moved = view.step({.sensors = {"SCAN"}});
  const std::vector<ViewMessage> messages = view_messages(&first, moved, {}, "");
  REQUIRE(messages.size() == 4);
  CHECK(at<std::uint64_t>(messages[0].bytes, 16) < moved.world_from_node->size());
  CHECK(json_of(messages[1].bytes)["values"] == nlohmann::json::parse("[[0, 0.75]]"));
  CHECK(at<std::uint8_t>(messages[2].bytes, 0) == 2);
  view.simulation.execute("<part name=\"NEW\" insert_at=\"ROOT\" shape=\"box\" size=\"1 1 1\"/>");
  CHECK(json_of(view_messages(&moved, view.step({}), {}, "")[0].bytes)["structure"] == 2);
}

TEST_CASE("what is hidden or shown again leaves the scene as it is") {
  View view;
  view.simulation.execute("<element type=\"visibility\" name=\"SEEN\" insert_at=\"BOX\"/>");
  const ViewFrame first = view.step({});
  CHECK(first.hidden->empty());
  view.simulation.set("SEEN", "visible", 0);
  const ViewFrame hidden = view.step({});
  const std::vector<ViewMessage> messages = view_messages(&first, hidden, {}, "");
  REQUIRE(messages.size() == 3);  // hidden, values, frame
  CHECK(json_of(messages[0].bytes) == nlohmann::json::parse(R"({"op":"hidden","items":[0]})"));
  CHECK(hidden.scene->list.items[0].visible);  // a page has it for later
  view.simulation.set("SEEN", "visible", 1);
  CHECK(json_of(view_messages(&hidden, view.step({}), {}, "")[0].bytes)["items"].empty());
}

TEST_CASE("another sky leaves the scene as it is") {
  View view;
  view.simulation.execute("<element type='sky' name='SKY' insert_at='ROOT' red='0.5'/>");
  const ViewFrame first = view.step({});
  view.simulation.set("SKY", "ambient_green", 0.25);
  view.simulation.set("SKY", "blue", 0.125);
  const ViewFrame dark = view.step({});
  const std::vector<ViewMessage> messages = view_messages(&first, dark, {}, "");
  REQUIRE(messages.size() == 3);  // environment, values, frame
  const nlohmann::json sky = json_of(messages[0].bytes);
  CHECK(sky["op"] == "environment");
  CHECK(sky["background"] == nlohmann::json({0.5f, 0.68f, 0.125f}));
  CHECK(sky["ambient"] == nlohmann::json({0.3f, 0.25f, 0.3f}));
  CHECK(view_messages(&dark, view.step({}), {}, "").size() == 1);  // op frame
}

TEST_CASE("the alpha of a colour counts where the material is not opaque") {
  View view;
  const ViewFrame first = view.step({});
  const auto alpha_of = [&](AlphaMode mode, float opacity) {
    ViewFrame changed = first;
    auto material = std::make_shared<Material>(*(*first.materials)[0]);
    material->base_color.a = 0.5f;
    material->alpha_mode = mode;
    material->opacity = opacity;
    auto all = std::make_shared<std::vector<std::shared_ptr<const Material>>>(*first.materials);
    (*all)[0] = material;
    changed.materials = all;
    return json_of(materials_message(&first, changed))["materials"][0][4].get<float>();
  };
  CHECK(alpha_of(AlphaMode::opaque, 1) == 1);
  CHECK(alpha_of(AlphaMode::opaque, 0.25f) == 0.25f);
  CHECK(alpha_of(AlphaMode::blend, 1) == 0.5f);
  CHECK(alpha_of(AlphaMode::blend, 0.25f) == 0.125f);
}

/// What a binary message says of its numbers, and where these begin.
std::pair<nlohmann::json, std::size_t> described(const std::string& message, std::size_t place) {
  const auto length = at<std::uint32_t>(message, place);
  REQUIRE(length % 8 == 0);
  return {nlohmann::json::parse(message.substr(place + 8, length)), place + 8 + length};
}

TEST_CASE("a scan has all its columns with units, and points; an image says its name, unit and type") {
  View view;
  const ViewFrame frame = view.step();
  REQUIRE(frame.scans.size() == 1);
  const std::string scan = scan_message(frame.scans[0]);
  const Scan& measured = view.simulation.scan("SCAN");
  CHECK(at<std::uint32_t>(scan, 112) == 1);
  CHECK(at<std::uint32_t>(scan, 116) == 9);
  const auto [columns, first] = described(scan, 120);
  CHECK(columns["columns"] == nlohmann::json::parse(R"([["range_m","m","f32"],["error_bound_m","m","f32"]])"));
  CHECK(columns["origins"] == false);
  REQUIRE(scan.size() == first + 9 * 5 * sizeof(float));
  CHECK(at<float>(scan, first + 4 * 4) == measured.range_m[4]);
  CHECK(at<float>(scan, first + (9 + 4) * 4) == measured.error_bound_m[4]);
  CHECK(at<float>(scan, first + (18 + 3 * 4) * 4) == static_cast<float>(measured.points()[4].x));
  REQUIRE(frame.images.size() == 2);
  const std::string color = image_message(frame.images[0]);
  const auto [of_color, png] = described(color, 16);
  CHECK(of_color["form"] == "png");
  CHECK(color.substr(png) == encode_png(view.simulation.color("CAM")));
  const std::string depth = image_message(frame.images[1]);
  const auto [of_depth, numbers] = described(depth, 16);
  CHECK(of_depth ==
        nlohmann::json::parse(R"({"name":"depth","unit":"m","form":"f32","width":8,"height":6,"channels":1})"));
  REQUIRE(depth.size() == numbers + 8 * 6 * sizeof(float));
  CHECK(at<float>(depth, numbers) == view.simulation.depth("CAM").pixels[0]);
}

TEST_CASE("beams that start beside the sensor say where") {
  constexpr std::uint32_t kBeams = 3;
  Scan scan = test::scan_of_numbers({0, 0, 0}, {0}, {1, 2, 3});
  scan.set_origins({0, 0.25, 0, 0, 0.5, 0, 0.125, 0, -0.5});
  const std::string message = scan_message({0, scan});
  const auto [columns, first] = described(message, 120);
  CHECK(columns["origins"] == true);
  const std::size_t points = first + 2 * kBeams * sizeof(float), origins = points + 3 * kBeams * sizeof(float);
  REQUIRE(message.size() == origins + 3 * kBeams * sizeof(float));
  for (std::size_t i = 0; i < 3 * kBeams; ++i) {
    CHECK(at<float>(message, origins + i * sizeof(float)) == static_cast<float>(scan.origin_m[i]));
  }
  CHECK(at<float>(message, points) == 1);
  CHECK(at<float>(message, points + 4) == 0.25f);
}

TEST_CASE("ids of a scan stay whole numbers, and the scene says whose they are and whose beams it draws") {
  Simulation simulation = Simulation::from_string(R"(
    <part name="BOX" insert_at="ROOT" shape="box" size="1 1 1" pose_offset="3 0 0 0 0 0"/>
    <element type="label" name="L" insert_at="ROOT" part="BOX" class="parcel" class_id="7"/>
    <element type="laser_beams" name="BEAMS" insert_at="ROOT" scanner="SCAN"/>
    <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="1" min_angle="0" max_angle="0" truth="instance semantic"/>)");
  const FrameTime time = simulation.next_frame();
  simulation.step();
  const ViewFrame frame = ViewCopier().copy(simulation, time, 0, {.every_sensor = true});
  const std::string scan = scan_message(frame.scans.at(0));
  const auto [columns, first] = described(scan, 120);
  const nlohmann::json& all = columns["columns"];
  int ids = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i][0] != "true_instance") continue;
    ++ids;
    CHECK(all[i][2] == "u32");
    CHECK(at<std::uint32_t>(scan, first + i * 4) == simulation.items()[0].instance);
  }
  CHECK(ids == 1);
  CHECK(simulation.items()[0].instance != 0);
  const nlohmann::json scene = json_of(scene_message(*frame.scene, ""));
  CHECK(scene["items"][0] == nlohmann::json({"BOX", simulation.items()[0].mesh, simulation.items()[0].instance, 7,
                                             "parcel", simulation.items()[0].shape}));
  CHECK(scene["objects"][0] == nlohmann::json({"BOX", "BOX", "part", simulation.items()[0].instance, 0, 7, "parcel"}));
  CHECK(scene["sensors"][0]["beams"] == true);
  simulation.execute("<remove name='BEAMS'/>");
  simulation.step();
  const ViewFrame later = ViewCopier().copy(simulation, time, 0, {});
  CHECK(json_of(scene_message(*later.scene, ""))["sensors"][0]["beams"] == false);
}

TEST_CASE("physics is copied where it is wanted: bodies once, places and contacts each frame") {
  Simulation simulation = Simulation::from_string(R"(
    <element type="physics" name="PHYSICS" insert_at="ROOT"/>
    <part name="FLOOR" insert_at="ROOT" shape="box" size="9 9 1" pose_offset="0 0 -0.5 0 0 0"/>
    <element type="body" name="F" insert_at="FLOOR" kind="static" shape="box"/>
    <part name="BALL" insert_at="ROOT" shape="sphere" radius="0.1" pose_offset="1 0 0.1 0 0 0"/>
    <element type="body" name="B" insert_at="BALL" shape="sphere" mass="2"/>)");
  ViewCopier copier;
  const auto step = [&](const ViewWants& wants) {
    const FrameTime time = simulation.next_frame();
    simulation.step();
    return copier.copy(simulation, time, 0, wants);
  };
  const ViewFrame unwanted = step({});
  CHECK_FALSE(unwanted.physics);
  CHECK(physics_message(unwanted).empty());
  const ViewFrame first = step({.physics = true}), second = step({.physics = true});
  const std::vector<ViewMessage> opening = view_messages(nullptr, second, {}, "");
  CHECK(json_of(opening[1].bytes)["op"] == "bodies");
  const nlohmann::json bodies = json_of(bodies_message(*first.scene))["bodies"];
  REQUIRE(bodies.size() == 2);
  CHECK(bodies[0]["kind"] == "static");
  CHECK(bodies[1]["name"] == "BALL");
  CHECK(bodies[1]["mass_kg"] == 2);
  CHECK(bodies[1]["shapes"][0]["kind"] == "sphere");
  const std::vector<ViewMessage> next = view_messages(&first, second, {}, "");
  REQUIRE(std::ranges::count_if(next, [](const ViewMessage& each) { return each.binary && each.bytes[0] == 4; }) == 1);
  const std::string physics = physics_message(second);
  CHECK(at<std::uint32_t>(physics, 4) == 2);
  const auto contacts = at<std::uint64_t>(physics, 16);
  CHECK(contacts == second.physics->contacts.size());
  REQUIRE(contacts > 0);
  REQUIRE(physics.size() == 24 + 2 * 96 + contacts * 72);
  CHECK(at<double>(physics, 24 + 96 + 3 * 8) == second.physics->world_from_body[1][3].x);
  const std::size_t contact = 24 + 2 * 96;
  CHECK(at<double>(physics, contact + 7 * 8) == second.physics->contacts[0].contact.force_n);
  CHECK(at<std::uint32_t>(physics, contact + 64) + at<std::uint32_t>(physics, contact + 68) == 1);
}

TEST_CASE("the last measurement of a sensor that no page showed is there for pages that show it later") {
  View view;
  const ViewFrame first = view.step({});
  CHECK(first.images.empty());
  view.simulation.enable("CAM", false);
  CHECK(view.step({.sensors = {"SCAN"}}).images.empty());
  const ViewFrame later = view.step();
  REQUIRE(later.images.size() == 2);
  CHECK(later.images[0].time_ns == first.time_ns);
  CHECK(view.step().images.empty());
}

TEST_CASE("a picture is the sensor's own memory, and the sensor goes on in other memory while the frame lives") {
  View view;
  const ViewFrame frame = view.step();
  REQUIRE(frame.images.size() == 2);
  const auto memory = [](const MeasuredArray& array) { return std::get<SharedArray<float>>(array.numbers).data(); };
  CHECK(memory(frame.images[0].array) == view.simulation.color("CAM").pixels.data());
  CHECK(memory(frame.images[1].array) == view.simulation.depth("CAM").pixels.data());
  const std::string message = image_message(frame.images[1]);
  view.simulation.step();
  CHECK(memory(frame.images[1].array) != view.simulation.depth("CAM").pixels.data());
  CHECK(image_message(frame.images[1]) == message);
}

}  // namespace
}  // namespace simvis::live
