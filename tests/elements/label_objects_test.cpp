// What labels make one object: by what they name, and by their attribute `level`.
#include <doctest/doctest.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/support/labelled_file.h"
#include "tests/support/urdf_scene.h"

TEST_SUITE_BEGIN("elements");

namespace simvis::test {
namespace {

// Two links: a top of two meshes, and legs of three, of which two have one name.
std::string named_visual(const std::string& name) {
  return "<visual name='" + name + "'><geometry><box size='1 1 1'/></geometry></visual>";
}
const std::string kChair =
    robot(link_xml("top", named_visual("seat") + named_visual("back")) +
          link_xml("legs", named_visual("leg_1") + named_visual("leg_2") + named_visual("foot")) +
          joint_xml("j", "fixed", "top", "legs"));

/// Numbers of surfaces by the paths of objects.
using Surfaces = std::map<std::string, std::size_t>;

Surfaces objects_with(const std::string& labels, bool with_class_only = true) {
  const TemporaryFolder folder;
  write_text(folder / "chair.urdf", kChair);
  const Simulation simulation = Simulation::from_string(
      "<simvis><part name='CHAIR_1' insert_at='ROOT' file='chair.urdf'/>"
      "<part name='CHAIR_2' insert_at='ROOT' file='chair.urdf'/>"
      "<part name='CUP' insert_at='CHAIR_1' shape='box' size='1 1 1'/>" +
          labels + "</simvis>",
      {}, folder.path());
  Surfaces surfaces;
  std::set<std::uint32_t> ids;
  const std::vector<SceneItem> items = simulation.items();
  for (const SceneObject& object : simulation.objects()) {
    CHECK(object.instance != 0);
    CHECK(ids.insert(object.instance).second);
    for (const ObjectSurface& each : object.surfaces) {
      CHECK(items.at(each.item).instance == object.instance);
      CHECK(items.at(each.item).semantic == object.semantic);
    }
    if (!object.surfaces.empty() && (object.semantic != 0 || !with_class_only)) {
      CHECK(surfaces.emplace(object.path, object.surfaces.size()).second);
    }
  }
  return surfaces;
}

std::string object_label(const std::string& attributes, const std::string& name = "L",
                         const std::string& type = "chair", const std::string& id = "62") {
  return "<element type='label' name='" + name + "' insert_at='ROOT' " + attributes + " class='" + type +
         "' class_id='" + id + "'/>";
}

TEST_CASE("without a label, links are objects, and a part without links is one") {
  CHECK(objects_with("", false) ==
        Surfaces{{"CHAIR_1/top", 2}, {"CHAIR_1/legs", 3}, {"CHAIR_2/top", 2}, {"CHAIR_2/legs", 3}, {"CHAIR_1/CUP", 1}});
}

TEST_CASE("what a label names is one object each: parts with all of their files, links for themselves") {
  CHECK(objects_with(object_label("part='CHAIR_1'")) == Surfaces{{"CHAIR_1", 5}});
  CHECK(objects_with(object_label("parts='CHAIR_?'")) == Surfaces{{"CHAIR_1", 5}, {"CHAIR_2", 5}});
  CHECK(objects_with(object_label("parts='CHAIR_*'")) == Surfaces{{"CHAIR_1", 5}, {"CHAIR_2", 5}});
  CHECK(objects_with(object_label("parts='CHAIR_1 CHAIR_2/legs'")) == Surfaces{{"CHAIR_1", 5}, {"CHAIR_2/legs", 3}});
  CHECK(objects_with(object_label("parts='*/legs'")) == Surfaces{{"CHAIR_1/legs", 3}, {"CHAIR_2/legs", 3}});
  CHECK(objects_with(object_label("part='CHAIR_2/top'")) == Surfaces{{"CHAIR_2/top", 2}});
  // What is not labelled keeps its objects.
  CHECK(objects_with(object_label("part='CHAIR_1'"), false) ==
        Surfaces{{"CHAIR_1", 5}, {"CHAIR_2/top", 2}, {"CHAIR_2/legs", 3}, {"CHAIR_1/CUP", 1}});
}

TEST_CASE("level makes the part, each link or each shape an object") {
  for (const std::string named : {"parts='*/legs'", "parts='CHAIR_?'", "parts='*/top */legs'"}) {
    CAPTURE(named);
    for (const char* const level : {"part", "model"}) {
      CHECK(objects_with(object_label(named + " level='" + level + "'")) == Surfaces{{"CHAIR_1", 5}, {"CHAIR_2", 5}});
    }
  }
  CHECK(objects_with(object_label("part='CHAIR_1' level='link'")) == Surfaces{{"CHAIR_1/top", 2}, {"CHAIR_1/legs", 3}});
  const Surfaces shapes = objects_with(object_label("part='CHAIR_1' level='shape'"));
  CHECK(shapes.size() == 5);
  for (const auto& [path, surfaces] : shapes) CHECK(surfaces == 1);
}

TEST_CASE("with shapes, what has a name is an object each; level makes one of all of them") {
  CHECK(objects_with(object_label("part='CHAIR_1' shapes='leg_*'")) ==
        Surfaces{{"CHAIR_1/legs/leg_1", 1}, {"CHAIR_1/legs/leg_2", 1}});
  CHECK(objects_with(object_label("part='CHAIR_1' shapes='leg_*' level='part'")) == Surfaces{{"CHAIR_1/L", 2}});
  // The rest of the part is an object of its own.
  CHECK(objects_with(object_label("part='CHAIR_1'", "A") +
                     object_label("part='CHAIR_1' shapes='leg_*'", "B", "leg", "7")) ==
        Surfaces{{"CHAIR_1", 3}, {"CHAIR_1/legs/leg_1", 1}, {"CHAIR_1/legs/leg_2", 1}});
}

TEST_CASE("meshes of one named node are one object, and nodes of one name are several") {
  GltfBuilder file;
  for (const char* const name : {"Wood", "Steel"}) file.append("materials", painted(name, {1, 0, 0, 1}));
  for (int i = 0; i < 4; ++i) add_plate(file, {.x = 4.0f + static_cast<float>(i)}, i % 2);
  json& nodes = file.root["nodes"];
  nodes.push_back({{"name", "chair"}, {"children", {0, 1}}});
  nodes.push_back({{"name", "chair"}, {"children", {2}}});
  file.root["scenes"][0]["nodes"] = {4, 5, 3};
  const TemporaryFolder folder;
  const Simulation simulation =
      scene_of_file(folder, "t.gltf", file.text(), file_label("chair", "part='M' shapes='chair'", 2));
  Surfaces surfaces;
  for (const SceneObject& object : simulation.objects()) {
    if (object.semantic != 0) surfaces[object.path] = object.surfaces.size();
  }
  CHECK(surfaces == Surfaces{{"M/chair", 2}, {"M/chair:2", 1}});
}

TEST_CASE("the id of an object does not depend on labels, unless they name shapes") {
  const auto id_of = [](const std::string& labels, const std::string& path) {
    const TemporaryFolder folder;
    const Simulation simulation = scene_of_file(folder, "c.urdf", kChair, labels);
    for (const SceneObject& object : simulation.objects()) {
      if (object.path == path) return object.instance;
    }
    return 0u;
  };
  const std::uint32_t whole = id_of("", "M"), top = id_of("", "M/top");
  CHECK(whole != 0);
  CHECK(id_of(object_label("part='M'"), "M") == whole);
  CHECK(id_of(object_label("part='M' level='link'"), "M/top") == top);
  CHECK(id_of(object_label("parts='top'", "L", "desk", "3"), "M/top") == top);
}

TEST_CASE("labels of a part and of its link, and levels that there are not, are errors") {
  const auto error = [](const std::string& labels) { return error_of([&] { objects_with(labels); }); };
  const std::string part = object_label("part='CHAIR_1'", "A");
  CHECK(contains(error(part + object_label("parts='*_1/legs'", "B", "leg", "7")),
                 "link \"CHAIR_1/legs\" of part \"CHAIR_1\" already has the class \"chair\" from label \"A\", expected "
                 "labels either of a whole part or of what stands in it"));
  CHECK(contains(error(object_label("part='CHAIR_1/legs'", "B", "leg", "7") + part),
                 "link \"CHAIR_1/legs\" of part \"CHAIR_1\" already has the class \"leg\" from label \"B\""));
  CHECK(contains(error(part + object_label("part='CHAIR_1'", "B", "seat", "7")),
                 "\"CHAIR_1\" already has the class \"chair\" from label \"A\", expected one label for each part"));
  CHECK(contains(error(object_label("part='CHAIR_1' level='links'")), "did you mean \"link\"?"));
  CHECK(contains(error(object_label("part='CHAIR_3'")), "there is no part or link \"CHAIR_3\", did you mean"));
  CHECK(contains(error(object_label("parts='CHAIR_1 SOFA_*'")), "there is no part or link \"SOFA_*\""));
  CHECK(contains(error(object_label("part='ROOT'")), "a label needs the attribute \"part\" or \"parts\""));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
