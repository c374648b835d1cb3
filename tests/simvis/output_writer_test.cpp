// The files of a run: their names and content, and that none is ever incomplete.
#include "program/output/output_writer.h"

#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>

#include <simvis/error.h>
#include "engine/base/srgb.h"
#include "engine/base/temporary_file.h"
#include "program/output/atomic_file.h"
#include "program/output/number_text.h"
#include "tests/support/infinity.h"
#include "tests/support/picture_files.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

const glm::dmat4 kIdentity(1.0);
const double kNan = std::numeric_limits<double>::quiet_NaN();

TEST_CASE("a file that is replaced keeps its mode") {
  const TemporaryFolder folder;
  write_file(folder / "secret", "1");
  const auto owner = std::filesystem::perms::owner_read | std::filesystem::perms::owner_write;
  std::filesystem::permissions(folder / "secret", owner);
  write_file(folder / "secret", "2");
  CHECK(read_text(folder / "secret") == "2");
  CHECK(std::filesystem::status(folder / "secret").permissions() == owner);
}

TEST_CASE("temporary files of other runs stay, and those of ended ones go") {
  const TemporaryFolder folder;
  const std::filesystem::path own = TemporaryFile(folder / "page.html", "page.html").hidden_name();
  std::string ended = own.filename().string();
  const std::string process = "." + std::to_string(::getpid()) + ".";
  ended.replace(ended.find(process), process.size(), ".99999999.");  // beyond the largest number of a process
  const std::filesystem::path other = folder / ".page.html.elsewhere.1.1.tmp";
  for (const bool own_only : {true, false}) {
    for (const std::filesystem::path& file : {own, folder / ended, other}) write_text(file, "");
    remove_leftovers(folder.path(), own_only);
    CHECK(std::filesystem::exists(own));
    CHECK_FALSE(std::filesystem::exists(folder / ended));
    CHECK(std::filesystem::exists(other) == own_only);
  }
}

Image gradient(std::uint32_t width, std::uint32_t height) {
  std::vector<float> pixels;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(width),
                  v = static_cast<float>(y) / static_cast<float>(height);
      pixels.insert(pixels.end(), {u, v, 0.25f * (u + v), 1});
    }
  }
  return {width, height, 4, std::move(pixels)};
}

TEST_CASE("pictures of a frame") {
  const TemporaryFolder folder;
  const std::vector<std::string> sensors = {"CAM"};
  OutputWriter writer({.folder = folder / "out", .sensors = sensors});
  const Image color = gradient(37, 5);
  Image depth{37, 5, 1, std::vector<float>(37 * 5, kInfinity)};
  depth.pixels.edit()[3] = 4.000001f;

  const MeasuredArray colors = image_array("color", color, ImageContent::color),
                      depths = image_array("depth", depth, ImageContent::depth, "m"),
                      left = image_array("left_depth", depth, ImageContent::depth, "m", "left");
  writer.write("CAM", {.index = 0}, kIdentity, {.arrays = {colors}});
  writer.write("CAM", {.index = 12}, kIdentity, {.arrays = {depths}});
  writer.write("CAM", {.index = 1234567}, kIdentity, {.arrays = {colors, depths}});
  writer.write("CAM", {.index = 1}, kIdentity, {.arrays = {left}});
  writer.finish();
  CHECK(files_below(folder / "out") == std::vector<std::string>{"CAM/000000.png", "CAM/000012.exr", "CAM/1234567.exr",
                                                                "CAM/1234567.png", "CAM_left/000001.exr",
                                                                "CAM_poses.csv", "CAM_poses.tum"});
  const std::string cam = (folder / "out/CAM").string();
  CHECK(writer.results() == std::vector<std::string>{cam + "/*.png", cam + "/*.exr", cam + "_left/*.exr"});

  const PngPicture png = read_png(folder / "out/CAM/000000.png");
  CHECK(png.width == 37);
  CHECK(png.height == 5);
  REQUIRE(png.channels == 3);
  bool equal = true;
  for (std::size_t i = 0; i < 37 * 5; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      equal = equal && png.pixels[3 * i + c] == srgb_code(color.pixels[4 * i + c]);
    }
  }
  CHECK(equal);

  const ExrPicture only_depth = read_exr(folder / "out/CAM/000012.exr");
  CHECK(only_depth.compression == Imf::ZIP_COMPRESSION);
  REQUIRE(only_depth.channels.size() == 1);
  CHECK(only_depth.channels.at("Z") == depth.pixels);
  const ExrPicture both = read_exr(folder / "out/CAM/1234567.exr");
  CHECK(both.width == 37);
  CHECK(both.height == 5);
  REQUIRE(both.channels.size() == 4);
  CHECK(both.channels.at("Z") == depth.pixels);
  CHECK(both.channels.at("R")[36] == color.pixels[4 * 36]);
  CHECK(both.channels.at("B")[36] == color.pixels[4 * 36 + 2]);
}

