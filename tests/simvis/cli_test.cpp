// Files and text of simvis-run for good input.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include <simvis/effect.h>
#include <simvis/element.h>
#include <simvis/sensor.h>
#include "program/report/command_reference.h"
#include "program/report/type_reference.h"
#include "tests/support/picture_files.h"
#include "tests/support/simvis_run.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;

TEST_CASE("a run writes pictures, scans and run.json, and prints where they are") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kWallSensors);
  const std::string out = (folder / "out").string();
  const ProcessResult result = run_simvis({scene.string(), "--out", out, "--frames", "3", "--seed", "7"});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  CHECK(result.err == "");
  CHECK(files_below(out) == Strings{"CAM.yaml", "CAM/000000.exr", "CAM/000000.png", "CAM/000001.exr", "CAM/000001.png",
                                    "CAM/000002.exr", "CAM/000002.png", "CAM_poses.csv", "CAM_poses.tum", "SCAN.csv",
                                    "SCAN_poses.csv", "SCAN_poses.tum", "SLOW.yaml", "SLOW/000000.png",
                                    "SLOW_poses.csv", "SLOW_poses.tum", "run.json"});
  CHECK(result.out.find(out + "/CAM/*.png") != std::string::npos);
  CHECK(result.out.find(out + "/SCAN.csv") != std::string::npos);
  CHECK(result.out.find("x real time at 15 Hz") != std::string::npos);

  const auto json = nlohmann::json::parse(read_text(folder / "out/run.json"));
  CHECK(json["scene"] == scene.string());
  CHECK(json["seed"] == 7);
  CHECK(json["frames"] == 3);
  CHECK(json["device"].get<std::string>() != "");
  CHECK(json["driver"].get<std::string>() != "");
  CHECK(json["wall_s"].get<double>() > 0);
  CHECK(json["frame_ms"]["median"].get<double>() > 0);
  CHECK(json["frame_ms"]["p99"].get<double>() >= json["frame_ms"]["median"].get<double>());
  CHECK(json["sensors"]["CAM"]["type"] == "camera");
  CHECK(json["sensors"]["CAM"]["frames"] == 3);
  CHECK(json["sensors"]["SLOW"]["frames"] == 1);
  CHECK(json["sensors"]["SCAN"]["method"] == "raycast");
  CHECK(json["sensors"]["SCAN"]["effects"].empty());
}

TEST_CASE("pictures and ranges of a wall follow from geometry") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kWallSensors);
  REQUIRE(run_simvis({scene.string(), "--out", (folder / "out").string(), "--frames", "2", "--quiet"}).exit_code == 0);

  const PngPicture png = read_png(folder / "out/CAM/000000.png");
  REQUIRE(png.channels == 3);
  REQUIRE(png.width == 64);
  REQUIRE(png.height == 48);
  // Unlit linear 1, 0.5, 0.25: sRGB 255, 187.5, 136.96; one code for the rounding of the colour target.
  const std::uint8_t* const middle = &png.pixels[3 * (24 * 64 + 32)];
  CHECK(middle[0] == 255);
  CHECK(std::abs(middle[1] - 187.5) <= 1);
  CHECK(std::abs(middle[2] - 137) <= 1);

  const ExrPicture exr = read_exr(folder / "out/CAM/000000.exr");
  REQUIRE(exr.channels.size() == 4);
  // Depth along the axis is 4 m everywhere. d = near / z and z = near / d each round once, and so do the vertices and
  // the interpolation: a few roundings of 2^-24 relative.
  constexpr float kDepthRounding = 4 * 8 * 0x1p-24f;
  const auto [low, high] = std::minmax_element(exr.channels.at("Z").begin(), exr.channels.at("Z").end());
  CHECK(*low >= 4 - kDepthRounding);
  CHECK(*high <= 4 + kDepthRounding);

  const Table scan = read_csv(folder / "out/SCAN.csv");
  CHECK(scan.columns == Strings{"frame", "time_s", "ring", "beam", "azimuth_deg", "elevation_deg", "range_m",
                                "error_bound_m", "x_m", "y_m", "z_m"});
  REQUIRE(scan.rows.size() == 10);
  for (std::size_t row = 0; row < 10; ++row) {
    const Strings& cell = scan.rows[row];
    const std::size_t beam = row % 5;
    const double azimuth_deg = -60 + 30.0 * static_cast<double>(beam);
    CHECK(cell[0] == (row < 5 ? "0" : "1"));
    CHECK(cell[1] == (row < 5 ? "0.000000000" : "0.066666667"));
    CHECK(cell[2] == "0");
    CHECK(cell[3] == std::to_string(beam));
    CHECK(std::stod(cell[4]) == doctest::Approx(azimuth_deg));
    CHECK(std::stod(cell[5]) == 0);
    const double range_m = std::stod(cell[6]), bound_m = std::stod(cell[7]);
    CHECK(std::abs(range_m - 3 / std::cos(azimuth_deg * M_PI / 180)) <= bound_m);
    CHECK(bound_m < 1e-3);
    // The point follows from the range, both printed with nine digits.
    CHECK(std::abs(std::stod(cell[8]) - range_m * std::cos(azimuth_deg * M_PI / 180)) < 1e-7);
    CHECK(std::abs(std::stod(cell[9]) - range_m * std::sin(azimuth_deg * M_PI / 180)) < 1e-7);
    CHECK(std::stod(cell[10]) == 0);
  }
}

