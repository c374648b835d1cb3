// The objects that importers find in part files: models, links, bodies and named places.
#include <doctest/doctest.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "simvis/built_scene.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/python_package.h"
#include "tests/support/sdf_scene.h"
#include "tests/support/urdf_scene.h"

TEST_SUITE_BEGIN("import");

namespace simvis::test {
namespace {

/// "KIND PATH" of all objects but ROOT, sorted.
using Listed = std::set<std::string>;

Listed objects_in(const std::string& file, const std::string& content, const std::string& copies = "") {
  const TemporaryFolder folder;
  write_text(folder / file, content);
  const BuiltScene built = build_scene(
      parse_commands("<part file='" + file + "' name='P' insert_at='ROOT'/>" + copies, "s.xml", folder.path()));
  Listed listed;
  const ObjectTree& tree = built.scene.objects();
  for (const Object& object : tree.all()) {
    if (object.kind != ObjectKind::world) listed.insert(std::string(to_string(object.kind)) + " " + object.path);
    if (object.kind != ObjectKind::world) CHECK(built.scene.has_insertion_point(object.name));
  }
  return listed;
}

const std::string kVisual = "<visual><geometry><box size='1 1 1'/></geometry></visual>";

TEST_CASE(
    "URDF: the links belong to the part, whatever joints hold them, and copies have the same paths below theirs") {
  const std::string chain = robot(link_xml("base", kVisual) + link_xml("arm", kVisual) + link_xml("hand", kVisual) +
                                  joint_xml("j1", "revolute", "base", "arm",
                                            "<limit effort='1' velocity='1' "
                                            "lower='0' upper='1'/>") +
                                  joint_xml("j2", "fixed", "arm", "hand"));
  CHECK(objects_in("r.urdf", chain) == Listed{"part P", "link P/base", "link P/arm", "link P/hand"});
  CHECK(objects_in("r.urdf", chain, "<part file='r.urdf' name='Q' insert_at='P'/>") ==
        Listed{"part P", "link P/base", "link P/arm", "link P/hand", "part P/Q", "link P/Q/base", "link P/Q/arm",
               "link P/Q/hand"});
}

TEST_CASE("SDF: models hold their links and nested models; a single model is the part") {
  const auto link = [](const std::string& name) { return "<link name='" + name + "'>" + sdf_box("1 1 1") + "</link>"; };
  CHECK(objects_in("w.sdf", sdf_world("<model name='m'>" + link("a") + link("b") + "<model name='n'>" + link("c") +
                                      "</model></model><model name='o'>" + link("d") + "</model>")) ==
        Listed{"part P", "model P/m", "link P/m/a", "link P/m/b", "model P/m/n", "link P/m/n/c", "model P/o",
               "link P/o/d"});
  CHECK(objects_in("m.sdf", sdf_model("<model name='m'>" + link("a") + "</model>")) == Listed{"part P", "link P/a"});
}

TEST_CASE("MJCF: bodies are links of the part; joints, sites and cameras are places of their bodies") {
  const std::string box = "<geom type='box' size='1 1 1'/>";
  const Listed listed = objects_in(
      "m.xml", "<mujoco><worldbody>" + box + "<body name='torso'>" + box + "<body name='hand'><joint name='wrist'/>" +
                   box + "<site name='grip'/></body></body><camera name='eye'/></worldbody></mujoco>");
  CHECK(listed ==
        Listed{"part P", "link P/torso", "link P/hand", "frame P/torso/wrist", "frame P/hand/grip", "frame P/eye"});
}

TEST_CASE("glTF: the part, and nodes that extras mark") {
  GltfBuilder file;
  file.append("nodes", {{"name", "table"}, {"extras", {{"simvis_links", {"TABLE"}}}}, {"children", {1}}});
  file.append("nodes", {{"name", "top"}, {"extras", {{"simvis_points", {"TOP"}}}}});
  file.append("nodes", {{"name", "group"}, {"extras", {{"simvis_models", {"KIT"}}}}, {"children", {3}}});
  file.append("nodes", {{"name", "cup"}, {"extras", {{"simvis_links", {"CUP"}}}}});
  file.root["scenes"][0]["nodes"] = {0, 2};
  CHECK(objects_in("t.gltf", file.text()) ==
        Listed{"part P", "link P/TABLE", "frame P/TABLE/TOP", "model P/KIT", "link P/KIT/CUP"});
}

TEST_CASE("OBJ, and other files without objects: the part") {
  CHECK(objects_in("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\no a\nf 1 2 3\no b\nf 1 3 2\n") == Listed{"part P"});
}

TEST_CASE("USD: rigid bodies are links, labelled prims are models with the bodies below them") {
  if (!has_python_module("pxr.Usd") || !has_python_module("numpy")) return;
  ::setenv("SIMVIS_PYTHON", kToolsPython, 1);
  const std::string body = R"( (prepend apiSchemas = ["PhysicsRigidBodyAPI"])
  {
    def Cube "shape"
    {
    }
  }
)";
  const std::string text = R"(#usda 1.0
( metersPerUnit = 1
  upAxis = "Z" )
def Xform "World"
{
  def Xform "crate")" + body +
                           R"(
  def Xform "chair" (prepend apiSchemas = ["SemanticsLabelsAPI:class"])
  {
    token[] semantics:labels:class = ["chair"]
    def Xform "seat")" + body +
                           R"(
    def Cube "back"
    {
    }
  }
})";
  CHECK(objects_in("p.usda", text) == Listed{"part P", "link P/crate", "model P/chair", "link P/chair/seat"});
  const TemporaryFolder folder;
  write_text(folder / "p.usda", text);
  const Simulation simulation =
      Simulation::from_string("<simvis><part name='P' insert_at='ROOT' file='p.usda'/></simvis>", {}, folder.path());
  std::map<std::string, std::size_t> surfaces;
  for (const SceneObject& object : simulation.objects()) {
    if (object.label == "chair") surfaces[object.path] = object.surfaces.size();
  }
  CHECK(surfaces == std::map<std::string, std::size_t>{{"P/chair", 2}});  // one object, with its body
  ::unsetenv("SIMVIS_PYTHON");
}

