// The element `laser_beams`: the places of its beams and hits, and which sensors see it.
#include "elements/visualization/laser_beams.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include <simvis/pose.h>
#include "tests/support/error_of.h"
#include "tests/support/infinity.h"
#include "tests/support/made_up_scan.h"
#include "tests/support/people_view.h"
#include "tests/support/reference_directions.h"

TEST_SUITE_BEGIN("elements");

namespace simvis {
namespace {

constexpr std::string_view kBeamScanner = "<sensor type='laser_scanner' name='S' insert_at='ROOT'/>";

std::string beams(const std::string& attributes) {
  return "<element type='laser_beams' name='E' insert_at='ROOT' scanner='S' " + attributes + "/>";
}

// Two rings of four beams. In the lower ring one beam hits nothing and one is blocked.
Scan some_scan() {
  return test::scan_of_numbers({-1, 0, 0.5, std::numbers::pi}, {-0.25, 0.5}, {1, 2, kInfinity, 0, 5, 6, 7, 8});
}

glm::dvec3 end_of(const Scan& scan, std::size_t ring, std::size_t beam, double length_m) {
  const double a = scan.azimuth_rad[beam], e = scan.elevation_rad[ring];
  return length_m * reference::beam_direction(a, e);
}

struct Beams : PeopleView {
  Scan measured = some_scan();
  explicit Beams(const std::string& attributes = "") : PeopleView(beams(attributes) + std::string(kBeamScanner)) {
    scans["S"] = {&measured, glm::dmat4(1), 1};
  }
  std::vector<SeenMarker> markers() {
    const DrawList& list = frame();
    REQUIRE(list.items.size() == 1);
    return markers_in(list, list.items[0]);
  }
  std::vector<SeenMarker> markers_with(std::string_view parameter, double value) {
    frame_with("E", parameter, value);
    return markers();
  }
};

TEST_CASE("each beam with a hit is a line from the scanner to its hit for every pose of the scanner") {
  // The second pose is far from the origin and rotated about all axes.
  for (const glm::dmat4& world_from_sensor : {glm::dmat4(1), matrix_from_degrees({1e7, -2e7, 100}, 20, -30, 130)}) {
    Beams view("width='0.02' size='0.1'");
    view.scans["S"].world_from_sensor = world_from_sensor;
    const std::vector<SeenMarker> seen = view.markers();
    REQUIRE(seen.size() == 12);
    const double tolerance_m = corner_tolerance_m(8.1, 3e7);
    const glm::dvec3 origin = world_from_sensor[3];
    for (std::size_t i = 0, hit = 0; i < 8; ++i) {
      const double range_m = view.measured.range_m[i];
      if (range_m == 0 || std::isinf(range_m)) continue;
      const glm::dvec3 expected = world_from_sensor * glm::dvec4(end_of(view.measured, i / 4, i % 4, range_m), 1);
      CHECK(glm::distance(seen[hit].from(), origin) < tolerance_m);
      CHECK(glm::distance(seen[hit].to(), expected) < tolerance_m);
      CHECK(std::abs(seen[hit].width() - 0.02) < 2 * tolerance_m);
      CHECK(glm::distance(seen[6 + hit].center(), expected) < tolerance_m);
      CHECK(std::abs(seen[6 + hit].size() - 0.1) < 2 * tolerance_m);
      ++hit;
    }
  }
}

TEST_CASE("each parameter of laser_beams") {
  Beams view;
  CHECK(view.markers().size() == 12);
  CHECK(view.markers_with("width", 0).size() == 6);
  CHECK(view.markers_with("size", 0).empty());
  CHECK(std::abs(view.markers_with("width", 0.5)[0].width() - 0.5) < 2 * corner_tolerance_m(2));
  const double size_m = view.markers_with("size", 0.25)[6].size();
  CHECK(std::abs(size_m - 0.25) < 2 * corner_tolerance_m(2));

  const std::vector<SeenMarker> thinned = view.markers_with("every", 2.9);  // beams 0 and 2; one of them misses
  REQUIRE(thinned.size() == 6);
  CHECK(glm::distance(thinned[2].to(), end_of(view.measured, 1, 2, 7)) < corner_tolerance_m(8));
  CHECK(view.markers_with("every", 1000).size() == 4);
  view.markers_with("every", 1);

  const std::vector<SeenMarker> missing = view.markers_with("miss_length", 40);
  REQUIRE(missing.size() == 13);  // one more line, no more hits; the blocked beam is no miss
  CHECK(glm::distance(missing[2].to(), end_of(view.measured, 0, 2, 40)) < corner_tolerance_m(41));

  view.markers_with("red", 0.125);
  view.markers_with("green", 0.25);
  view.markers_with("blue", 0.5);
  std::vector<SeenMarker> colored = view.markers_with("opacity", 0.75);
  CHECK(colored[0].color == glm::vec4(0.125f, 0.25f, 0.5f, 0.75f));
  CHECK(colored[12].color == glm::vec4(0.125f, 0.25f, 0.5f, 1));
  const auto material = [&] { return *view.people.update().materials.at(view.people.update().items[0].material); };
  CHECK(material().alpha_mode == AlphaMode::blend);
  CHECK(material().unlit);
  CHECK(material().base_color == glm::vec4(1));
  colored = view.markers_with("opacity", 1);
  CHECK(colored[0].color.a == 1);
  CHECK(material().alpha_mode == AlphaMode::opaque);
}

TEST_CASE("beams are redrawn for a new scan, and only then") {
  Beams view;
  view.scans["S"] = {};
  CHECK(view.markers().empty());  // nothing measured yet
  view.scans["S"] = {&view.measured, moved_to(1, 0, 0), 1};
  CHECK(view.markers().size() == 12);
  const FlattenCounters before = view.people.counters();
  std::ranges::fill(view.measured.edit_ranges().range_m, 3.0f);
  view.scans["S"].world_from_sensor = moved_to(2, 0, 0);
  CHECK(glm::distance(view.markers()[0].from(), {1, 0, 0}) < corner_tolerance_m(2));
  CHECK(view.people.counters() == before);
  view.scans["S"].count = 2;
  const std::vector<SeenMarker> seen = view.markers();
  CHECK(seen.size() == 16);
  CHECK(glm::distance(seen[0].from(), {2, 0, 0}) < corner_tolerance_m(2));
  CHECK(view.people.counters().rebuilds == before.rebuilds);
  CHECK(view.people.counters().meshes_written == before.meshes_written + 1);
}

TEST_CASE("sensors see no beams") {
  Beams view;
  view.frame();
  PeopleView without(kBeamScanner);
  CHECK(same_content(view.sensors.update(), without.sensors.update()));
  CHECK_FALSE(same_content(view.people.update(), without.people.update()));
}

TEST_CASE("beams have world coordinates, independent of their insertion point") {
  PeopleView view("<element type='pose' name='P' insert_at='ROOT' x='5'/>" + beams("") + std::string(kBeamScanner));
  const Scan measured = some_scan();
  view.scans["S"] = {&measured, moved_to(1, 0, 0), 1};
  const DrawList& list = view.frame();
  REQUIRE(list.items.size() == 1);
  CHECK(glm::distance(markers_in(list, list.items[0])[0].from(), {1, 0, 0}) < corner_tolerance_m(2));
  CHECK(view.built.scene.find_node("E") != nullptr);
}

TEST_CASE("mistakes in laser_beams") {
  const auto error = [](const std::string& commands) { return error_of([&] { PeopleView view(commands); }); };
  CHECK(contains(error("<element type='laser_beams' name='E' insert_at='ROOT'/>"), "s.xml:1:2: error: "));
  CHECK(contains(error("<element type='laser_beams' name='E' insert_at='ROOT'/>"), "scanner"));
  CHECK(contains(error(beams("")), "there is no sensor \"S\" that gives scans"));
  CHECK(
      contains(error("<element type='laser_beams' name='E' insert_at='ROOF' scanner='S'/>" + std::string(kBeamScanner)),
               "s.xml:1:38: error: there is no insertion point \"ROOF\""));
  CHECK(contains(error(beams("every='0.5'") + std::string(kBeamScanner)), "attribute \"every\": 0.5 is not allowed"));
  CHECK(contains(error(beams("width='-1'") + std::string(kBeamScanner)), "attribute \"width\": -1 is not allowed"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
