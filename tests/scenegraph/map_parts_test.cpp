// Walls, heightmaps and ROS maps as parts: ranges against closed formulas, and what is refused.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/simulation.h>
#include "program/output/depth_png_file.h"
#include "program/output/exr_file.h"
#include "scenegraph/height_map.h"
#include "scenegraph/wall_mesh.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis {
namespace {

// Corners and ranges are float32: below 16 m each rounds by at most 4.8e-7 m. A corner's two coordinates and the range
// make three of these, and the slant of a beam that meets a side is below 10.
constexpr double kMapRange_m = 3 * 4.8e-7 * 10;

struct Rectangle {
  double x0, x1, y0, y1;
};

// The range of a beam from the origin to the nearest side of the rectangles; infinity if it meets none.
double range_to(std::vector<Rectangle> rectangles, double azimuth) {
  const double dx = std::cos(azimuth), dy = std::sin(azimuth);
  double nearest = std::numeric_limits<double>::infinity();
  for (const Rectangle& r : rectangles) {
    for (const double x : {r.x0, r.x1}) {
      const double range = x / dx;
      if (range > 0 && range * dy >= r.y0 && range * dy <= r.y1) nearest = std::min(nearest, range);
    }
    for (const double y : {r.y0, r.y1}) {
      const double range = y / dy;
      if (range > 0 && range * dx >= r.x0 && range * dx <= r.x1) nearest = std::min(nearest, range);
    }
  }
  return nearest;
}

Simulation scene_with(const std::string& commands, const std::filesystem::path& folder = ".") {
  return Simulation::from_string(commands, {}, folder);
}

std::string scanner_at(double z_m, const std::string& attributes = "samples='721' min_angle='-180' max_angle='180'") {
  return "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' pose_offset='0 0 " + std::to_string(z_m) +
         " 0 0 0' " + attributes + "/>";
}

// Returns how many beams hit something.
int check_ranges(Simulation& simulation, const std::vector<Rectangle>& rectangles) {
  simulation.step();
  const Scan& scan = simulation.scan("SCAN");
  int hits = 0;
  for (std::size_t i = 0; i < scan.beams; ++i) {
    const double expected = range_to(rectangles, scan.azimuth_rad[i]);
    CAPTURE(i);
    if (std::isinf(expected)) {
      CHECK(std::isinf(scan.range_m[i]));
    } else {
      CHECK(std::abs(scan.range_m[i] - expected) < kMapRange_m);
      ++hits;
    }
  }
  return hits;
}

double volume_of(const Mesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const auto at = [&](std::size_t k) { return glm::dvec3(mesh.positions[mesh.indices[i + k]]); };
    sum += glm::dot(at(0), glm::cross(at(1), at(2))) / 6;
  }
  return sum;
}

std::string refused_map(const std::string& attributes, const std::filesystem::path& folder = ".") {
  return error_of([&] { scene_with("<part name='A' insert_at='ROOT' " + attributes + "/>", folder); });
}

TEST_CASE("beams pass through doors and windows and meet the wall beside, above and below them") {
  const std::string wall =
      "<part name='WALL' insert_at='ROOT' shape='wall' points='3 -4.1, 3 4.3' height='2.5' thickness='0.2' "
      "doors='4.1 1.1 2' windows='6.6 0.9 1 1.1'/>";
  // Along the wall, y is the distance minus 4.1: the door reaches from -0.55 to 0.55 and up to 2 m, the window
  // from 2.05 to 2.95 and from 1 to 2.1 m.
  const Rectangle before_door{2.9, 3.1, -4.1, -0.55}, behind_window{2.9, 3.1, 2.95, 4.3};
  const std::vector<std::pair<double, std::vector<Rectangle>>> levels = {
      {0.5, {before_door, {2.9, 3.1, 0.55, 4.3}}},
      {1.5, {before_door, {2.9, 3.1, 0.55, 2.05}, behind_window}},
      {2.05, {{2.9, 3.1, -4.1, 2.05}, behind_window}},
      {2.2, {{2.9, 3.1, -4.1, 4.3}}},
      {2.6, {}}};
  for (const auto& [z_m, rectangles] : levels) {
    CAPTURE(z_m);
    Simulation simulation = scene_with(wall + scanner_at(z_m));
    CHECK((check_ranges(simulation, rectangles) > 100) == (z_m < 2.5));
  }
}

