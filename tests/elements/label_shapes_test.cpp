// Labels by the names that files give to shapes: geoms, visuals, nodes, meshes, groups.
#include <doctest/doctest.h>

#include <cstdint>
#include <limits>
#include <map>
#include <string>

#include "tests/support/labelled_file.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/parts/inventor_fixture.h"
#include "tests/support/urdf_scene.h"

TEST_SUITE_BEGIN("elements");

namespace simvis::test {
namespace {

// Two knobs and a door in each file, where the format has names for them.
const std::string kThree =
    file_label("knob", "part='M' shapes='knob_*'", 4) + file_label("door", "part='M' shapes='door'", 5);
const ClassCounts kThreeClasses = {{"", 1}, {"knob", 2}, {"door", 1}};

std::string mjcf_box(const std::string& name) {
  return "<geom" + (name.empty() ? "" : " name='" + name + "'") + " type='box' size='1 1 1'/>";
}

TEST_CASE("geoms of MJCF are labelled by their names, and by those of their meshes") {
  const std::string stove = "<body name='stove'>" + mjcf_box("knob_left") + mjcf_box("knob_right") + mjcf_box("door") +
                            mjcf_box("") + "</body>";
  CHECK(classes_in("m.xml", "<mujoco><worldbody>" + stove + "</worldbody></mujoco>", kThree) == kThreeClasses);
  const std::string mesh = "<asset><mesh name='knob_mesh' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/></asset>";
  CHECK(classes_in("m.xml",
                   "<mujoco>" + mesh + "<worldbody><geom type='mesh' mesh='knob_mesh'/>" + mjcf_box("") +
                       "</worldbody></mujoco>",
                   kThree.substr(0, kThree.find("<element", 1))) == ClassCounts{{"", 1}, {"knob", 1}});
}

TEST_CASE("visuals of URDF are labelled by their names, and those without one by their link") {
  const auto visual = [](const std::string& name) {
    return "<visual" + (name.empty() ? "" : " name='" + name + "'") +
           "><geometry><box size='1 1 1'/></geometry></visual>";
  };
  const std::string content = robot(link_xml("stove", visual("knob_1") + visual("knob_2") + visual("")) +
                                    link_xml("door", visual("")) + joint_xml("j", "fixed", "stove", "door"));
  CHECK(classes_in("r.urdf", content, kThree) == kThreeClasses);
}

TEST_CASE("visuals of SDF are labelled by their names") {
  const auto visual = [](const std::string& name) {
    return "<visual name='" + name + "'><geometry><box><size>1 1 1</size></box></geometry></visual>";
  };
  CHECK(classes_in("m.sdf",
                   "<sdf version='1.9'><model name='stove'><link name='l'>" + visual("knob_1") + visual("knob_2") +
                       visual("door") + visual("body") + "</link></model></sdf>",
                   kThree) == kThreeClasses);
}

TEST_CASE("nodes and meshes of glTF are labelled by their names") {
  GltfBuilder file;
  file.append("materials", painted("Steel", {1, 0, 0, 1}));
  for (int i = 0; i < 4; ++i) add_plate(file, {.x = 4.0f + static_cast<float>(i)}, 0);
  file.root["nodes"][0]["name"] = "knob_a";
  file.root["meshes"][1]["name"] = "knob_b";
  file.root["nodes"][2]["name"] = "door";
  CHECK(classes_in("t.gltf", file.text(), kThree) == kThreeClasses);
}

TEST_CASE("groups and objects of OBJ, nodes of COLLADA and of VRML are labelled by their names") {
  std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 1\n";
  obj += "o knob_1\nf 1 2 3\no stove\nf 1 2 4\ng knob_2\nf 1 3 4\ng door\nf 2 3 4\n";
  CHECK(classes_in("t.obj", obj, kThree) == kThreeClasses);
  std::string dae = dae_box(kMetresZUp);
  const std::string id = R"(<node id="n")";
  REQUIRE(dae.find(id) != std::string::npos);
  dae.replace(dae.find(id), id.size(), R"(<node id="door")");
  CHECK(classes_in("t.dae", dae, file_label("door", "part='M' shapes='d?or'", 5)) == ClassCounts{{"door", 1}});
  if (!has_coin()) return;
  std::string vrml = kVrml97Header;
  for (const char* const name : {"DEF knob_1", "DEF knob_2", "DEF door", ""}) {
    vrml += std::string(name) + " Shape { geometry Box { } }\n";
  }
  CHECK(classes_in("t.wrl", vrml, kThree) == kThreeClasses);
}

TEST_CASE("the nearest name of a shape takes precedence, then a material, then the part") {
  GltfBuilder file;
  for (const char* const name : {"Wood", "Steel"}) file.append("materials", painted(name, {1, 0, 0, 1}));
  for (int i = 0; i < 4; ++i) add_plate(file, {.x = 4.0f + static_cast<float>(i)}, i % 2);
  json& nodes = file.root["nodes"];
  nodes.push_back({{"name", "table"}, {"children", {0, 1}}});
  nodes[0]["name"] = "leg";
  file.root["scenes"][0]["nodes"] = {2, 3, 4};
  const auto label = [](const std::string& name, const std::string& attributes, int id) {
    return file_label(name, "part='M' " + attributes, id);
  };
  const std::string table = label("table", "shapes='table'", 2), leg = label("leg", "shapes='leg'", 3),
                    steel = label("steel", "material='Steel'", 4), all = label("all", "", 5),
                    steel_table = label("steel_table", "shapes='table' material='Steel'", 6);
  // Shapes: leg in table of wood, one in table of steel, one of wood, one of steel.
  CHECK(classes_in("t.gltf", file.text(), table + all) == ClassCounts{{"table", 2}, {"all", 2}});
  for (const std::string& labels : {table + leg + steel + all, all + steel + leg + table}) {
    CHECK(classes_in("t.gltf", file.text(), labels) == ClassCounts{{"leg", 1}, {"table", 1}, {"steel", 1}, {"all", 1}});
  }
  CHECK(classes_in("t.gltf", file.text(), steel_table + table + leg + all) ==
        ClassCounts{{"leg", 1}, {"steel_table", 1}, {"all", 2}});
}

TEST_CASE("a name reaches no other insertion point, and the names of a part, its file and its links are no shapes") {
  GltfBuilder file;
  file.append("materials", painted("Steel", {1, 0, 0, 1}));
  for (int i = 0; i < 2; ++i) add_plate(file, {.x = 4.0f + static_cast<float>(i)}, 0);
  json& nodes = file.root["nodes"];
  nodes[0]["name"] = "base";
  nodes[0]["children"] = {1};
  nodes[1]["name"] = "arm";
  nodes[1]["extras"]["simvis_points"] = json::array({"GRIP"});
  file.root["scenes"][0]["nodes"] = {0};
  for (const char* const name : {"base", "arm"}) {
    CHECK(classes_in("t.gltf", file.text(), file_label("x", "part='M' shapes='" + std::string(name) + "'", 2)) ==
          ClassCounts{{"", 1}, {"x", 1}});
  }
  const std::string content = "<mujoco><worldbody><body name='hand'>" + mjcf_box("") + "</body></worldbody></mujoco>";
  const std::string error =
      error_of([&] { classes_in("m.xml", content, file_label("x", "part='M' shapes='[mMh]*'", 2)); });
  CHECK(contains(error, "there is no shape \"[mMh]*\" in what the label names"));
  CHECK(contains(error, "(expected one of: box, or a pattern)"));
}

TEST_CASE("a name that no shape has is an error with the names that there are") {
  const auto error = [](const std::string& attributes) {
    return error_of([&] {
      classes_in("m.xml", "<mujoco><worldbody>" + mjcf_box("door") + "</worldbody></mujoco>",
                 file_label("x", attributes, 2));
    });
  };
  CHECK(contains(error("part='M' shapes='dor'"),
                 "there is no shape \"dor\" in what the label names, did you mean \"door\"?"));
  CHECK(contains(error("part='M' shapes='w*'"), "(expected one of: box, door, or a pattern)"));
  CHECK(contains(error("shapes='door'"), "a label needs the attribute \"part\" or \"parts\""));
  const std::string twice = error_of([] {
    classes_in("m.xml", "<mujoco><worldbody>" + mjcf_box("door") + "</worldbody></mujoco>",
               file_label("a", "part='M' shapes='door'", 2) + file_label("b", "part='M' shapes='d*'", 3));
  });
  CHECK(contains(twice,
                 "\"M\" already has the class \"a\" from label \"a\" for the shapes \"door\", expected one label"));
  std::string many;
  for (int i = 10; i < 40; ++i) many += mjcf_box("g" + std::to_string(i));
  CHECK(contains(error_of([&] {
                   classes_in("m.xml", "<mujoco><worldbody>" + many + "</worldbody></mujoco>",
                              file_label("x", "part='M' shapes='z*'", 2));
                 }),
                 "g27, g28 and 11 more, or a pattern)"));
}

TEST_CASE("a camera and a scanner give a shape that a name labels the same ids, and no label changes those of shapes") {
  const std::string content =
      "<mujoco><worldbody><geom name='wall' type='box' size='0.1 5 5' pos='4 0 0'/>"
      "<geom name='knob' type='box' size='0.1 0.5 0.5' pos='3 0 0'/></worldbody></mujoco>";
  const std::string sensors =
      "<sensor type='camera' name='CAM' insert_at='ROOT' width='9' height='9' hfov='60' outputs='instance semantic "
      "shape'/>"
      "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='3' min_angle='-25' max_angle='25' "
      "truth='instance semantic shape'/>";
  const TemporaryFolder folder;
  const auto seen = [&](const std::string& labels) {
    Simulation simulation = scene_of_file(folder, "m.xml", content, labels + sensors);
    simulation.step();
    const Measurement camera = simulation.measurement("CAM");
    const Scan& scan = simulation.scan("SCAN");
    std::map<std::string, double> ids;
    constexpr std::size_t kMiddleRow = 4 * 9;  // of 9 rows and columns; beam 0 looks to the right, 25 of 30 degrees
    for (const auto& [name, pixel, beam] : {std::tuple{"knob", kMiddleRow + 4, 1}, {"wall", kMiddleRow + 8, 0}}) {
      for (const std::string kind : {"instance", "semantic", "shape"}) {
        const double id = camera.find(kind)->number(pixel);
        CHECK(scan.channel("true_" + kind)->values[static_cast<std::size_t>(beam)] == id);
        ids[name + (" " + kind)] = id;
      }
    }
    return ids;
  };
  auto plain = seen(""), labelled = seen(file_label("knob", "part='M' shapes='kn*'", 7));
  CHECK(labelled.at("knob semantic") == 7);
  CHECK(labelled.at("wall semantic") == 0);
  CHECK(plain.at("knob semantic") == 0);
  for (const char* const shape : {"knob shape", "wall shape"}) CHECK(plain.at(shape) == labelled.at(shape));
  CHECK(plain.at("knob shape") != plain.at("wall shape"));
  CHECK(plain.at("knob instance") == plain.at("wall instance"));  // both are the part
  CHECK(labelled.at("wall instance") == plain.at("wall instance"));
  CHECK(labelled.at("knob instance") != plain.at("knob instance"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