TEST_CASE("a beam that hits nothing has no point") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(
      folder.path(),
      R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="2" min_angle="0" max_angle="180"/>)");
  REQUIRE(run_simvis({scene.string(), "--out", (folder / "out").string(), "--quiet"}).exit_code == 0);
  const Table scan = read_csv(folder / "out/SCAN.csv");
  REQUIRE(scan.rows.size() == 2);
  CHECK(scan.rows[1][6] == "inf");
  CHECK(scan.rows[1][8] == "");
  CHECK(scan.rows[1][9] == "");
  CHECK(scan.rows[1][10] == "");
}

TEST_CASE("--set, --trajectory and --rate move the sensors after an element") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kWallSensors);
  const std::string out = (folder / "out").string();
  write_text(folder / "drive.csv", "time_s,MOVE.x\n0,0\n1,2\n");
  REQUIRE(run_simvis({scene.string(), "--out", out, "--frames", "3", "--rate", "2", "--trajectory",
                      (folder / "drive.csv").string(), "--set", "MOVE.y=-1", "--set", "MOVE.z=0.5", "--sensor", "SCAN"})
              .exit_code == 0);
  // Only the scanner was on.
  CHECK(files_below(out) == Strings{"SCAN.csv", "SCAN_poses.csv", "SCAN_poses.tum", "run.json"});
  const Table scan = read_csv(folder / "out/SCAN.csv");
  REQUIRE(scan.rows.size() == 15);
  for (std::size_t frame = 0; frame < 3; ++frame) {
    const Strings& middle = scan.rows[5 * frame + 2];
    CHECK(std::stod(middle[1]) == 0.5 * static_cast<double>(frame));
    CHECK(std::abs(std::stod(middle[6]) - (3 - static_cast<double>(frame))) <= std::stod(middle[7]));
  }
}

TEST_CASE("--summary adds lines at the end and changes no result") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kWallSensors);
  const std::string out = (folder / "out").string();
  const ProcessResult plain = run_simvis({scene.string(), "--out", (folder / "plain").string()});
  const ProcessResult result = run_simvis({scene.string(), "--out", out, "--summary"});
  INFO(result.err);
  REQUIRE(plain.exit_code == 0);
  REQUIRE(result.exit_code == 0);
  for (const char* text : {"scanners: 1 with 5 beams", "cameras: ", "what accuracy costs SCAN", "\n  nearest ",
                           "\n  planar ", "\n  hybrid ", "\n  raycast "}) {
    CHECK_MESSAGE(result.out.find(text) != std::string::npos, text);
  }
  CHECK(result.out.ends_with("/SCAN.csv, " + out + "/run.json\n"));
  CHECK(plain.out.find("open first") == std::string::npos);
  CHECK(files_below(out) == files_below(folder / "plain"));
  CHECK(read_text(folder / "out/SCAN.csv") == read_text(folder / "plain/SCAN.csv"));
  for (const char* other : {"--quiet", "--price"}) {
    check_refused({"--summary", other}, std::string(kWallSensors), {"--summary", other});
  }
}

