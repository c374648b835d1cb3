// Shapes of parts are read when something needs them, and not before: each format with each thing that needs shapes.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "scenegraph/pictures/png_bytes.h"
#include "simvis/built_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/sensor_bytes.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis {
namespace {

// Each is 1 m in front of the scanner or nearer. `file` has the shapes.
struct ShapedPart {
  std::string name, command, file;
};
const std::vector<ShapedPart> kShapedParts{
    {"OBJ", "<part file='box.obj' name='P' insert_at='ROOT' pose_offset='0 -3 -4.5 0 0 0'/>", "box.obj"},
    {"OBJ, scaled, with an opacity",
     "<part file='box.obj' name='P' insert_at='ROOT' scale='0.5' opacity='0.9' pose_offset='0 -1.5 -2 0 0 0'/>",
     "box.obj"},
    {"glTF", "<part file='wall.gltf' name='P' insert_at='ROOT' up='z'/>", "wall.bin"},
    {"glTF, with an opacity", "<part file='wall.gltf' name='P' insert_at='ROOT' up='z' opacity='0.9'/>", "wall.bin"},
    {"URDF", "<part file='robot.urdf' name='P' insert_at='ROOT' pose_offset='0 -3 -4.5 0 0 0'/>", "box.obj"},
    {"height map",
     "<part name='P' insert_at='ROOT' shape='heightmap' size='4 4' z_range='0 0.5' heights='slope.png' pose_offset='1 "
     "0 0 0 -90 0'/>",
     "slope.png"},
};

const std::string kPostponedImu = "<sensor type='imu' name='IMU' insert_at='ROOT'/>";
const std::string kPostponedScanner =
    "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='31' min_angle='-30' max_angle='30'/>";

struct PostponedStage {
  PostponedStage() {
    write_text(folder / "box.obj", test::obj_box());
    write_text(folder / "broken.obj", "v 0 0 0\nf 1 2 3\n");
    write_text(folder / "robot.urdf",
               "<robot name='r'><link name='base'><visual><geometry><mesh filename='box.obj'/></geometry></visual>"
               "</link></robot>");
    write_text(folder / "wall.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
      "nodes": [{"name": "wall", "mesh": 0, "extras": {"simvis_points": ["TOP"]}}],
      "materials": [{"name": "paint"}],
      "meshes": [{"name": "wall", "primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [1, -9, -9],
                     "max": [1, 9, 9]}],
      "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"uri": "wall.bin", "byteLength": 36}]})");
    std::string bytes;
    for (const float value : {1.f, -9.f, -9.f, 1.f, 9.f, -9.f, 1.f, 0.f, 9.f}) test::put_float(bytes, value);
    write_text(folder / "wall.bin", bytes);
    const std::vector<std::uint8_t> grey{0, 50, 100, 150};
    write_text(folder / "slope.png", png_bytes({.width = 2, .height = 2, .bits = 8, .channels = 1}, grey));
  }
  Simulation simulation(const std::string& commands, const SimulationDesc& desc = {}) const {
    return Simulation::from_string(commands, desc, folder.path(), "s.xml");
  }
  TemporaryFolder folder;
};

bool has_read(const Simulation& simulation, const std::string& name) {
  return std::ranges::any_of(simulation.diagnostics().inputs(),
                             [&](const auto& file) { return file.filename() == name; });
}

std::string shapes_needed_by(const Simulation& simulation) {
  const std::vector<PartFile> files = built_scene(simulation).scene.part_files();
  return files.empty() ? "" : files.front().needed_by;
}

// What needs shapes in a scene that has run without them.
struct ShapeUser {
  std::string name;
  std::function<void(Simulation&)> use;
};
const std::vector<ShapeUser> kShapeUsers{
    {"a sensor that is added", [](Simulation& simulation) { simulation.execute(kPostponedScanner); }},
    {"the table of items", [](Simulation& simulation) { CHECK(simulation.items().size() == 1); }},
    {"the table of objects", [](Simulation& simulation) { CHECK_FALSE(simulation.objects().empty()); }},
    {"a program that shows the scene",
     [](Simulation& simulation) {
       read_all_content(simulation);
       simulation.step();
       CHECK(simulation.diagnostics().draw_list().items.size() == 1);
     }},
    {"an element that changes materials",
     [](Simulation& simulation) {
       simulation.execute("<element type='material' name='M' insert_at='ROOT' part='P' opacity='1'/>");
     }},
    {"a static body of physics",
     [](Simulation& simulation) {
       simulation.execute(
           "<element type='physics' name='PHYSICS' insert_at='ROOT'/>"
           "<element type='body' name='B' insert_at='P' kind='static' shape='mesh'/>");
     }},
};

TEST_CASE("each format with each user of shapes: not read without the user, read for it, and with the same results") {
  const Device shared;
  const PostponedStage stage;
  int tried = 0;
  for (const ShapedPart& part : kShapedParts) {
    Simulation whole = stage.simulation(part.command + kPostponedScanner);
    CHECK(has_read(whole, part.file));
    whole.step();
    whole.step();
    REQUIRE(std::isfinite(whole.scan("SCAN").range_m[15]));
    for (const ShapeUser& user : kShapeUsers) {
      CAPTURE(part.name);
      CAPTURE(user.name);
      Simulation simulation = stage.simulation(part.command + kPostponedImu);
      simulation.step();
      CHECK_FALSE(has_read(simulation, part.file));
      CHECK(simulation.diagnostics().draw_list().items.empty());
      user.use(simulation);
      CHECK(has_read(simulation, part.file));
      if (simulation.sensors().size() == 1) simulation.execute(kPostponedScanner);
      simulation.step();
      CHECK(simulation.scan("SCAN").range_m == whole.scan("SCAN").range_m);
      CHECK(simulation.scan("SCAN").error_bound_m == whole.scan("SCAN").error_bound_m);
      ++tried;
    }
  }
  CHECK(tried == 36);
}

TEST_CASE("only sensors that are on count, and one that is switched on has what it needs") {
  const Device shared;
  const PostponedStage stage;
  SimulationDesc imu_only;
  imu_only.sensors = {"IMU"};
  for (const ShapedPart& part : kShapedParts) {
    CAPTURE(part.name);
    Simulation simulation = stage.simulation(part.command + kPostponedImu + kPostponedScanner, imu_only);
    simulation.step();
    CHECK(std::vector<std::string>(simulation.measured().begin(), simulation.measured().end()) ==
          std::vector<std::string>{"IMU"});
    CHECK_FALSE(has_read(simulation, part.file));
    simulation.enable("SCAN", true);
    CHECK(has_read(simulation, part.file));
    simulation.step();
    CHECK(std::isfinite(simulation.scan("SCAN").range_m[15]));
  }
  imu_only.sensors = {"IMO"};
  CHECK(contains(error_of([&] { stage.simulation(kPostponedImu, imu_only); }), "did you mean \"IMU\"?"));
}

TEST_CASE("what a file was read for is known") {
  const PostponedStage stage;
  const std::string& obj = kShapedParts.front().command;
  CHECK(shapes_needed_by(stage.simulation(obj + kPostponedImu + kPostponedScanner)) == "sensor \"SCAN\"");
  CHECK(shapes_needed_by(stage.simulation(obj)) == "a scene without sensors");
  Simulation later = stage.simulation(obj + kPostponedImu);
  CHECK(shapes_needed_by(later).empty());
  later.execute(kPostponedScanner);
  CHECK(shapes_needed_by(later) == "sensor \"SCAN\"");
}

TEST_CASE("points inside of a file exist without its shapes") {
  const PostponedStage stage;
  Simulation simulation = stage.simulation(
      "<part file='wall.gltf' name='P' insert_at='ROOT'/>"
      "<part file='robot.urdf' name='R' insert_at='TOP'/>"
      "<sensor type='imu' name='IMU' insert_at='base'/>");
  simulation.step();
  CHECK(simulation.measured().size() == 1);
  CHECK_FALSE(has_read(simulation, "wall.bin"));
  CHECK_FALSE(has_read(simulation, "box.obj"));
}

TEST_CASE("a missing file is an error at once, with its place") {
  const PostponedStage stage;
  CHECK(
      contains(error_of([&] { stage.simulation("\n<part file='no.obj' name='P' insert_at='ROOT'/>" + kPostponedImu); }),
               "s.xml:2:7: error: there is no part file"));
  write_text(stage.folder / "bare.gltf",
             R"({"asset": {"version": "2.0"}, "buffers": [{"uri": "no.bin", "byteLength": 36}]})");
  CHECK(contains(
      error_of([&] { stage.simulation("<part file='bare.gltf' name='P' insert_at='ROOT'/>" + kPostponedImu); }),
      "no.bin"));
  CHECK(contains(error_of([&] {
                   stage.simulation("<part name='P' insert_at='ROOT' shape='heightmap' size='4 4' heights='no.png'/>" +
                                    kPostponedImu);
                 }),
                 "there is no picture"));
  write_text(stage.folder / "lost.urdf",
             "<robot name='r'><link name='base'><visual><geometry><mesh filename='no.obj'/></geometry></visual>"
             "</link></robot>");
  CHECK(contains(
      error_of([&] { stage.simulation("<part file='lost.urdf' name='P' insert_at='ROOT'/>" + kPostponedImu); }),
      "none of its visuals can be shown"));
}

TEST_CASE(
    "a broken file is an error when its shapes are read, in a strict scene at once, and the scene stays as it was") {
  const Device shared;
  const PostponedStage stage;
  const std::string broken = "\n<part file='broken.obj' name='P' insert_at='ROOT'/>";
  const std::string place = "s.xml:2:2: error: part P: ", file = "broken.obj";
  SimulationDesc strict;
  strict.strict = true;
  for (const std::string& refused : {error_of([&] { stage.simulation(broken + kPostponedScanner); }),
                                     error_of([&] { stage.simulation(broken + kPostponedImu, strict); })}) {
    CHECK(contains(refused, place));
    CHECK(contains(refused, file));
  }
  Simulation simulation = stage.simulation(broken + kPostponedImu);
  simulation.step();
  for (int i = 0; i < 2; ++i) {
    CHECK(contains(error_of([&] { simulation.execute(kPostponedScanner); }), place));
    CHECK(contains(error_of([&] { static_cast<void>(simulation.items()); }), place));
    CHECK(simulation.sensors().size() == 1);
    simulation.step();
  }
  SimulationDesc imu_only;
  imu_only.sensors = {"IMU"};
  Simulation switched = stage.simulation(broken + kPostponedImu + kPostponedScanner, imu_only);
  CHECK(contains(error_of([&] { switched.enable("SCAN", true); }), place));
  switched.step();
  CHECK(switched.measured().size() == 1);
}

TEST_CASE("a glTF file that changes between its structure and its shapes is an error") {
  const PostponedStage stage;
  Simulation simulation = stage.simulation(kShapedParts[2].command + kPostponedImu);
  write_text(stage.folder / "wall.gltf", R"({"asset": {"version": "2.0"}})");
  CHECK(contains(error_of([&] { simulation.execute(kPostponedScanner); }), "has changed since the scene was read"));
}

TEST_CASE("copies of a part, and parts of their own, get the shapes that are read later") {
  const Device shared;
  const PostponedStage stage;
  const std::string parts =
      "<part file='wall.gltf' name='A' insert_at='ROOT' up='z'/>"
      "<part file='wall.gltf' name='B' insert_at='ROOT' up='z' pose_offset='1 0 0 0 0 0' opacity='0.2'/>"
      "<part file='box.obj' name='C' insert_at='ROOT' pose_offset='3 0 0 0 0 0'/>"
      "<part file='box.obj' name='D' insert_at='ROOT' pose_offset='6 0 0 0 0 0' opacity='0.2'/>"
      "<element type='material' name='M' insert_at='ROOT' part='A' material='paint' opacity='0.1'/>";
  Simulation whole = stage.simulation(parts + kPostponedScanner), later = stage.simulation(parts + kPostponedImu);
  later.step();
  later.execute(kPostponedScanner);
  whole.step();
  later.step();
  const DrawList &a = whole.diagnostics().draw_list(), &b = later.diagnostics().draw_list();
  REQUIRE(a.items.size() == 4);
  REQUIRE(b.items.size() == 4);
  for (std::size_t i = 0; i < a.items.size(); ++i) {
    CAPTURE(i);
    CHECK(a.materials[a.items[i].material]->opacity == b.materials[b.items[i].material]->opacity);
    CHECK(a.world_from_node[a.items[i].transform] == b.world_from_node[b.items[i].transform]);
    CHECK(a.meshes[a.items[i].mesh] == b.meshes[b.items[i].mesh]);
  }
}

TEST_CASE("a part that a failed request took out has the shapes that were read meanwhile") {
  const Device shared;
  const PostponedStage stage;
  for (const ShapedPart& part : kShapedParts) {
    CAPTURE(part.name);
    Simulation simulation = stage.simulation(part.command + kPostponedImu);
    simulation.step();
    std::string again = part.command;
    again.replace(again.find("name='P'"), 8, "name='Q'");
    const std::string request =
        "<remove name='P'/>" + again + "<part file='broken.obj' name='X' insert_at='ROOT'/>" + kPostponedScanner;
    CHECK(contains(error_of([&] { simulation.execute(request, stage.folder.path()); }), "broken.obj"));
    simulation.execute(kPostponedScanner);
    simulation.step();
    Simulation whole = stage.simulation(part.command + kPostponedScanner);
    whole.step();
    const Scan scan = simulation.scan("SCAN"), expected = whole.scan("SCAN");
    CHECK(std::ranges::equal(scan.range_m, expected.range_m));
    CHECK(std::ranges::any_of(scan.range_m, [](float range_m) { return std::isfinite(range_m); }));
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
