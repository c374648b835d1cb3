// The element `trail`: the path that it keeps, and which sensors see it.
#include "elements/visualization/trail.h"

#include <doctest/doctest.h>

#include <cmath>
#include <optional>

#include "tests/support/error_of.h"
#include "tests/support/parts/stub_part.h"
#include "tests/support/people_view.h"

TEST_SUITE_BEGIN("elements");

namespace simvis {
namespace {

std::string trail(const std::string& attributes) {
  return "<element type='trail' name='E' insert_at='ROOT' part='R' " + attributes + "/>";
}
constexpr std::string_view kPart = "<part file='robot.stub' name='R' insert_at='ROOT' pose_offset='0 0 1 0 0 0'/>";
constexpr std::string_view kPose = "<element type='pose' name='P' insert_at='R'/>";

// A part that is moved by a pose inserted after the trail.
struct Trail {
  TemporaryFolder folder;
  std::optional<PeopleView> view;
  explicit Trail(const std::string& attributes = "", std::string_view pose = kPose) {
    write_text(folder / "robot.stub", "");
    view.emplace(std::string(kPart) + trail(attributes) + std::string(pose), folder.path());
  }
  std::vector<SeenMarker> lines() {
    const DrawList& list = view->frame();
    REQUIRE(list.items.size() == 1);
    return markers_in(list, list.items[0]);
  }
  std::vector<SeenMarker> lines_at(double x) { return lines_with("P", "x", x); }
  std::vector<SeenMarker> lines_with(std::string_view element, std::string_view parameter, double value) {
    view->built.parameters.set(view->built.parameters.index(element, parameter), value);
    return lines();
  }
};

TEST_CASE("the trail connects the places where the part has been") {
  // The second place is far out: float32 world coordinates there have a resolution of about a metre.
  for (const double y : {2.0, 1e7}) {
    Trail trail("step='0.5'", "<element type='pose' name='P' insert_at='R' y='" + std::to_string(y) + "'/>");
    const double tolerance_m = corner_tolerance_m(4, 2 * y);
    CHECK(trail.lines().empty());
    CHECK(trail.lines_at(0.25).empty());  // not far enough yet
    std::vector<SeenMarker> seen = trail.lines_at(0.75);
    REQUIRE(seen.size() == 1);
    CHECK(glm::distance(seen[0].from(), {0, y, 1}) < tolerance_m);
    CHECK(glm::distance(seen[0].to(), {0.75, y, 1}) < tolerance_m);
    seen = trail.lines_with("P", "z", 2);
    REQUIRE(seen.size() == 2);
    CHECK(glm::distance(seen[0].from(), {0, y, 1}) < tolerance_m);
    CHECK(glm::distance(seen[0].to(), {0.75, y, 1}) < tolerance_m);
    CHECK(glm::distance(seen[1].from(), {0.75, y, 1}) < tolerance_m);
    CHECK(glm::distance(seen[1].to(), {0.75, y, 3}) < tolerance_m);
  }
}

TEST_CASE("a part at rest changes nothing") {
  Trail trail;
  trail.lines_at(1);
  trail.lines_at(2);
  const FlattenCounters before = trail.view->people.counters();
  CHECK(trail.lines().size() == 1);
  CHECK(trail.lines().size() == 1);
  CHECK(trail.view->people.counters() == before);
}

TEST_CASE("each parameter of trail") {
  Trail trail("step='0.5' width='0.1'");
  const double tolerance_m = 2 * corner_tolerance_m(8, 8);
  for (int x = 0; x <= 4; ++x) trail.lines_at(x);
  CHECK(trail.lines().size() == 4);
  CHECK(std::abs(trail.lines()[0].width() - 0.1) < tolerance_m);
  CHECK(std::abs(trail.lines_with("E", "width", 0.25)[0].width() - 0.25) < tolerance_m);
  trail.lines_with("E", "red", 0.125);
  trail.lines_with("E", "green", 0.25);
  CHECK(trail.lines_with("E", "blue", 0.5)[3].color == glm::vec4(0.125f, 0.25f, 0.5f, 1));

  trail.lines_with("E", "step", 1.5);
  CHECK(trail.lines_at(5).size() == 4);
  CHECK(trail.lines_at(5.5).size() == 5);
  const std::vector<SeenMarker> kept = trail.lines_with("E", "keep", 3.9);
  REQUIRE(kept.size() == 2);  // three points
  CHECK(glm::distance(kept[0].from(), {3, 0, 1}) < tolerance_m);
  CHECK(glm::distance(kept[1].to(), {5.5, 0, 1}) < tolerance_m);
  CHECK(glm::distance(trail.lines_at(7.5)[0].from(), {4, 0, 1}) < tolerance_m);
  CHECK(trail.lines_with("E", "width", 0).empty());
}

TEST_CASE("the trail continues after a part gets its own content or was switched off for a while") {
  Trail trail;
  trail.lines_at(0);
  trail.view->built.scene.own_part("R", {});
  CHECK(trail.lines_at(1).size() == 1);

  const auto part = std::dynamic_pointer_cast<Group>(trail.view->built.scene.find_node("R"));
  const GroupPtr root = trail.view->built.scene.root();
  root->remove(*part);
  CHECK(trail.lines_at(2).size() == 1);
  root->add(part);
  CHECK(trail.lines_at(3).size() == 2);
}

TEST_CASE("sensors see no trail") {
  Trail trail;
  trail.lines_at(0);
  trail.lines_at(1);
  PeopleView without(std::string(kPart) + std::string(kPose), trail.folder.path());
  without.frame_with("P", "x", 1);
  CHECK(same_content(trail.view->sensors.update(), without.sensors.update()));
  CHECK(trail.view->sensors.counters().nodes_visited == without.sensors.counters().nodes_visited + 2);
}

TEST_CASE("a removed trail leaves the scene as it was before") {
  TemporaryFolder folder;
  write_text(folder / "robot.stub", "");
  BuiltScene built;
  SceneBuilder builder(built, {});
  builder.execute(parse_commands(std::string(kPart), "s.xml", folder.path()));
  Flattener people(built.scene.root(), Audience::people);
  people.update();
  const std::uint64_t nodes = people.counters().nodes_visited;
  const std::string later = trail("") + "<element type='pose' name='P' insert_at='NOWHERE'/>";
  CHECK(contains(error_of([&] { builder.execute(parse_commands(later, "s.xml", "")); }), "\"NOWHERE\""));
  people.update();
  CHECK(people.counters().nodes_visited == 2 * nodes);
  CHECK(built.scene.find_node("E") == nullptr);
}

TEST_CASE("mistakes in trail") {
  const auto error = [](const std::string& commands) { return error_of([&] { PeopleView view(commands); }); };
  CHECK(contains(error("<element type='trail' name='E' insert_at='ROOT'/>"), "s.xml:1:2: error: "));
  CHECK(contains(error("<element type='trail' name='E' insert_at='ROOT'/>"), "part"));
  CHECK(contains(error(trail("")), "s.xml:1:49: error: there is no part or link \"R\""));
  CHECK(contains(error(trail("step='0'")), "attribute \"step\": 0 is not allowed"));
  CHECK(contains(error(trail("keep='1'")), "attribute \"keep\": 1 is not allowed"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
