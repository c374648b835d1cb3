// The element `label`, and the ids of items.
#include "elements/label.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "tests/support/element_scene.h"

TEST_SUITE_BEGIN("elements");

namespace simvis::test {
namespace {

std::string box(const std::string& name, const std::string& at = "ROOT") {
  return "<part name='" + name + "' insert_at='" + at + "' shape='box' size='1 1 1'/>";
}
std::string label(const std::string& name, const std::string& attributes) {
  return "<element type='label' name='" + name + "' insert_at='ROOT' " + attributes + "/>";
}
std::string scene_of(const std::string& commands) { return "<simvis>" + commands + "</simvis>"; }

using ByPart = std::map<std::string, SceneItem>;

/// The items by part; of parts with several, the last.
ByPart items_by_part(const Simulation& simulation) {
  ByPart items;
  for (const SceneItem& item : simulation.items()) items[item.part] = item;
  return items;
}
ByPart items_by_part(const std::string& commands) { return items_by_part(Simulation::from_string(scene_of(commands))); }

TEST_CASE("a label gives its class to a part, or to all parts that match, and to nothing that stands on them") {
  const ByPart items = items_by_part(box("TABLE") + box("CUP", "TABLE") + box("CHAIR_1") + box("CHAIR_2") +
                                     label("T", "part='TABLE' class='table' class_id='7'") +
                                     label("C", "parts='CHAIR_*' class='chair' class_id='62'"));
  REQUIRE(items.size() == 4);
  CHECK(items.at("TABLE").semantic == 7);
  CHECK(items.at("TABLE").label == "table");
  CHECK(items.at("CUP").semantic == 0);
  CHECK(items.at("CUP").label.empty());
  for (const char* const chair : {"CHAIR_1", "CHAIR_2"}) {
    CHECK(items.at(chair).semantic == 62);
    CHECK(items.at(chair).label == "chair");
  }
  std::set<std::uint32_t> ids;
  for (const auto& [part, item] : items) ids.insert(item.instance);
  CHECK(ids.size() == 4);
  CHECK_FALSE(ids.contains(0));
}

TEST_CASE("a label of a material takes precedence over that of the part, and a second label of a class needs no id") {
  const TemporaryFolder folder;
  GltfBuilder file;
  file.append("materials", painted("Wood", {1, 0, 0, 1}));
  file.append("materials", painted("Steel", {0, 1, 0, 1}));
  file.append("materials", painted("Glass", {0, 0, 1, 1}));
  add_plate(file, {.x = 4}, 0);
  add_plate(file, {.x = 5}, 1);
  add_plate(file, {.x = 6}, 2);
  write_text(folder / "table.gltf", file.text());
  const std::string part = "<part name='TABLE' insert_at='ROOT' file='table.gltf' up='z'/>";
  const Simulation simulation =
      Simulation::from_string(scene_of(part + label("A", "part='TABLE' class='table' class_id='7'") +
                                       label("B", "part='TABLE' material='Steel' class='leg' class_id='8'") +
                                       label("C", "part='TABLE' material='Glass' class='leg'")),
                              {}, folder.path());
  std::multiset<std::string> classes;
  for (const SceneItem& item : simulation.items()) classes.insert(item.label);
  CHECK(classes == std::multiset<std::string>{"leg", "leg", "table"});
  CHECK(contains(error_of([&] {
                   Simulation::from_string(
                       scene_of(part + label("A", "part='TABLE' material='Steal' class='leg' class_id='8'")), {},
                       folder.path());
                 }),
                 "there is no material \"Steal\" in what the label names, did you mean \"Steel\"?"));
}

TEST_CASE("ids do not depend on the order of commands, on other things, or on what came and went") {
  const std::string labels = label("T", "part='B' class='table' class_id='7'");
  const ByPart all = items_by_part(box("A") + box("B") + box("C", "B") + labels);
  CHECK(items_by_part(box("B") + labels + box("C", "B") + box("A")) == all);
  CHECK(items_by_part(box("B")).at("B").instance == all.at("B").instance);
  // Stable between versions too: FNV-1a of "B", then of the number 0, folded to 32 bits.
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const std::uint64_t word : {std::uint64_t{'B'}, std::uint64_t{0}}) hash = (hash ^ word) * 0x100000001b3u;
  CHECK(all.at("B").instance == static_cast<std::uint32_t>(hash ^ hash >> 32));

