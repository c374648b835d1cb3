// Labels of what files name: links of URDF, bodies and materials of MJCF, materials and points of glTF.
#include <doctest/doctest.h>

#include <cstdint>
#include <map>
#include <string>

#include "tests/support/labelled_file.h"
#include "tests/support/urdf_scene.h"

TEST_SUITE_BEGIN("elements");

namespace simvis::test {
namespace {

TEST_CASE("links of URDF are labelled by a pattern of their names") {
  const std::string visual = "<visual><geometry><box size='1 1 1'/></geometry></visual>";
  const std::string content =
      robot(link_xml("base", visual) + link_xml("arm_left", visual + visual) + link_xml("arm_right", visual) +
            joint_xml("j1", "fixed", "base", "arm_left") + joint_xml("j2", "fixed", "base", "arm_right"));
  CHECK(classes_in("r.urdf", content, file_label("arm", "parts='arm_*'", 4)) == ClassCounts{{"", 1}, {"arm", 3}});
  CHECK(classes_in("r.urdf", content, file_label("robot", "part='M'", 5)) == ClassCounts{{"robot", 4}});
}

TEST_CASE("bodies and materials of MJCF are labelled by patterns of their names, and a geom by either of them") {
  const std::string content =
      "<mujoco model='m'><default><default class='skin'><geom material='skin_soft'/></default></default><asset>"
      "<material name='skin_soft'/><material name='skin_hard'/><material name='metal'/></asset><worldbody>"
      "<body name='torso'><geom name='chest' type='box' size='1 1 1' material='metal'/>"
      "<body name='left_hand'><geom type='sphere' size='1' class='skin'/><geom type='sphere' size='1'/></body>"
      "<body name='right_hand'><geom type='sphere' size='1' material='skin_hard'/></body></body></worldbody></mujoco>";
  CHECK(classes_in("m.xml", content, file_label("hand", "parts='*_hand'", 4)) == ClassCounts{{"", 1}, {"hand", 3}});
  CHECK(classes_in("m.xml", content, file_label("skin", "part='M' material='skin_*'", 5)) ==
        ClassCounts{{"", 2}, {"skin", 2}});
  CHECK(classes_in(
            "m.xml", content,
            file_label("left", "parts='left_hand'", 6) + file_label("soft", "parts='left_hand' material='*soft'", 7)) ==
        ClassCounts{{"", 2}, {"left", 1}, {"soft", 1}});
}

TEST_CASE("materials of glTF are labelled by a pattern of their names, and nodes by the points that they name") {
  GltfBuilder file;
  for (const char* const name : {"Wood_oak", "Wood_pine", "Steel"})
    file.append("materials", painted(name, {1, 0, 0, 1}));
  for (int i = 0; i < 3; ++i) add_plate(file, {.x = 4.0f + static_cast<float>(i)}, i);
  CHECK(classes_in("t.gltf", file.text(), file_label("wood", "part='M' material='Wood_*'", 4)) ==
        ClassCounts{{"", 1}, {"wood", 2}});
  CHECK(classes_in("t.gltf", file.text(), file_label("steel", "part='M' material='St?el'", 5)) ==
        ClassCounts{{"", 2}, {"steel", 1}});
  file.root["nodes"][0]["extras"]["simvis_points"] = json::array({"CHAIR_1"});
  file.root["nodes"][2]["extras"]["simvis_points"] = json::array({"CHAIR_2"});
  CHECK(classes_in("t.gltf", file.text(), file_label("chair", "parts='CHAIR_*'", 6)) ==
        ClassCounts{{"", 1}, {"chair", 2}});
}

TEST_CASE("materials of OBJ that look the same are labelled by their own names") {
  const TemporaryFolder folder;
  write_text(folder / "h.mtl", "newmtl roof\nKd 1 0 0\nnewmtl door\nKd 1 0 0\n");
  write_text(folder / "h.obj",
             "mtllib h.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl roof\nf 1 2 3\nusemtl door\nf 1 2 4\n");
  const Simulation simulation =
      Simulation::from_string("<simvis><part name='M' insert_at='ROOT' file='h.obj'/>" +
                                  file_label("door", "part='M' material='d*'", 4) + "</simvis>",
                              {}, folder.path());
  std::map<std::string, std::uint64_t> triangles;
  for (const SceneItem& item : simulation.items()) triangles[item.label] += item.triangles;
  CHECK(triangles == std::map<std::string, std::uint64_t>{{"", 1}, {"door", 1}});
}

TEST_CASE("two labels whose patterns match one material of a part are an error at the second one") {
  const auto error = error_of([] {
    GltfBuilder file;
    for (const char* const name : {"Wood_oak", "Wood_pine"}) file.append("materials", painted(name, {1, 0, 0, 1}));
    for (int i = 0; i < 2; ++i) add_plate(file, {.x = 4.0f + static_cast<float>(i)}, i);
    classes_in("t.gltf", file.text(),
               file_label("wood", "part='M' material='Wood_*'", 4) + file_label("oak", "part='M' material='*oak'", 5));
  });
  CHECK(contains(error,
                 "\"M\" already has the class \"wood\" from label \"wood\" for the material \"Wood_oak\", "
                 "expected one label for each part"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
