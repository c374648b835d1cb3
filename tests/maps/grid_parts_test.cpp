// Foreign map files as parts: which cells are occupied, and what is refused.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "program/maps/map_files.h"
#include "program/maps/scene_cells.h"
#include "program/output/npy_file.h"
#include "program/output/zip_file.h"
#include "simvis/built_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("maps");

namespace simvis {
namespace {

struct GridPart {
  std::string cells;  // of the lowest layer, rows from the top: # occupied
  std::vector<std::string> warnings;
};

// The cells of 1 m from (0, 0) to `size` of a part file.
GridPart load(const TemporaryFolder& folder, const std::string& name, const glm::ivec2& size = {3, 1}) {
  Simulation simulation =
      Simulation::from_string("<part name='MAP' insert_at='ROOT' file='" + name + "'/>", {}, folder.path());
  read_all_content(simulation);
  simulation.step();
  const SceneCells map = map_scene(
      simulation.diagnostics().draw_list(), {},
      {.resolution_m = 1, .is_flat = true, .heights_m = {{0.1, 0.9}}, .area_m = {{{0, 0}, glm::dvec2(size)}}});
  GridPart part;
  for (std::uint32_t row = map.size.y; row-- > 0;) {
    for (std::uint32_t column = 0; column < map.size.x; ++column) {
      part.cells += map.at({column, row, 0}) == CellState::occupied ? '#' : '.';
    }
    if (row > 0) part.cells += '\n';
  }
  for (const std::string& warning : simulation.warnings()) {
    if (warning.find("has no sensor") == warning.npos) part.warnings.push_back(warning);
  }
  return part;
}

std::string refused(const TemporaryFolder& folder, const std::string& name) {
  return error_of([&] { load(folder, name); });
}

const std::string kHead = "resolution: 1\norigin: [0, 0, 0]\n";

std::string cells_of(const TemporaryFolder& folder, const std::string& picture, const std::string& yaml,
                     const glm::ivec2& size = {3, 1}) {
  write_text(folder / "m.pgm", picture);
  write_text(folder / "m.yaml", "image: m.pgm\n" + kHead + yaml);
  return load(folder, "m.yaml", size).cells;
}

std::string grey(std::initializer_list<int> shades) {
  std::string picture = "P5\n" + std::to_string(shades.size()) + " 1\n255\n";
  for (const int shade : shades) picture += static_cast<char>(shade);
  return picture;
}

TEST_CASE("the modes of a ROS map say which shades are occupied") {
  const TemporaryFolder folder;
  const std::string thresholds = "occupied_thresh: 0.65\nfree_thresh: 0.196\n";
  // 1 - 89 / 255 = 0.651 and 1 - 90 / 255 = 0.647.
  CHECK(cells_of(folder, grey({89, 90, 254}), thresholds) == "#..");
  CHECK(cells_of(folder, grey({89, 90, 254}), "mode: trinary\nnegate: 1\n" + thresholds) == "..#");
  CHECK(cells_of(folder, grey({89, 90, 254}), "mode: trinary\nnegate: true\n") == "..#");
  CHECK(cells_of(folder, grey({89, 90, 254}), "negate: False\n" + thresholds) == "#..");
  CHECK(cells_of(folder, grey({0, 90, 254}), "mode: scale\n" + thresholds) == "#..");
  CHECK(cells_of(folder, grey({100, 66, 65}), "mode: raw\n" + thresholds) == "##.");  // percents
  CHECK(cells_of(folder, grey({100, 101, 255}), "mode: 'raw'\n" + thresholds) == "#..");
}

TEST_CASE("maps may be in text, in 16 bits and with any largest value") {
  const TemporaryFolder folder;
  CHECK(cells_of(folder, "P2\n# CREATOR: nobody\n3 1\n255\n0 205\n254\n", "") == "#..");
  CHECK(cells_of(folder, "P2 3 1 # of 7\n7\n0 7 1", "") == "#.#");
  CHECK(cells_of(folder, "P5\n3 1\n100\n" + std::string("\x64\x00\x30", 3), "") == ".#.");
  CHECK(cells_of(folder, "P5 3 1 65535\n" + std::string("\xff\xff\x00\xff\x10\x00", 6), "") == ".##");
  CHECK(cells_of(folder, "P3\n3 1\n255\n0 0 0 255 255 255 0 0 90\n", "") == "#.#");
  CHECK(cells_of(folder, "P6\n3 1\n255\n" + std::string("\xff\xff\xff\0\0\0\xff\xff\xff", 9), "") == ".#.");
}

TEST_CASE("broken pictures of maps are refused at the line that names them") {
  const TemporaryFolder folder;
  for (const std::string picture :
       {"P2\n3 1\n255\n0 0", "P5\n3 1\n255\n\x01\x02", "P2\n3 1\n0\n0 0 0", "P2\n3 1\n70000\n0 0 0",
        "P2\n3 1\n255\n0 x 0", "P5\n3\n", "P2\n99999 1\n255\n0", "P6\n3 1\n255\n\x01\x02\x03", "P2\n0 1\n255\n"}) {
    CAPTURE(picture);
    CHECK(contains(error_of([&] { cells_of(folder, picture, ""); }), "m.yaml:1:1: key \"image\": "));
  }
}

// An uncompressed TGA with one row of BGRA.
std::string tga(const std::vector<std::array<int, 4>>& pixels) {
  std::string bytes("\0\0\2\0\0\0\0\0\0\0\0\0", 12);
  bytes += static_cast<char>(pixels.size());
  bytes += std::string("\0\1\0\x20\x28", 5);
  for (const auto& pixel : pixels) {
    for (const int channel : pixel) bytes += static_cast<char>(channel);
  }
  return bytes;
}

TEST_CASE("alpha is a fourth colour in mode trinary, and unknown in mode scale") {
  const TemporaryFolder folder;
  // Black and transparent, grey and opaque, black and opaque: means of 4 channels 0, 124 and 64.
  const std::string picture = tga({{0, 0, 0, 0}, {80, 80, 80, 255}, {0, 0, 0, 255}});
  write_text(folder / "m.tga", picture);
  const auto cells = [&](const std::string& mode) {
    write_text(folder / "a.yaml", "image: m.tga\n" + kHead + "mode: " + mode + "\n");
    return load(folder, "a.yaml").cells;
  };
  CHECK(cells("trinary") == "#.#");
  CHECK(cells("scale") == ".##");
}

TEST_CASE("the origin of a map moves and turns it") {
  const TemporaryFolder folder;
  write_text(folder / "m.pgm", grey({0, 254, 0}));
  write_text(folder / "m.yaml", "image: m.pgm\nresolution: 1\norigin: [1, 0, 1.5707963267948966]\n");
  CHECK(load(folder, "m.yaml", {3, 3}).cells == "#..\n...\n#..");
}

TEST_CASE("keys of a map that are wrong are refused at their line") {
  const TemporaryFolder folder;
  write_text(folder / "m.pgm", grey({0, 254, 0}));
  const auto message = [&](const std::string& line) {
    write_text(folder / "m.yaml", "image: m.pgm\n" + kHead + line + "\n");
    return refused(folder, "m.yaml");
  };
  CHECK(contains(message("mode: grey"),
                 "m.yaml:4:1: key \"mode\": \"grey\" is not allowed, expected trinary, scale or raw"));
  CHECK(contains(message("negate: maybe"), "m.yaml:4:1: key \"negate\": \"maybe\""));
  CHECK(contains(message("occupied_thresh: 65"), "m.yaml:4:1: key \"occupied_thresh\": \"65\""));
}

const std::string kTreeHead = "# Octomap OcTree binary file\nid OcTree\nsize 17\nres 1\ndata\n";

// The tree with the cell at the origin.
std::string tree(char leaf = 2) {
  std::string nodes("\0\xc0", 2);
  for (int i = 0; i < 14; ++i) nodes += std::string("\3\0", 2);
  return nodes + std::string{leaf, '\0'};
}

TEST_CASE("trees of OctoMap are read with comments, unknown keys and any order of the header") {
  const TemporaryFolder folder;
  write_text(folder / "t.bt", kTreeHead + tree());
  CHECK(load(folder, "t.bt").cells == "#..");
  CHECK(load(folder, "t.bt").warnings.empty());
  write_text(
      folder / "t.bt",
      "# Octomap OcTree binary file 2\n# more\n\nres 1\r\nsize 17\ncolour red\nid 1\n#\ndata \n" + tree() + "xy");
  const GridPart part = load(folder, "t.bt");
  CHECK(part.cells == "#..");
  REQUIRE(part.warnings.size() == 2);
  CHECK(contains(part.warnings[0], "t.bt: line 6: \"colour\" is not known, the line is left out"));
  CHECK(contains(part.warnings[1], "t.bt: has 2 bytes behind the tree, left out"));
}

TEST_CASE("trees that are broken are refused, and none of their beginnings is taken for a whole one") {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& bytes) {
    write_text(folder / "t.bt", bytes);
    return refused(folder, "t.bt");
  };
  const std::string whole = kTreeHead + tree();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    CAPTURE(size);
    CHECK(contains(message(whole.substr(0, size)), "t.bt"));
  }
  CHECK(contains(message("# Octomap OcTree file\n"),
                 "t.bt:1:1: is a tree with probabilities (.ot), expected a binary one"));
  CHECK(contains(message("ply\n"), "t.bt:1:1: does not begin with"));
  CHECK(contains(message("# Octomap OcTree binary file\nres 0\n"), "t.bt:2:1: res \"0\" is not allowed"));
  CHECK(contains(message("# Octomap OcTree binary file\nsize -1\n"), "t.bt:2:1: size \"-1\" is not allowed"));
  CHECK(contains(message("# Octomap OcTree binary file\nsize 1\ndata\n"), "t.bt:3:1: comes without a line \"res\""));
  CHECK(contains(message("# Octomap OcTree binary file\nres 1\ndata\n"), "t.bt:3:1: comes without a line \"size\""));
  CHECK(contains(message("# Octomap OcTree binary file\nres 1\nsize 0\ndata\n"), "has no occupied cell"));
  CHECK(contains(message("# Octomap OcTree binary file\nres 1\nsize 18\ndata\n" + tree()),
                 "t.bt:3:1: says that the tree has 18 nodes, but it has 17"));
  CHECK(contains(message(kTreeHead + tree(1)), "has no occupied cell"));
  CHECK(contains(message(kTreeHead + tree(3) + std::string(2, '\0')), "has a node below depth 16"));
  CHECK(contains(message("# Octomap OcTree binary file\nres 1\nsize 2\ndata\n" + std::string("\2\0", 2)),
                 "its occupied cells span 32768 x 32768 x 32768 cells, expected at most 268435456 in all"));
}