TEST_CASE("SDF: a labelled model is one object with all of its links, and mixed labels are objects of their own") {
  const auto label = [](const std::string& number) {
    return "<plugin filename='gz-sim-label-system' name='gz::sim::systems::Label'><label>" + number +
           "</label></plugin>";
  };
  const auto link = [](const std::string& name, const std::string& in_visual = "") {
    return "<link name='" + name + "'>" + sdf_box("1 1 1", in_visual) + "</link>";
  };
  const auto labelled = [](const std::string& text) {
    const TemporaryFolder folder;
    write_text(folder / "w.sdf", text);
    const Simulation simulation =
        Simulation::from_string("<simvis><part name='W' insert_at='ROOT' file='w.sdf'/></simvis>", {}, folder.path());
    std::map<std::string, std::size_t> surfaces;
    for (const SceneObject& object : simulation.objects()) {
      if (object.semantic != 0) surfaces[object.path] = object.surfaces.size();
    }
    return surfaces;
  };
  using Surfaces = std::map<std::string, std::size_t>;
  CHECK(labelled(sdf_world("<model name='m'>" + link("a") + link("b") + label("62") + "</model><model name='o'>" +
                           link("c") + "</model>")) == Surfaces{{"W/m", 2}});
  CHECK(labelled(sdf_model("<model name='m'>" + link("a") + link("b") + label("62") + "</model>")) ==
        Surfaces{{"W", 2}});
  CHECK(labelled(sdf_world("<model name='m'>" + link("a", label("7")) + link("b") + label("8") + "</model>")) ==
        Surfaces{{"W/m/a", 1}, {"W/m/b", 1}});
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