Measurement rows_of(const std::vector<TableColumn>& columns, std::vector<double> values) {
  return Reading(columns, std::move(values));
}

TEST_CASE("tables begin with frame and time and grow by whole frames") {
  const TemporaryFolder folder;
  const std::vector<std::string> sensors = {"SCAN"};
  const std::vector<TableColumn> columns = {{"beam", "%lld", true}, {"range_m", "%.9g"}, {"x_m", "%.9g"}};
  OutputWriter writer({.folder = folder.path(), .sensors = sensors});
  const Measurement first = rows_of(columns, {0, 4.0000010000001, -1.5, 1, kInfinity, kNan}),
                    second = rows_of(columns, {0, 0.1f, 1e-12});
  writer.write("SCAN", {.index = 0, .time_ns = 0}, kIdentity, first);
  writer.write("SCAN", {.index = 1, .time_ns = 66'666'667}, kIdentity, second);
  writer.finish();
  CHECK(read_text(folder / "SCAN.csv") ==
        "frame,time_s,beam,range_m,x_m\n"
        "0,0.000000000,0,4.000001,-1.5\n"
        "0,0.000000000,1,inf,\n"
        "1,0.066666667,0,0.100000001,1e-12\n");
  CHECK(writer.results() == std::vector<std::string>{(folder / "SCAN.csv").string()});

  // A sensor of a part that stands in the scene twice.
  const std::vector<std::string> inner = {"LEFT/SCAN"};
  OutputWriter second_writer({.folder = folder.path(), .sensors = inner});
  second_writer.write("LEFT/SCAN", {}, kIdentity, second);
  second_writer.finish();
  CHECK(std::filesystem::exists(folder / "LEFT/SCAN.csv"));
}

