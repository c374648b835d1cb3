// The element `point_cloud`: points from files and scanners, and which sensors see them.
#include "elements/visualization/point_cloud.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <optional>

#include <simvis/pose.h>
#include "tests/support/error_of.h"
#include "tests/support/made_up_scan.h"
#include "tests/support/people_view.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("elements");

namespace simvis {
namespace {

constexpr std::string_view kCloudScanner = "<sensor type='laser_scanner' name='S' insert_at='ROOT'/>";

std::string cloud(const std::string& attributes) {
  return "<element type='point_cloud' name='E' insert_at='ROOT' " + attributes + "/>";
}

// A scene with a file of points.
struct FileCloud {
  TemporaryFolder folder;
  std::optional<PeopleView> view;
  FileCloud(const std::string& text, const std::string& attributes = "", const std::string& before = "") {
    write_text(folder / "points.csv", text);
    view.emplace(before + cloud("file='points.csv' " + attributes), folder.path());
  }
  std::vector<SeenMarker> points() {
    const DrawList& list = view->frame();
    REQUIRE(list.items.size() == 1);
    return markers_in(list, list.items[0]);
  }
  std::vector<SeenMarker> points_with(std::string_view parameter, double value) {
    view->frame_with("E", parameter, value);
    return points();
  }
};

TEST_CASE("points from a file have coordinates of the frame at the insertion point") {
  FileCloud cloud("1 2 3\n-4,5.5, 6\n", "size='0.25'");
  std::vector<SeenMarker> seen = cloud.points();
  REQUIRE(seen.size() == 2);
  CHECK(glm::distance(seen[0].center(), {1, 2, 3}) < corner_tolerance_m(8, 8));
  CHECK(glm::distance(seen[1].center(), {-4, 5.5, 6}) < corner_tolerance_m(8, 8));
  CHECK(std::abs(seen[0].size() - 0.25) < 2 * corner_tolerance_m(8, 8));

  // Far from the origin in the file and in the scene.
  FileCloud moved("1e7 0 0\n10000001.5 2 3\n", "", "<element type='pose' name='P' insert_at='ROOT' y='1e7' yaw='90'/>");
  seen = moved.points();
  CHECK(glm::distance(seen[0].center(), {0, 2e7, 0}) < corner_tolerance_m(4, 4e7));
  CHECK(glm::distance(seen[1].center(), {-2, 20000001.5, 3}) < corner_tolerance_m(4, 4e7));
}

TEST_CASE("formats of a file with points") {
  const auto count = [](const std::string& text) { return FileCloud(text).points().size(); };
  CHECK(count("1 2 3") == 1);
  CHECK(count("\xef\xbb\xbfx,y,z\r\n1,2,3\r\n\r\n4,5,6\r\n") == 2);
  CHECK(count("# a comment, and another\n\nx y z r g b\n\t1 , 2 , 3 , 0 , 0 , 0 \n") == 1);
  CHECK(count("1e-3\t-2.5E+2\t3\n4\t5\t6\n7\t8\t9") == 3);

  TemporaryFolder folder;
  write_text(folder / "points.xyz", "1 2 3\n");
  PeopleView view(cloud("file='points.xyz'"), folder.path());
  CHECK(markers_in(view.frame(), view.frame().items.at(0)).size() == 1);
}

TEST_CASE("colours in a file are those of pictures") {
  FileCloud cloud("0 0 0 255 0 128\n0 0 1 10 11 12\n");
  const std::vector<SeenMarker> seen = cloud.points();
  CHECK(seen[0].color.r == 1);
  CHECK(seen[0].color.g == 0);
  // Back to bytes by the formula of sRGB. float32 is a thousand times finer.
  const auto byte = [](float linear) {
    return std::lround(255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055));
  };
  CHECK(byte(seen[0].color.b) == 128);
  CHECK(byte(seen[1].color.r) == 10);
  CHECK(byte(seen[1].color.g) == 11);
  CHECK(byte(seen[1].color.b) == 12);
  CHECK(cloud.points_with("red", 0.5)[0].color == seen[0].color);
}

TEST_CASE("each parameter of point_cloud") {
  FileCloud cloud("0 0 0\n0 0 1\n0 0 2\n");
  CHECK(cloud.points().size() == 3);
  CHECK(cloud.points_with("count", 2.9).size() == 2);
  CHECK(cloud.points_with("count", 0).empty());
  CHECK(cloud.points_with("count", 1).size() == 1);
  CHECK(std::abs(cloud.points_with("size", 0.5)[0].size() - 0.5) < 2 * corner_tolerance_m(1));
  cloud.points_with("red", 0.125);
  cloud.points_with("green", 0.25);
  CHECK(cloud.points_with("blue", 0.5)[0].color == glm::vec4(0.125f, 0.25f, 0.5f, 1));
  CHECK(cloud.points_with("size", 0).empty());
}

TEST_CASE("sensors see no points") {
  FileCloud file("0 0 0\n");
  CHECK(file.points().size() == 1);
  PeopleView without("");
  CHECK(same_content(file.view->sensors.update(), without.sensors.update()));
  PeopleView scanned(cloud("scanner='S'") + std::string(kCloudScanner)), bare(kCloudScanner);
  CHECK(same_content(scanned.sensors.update(), bare.sensors.update()));
}

TEST_CASE("points without an observer have no mesh") {
  FileCloud cloud("0 0 0\n");
  CHECK(cloud.view->people.update().meshes.at(0)->positions.empty());
  CHECK(cloud.points().size() == 1);
}

// The element observes a scanner; scan number k reads k, 2 k and nothing, from x = 10^7 k.
struct ScanCloud : PeopleView {
  Scan measured;
  explicit ScanCloud(const std::string& attributes = "")
      : PeopleView(cloud("scanner='S' " + attributes) + std::string(kCloudScanner)) {
    scans["S"] = {};
  }
  const DrawList& measure(std::uint64_t k) {
    measured = test::scan_of_numbers(
        {0, 0.5, 1}, {0.25},
        {static_cast<float>(k), static_cast<float>(2 * k), std::numeric_limits<float>::infinity()});
    scans["S"] = {&measured, moved_to(1e7 * static_cast<double>(k), 0, 0), k};
    return frame();
  }
};

// Checks that item `item` shows scan k.
void check_scan(const DrawList& list, std::size_t item, double k) {
  CAPTURE(k);
  const std::vector<SeenMarker> seen = markers_in(list, list.items.at(item));
  REQUIRE(seen.size() == 2);
  for (std::size_t i = 0; i < 2; ++i) {
    const double range_m = i == 0 ? k : 2 * k, a = i == 0 ? 0 : 0.5, e = 0.25;
    const glm::dvec3 expected(1e7 * k + range_m * std::cos(e) * std::cos(a), range_m * std::cos(e) * std::sin(a),
                              range_m * std::sin(e));
    CHECK(glm::distance(seen[i].center(), expected) < corner_tolerance_m(2 * k + 1, 1e7 * k));
  }
}

TEST_CASE("the latest hits of a scanner are shown where they were measured") {
  ScanCloud cloud;
  CHECK(cloud.frame().items.empty());
  CHECK(cloud.measure(1).items.size() == 1);
  check_scan(cloud.frame(), 0, 1);
  const FlattenCounters before = cloud.people.counters();
  check_scan(cloud.frame(), 0, 1);
  CHECK(cloud.people.counters() == before);
  CHECK(cloud.measure(2).items.size() == 1);
  check_scan(cloud.frame(), 0, 2);
  cloud.measure(3);
  const std::uint64_t rebuilds = cloud.people.counters().rebuilds;
  check_scan(cloud.measure(4), 0, 4);
  CHECK(cloud.people.counters().rebuilds == rebuilds);
}

TEST_CASE("the given number of scans is shown") {
  ScanCloud cloud("keep='3'");
  for (std::uint64_t k = 1; k <= 3; ++k) CHECK(cloud.measure(k).items.size() == k);
  const DrawList& list = cloud.measure(4);  // its points reuse the nodes of the oldest
  REQUIRE(list.items.size() == 3);
  check_scan(list, 0, 4);
  check_scan(list, 1, 2);
  check_scan(list, 2, 3);
  CHECK(cloud.frame_with("E", "keep", 2.5).items.size() == 2);
  check_scan(cloud.frame(), 0, 4);
  check_scan(cloud.frame(), 1, 3);
  cloud.measure(5);
  check_scan(cloud.frame(), 0, 4);
  check_scan(cloud.frame(), 1, 5);
  cloud.frame_with("E", "keep", 4);
  CHECK(cloud.measure(6).items.size() == 3);
  // Each parameter also applies to earlier scans.
  cloud.frame_with("E", "red", 1);
  for (const DrawItem& item : cloud.frame().items) CHECK(markers_in(cloud.frame(), item)[0].color.r == 1);
  cloud.frame_with("E", "count", 1);
  for (const DrawItem& item : cloud.frame().items) CHECK(markers_in(cloud.frame(), item).size() == 1);
}

TEST_CASE("mistakes in a file of points") {
  TemporaryFolder folder;
  const std::string file = (folder / "points.csv").string();
  const auto error = [&](const std::string& text) {
    write_text(folder / "points.csv", text);
    return error_of([&] { PeopleView view(cloud("file='points.csv'"), folder.path()); });
  };
  const std::string expected = ", expected \"x y z\" or \"x y z r g b\", metres and colours from 0 to 255";
  CHECK(error("") == file + ": error: the file has no points" + expected);
  CHECK(error("x,y,z\n# 1 2 3\n") == file + ": error: the file has no points" + expected);
  CHECK(error("1 2 3\n4 5\n") == file + ":2:1: error: 2 values in a line" + expected);
  CHECK(error("1 2 3 4") == file + ":1:1: error: 4 values in a line" + expected);
  CHECK(error("1 2 3\n4,five,6\n") ==
        file + ":2:3: error: \"five\" is not allowed, expected a number from -1e+15 to 1e+15");
  CHECK(error("1 2 nan\n") == file + ":1:5: error: \"nan\" is not allowed, expected a number from -1e+15 to 1e+15");
  CHECK(contains(error("1 -1e16 3\n"), file + ":1:3: error: \"-1e16\" is not allowed"));
  CHECK(error("1 2 3 0 256 0\n") == file + ":1:9: error: \"256\" is not allowed, expected a number from 0 to 255");
  CHECK(error("1 2 3\n1 2 3 4 5 6\n") ==
        file + ":2:1: error: a point with a colour after points without one, expected each to have one or none");
  CHECK(error("1 2 3 4 5 6\n1 2 3\n") ==
        file + ":2:1: error: a point without a colour after points with one, expected each to have one or none");
  CHECK(contains(error("1 2 3\nx,y,z\n"), file + ":2:1: error: \"x\" is not allowed"));
  CHECK(contains(error("1 2 3\n1 2 \xff\n"), file + ":2:5: error: byte 0xff is not allowed in UTF-8"));
}

TEST_CASE("mistakes in point_cloud") {
  TemporaryFolder folder;
  write_text(folder / "points.ply", "");
  std::filesystem::create_directory(folder / "folder.csv");
  const auto error = [&](const std::string& attributes) {
    return error_of([&] { PeopleView view(cloud(attributes) + std::string(kCloudScanner), folder.path()); });
  };
  const std::string either = "s.xml:1:2: error: expected exactly one of the attributes \"file\" and \"scanner\"";
  CHECK(error("") == either);
  CHECK(error("file='a.csv' scanner='S'") == either);
  CHECK(error("file='a.csv'") == "s.xml:1:55: error: there is no point file \"" + (folder / "a.csv").string() + "\"");
  CHECK(contains(error("file='folder.csv'"), "s.xml:1:55: error: there is no point file "));
  CHECK(contains(error("file='points.ply'"), "is of an unknown kind, expected one of: .csv, .xyz"));
  CHECK(contains(error("scanner='T'"), "there is no sensor \"T\" that gives scans"));
  CHECK(contains(error("scanner='S' keep='0'"), "attribute \"keep\": 0 is not allowed"));
  CHECK(contains(error("scanner='S' count='-1'"), "attribute \"count\": -1 is not allowed"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