TEST_CASE("a closed wall surrounds a room, and its corners meet") {
  Simulation simulation = scene_with(
      "<part name='ROOM' insert_at='ROOT' shape='wall' points='-2 -1.5, 2 -1.5, 2 1.5, -2 1.5, -2 -1.5' height='2' "
      "thickness='0.2'/>" +
      scanner_at(1));
  CHECK(check_ranges(simulation, {{-1.9, 1.9, -1.4, 1.4}}) == 721);
}

TEST_CASE("the volume of a wall is length times thickness times height, without its openings") {
  const double kVolume = 1e-5;  // of about 10 m^3 with corners rounded to 2.4e-7 m
  WallPlan plan{{{0, 0}, {4, 0}, {4, 3}}, 2.5, 0.2, {}};
  CHECK(std::abs(volume_of(wall_mesh(plan)) - 7 * 0.2 * 2.5) < kVolume);
  plan.openings = {{1, 0.9, 0, 2}, {5.5, 1, 0.9, 1.2}};
  CHECK_FALSE(check_wall(plan));
  CHECK(std::abs(volume_of(wall_mesh(plan)) - 0.2 * (7 * 2.5 - 0.9 * 2 - 1 * 1.2)) < kVolume);
  plan.points = {{0, 0}, {4, 0}, {4, 3}, {0, 3}, {0, 0}};
  CHECK(std::abs(volume_of(wall_mesh(plan)) - 0.2 * (14 * 2.5 - 0.9 * 2 - 1 * 1.2)) < kVolume);
}

TEST_CASE("walls that cannot be built are refused at the attribute") {
  const std::string sizes = " height='2' thickness='0.2' ";
  CHECK(contains(refused_map("shape='wall' points='0 0, 1 0'"),
                 "a wall without attribute \"height\", expected points and "
                 "height and thickness"));
  CHECK(contains(refused_map("shape='wall' points='0 0'" + sizes),
                 "\"points\": \"0 0\" is not allowed, expected at least two"));
  CHECK(contains(refused_map("shape='wall' points='0 0, 1'" + sizes),
                 "\"points\": \" 1\" is not allowed, expected points x y"));
  CHECK(contains(refused_map("shape='wall' points='0 0, 1 0, 1 0'" + sizes), "point 3 is the one before it"));
  CHECK(contains(refused_map("shape='wall' points='0 0, 4 0, 0 0.1'" + sizes), "the corner at point 2 has 1.43"));
  CHECK(contains(refused_map("shape='wall' points='0 0, 4 0, 4 0.05, 0 0.05'" + sizes),
                 "points 2 and 3 are too near to each other for a wall of this thickness"));
  CHECK(contains(refused_map("shape='wall' points='0 0, 4 0' doors='3.8 1 2'" + sizes),
                 "attribute \"doors\": the opening at 3.8 m: it is not within one straight piece"));
  CHECK(contains(refused_map("shape='wall' points='0 0, 4 0' doors='2 1 2.1'" + sizes), "its upper edge is at 2.1 m"));
  CHECK(contains(refused_map("shape='wall' points='0 0, 4 0' doors='2 1 1' windows='1.2 0.8 1 0.5'" + sizes),
                 "\"windows\": the opening at 1.2 m: it overlaps or touches the one at 2 m"));
  CHECK(contains(refused_map("shape='wall' points='0 0, 4 0' doors='2 1'" + sizes),
                 "expected doors \"at width height\""));
  CHECK(contains(refused_map("shape='wall' points='0 0, 4 0' doors='2 0 1'" + sizes),
                 "expected a width of at least 1e-06 m"));
  CHECK(contains(refused_map("shape='box' size='1 1 1' points='0 0, 1 1'"), "\"points\": a box has none"));
}

// z = 2 + x / 2 over 4 m x 2 m, as a picture of 3 x 2 pixels whose values are metres.
Image slope_picture() { return {3, 2, 1, {1, 2, 3, 1, 2, 3}}; }