std::string printed_by_c(const char* format, double value) {
  char text[512];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

TEST_CASE("numbers are written as by printf") {
  std::uint64_t state = 1, wrong = 0;
  const NumberFormat g = number_format({"c", "%.9g"}), f = number_format({"c", "%.9f"}),
                     e = number_format({"c", "%.3e"});
  for (int i = 0; i < 200'000; ++i) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    const double value = std::bit_cast<double>(state);
    const float narrow = std::bit_cast<float>(static_cast<std::uint32_t>(state >> 32));
    if (!std::isfinite(value) || !std::isfinite(narrow)) continue;
    std::string text;
    append_number(text, g, value);
    wrong += text != printed_by_c("%.9g", value);
    text.clear();
    append_number(text, f, value);
    wrong += text != printed_by_c("%.9f", value);
    text.clear();
    append_number(text, e, value);
    wrong += text != printed_by_c("%.3e", value);
    text.clear();
    append_number(text, g, narrow);
    wrong += std::strtof(text.c_str(), nullptr) != narrow;
  }
  CHECK(wrong == 0);
  const NumberFormat exact = number_format({"c", "exact"});
  CHECK(number_cell(exact, -89.5) == "-89.5");
  CHECK(number_cell(exact, 0.1 + 0.2) == "0.30000000000000004");
  CHECK(number_cell(exact, kNan).empty());
  CHECK_THROWS_AS(number_format({"c", "exact", true}), InputError);
  std::string text;
  append_number(text, number_format({"c", "%lld", true}), -131072);
  append_number(text, g, -kInfinity);
  CHECK(text == "-131072-inf");
  for (const char* bad : {"%s", "%d", "%.9g%n", "%.99g", "%.g", "9g", "%.9", "%.-1g", ""}) {
    CHECK_THROWS_AS(number_format({"c", bad}), InputError);
  }
  CHECK_THROWS_AS(number_format({"c", "%.9g", true}), InputError);
}

TEST_CASE("no incomplete file stays, and what SimVis did not write is not replaced") {
  const TemporaryFolder folder;
  const std::vector<std::string> sensors = {"SCAN"};
  const std::vector<TableColumn> columns = {{"beam", "%lld", true}};
  const std::vector<double> many(5000, 7);  // more than a page: by a twin of the table
  const auto write = [&] {
    OutputWriter writer({.folder = folder.path(), .sensors = sensors});
    for (std::uint64_t frame = 0; frame < 3; ++frame) {
      writer.write("SCAN", {.index = frame}, kIdentity, rows_of(columns, many));
    }
    writer.finish();
  };
  write();
  CHECK(files_below(folder.path()) == std::vector<std::string>{"SCAN.csv", "SCAN_poses.csv", "SCAN_poses.tum"});
  const std::string table = read_text(folder / "SCAN.csv");
  CHECK(std::ranges::count(table, '\n') == 1 + 3 * 5000);

  CHECK_THROWS_AS(write(), InputError);
  CHECK(read_text(folder / "SCAN.csv") == table);
  CHECK(files_below(folder.path()) == std::vector<std::string>{"SCAN.csv", "SCAN_poses.csv", "SCAN_poses.tum"});
}

TEST_CASE("new files are announced once for each frame, before one of them is there") {
  const TemporaryFolder folder;
  std::vector<std::string> sensors;
  for (int i = 0; i < 30; ++i) sensors.push_back("S" + std::to_string(i));
  std::vector<std::size_t> announced;  // the number of files, by call
  OutputWriter writer({.folder = folder.path(), .sensors = sensors, .on_new_file = [&](const RunFiles& files) {
                         std::size_t sum = 0;
                         for (const auto& [owner, names] : files) {
                           sum += names.size();
                           if (announced.empty()) CHECK_FALSE(std::filesystem::exists(folder / names.front()));
                         }
                         announced.push_back(sum);
                       }});
  constexpr std::size_t kFiles = 3;  // of each sensor: SENSOR.csv, SENSOR_poses.csv, SENSOR_poses.tum
  for (std::uint64_t frame = 0; frame < 3; ++frame) {
    for (std::size_t i = 0; i < (frame == 0 ? 20 : sensors.size()); ++i) {
      writer.write(sensors[i], {.index = frame}, kIdentity, rows_of({{"beam", "%lld", true}}, {1}));
    }
    writer.end_frame();
  }
  writer.finish();
  CHECK(announced == std::vector<std::size_t>{20 * kFiles, 30 * kFiles});
  CHECK(files_below(folder.path()).size() == 30 * kFiles);
}

std::string failure(const std::filesystem::path& folder, const std::vector<std::string>& sensors) {
  try {
    OutputWriter writer({.folder = folder, .sensors = sensors});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST_CASE("folders and names that cannot be written") {
  const TemporaryFolder folder;
  write_text(folder / "file", "");
  CHECK(failure(folder / "file", {}).starts_with((folder / "file").string() + ": error: "));
  CHECK(failure(folder / "file/out", {}).find("Not a directory") != std::string::npos);
  for (const char* name : {"", ".", "..", "../x", "a/../b", "a//b", "/a", "a/", ".hidden"}) {
    CHECK(failure(folder.path(), {name}).find("cannot name its files") != std::string::npos);
  }
  CHECK(files_below(folder.path()) == std::vector<std::string>{"file"});

  // The name is taken by a folder: the rename fails, and the temporary goes.
  std::filesystem::create_directory(folder / "taken");
  CHECK_THROWS_AS(write_file(folder / "taken", "text"), InputError);
  CHECK(files_below(folder.path()) == std::vector<std::string>{"file"});
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