  Simulation simulation = Simulation::from_string(scene_of(box("A") + box("B") + box("C", "B") + labels));
  CHECK(items_by_part(simulation) == all);
  simulation.execute(scene_of("<remove kind='part' name='A'/>" + box("0_NEW")));
  simulation.step();
  ByPart others = items_by_part(simulation);
  CHECK(others.at("B") == all.at("B"));
  CHECK(others.at("C") == all.at("C"));
  simulation.execute(scene_of("<remove kind='part' name='0_NEW'/>" + box("A")));
  simulation.step();
  CHECK(items_by_part(simulation) == all);
  simulation.execute(scene_of("<remove kind='element' name='T'/>"));
  simulation.step();
  CHECK(items_by_part(simulation).at("B").semantic == 0);
}

TEST_CASE("two parts whose names have one hash have different ids, which they keep when the other one goes") {
  const std::string first = "P1915", second = "P120445";  // found by trying names
  Simulation simulation = Simulation::from_string(scene_of(box(first) + box(second)));
  const ByPart both = items_by_part(simulation);
  CHECK(both.at(second).instance == items_by_part(box(first)).at(first).instance);
  CHECK(both.at(first).instance == both.at(second).instance + 1);  // the names are sorted as texts
  simulation.execute(scene_of("<remove kind='part' name='" + second + "'/>"));
  simulation.step();
  CHECK(items_by_part(simulation).at(first) == both.at(first));
  simulation.execute(scene_of(box(second)));
  simulation.step();
  CHECK(items_by_part(simulation) == both);
}

TEST_CASE("a label that names no part gives its class to the part where it is inserted, and to nothing on it") {
  const auto items = items_by_part(box("TABLE") + box("CUP", "TABLE") +
                                   "<element type='label' name='T' insert_at='TABLE' class='table' class_id='7'/>");
  CHECK(items.at("TABLE").label == "table");
  CHECK(items.at("CUP").label.empty());
}

TEST_CASE("mistakes in labels are errors at their place") {
  const std::string parts = box("TABLE") + box("CHAIR") + "\n";
  const auto error = [&](const std::string& attributes, const std::string& before = "") {
    return error_of(
        [&] { Simulation::from_string(scene_of(parts + before + "\n" + label("L", attributes)), {}, ".", "s.xml"); });
  };
  const std::string table = label("FIRST", "part='TABLE' class='table' class_id='7'");
  const std::string unknown = error("part='CHAIR' class='tabel'", table);
  CHECK(contains(unknown, "s.xml:3:62: error: class \"tabel\" is unknown, did you mean \"table\"?"));
  CHECK(contains(unknown, "expected a class of a label before, or the attribute \"class_id\""));
  CHECK(contains(error("part='TABLE' class='desk' class_id='8'", table),
                 "s.xml:3:49: error: \"TABLE\" already has the class \"table\" from label \"FIRST\", expected one "
                 "label for each part"));
  CHECK(contains(error("parts='T*' class='desk' class_id='8'", table), "\"TABLE\" already has the class \"table\""));
  CHECK(contains(error("part='CHAIR' class='table' class_id='8'", table),
                 "class \"table\" has the id 7 from label \"FIRST\", expected no other"));
  CHECK(contains(error("part='CHAIR' class='chair' class_id='7'", table),
                 "the id 7 belongs to the class \"table\" of label \"FIRST\", expected another id"));
  CHECK(contains(error("class='chair' class_id='7'"), "a label needs the attribute \"part\" or \"parts\""));
  CHECK(contains(error("part='CHAIR' parts='C*' class='chair' class_id='7'"), "expected one of them, not both"));
  const std::string nowhere = error_of([&] {
    Simulation::from_string(
        scene_of(parts + "<element type='label' name='L' insert_at='CHIAR' class='chair' class_id='7'/>"), {}, ".",
        "s.xml");
  });
  CHECK(contains(nowhere, "there is no insertion point \"CHIAR\", did you mean \"CHAIR\"?"));
  CHECK(contains(error("parts='SOFA*' class='sofa' class_id='9'"), "there is no part or link \"SOFA*\""));
  CHECK(contains(error("part='CHIAR' class='chair' class_id='7'"), "did you mean \"CHAIR\"?"));
  CHECK(contains(error("part='CHAIR' class_id='7'"), "class"));
  CHECK(contains(error("part='CHAIR' class='chair' class_id='0'"), "class_id"));
  CHECK(contains(error("part='CHAIR' material='Wood' class='chair' class_id='7'"),
                 "there is no material \"Wood\" in what the label names"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
