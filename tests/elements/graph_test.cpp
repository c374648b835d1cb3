// The element `graph`: the places of nodes and edges, the allowed input, and which sensors see it.
#include "elements/visualization/graph.h"

#include <doctest/doctest.h>

#include <cmath>

#include <simvis/pose.h>
#include "tests/support/error_of.h"
#include "tests/support/people_view.h"

TEST_SUITE_BEGIN("elements");

namespace simvis {
namespace {

std::string graph(const std::string& attributes) {
  return "<element type='graph' name='E' insert_at='ROOT' " + attributes + "/>";
}
const std::string kTriangle = graph("nodes='1 2 3, -4 5.5 6,7 8 9' edges='0-1, 2 - 1' size='0.5' width='0.1'");

// The markers of the only item: lines first, then points.
std::vector<SeenMarker> markers(const DrawList& list) {
  REQUIRE(list.items.size() == 1);
  return markers_in(list, list.items[0]);
}

void check_triangle(const std::vector<SeenMarker>& seen, const glm::dvec3 (&nodes)[3], double tolerance_m) {
  REQUIRE(seen.size() == 5);
  CHECK(glm::distance(seen[0].from(), nodes[0]) < tolerance_m);
  CHECK(glm::distance(seen[0].to(), nodes[1]) < tolerance_m);
  CHECK(glm::distance(seen[1].from(), nodes[2]) < tolerance_m);
  CHECK(glm::distance(seen[1].to(), nodes[1]) < tolerance_m);
  for (std::size_t i = 0; i < 3; ++i) CHECK(glm::distance(seen[2 + i].center(), nodes[i]) < tolerance_m);
}

TEST_CASE("nodes are points and edges lines, in the frame at the insertion point") {
  PeopleView view(kTriangle);
  check_triangle(markers(view.frame()), {{1, 2, 3}, {-4, 5.5, 6}, {7, 8, 9}}, corner_tolerance_m(16, 16));

  PeopleView moved("<element type='pose' name='P' insert_at='ROOT' x='1' yaw='90'/>" + kTriangle);
  check_triangle(markers(moved.frame()), {{-1, 1, 3}, {-4.5, -4, 6}, {-7, 7, 9}}, corner_tolerance_m(16, 16));

  // Coordinates as in maps: far east and north.
  PeopleView far(graph("nodes='4e7 5e7 0, 40000003 50000001 0.5, 4e7 50000002 0' edges='0-1, 2-1'"));
  check_triangle(markers(far.frame()), {{4e7, 5e7, 0}, {40000003, 50000001, 0.5}, {4e7, 50000002, 0}},
                 corner_tolerance_m(8, 1e8));
}

TEST_CASE("each parameter of graph") {
  PeopleView view(kTriangle);
  const double tolerance_m = 2 * corner_tolerance_m(16, 16);
  CHECK(std::abs(markers(view.frame())[0].width() - 0.1) < tolerance_m);
  CHECK(std::abs(markers(view.frame())[2].size() - 0.5) < tolerance_m);
  CHECK(std::abs(markers(view.frame_with("E", "width", 0.25))[0].width() - 0.25) < tolerance_m);
  CHECK(std::abs(markers(view.frame_with("E", "size", 0.75))[2].size() - 0.75) < tolerance_m);

  view.frame_with("E", "red", 0.125);
  view.frame_with("E", "green", 0.25);
  view.frame_with("E", "blue", 0.5);
  view.frame_with("E", "edge_red", 0.75);
  view.frame_with("E", "edge_green", 0.875);
  const std::vector<SeenMarker> seen = markers(view.frame_with("E", "edge_blue", 0.0625));
  CHECK(seen[0].color == glm::vec4(0.75f, 0.875f, 0.0625f, 1));
  CHECK(seen[2].color == glm::vec4(0.125f, 0.25f, 0.5f, 1));

  CHECK(markers(view.frame_with("E", "size", 0)).size() == 2);
  view.frame_with("E", "size", 0.25);
  CHECK(markers(view.frame_with("E", "width", 0)).size() == 3);
}

TEST_CASE("the place of each node is a parameter") {
  PeopleView view(kTriangle);
  const ElementDescriptor& element = view.built.parameters.elements().at(0);
  REQUIRE(element.parameters.size() == 8 + 9);
  CHECK(element.parameters[8].name == "x0");
  CHECK(element.parameters[12].name == "y1");
  CHECK(element.parameters[16].name == "z2");
  CHECK(element.parameters[16].unit == "m");
  CHECK(view.built.parameters.values()[view.built.parameters.index("E", "y1")] == 5.5);
  glm::dvec3 nodes[3] = {{1, 2, 3}, {-4, 5.5, 6}, {7, 8, 9}};
  for (std::size_t node = 0; node < 3; ++node) {
    for (int axis = 0; axis < 3; ++axis) {
      nodes[node][axis] += 0.5 + axis + static_cast<double>(node);
      const std::string name = std::string(1, "xyz"[axis]) + std::to_string(node);
      check_triangle(markers(view.frame_with("E", name, nodes[node][axis])), nodes, corner_tolerance_m(32, 32));
    }
  }
  CHECK(contains(error_of([&] { view.frame_with("E", "x3", 1); }), "has no parameter \"x3\""));
  CHECK(contains(error_of([&] { view.frame_with("E", "x0", 1e16); }), "E.x0: "));
}

TEST_CASE("a single node without edges") {
  PeopleView view(graph("nodes='1 2 3'"));
  const std::vector<SeenMarker> seen = markers(view.frame());
  REQUIRE(seen.size() == 1);
  CHECK(glm::distance(seen[0].center(), {1, 2, 3}) < corner_tolerance_m(4));
}

TEST_CASE("sensors see no graph") {
  PeopleView view(kTriangle), without("");
  CHECK(view.frame().items.size() == 1);
  CHECK(same_content(view.sensors.update(), without.sensors.update()));
}

TEST_CASE("mistakes in graph") {
  const auto error = [](const std::string& attributes) {
    return error_of([&] { PeopleView view(graph(attributes)); });
  };
  CHECK(contains(error(""), "s.xml:1:2: error: "));
  CHECK(contains(error(""), "nodes"));
  const std::string three = ", expected \"x y z\", three numbers of at most 1e15 either way (m)";
  CHECK(error("nodes='1 2 3, 4 5'") ==
        "s.xml:1:49: error: attribute \"nodes\", entry 1: \"4 5\" is not allowed" + three);
  CHECK(contains(error("nodes='1 2 3,'"), "entry 1: \"\" is not allowed" + three));
  CHECK(contains(error("nodes='1 2 inf'"), "entry 0: \"1 2 inf\" is not allowed" + three));
  CHECK(contains(error("nodes='1 2 -1e16'"), "entry 0: \"1 2 -1e16\" is not allowed" + three));
  const std::string two = ", expected \"A-B\", the numbers of two different nodes";
  const auto edges = [&](const std::string& text) { return error("nodes='0 0 0, 1 0 0' edges='" + text + "'"); };
  CHECK(edges("0-2") ==
        "s.xml:1:70: error: attribute \"edges\", entry 0: \"0-2\" is not allowed" + two + " from 0 to 1");
  for (const std::string wrong : {"0", "0-", "-1", "0-0", "0-1-0", "0--1", "a-b", "0 1", "0-99999999999999999999"}) {
    CHECK(contains(edges("0-1, " + wrong), "entry 1: \"" + wrong + "\" is not allowed" + two));
  }
  CHECK(contains(error("nodes='0 0 0' edges='0-1'"), two + ", but there is only one node"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