std::string npz(const std::string& cells, const std::string& resolution = "", const std::string& origin = "") {
  std::vector<ZipEntry> entries{{"cells.npy", cells}};
  if (!resolution.empty()) entries.push_back({"resolution_m.npy", resolution});
  if (!origin.empty()) entries.push_back({"origin_m.npy", origin});
  return encode_zip(entries);
}

std::string array(const std::string& type, const std::string& order, const std::string& shape,
                  const std::string& data) {
  const std::string header = "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }\n";
  return std::string("\x93NUMPY\1\0", 8) + static_cast<char>(header.size()) + '\0' + header + data;
}

std::string number(double value) { return encode_npy(std::span<const double>(&value, 1), {}); }

TEST_CASE("voxel grids of NumPy are read in both orders, of all small types, with and without an origin") {
  const TemporaryFolder folder;
  const auto cells = [&](const std::string& bytes, const glm::ivec2& size = {3, 2}) {
    write_text(folder / "v.npz", bytes);
    return load(folder, "v.npz", size).cells;
  };
  const std::string data("\1\0\0\0\0\1", 6);  // [x, y]: (0, 0) and (2, 1)
  CHECK(cells(npz(array("|b1", "False", "(3, 2, 1)", data), number(1))) == "..#\n#..");
  CHECK(cells(npz(array("|u1", "False", "(3, 2, 1)", data), number(1))) == "..#\n#..");
  CHECK(cells(npz(array("|i1", "False", "(3, 2, 1)", std::string("\1\xff\0\0\0\1", 6)), number(1))) == "..#\n#..");
  CHECK(cells(npz(array("|u1", "False", "(3, 2, 1)", std::string("\1\xff\0\0\0\1", 6)), number(1))) == "#.#\n#..");
  CHECK(cells(npz(array("|b1", "True", "(3, 2, 1)", std::string("\1\0\0\0\0\1", 6)), number(1))) == "..#\n#..");
  CHECK(cells(npz(array("|b1", "True", "(3, 2, 1)", std::string("\0\1\0\0\0\1", 6)), number(1))) == "..#\n.#.");
  const std::string one_as_float("\0\0\x80\x3f", 4), one_as_int("\1\0\0\0", 4);
  CHECK(cells(npz(array("|b1", "False", "(3, 2, 1)", data), array("<f4", "False", "()", one_as_float))) == "..#\n#..");
  CHECK(cells(npz(array("|b1", "False", "(3, 2, 1)", data), array("<i4", "False", "()", one_as_int))) == "..#\n#..");
  CHECK(cells(npz(array("|b1", "False", "(3, 2, 1)", data),
                  array("<i8", "False", "()", one_as_int + std::string(4, '\0')))) == "..#\n#..");
  const double origin[] = {1, 0, 0};
  const std::size_t three[] = {3};
  CHECK(cells(npz(array("|b1", "False", "(3, 2, 1)", data), number(1), encode_npy(origin, three)), {4, 2}) ==
        "...#\n.#..");
}