TEST_CASE("a heightmap has the heights of its picture, from PNG and from EXR") {
  const TemporaryFolder folder;
  const Image slope = slope_picture();
  write_text(folder / "slope.png", encode_depth_png(slope, 0.001));  // a code is a millimetre
  write_text(folder / "slope.exr", encode_exr(nullptr, &slope, {}));
  // The scanner looks down from z = 10; its beams lie in the plane of x and z.
  const std::string scanner =
      "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='21' min_angle='-10' "
      "max_angle='10' pose_offset='0 0 10 0 90 90'/>";
  for (const std::string picture : {"heights='slope.png' z_range='0 65.535'", "heights='slope.exr'"}) {
    CAPTURE(picture);
    Simulation simulation = scene_with(
        "<part name='MAP' insert_at='ROOT' shape='heightmap' size='4 2' " + picture + "/>" + scanner, folder.path());
    simulation.step();
    const Scan& scan = simulation.scan("SCAN");
    const std::vector<glm::dvec3> points = scan.world_points();
    int hits = 0;
    for (std::size_t i = 0; i < scan.beams; ++i) {
      const double a = scan.azimuth_rad[i];
      CAPTURE(i);
      // The beam goes along (-sin a, 0, -cos a), and z = 2 + x / 2 is the slope.
      CHECK(std::abs(scan.range_m[i] - 8 / (std::cos(a) - 0.5 * std::sin(a))) < kMapRange_m);
      CHECK(std::abs(points[i].z - (2 + points[i].x / 2)) < kMapRange_m);
      ++hits;
    }
    CHECK(hits == 21);
  }
}

TEST_CASE("heights of 16 bits are not rounded before they are used") {
  constexpr double kBound_m = 1e-6;  // of a range of 1 m; values rounded to float32 put the surface up to 2.6e-4 m off
  const TemporaryFolder folder;
  for (const float code : {1.0f, 12345.0f, 40000.0f, 54321.0f, 65534.0f}) {
    CAPTURE(code);
    const Image flat{2, 2, 1, {code, code, code, code}};
    write_text(folder / "flat.png", encode_depth_png(flat, 1));
    const double above_m = 8848 * static_cast<double>(code) / 65535 + 1;
    Simulation simulation = scene_with(
        "<part name='MAP' insert_at='ROOT' shape='heightmap' size='4 2' heights='flat.png' z_range='0 8848'/>"
        "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='1' min_angle='0' max_angle='0' "
        "pose_offset='0.3 0.2 " +
            format_number(above_m) + " 0 90 0'/>",
        folder.path());
    simulation.step();
    const Scan& scan = simulation.scan("SCAN");
    CHECK(std::abs(scan.range_m[0] - 1) <= scan.error_bound_m[0]);
    CHECK(scan.error_bound_m[0] < kBound_m);
  }
}

TEST_CASE("the left column of a heightmap is at -x, its top row at +y, and its outer pixels are at the edges") {
  const Mesh mesh = mesh_in_place(height_map({3, 2, {9, 0, 0, 0, 0, 0}}, {4, 2}, 1, 2));
  REQUIRE(mesh.positions.size() == 6);
  CHECK(mesh.indices.size() == 12);
  CHECK(mesh.positions.front() == glm::vec3(-2, 1, 10));
  CHECK(mesh.positions.back() == glm::vec3(2, -1, 1));
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const auto at = [&](std::size_t k) { return glm::dvec3(mesh.positions[mesh.indices[i + k]]); };
    CHECK(glm::cross(at(1) - at(0), at(2) - at(0)).z > 0);
  }
}

TEST_CASE("pictures of heights that cannot be read are refused at the attribute") {
  const TemporaryFolder folder;
  write_text(folder / "a.png", "\x89PNG\r\n\x1a\n");
  write_text(folder / "a.txt", "0 1");
  write_text(folder / "one.png", encode_depth_png({1, 2, 1, {1, 1}}, 0.001));
  const auto map = [&](const std::string& attributes) {
    return refused_map("shape='heightmap' size='1 1' " + attributes, folder.path());
  };
  CHECK(contains(map("heights='no.png'"), "\"heights\": there is no picture"));
  CHECK(contains(map("heights='a.png'"), "a.png: the picture of heights has a broken header"));
  CHECK(contains(map("heights='a.txt'"), "is of another kind, expected PNG or EXR"));
  CHECK(contains(map("heights='one.png'"), "has 1 x 2 pixels, expected from 2 to 4097 on a side"));
  CHECK(contains(map("heights='one.png' z_range='0'"), "\"z_range\": \"0\" is not allowed, expected two numbers"));
}