TEST_CASE("--explain, --profile, --quiet, --describe, --list-devices, --version, --help") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kWallSensors);
  const std::string out = (folder / "out").string();
  const ProcessResult explained = run_simvis({scene.string(), "--out", out, "--explain", "--quiet", "--frames", "2",
                                              "--profile", (folder / "p.json").string()});
  CHECK(explained.exit_code == 0);
  CHECK(explained.out.find("CAM") != std::string::npos);
  CHECK(explained.out.find("SCAN") != std::string::npos);
  CHECK(explained.out.find(" draws, ") != std::string::npos);
  CHECK(explained.out.find("wrote") == std::string::npos);
  Strings stages;
  const auto profile = nlohmann::json::parse(read_text(folder / "p.json"));
  for (const auto& event : profile["traceEvents"]) {
    if (event.value("cat", "") == "stage") stages.push_back(event["name"]);
  }
  CHECK(stages == Strings{"elements", "flatten", "plan", "render", "collect", "write", "elements", "flatten", "plan",
                          "render", "collect", "write"});

  const ProcessResult quiet = run_simvis({scene.string(), "--out", out, "--quiet"});
  CHECK(quiet.exit_code == 0);
  CHECK(quiet.out == "");
  CHECK(quiet.err == "");

  const ProcessResult described = run_simvis({"--describe", "camera"});
  CHECK(described.exit_code == 0);
  for (const char* name : {"width", "height", "hfov", "near", "outputs", "rate"}) {
    CHECK(described.out.find(name) != std::string::npos);
  }
  const ProcessResult effect = run_simvis({"--describe", "beam_divergence"});
  CHECK(effect.exit_code == 0);
  for (const char* part : {"divergence_samples", "called for by", "shown in: ranges", "laser_scanner"}) {
    CHECK(effect.out.find(part) != std::string::npos);
  }
  const ProcessResult unknown = run_simvis({"--describe", "camra"});
  CHECK(unknown.exit_code == 2);
  CHECK(unknown.err.find("did you mean \"camera\"?") != std::string::npos);

  const ProcessResult devices = run_simvis({"--list-devices"});
  CHECK(devices.exit_code == 0);
  CHECK(devices.out.starts_with("0: "));
  CHECK(devices.out.find("usable") != std::string::npos);

  CHECK(run_simvis({"--version"}).out.starts_with("simvis-run 0."));
  const ProcessResult help = run_simvis({"--help"});
  CHECK(help.exit_code == 0);
  for (const char* option : {"--out", "--frames", "--rate", "--set", "--trajectory", "--sensor", "--method",
                             "--max-error", "--seed", "--device", "--list-devices", "--explain", "--profile", "--quiet",
                             "--summary", "--describe", "--plugin", "--version", "--help"}) {
    CHECK_MESSAGE(help.out.find(option) != std::string::npos, option);
  }
}

TEST_CASE("--help has groups of options, lines that fit a terminal, and no lists of what excludes what") {
  const std::string help = run_simvis({"--help"}).out;
  for (const char* group : {"The run:\n", "Sensors:\n", "Results:\n", "Reports on a run:\n",
                            "Other processes and machines:\n", "Instead of a run:\n"}) {
    CHECK_MESSAGE(help.find(group) != std::string::npos, group);
  }
  CHECK(help.find("Excludes") == std::string::npos);
  CHECK(help.find("Needs") == std::string::npos);
  CHECK(help.find("\nOptions:") == std::string::npos);  // options without a group
  std::istringstream lines(help);
  std::size_t longest = 0;
  for (std::string line; std::getline(lines, line);) longest = std::max(longest, line.size());
  CHECK(longest > 50);
  CHECK(longest <= 100);
}