TEST_CASE("archives that hold no voxel grid are refused with the array") {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& bytes) {
    write_text(folder / "v.npz", bytes);
    return refused(folder, "v.npz");
  };
  const std::string cells = array("|b1", "False", "(1, 1, 1)", "\1");
  CHECK(contains(message("PK"), "v.npz: has no directory"));
  CHECK(contains(message(npz(cells)), "has no array \"resolution_m\", expected cells, resolution_m and origin_m"));
  CHECK(contains(message(npz(cells, number(0))), "array \"resolution_m\": 0 is not allowed"));
  CHECK(contains(message(npz(cells, number(NAN))), "array \"resolution_m\": nan is not allowed"));
  CHECK(contains(message(npz(cells, cells)),
                 "array \"resolution_m\" has numbers of the type \"|b1\", expected float64, float32, int64 or int32"));
  CHECK(
      contains(message(npz(cells, number(1), number(1))), "array \"origin_m\" has 8 bytes, expected 24 for its shape"));
  CHECK(contains(message(npz("", number(1))), "array \"cells\" is no array of NumPy"));
  CHECK(contains(message(npz(array("<f8", "False", "(1, 1, 1)", "12345678"), number(1))),
                 "of the type \"<f8\", expected bool, int8 or uint8"));
  CHECK(contains(message(npz(array("|b1", "False", "(1, 1)", "\1"), number(1))),
                 "array \"cells\" has 2 axes, expected x, y, z"));
  CHECK(contains(message(npz(array("|b1", "False", "(1, 1, 2)", "\1"), number(1))),
                 "array \"cells\" has 1 bytes, expected 2"));
  CHECK(contains(message(npz(array("|b1", "False", "(9999, 9999, 9999)", "\1"), number(1))),
                 "has 9999 x 9999 x 9999 cells, expected at most"));
  // 2^20 cells along an axis are allowed.
  CHECK(contains(message(npz(array("|b1", "False", "(1, 1048576, 1)", "\1"), number(1))),
                 "array \"cells\" has 1 bytes, expected 1048576"));
  for (const std::string shape : {"(1048577, 1, 1)", "(1, 1048577, 1)", "(1, 1, 1048577)", "(268435456, 1, 1)"}) {
    CHECK(contains(message(npz(array("|b1", "False", shape, "\1"), number(1))),
                   "cells, expected at most 1048576 along an axis"));
  }
  CHECK(contains(message(npz(array("|b1", "False", "(a, 1, 1)", "\1"), number(1))), "has a shape that cannot be read"));
  for (const std::string shape : {"(0, 4294967295, 4294967295)", "(1, 0, 1)", "(4294967297, 4294967297, 0)"}) {
    CAPTURE(shape);
    CHECK(contains(message(npz(array("|b1", "False", shape, ""), number(1))),
                   "array \"cells\" has an axis without cells, expected at least one cell along x, y and z"));
  }
  CHECK(contains(message(npz(array("|b1", "False", "(1, 1048576, 17)", "\1"), number(1))),
                 "has 1 x 1048576 x 17 cells, expected at most 1073741824 after rows along x are filled up to a "
                 "multiple of 64"));
  CHECK(contains(message(npz(array("|b1", "False", "(1, 1, 1)", std::string(1, '\0')), number(1))),
                 "has no occupied cell"));
  const std::string whole = npz(cells, number(1));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    CAPTURE(size);
    CHECK(contains(message(whole.substr(0, size)), "v.npz"));
  }
  for (std::size_t size = 0; size < cells.size(); ++size) {
    CAPTURE(size);
    CHECK(contains(message(npz(cells.substr(0, size), number(1))), "array \"cells\" "));
  }
}

}  // namespace
}  // namespace simvis
