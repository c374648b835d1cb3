// The bytes of map files, and the same cells when they are read back as parts.
#include "program/maps/map_files.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "program/maps/octomap_file.h"
#include "simvis/built_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("maps");

namespace simvis {
namespace {

constexpr CellState kOccupied = CellState::occupied, kFree = CellState::free, kUnknown = CellState::unknown;

SceneCells map_of(const glm::ivec3& first, const glm::uvec3& size, double resolution_m, CellState state) {
  SceneCells map{.resolution_m = resolution_m, .first = first, .size = size};
  map.origin_m = glm::dvec3(first) * resolution_m;
  map.cell_m = glm::dvec3(resolution_m);
  map.states.assign(std::size_t{size.x} * size.y * size.z, state);
  return map;
}

std::string tree_of(const SceneCells& map) {
  const std::string bytes = encode_octomap(map);
  return bytes.substr(bytes.find("data\n") + 5);
}

std::string bytes_of(std::initializer_list<int> numbers) {
  std::string bytes;
  for (const int number : numbers) bytes += static_cast<char>(number);
  return bytes;
}

std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

TEST_CASE("a ROS map has the names, numbers and shades of map_saver") {
  SceneCells map = map_of({-3, 2, 0}, {3, 2, 1}, 0.05, kFree);
  map.states[map.index({0, 0, 0})] = kOccupied;
  map.states[map.index({2, 1, 0})] = kUnknown;
  const std::vector<MapFileBytes> files = encode_map(map, "out/a \"b.yaml", MapFormat::ros_map);
  REQUIRE(files.size() == 2);
  CHECK(files[0].file == "out/a \"b.pgm");
  CHECK(files[0].bytes == "P5\n3 2\n255\n" + bytes_of({254, 254, 205, 0, 254, 254}));
  CHECK(files[1].file == "out/a \"b.yaml");
  CHECK(files[1].bytes ==
        "image: 'a \"b.pgm'\nmode: trinary\nresolution: 0.05\norigin: [-0.15000000000000002, 0.1, 0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n");
}

// YAML 1.1 reads 1e-04 as a text.
TEST_CASE("numbers of a ROS map are floats of YAML 1.1") {
  const std::vector<MapFileBytes> files =
      encode_map(map_of({-1, 3, 0}, {1, 1, 1}, 0.0001, kFree), "a.yaml", MapFormat::ros_map);
  REQUIRE(files.size() == 2);
  CHECK(contains(files[1].bytes, "resolution: 1.0e-04\norigin: [-1.0e-04, "));
}

TEST_CASE("an OctoMap has the header and the nodes of OctoMap") {
  // The cell at the origin is the upper half of the root along all axes, and the lower half of all other nodes.
  const std::string bytes = encode_octomap(map_of({0, 0, 0}, {1, 1, 1}, 0.1, kOccupied));
  CHECK(bytes ==
        "# Octomap OcTree binary file\n# (feel free to add / change comments, but leave the first line as it is!)\n#\n"
        "id OcTree\nsize 17\nres 0.1\ndata\n" +
            bytes_of({0x00, 0xc0}) + repeated(bytes_of({0x03, 0x00}), 14) + bytes_of({0x02, 0x00}));
  // The cell (-1, 0, 2) is in the lower half along x and the upper half along y and z: child 6 of the root. Below, x is
  // in the upper half always, y in the lower half, and z in the upper half at depth 15, where 2 has its bit.
  const std::string other = tree_of(map_of({-1, 0, 2}, {1, 1, 1}, 0.1, kFree));
  CHECK(other == bytes_of({0x00, 0x30}) + repeated(bytes_of({0x0c, 0x00}), 13) + bytes_of({0x00, 0x0c}) +
                     bytes_of({0x04, 0x00}));
}

TEST_CASE("eight equal cells of an OctoMap are one leaf, and unknown ones none") {
  CHECK(tree_of(map_of({0, 0, 0}, {2, 2, 2}, 0.1, kOccupied)) ==
        bytes_of({0x00, 0xc0}) + repeated(bytes_of({0x03, 0x00}), 13) + bytes_of({0x02, 0x00}));
  CHECK(contains(encode_octomap(map_of({0, 0, 0}, {4, 4, 4}, 0.1, kFree)), "size 15\n"));
  SceneCells map = map_of({0, 0, 0}, {2, 2, 2}, 0.1, kUnknown);
  map.states[map.index({1, 0, 0})] = kFree;
  map.states[map.index({0, 1, 1})] = kOccupied;
  // Child 1 free, child 6 occupied.
  CHECK(tree_of(map) == bytes_of({0x00, 0xc0}) + repeated(bytes_of({0x03, 0x00}), 14) + bytes_of({0x04, 0x20}));
  CHECK(contains(encode_octomap(map), "size 18\n"));
  CHECK(tree_of(map_of({0, 0, 0}, {2, 2, 2}, 0.1, kUnknown)) == bytes_of({0, 0}));
}

TEST_CASE("an OctoMap refuses cells that its keys do not reach") {
  encode_octomap(map_of({32767, -32768, 0}, {1, 1, 1}, 0.1, kOccupied));
  for (const glm::ivec3& first : {glm::ivec3(32768, 0, 0), {0, -32769, 0}, {0, 0, 40000}}) {
    CHECK(contains(error_of([&] {
                     encode_octomap(map_of(first, {1, 1, 1}, 0.1, kOccupied));
                   }),
                   "farther than 32768 cells from the origin"));
  }
}

// The map of a scene with the one part, in the area and heights of `like`.
SceneCells map_again(const std::filesystem::path& file, const SceneCells& like, bool is_flat,
                     const std::string& attributes = "") {
  Simulation simulation = Simulation::from_string(
      "<part name='MAP' insert_at='ROOT' file='" + file.filename().string() + "'" + attributes + "/>", {},
      file.parent_path());
  read_all_content(simulation);
  simulation.step();
  const glm::dvec3 end = like.origin_m + glm::dvec3(like.size) * like.cell_m;
  const MapDesc desc{.resolution_m = like.resolution_m,
                     .is_flat = is_flat,
                     .heights_m = {{is_flat ? 0.1 : like.origin_m.z, is_flat ? 1 : end.z}},
                     .area_m = {{glm::dvec2(like.origin_m), glm::dvec2(end)}}};
  return map_scene(simulation.diagnostics().draw_list(), {}, desc);
}

void check_round_trip(const SceneCells& map, MapFormat format, const std::string& name) {
  const TemporaryFolder folder;
  for (const MapFileBytes& each : encode_map(map, folder / name, format)) write_text(each.file, each.bytes);
  const SceneCells again = map_again(folder / name, map, format == MapFormat::ros_map);
  CHECK(again.first == map.first);
  CHECK(again.size == map.size);
  CHECK(again.states == map.states);
}

// Half of all cells and of a solid block, whose inner cells have occupied ones around them.
SceneCells noisy_map(const glm::ivec3& first, const glm::uvec3& size, double resolution_m) {
  SceneCells map = map_of(first, size, resolution_m, kFree);
  std::mt19937_64 random(size.x);
  for (std::uint32_t z = 0; z < size.z; ++z) {
    for (std::uint32_t y = 0; y < size.y; ++y) {
      for (std::uint32_t x = 0; x < size.x; ++x) {
        const bool is_solid = x > 3 && x + 4 < size.x && y > 2 && y < 10 && (size.z == 1 || (z > 1 && z < 8));
        if (is_solid || random() % 3 == 0) map.states[map.index({x, y, z})] = kOccupied;
      }
    }
  }
  return map;
}

TEST_CASE("maps give the same cells when they are read back as parts") {
  for (const double resolution_m : {0.05, 0.1, 0.25, 0.3}) {
    CAPTURE(resolution_m);
    for (const glm::ivec3& first : {glm::ivec3(0), {-31, 17, -5}, {10007, -20011, 303}}) {
      CAPTURE(first.x);
      SceneCells flat = noisy_map({first.x, first.y, 0}, {150, 30, 1}, resolution_m);
      check_round_trip(flat, MapFormat::ros_map, "map.yaml");
      const SceneCells voxels = noisy_map(first, {70, 13, 11}, resolution_m);
      check_round_trip(voxels, MapFormat::voxels, "map.npz");
      check_round_trip(voxels, MapFormat::octomap, "map.bt");
    }
  }
}

TEST_CASE("the picture of a ROS map is found by any name") {
  for (const std::string name : {"it's", "a \"b\"", "back\\slash", "two\nlines of \"it's\" \\", "# 1: x"}) {
    CAPTURE(name);
    const TemporaryFolder folder;
    const SceneCells map = map_of({2, 1, 0}, {3, 2, 1}, 1, kOccupied);
    const std::vector<MapFileBytes> files = encode_map(map, folder / (name + ".yaml"), MapFormat::ros_map);
    REQUIRE(files.size() == 2);
    write_text(files[0].file, files[0].bytes);
    write_text(folder / "m.yaml", files[1].bytes);
    CHECK(map_again(folder / "m.yaml", map, true).states == map.states);
  }
}

TEST_CASE("a map of walls that stand askew is the same when it is read back and mapped again") {
  Simulation simulation = Simulation::from_string(
      "<part name='WALLS' insert_at='ROOT' shape='wall' points='-2 -1, 2 -0.7, 1.2 1.5, -1 1' height='1.3'"
      " thickness='0.13' pose_offset='0.123 0.456 -0.1 0 0 17'/>"
      "<part name='BALL' insert_at='ROOT' shape='sphere' radius='0.43' pose_offset='0 0 0.3 0 0 0'/>");
  read_all_content(simulation);
  simulation.step();
  const DrawList& list = simulation.diagnostics().draw_list();
  check_round_trip(map_scene(list, {}, {.resolution_m = 0.05, .is_flat = true, .heights_m = {{0.1, 1}}}),
                   MapFormat::ros_map, "map.yaml");
  const SceneCells voxels = map_scene(list, {}, {.resolution_m = 0.05});
  check_round_trip(voxels, MapFormat::voxels, "map.npz");
  check_round_trip(voxels, MapFormat::octomap, "map.bt");
}

TEST_CASE("test data: the map of a house has the cells of its picture") {
  const std::optional<std::filesystem::path> house = test::test_data("house");
  if (!house) return;
  const std::string picture = read_text(*house / "reference_map/map.pgm");
  const std::size_t end = picture.find("255\n") + 4;
  const std::string yaml = read_text(*house / "reference_map/map.yaml");
  CAPTURE(yaml);
  CAPTURE(picture.substr(0, end));
  const std::string pixels = picture.substr(end);
  const long dark = std::ranges::count_if(pixels, [](char c) {
    return (255 - static_cast<unsigned char>(c)) / 255.0 > 0.65;  // occupied_thresh of the file
  });
  Simulation simulation =
      Simulation::from_string("<part name='MAP' insert_at='ROOT' file='map.yaml'/>", {}, *house / "reference_map");
  read_all_content(simulation);
  simulation.step();
  const SceneCells map = map_scene(simulation.diagnostics().draw_list(), {},
                                   {.resolution_m = 0.05, .is_flat = true, .heights_m = {{0.1, 1}}});
  CHECK(std::ranges::count(map.states, kOccupied) == dark);
}

}  // namespace
}  // namespace simvis
