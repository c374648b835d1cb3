// Classes that the plug-in gz::sim::systems::Label gives to models and visuals of SDF.
#include <doctest/doctest.h>

#include <map>
#include <string>
#include <utility>

#include "elements/label.h"
#include "tests/support/error_of.h"
#include "tests/support/sdf_scene.h"

TEST_SUITE_BEGIN("import");

namespace simvis::test {
namespace {

std::string label_plugin(const std::string& number, const std::string& space = "gz::sim") {
  return "<plugin filename='gz-sim-label-system' name='" + space + "::systems::Label'><label>" + number +
         "</label></plugin>";
}

std::string sdf_box_link(const std::string& name, const std::string& in_visual = "") {
  return "<link name='" + name + "'>" + sdf_box("1 1 1", in_visual) + "</link>";
}

/// The classes by insertion point.
std::map<std::string, std::pair<std::string, std::uint32_t>> classes_of(SdfScene& scene) {
  std::map<std::string, std::pair<std::string, std::uint32_t>> classes;
  for (const Label* const label : labels_of(scene.built().scene)) {
    for (const auto& [point, object] : label->shapes.points) classes[point] = {label->class_name, label->class_id};
  }
  return classes;
}

TEST_CASE("a label of a model is that of its own links, and not of nested models") {
  for (const char* const space : {"gz::sim", "ignition::gazebo"}) {
    SdfScene scene(sdf_world("<model name='m'>" + sdf_box_link("a") + sdf_box_link("b") + label_plugin("62", space) +
                             "<model name='n'>" + sdf_box_link("c") + "</model></model><model name='o'>" +
                             sdf_box_link("d") + "</model>"));
    CHECK(scene.warnings().empty());
    const auto classes = classes_of(scene);
    CHECK(classes.size() == 2);
    CHECK(classes.at("m/a") == std::pair<std::string, std::uint32_t>("label_62", 62));
    CHECK(classes.at("m/b") == std::pair<std::string, std::uint32_t>("label_62", 62));
  }
}

TEST_CASE("a label in a visual, and one in an <include>, which stands behind that of the model") {
  SdfScene visual(sdf_world("<model name='m'>" + sdf_box_link("a", label_plugin("7")) + sdf_box_link("b") +
                            label_plugin("8") + "</model>"));
  CHECK(classes_of(visual).at("m/a").second == 7);
  CHECK(classes_of(visual).at("m/b").second == 8);
  CHECK(visual.warnings().empty());
  const std::string model = sdf_model("<model name='chair'>" + sdf_box_link("l") + label_plugin("3") + "</model>");
  SdfScene included(sdf_world("<include><uri>chair</uri><name>one</name>" + label_plugin("4") +
                              "</include><include><uri>chair</uri><name>two</name></include>"),
                    {{"chair/model.sdf", model}});
  CHECK(classes_of(included).at("one/l").second == 4);
  CHECK(classes_of(included).at("two/l").second == 3);
  CHECK(included.warnings().empty());
}

TEST_CASE("two parts of one file have the same classes") {
  const std::string text = sdf_model("<model name='m'>" + sdf_box_link("l") + label_plugin("5") + "</model>");
  SdfScene scene(text, {}, "<part file='w.sdf' name='V' insert_at='ROOT'/>");
  const auto classes = classes_of(scene);
  for (const char* const link : {"W/l", "V/l"}) CHECK(classes.at(link).second == 5);
}

TEST_CASE("a label of one visual among others of its link is that of the visual's name") {
  const auto visual = [](const std::string& name, const std::string& label) {
    return "<visual name='" + name + "'><geometry><box><size>1 1 1</size></box></geometry>" +
           (label.empty() ? "" : label_plugin(label)) + "</visual>";
  };
  const auto scene_of = [](const std::string& visuals) {
    return SdfScene(sdf_world("<model name='m'><link name='l'>" + visuals + "</link></model>"));
  };
  SdfScene mixed = scene_of(visual("v", "7") + visual("w", "8") + visual("plain", ""));
  CHECK(mixed.warnings().empty());
  std::map<SelectedNames, std::uint32_t> numbers;
  for (const Label* const label : labels_of(mixed.built().scene)) {
    CHECK(label->shapes.points.size() == 1);
    CHECK(label->shapes.points.contains("m/l"));
    numbers[label->shapes.names] = label->class_id;
  }
  CHECK(numbers == std::map<SelectedNames, std::uint32_t>{{{"v"}, 7}, {{"w"}, 8}});
  SdfScene twins = scene_of(visual("v", "7") + visual("v", "8") + visual("w", "9"));
  REQUIRE(labels_of(twins.built().scene).size() == 1);
  CHECK(labels_of(twins.built().scene)[0]->class_id == 9);
  REQUIRE(twins.warnings().size() == 1);
  CHECK(contains(twins.warnings()[0], "label of a visual that has no name of its own"));
  // The visual without its mesh is left out, and its label with it.
  SdfScene missing = scene_of("<visual name='gone'><geometry><mesh><uri>gone.dae</uri></mesh></geometry>" +
                              label_plugin("7") + "</visual>" + visual("w", "9"));
  REQUIRE(labels_of(missing.built().scene).size() == 1);
  CHECK(labels_of(missing.built().scene)[0]->class_id == 9);
}

TEST_CASE("labels that mean nothing are left out, and 0 is no class") {
  SdfScene none(sdf_world("<model name='m'>" + sdf_box_link("a") + label_plugin("0") + "</model>"));
  CHECK(classes_of(none).empty());
  CHECK(none.warnings().empty());
  for (const char* const wrong : {"256", "-1", "1.5", "chair"}) {
    SdfScene scene(sdf_world("<model name='m'>" + sdf_box_link("a") + label_plugin(wrong) + "</model>"));
    CHECK(classes_of(scene).empty());
    REQUIRE(scene.warnings().size() == 1);
    CHECK(contains(scene.warnings()[0], "the label is left out"));
  }
  SdfScene in_link(
      sdf_world("<model name='m'><link name='l'>" + sdf_box("1 1 1") + label_plugin("7") + "</link></model>"));
  CHECK(classes_of(in_link).empty());
  REQUIRE(in_link.warnings().size() == 1);
  CHECK(contains(in_link.warnings()[0], "element <plugin>"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
