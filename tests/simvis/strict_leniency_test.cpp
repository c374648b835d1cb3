// Every leniency in reading strangers' files is a warning, and an error where warnings are errors.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "simvis/live_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

using test::dae_box;
using test::kMetresZUp;
using test::obj_box;

struct Leniency {
  std::string file;                          // the part's
  std::map<std::string, std::string> files;  // with their content
  std::string warning;                       // a part of it
};

std::string robot_with(const std::string& content) {
  return "<robot name='r'><link name='a'><visual><geometry><box size='1 1 1'/></geometry></visual>" + content +
         "</robot>";
}

std::string sdf_with(const std::string& content) {
  return "<sdf version='1.9'><model name='m'><link name='l'><visual name='v'><geometry><box><size>1 1 1</size></box>"
         "</geometry></visual></link>" +
         content + "</model></sdf>";
}

Leniency obj_with(const std::string& material, const std::string& warning) {
  return {"a.obj",
          {{"a.obj", "mtllib a.mtl\nusemtl m\n" + obj_box()}, {"a.mtl", "newmtl m\nKd 1 0 0\n" + material + "\n"}},
          warning};
}

std::string effect_with(const std::string& rest) { return "<diffuse><color>1 0 0 1</color></diffuse>" + rest; }

std::string utf16(const std::string& text) {
  std::string bytes = "\xff\xfe";
  for (const char c : text) bytes += {c, '\0'};
  return bytes;
}

std::string black_stl() {
  std::string bytes = test::stl_box(true);
  for (std::size_t facet = 0; facet < 12; ++facet) bytes[84 + 50 * facet + 49] = '\x80';
  return bytes;
}

std::vector<Leniency> leniencies() {
  const std::string ply = test::ply_box(test::PlyFormat::text);
  return {
      obj_with("d 0", "is wholly transparent"),
      obj_with("d 0.5\nTr 0.9", "d and Tr contradict each other"),
      obj_with("map_Kd no.png", "picture \"no.png\" is not there"),
      obj_with("map_Kd a.obj", "the material's colour replaces it"),
      {"a.obj", {{"a.obj", "mtllib no.mtl\n" + obj_box()}}, "there is no material file"},
      {"a.obj", {{"a.obj", utf16(obj_box())}}, "is text in UTF-16"},
      {"a.stl", {{"a.stl", black_stl()}}, "every colour is 0"},
      {"a.ply",
       {{"a.ply",
         "ply\n" + ply.substr(4, ply.find("end_header") - 4) + "nonsense 1\n" + ply.substr(ply.find("end_header"))}},
       "it is left out"},
      {"a.dae", {{"a.dae", dae_box(kMetresZUp) + std::string(3, '\0')}}, "bytes behind </COLLADA>"},
      {"a.dae",
       {{"a.dae", dae_box(kMetresZUp, 1, "",
                          effect_with("<transparent><color>0 0 0 1</color></transparent><transparency><float>0</float>"
                                      "</transparency>"))}},
       "is wholly transparent"},
      {"a.urdf",
       {{"a.urdf", robot_with("<visual><geometry><mesh filename='no.stl'/></geometry></visual></link>")}},
       "a visual is left out"},
      {"a.urdf",
       {{"a.urdf", robot_with("<visual><geometry><box size='0 1 1'/></geometry></visual></link>")}},
       "whose size is not above 0"},
      {"a.urdf",
       {{"a.urdf", robot_with("<visual><geometry><box size='1 1 1'/></geometry><material name='x'/></visual></link>")}},
       "which is not defined"},
      {"a.urdf",
       {{"a.urdf",
         robot_with("</link><link name='b'/><joint name='j' type='revolute'><parent link='a'/><child link='b'/>"
                    "<axis xyz='0 0 1'/><limit lower='1' upper='-1' effort='1' velocity='1'/></joint>")}},
       "limit"},
      {"a.sdf", {{"a.sdf", sdf_with("<plugin name='p' filename='p'/>")}}, "element <plugin> is not taken over"},
      {"a.sdf",
       {{"a.sdf", sdf_with("<joint name='j' type='revolute'><parent>l</parent><child>x</child></joint>")}},
       "is left out"},
  };
}

std::vector<std::string> warnings_of(const Leniency& each, bool strict) {
  const TemporaryFolder folder;
  for (const auto& [name, content] : each.files) write_text(folder / name, content);
  const LiveScene scene({},
                        parse_commands("<part file='" + each.file +
                                           "' name='P' insert_at='ROOT'/><sensor type='camera' "
                                           "name='CAM' insert_at='ROOT'/>",
                                       "s.xml", folder.path()),
                        0, {}, {}, strict);
  return scene.built.scene.warnings();
}

TEST_CASE("each leniency is a warning, and an error if the scene is strict") {
  for (const Leniency& each : leniencies()) {
    CAPTURE(each.file);
    CAPTURE(each.warning);
    const std::vector<std::string> warnings = warnings_of(each, false);
    CHECK(std::ranges::any_of(warnings, [&](const std::string& text) { return contains(text, each.warning); }));
    const std::string error = error_of([&] { warnings_of(each, true); });
    CHECK(contains(error, each.warning));
    CHECK(contains(error, "a warning, which is an error here"));
  }
}

}  // namespace
}  // namespace simvis