// A room of 8 x 4 cells whose border is occupied; the rows of the picture begin at the top.
std::string room_picture(unsigned char occupied, unsigned char free) {
  std::string pixels;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 8; ++column) {
      const bool border = row == 0 || row == 3 || column == 0 || column == 7;
      pixels += static_cast<char>(border ? occupied : free);
    }
  }
  return "P5\n8 4\n255\n" + pixels;
}

const std::string kRoomMap =
    "image: room.pgm\nresolution: 0.5 # m\norigin: [-2.0, -1.0, 0.0]\nnegate: 0\n"
    "occupied_thresh: 0.65\nfree_thresh: 0.196\n";
const std::string kMapPart = "<part name='MAP' insert_at='ROOT' file='room.yaml'/>";

TEST_CASE("the occupied cells of a ROS map are walls, unknown and free ones are not") {
  const TemporaryFolder folder;
  write_text(folder / "room.yaml", kRoomMap);
  for (const unsigned char free : {254, 205}) {
    write_text(folder / "room.pgm", room_picture(0, free));
    Simulation simulation = scene_with(kMapPart + scanner_at(1), folder.path());
    CHECK(check_ranges(simulation, {{-1.5, 1.5, -0.5, 0.5}}) == 721);
    // Four sides within and four around, and four rectangles each on top and below.
    CHECK(simulation.diagnostics().draw_list().meshes.at(0)->indices.size() == 3 * 2 * 16);
  }
  Simulation above = scene_with(kMapPart + scanner_at(2.6), folder.path());
  CHECK(check_ranges(above, {}) == 0);
  Simulation higher = scene_with(
      "<part name='MAP' insert_at='ROOT' file='room.yaml' wall_height='3'/>" + scanner_at(2.6), folder.path());
  CHECK(check_ranges(higher, {{-1.5, 1.5, -0.5, 0.5}}) == 721);
}

TEST_CASE("a ROS map may be turned, inverted and quoted") {
  const TemporaryFolder folder;
  write_text(folder / "room.pgm", room_picture(255, 0));
  write_text(folder / "room.yaml",
             "image: \"room.pgm\"\nresolution: 0.5\norigin: [1, -2, 1.5707963267948966]\n"
             "negate: 1\nmode: trinary\n");
  Simulation simulation = scene_with(kMapPart + scanner_at(1), folder.path());
  CHECK(check_ranges(simulation, {{-0.5, 0.5, -1.5, 1.5}}) == 721);
}

TEST_CASE("the origin of a ROS map may be a list of lines") {
  const TemporaryFolder folder;
  write_text(folder / "room.pgm", room_picture(0, 254));
  write_text(folder / "room.yaml",
             "image: room.pgm\nresolution: 0.5\norigin:\n- -2.0\n  - -1.0 # m\n- 0.0\nnegate: 0\n");
  Simulation simulation = scene_with(kMapPart + scanner_at(1), folder.path());
  CHECK(check_ranges(simulation, {{-1.5, 1.5, -0.5, 0.5}}) == 721);
}

TEST_CASE("maps that are incomplete or empty are refused with their place") {
  const TemporaryFolder folder;
  write_text(folder / "room.pgm", room_picture(254, 254));
  const auto map = [&](const std::string& text) {
    write_text(folder / "room.yaml", text);
    return error_of([&] { scene_with(kMapPart, folder.path()); });
  };
  CHECK(contains(map(kRoomMap), "has no occupied cell"));
  CHECK(contains(map("image: room.pgm\norigin: [0, 0, 0]\n"), "has no key \"resolution\""));
  CHECK(
      contains(map("image: room.pgm\nresolution: 0\norigin: [0, 0, 0]\n"), "room.yaml:2:1: key \"resolution\": \"0\""));
  CHECK(contains(map("image: room.pgm\nresolution: 1\norigin: [0, 0]\n"), "room.yaml:3:1: key \"origin\": \"[0, 0]\""));
  CHECK(contains(map("image: no.pgm\nresolution: 1\norigin: [0, 0, 0]\n"), "room.yaml:1:1: key \"image\": "));
  CHECK(contains(map("resolution: 1\norigin: [0, 0, 0]\n"), "has no key \"image\""));
  CHECK(contains(refused_map("shape='box' size='1 1 1' wall_height='2'"), "it says how a file is read"));
}

}  // namespace
}  // namespace simvis