TEST_CASE("--describe prints the commands of the scene language") {
  const std::string part = run_simvis({"--describe", "part"}).out;
  for (const char* row : {"\nfile ", "\nname ", "\ninsert_at ", "\npose_offset ", "\nquaternion ", "\nup ",
                          "\nopacity ", "\nscale ", "\nunit ", "\nshape ", "\nwall_height "}) {
    CHECK_MESSAGE(part.find(row) != std::string::npos, row);
  }
  CHECK(run_simvis({"--describe", "sensor"}).out.find("\nlook_at ") != std::string::npos);
  CHECK(run_simvis({"--describe", "element"}).out.find("\ntype ") != std::string::npos);
  CHECK(run_simvis({"--describe", "remove"}).out.find("\nkind ") != std::string::npos);
  CHECK(run_simvis({"--describe", "set"}).out.find("\nvalue ") != std::string::npos);
  CHECK(run_simvis({"--describe", "repeat"}).out.find("\ncount ") != std::string::npos);
  CHECK(run_simvis({"--describe", "include"}).out.find("\nprefix ") != std::string::npos);
  CHECK(run_simvis({"--describe", "prt"}).err.find("did you mean \"part\"?") != std::string::npos);
}

TEST_CASE("--describe fits 100 columns, of every type and command") {
  std::vector<std::string> names{"all"};
  for (const ElementType* const type : element_types()) names.emplace_back(type->name);
  for (const SensorType* const type : sensor_types()) names.emplace_back(type->name);
  for (const EffectType* const type : effect_types()) names.emplace_back(type->name);
  names.emplace_back("presets");
  for (const CommandForm& form : command_forms()) names.emplace_back(form.name);
  std::size_t longest = 0;
  for (const std::string& name : names) {
    std::istringstream lines(type_reference(name, ReferenceFormat::text));
    for (std::string line; std::getline(lines, line);) longest = std::max(longest, line.size());
  }
  CHECK(names.size() > 60);
  CHECK(longest > 90);
  CHECK(longest <= 100);
}

TEST_CASE("--describe --json has every type with the rows of its table") {
  const ProcessResult printed = run_simvis({"--describe", "all", "--json"});
  REQUIRE_MESSAGE(printed.exit_code == 0, printed.err);
  const auto all = nlohmann::json::parse(printed.out);
  CHECK(all["commands"].size() == command_forms().size());
  CHECK(all["effects"].size() > 20);
  std::map<std::string, nlohmann::json> sensors;
  for (const auto& sensor : all["sensors"]) sensors[sensor["name"]] = sensor;
  for (const SensorType* const type : sensor_types()) {
    if (!sensors.contains(std::string(type->name))) continue;  // a type of another test
    const nlohmann::json& sensor = sensors[std::string(type->name)];
    const std::vector<AttributeSpec> rows = all_attributes(*type);
    REQUIRE(sensor["attributes"].size() == rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const nlohmann::json& attribute = sensor["attributes"][i];
      CAPTURE(rows[i].name);
      CHECK(attribute["name"] == rows[i].name);
      CHECK(attribute["text"] == rows[i].text);
      CHECK(attribute["live"] == rows[i].live);
      CHECK(attribute["min"].is_null() == (rows[i].min == -kNoLimit));
      if (!attribute["max"].is_null()) CHECK(attribute["max"] == rows[i].max);
      CHECK(attribute["default"].is_null() == rows[i].default_value.empty());
    }
    CHECK(sensor["presets"].size() == type->presets.size());
  }
  CHECK(sensors.size() >= 25);
  const auto camera = nlohmann::json::parse(run_simvis({"--describe", "camera", "--json"}).out);
  CHECK(camera["sensors"] == nlohmann::json::array({sensors["camera"]}));
  CHECK(camera["elements"].empty());
  CHECK(run_simvis({"--describe", "camra", "--json"}).exit_code == 2);
  CHECK(run_simvis({"--describe", "all", "--json", "--markdown"}).exit_code == 2);
}

TEST_CASE("a reader that closes the pipe early, as head does, is no error") {
  // The text is larger than the buffer of a pipe (64 KiB), so that it cannot be written whole without a reader.
  const ProcessResult result = Process({"/bin/bash", "-c", "set -o pipefail; \"$@\" | head -n 1", "bash", simvis_run(),
                                        "--describe", "all", "--markdown"})
                                   .wait();
  CHECK(result.exit_code == 0);
  CHECK(result.err == "");
  CHECK(result.out == "# Reference of elements, sensors and effects\n");
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
