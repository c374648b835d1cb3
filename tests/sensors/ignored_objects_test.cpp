// What a sensor does not see, because it ignores it or by its visibility mask: each type of sensor with each of its
// methods gives the bytes of a scene without it.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/device.h>
#include <simvis/diagnostics.h>
#include <simvis/sensor_type.h>
#include <simvis/simulation.h>
#include "tests/support/error_of.h"
#include "tests/support/every_sensor.h"
#include "tests/support/sensor_bytes.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis::test {
namespace {

// The housing and the post are seen by sensors whose mask has the second bit.
const std::string kFlags =
    "<element type='visibility_flags' name='FLAGS' insert_at='ROOT' parts='HOUSING POST' flags='2'/>";

// These see no surfaces.
const std::set<std::string_view> kBlind = {"altimeter", "barometer",   "force_torque", "gnss",
                                           "imu",       "joint_state", "magnetometer", "odometry"};
// Their bodies and surfaces are what they sense; `bumper` has an attribute of this name itself.
const std::set<std::string_view> kOfOwnSurface = {"bumper", "contact", "force_torque"};

// A housing around the sensor, and a post in front of it: with their surfaces, or without.
std::string housed(bool has_surfaces, std::string_view sensor) {
  const std::string ball = has_surfaces ? " shape='sphere' radius='0.2'" : "",
                    box = has_surfaces ? " shape='box' size='0.1 0.3 2'" : "";
  return scene_with("<part name='HOUSING' insert_at='ROBOT'" + ball + "/><part name='POST' insert_at='ROBOT'" + box +
                    " pose_offset='0.6 0 0 0 0 0'/><element type='temperature' name='HOT' insert_at='WALL' "
                    "temperature='400'/>" +
                    std::string(sensor));
}

std::string sensor_at(std::string_view point, std::string_view type, const std::string& attributes) {
  return "<sensor type='" + std::string(type) + "' name='S' insert_at='" + std::string(point) + "' " + attributes +
         "/>";
}

std::vector<std::uint64_t> hashes(const std::string& xml) {
  Simulation simulation = Simulation::from_string(xml);
  std::vector<std::uint64_t> all;
  for (int frame = 0; frame < 3; ++frame) {
    simulation.set("MOVE", "x", 0.1 * frame);
    simulation.step();
    all.push_back(measured_hash(simulation));
  }
  return all;
}

std::vector<std::string> tried_attributes(std::string_view type) {
  std::vector<std::string> all = attributes_of(type);
  if (type == "touch") all = {"length='0.5'"};  // through the housing
  if (type == "laser_scanner") {
    for (const std::string method : {"raycast", "planar", "hybrid", "nearest", "auto"}) {
      all.push_back("samples='41' vertical_samples='3' vertical_min_angle='-5' vertical_max_angle='5' method='" +
                    method + "' truth='range instance'");
    }
    all.emplace_back("pattern='device:velodyne_vlp16'");
    all.emplace_back("samples='41' divergence='0.5' return='last'");
  }
  return all;
}

TEST_CASE("a sensor of any type and method gives the bytes of a scene without what it ignores") {
  const Device shared;  // all simulations use it, which is not opened again for each
  std::size_t compared = 0, seeing = 0;
  for (const SensorType* const type : sensor_types()) {
    if (kOfOwnSurface.contains(type->name)) continue;
    for (const std::string& attributes : tried_attributes(type->name)) {
      CAPTURE(type->name);
      CAPTURE(attributes);
      const auto here = [&](const std::string& ignore) { return sensor_at("ROBOT", type->name, attributes + ignore); };
      const std::vector<std::uint64_t> without = hashes(housed(false, here("")));
      for (const char* const names : {"HOUSING POST", "POST HOUSING", "HOUS* ?OST", "ROBOT/HOUSING POST"}) {
        CAPTURE(names);
        CHECK(hashes(housed(true, here(" ignore='" + std::string(names) + "'"))) == without);
        ++compared;
      }
      const auto flagged = [&](const std::string& mask) {
        return hashes(housed(true, kFlags + here(" visibility_mask='" + mask + "'")));
      };
      CHECK(flagged("4294967293") == without);
      // What is not ignored is seen: this comparison can fail.
      if (kBlind.contains(type->name)) continue;
      ++seeing;
      const std::vector<std::uint64_t> with = hashes(housed(true, here("")));
      CHECK(with != without);
      CHECK(flagged("2") != without);
      CHECK(hashes(housed(true, kFlags + here(""))) == with);
      // By default, the housing at which the sensor stands is not seen.
      const auto there = [&](const std::string& ignore) {
        return sensor_at("HOUSING", type->name, attributes + " ignore='POST " + ignore + "'");
      };
      CHECK(hashes(housed(true, there("HOUSING"))) == hashes(housed(false, there(""))));
    }
  }
  CHECK(compared > 3 * 40);
  CHECK(seeing > 40);
}

TEST_CASE("a mask shows what shares a bit with it, for all pairs of the bits 0 to 3") {
  const Device shared;
  std::string sensors = "<sensor type='range' name='ALL' insert_at='ROOT' range_max='9'/>";
  for (int mask = 0; mask < 16; ++mask) {
    const std::string bits = std::to_string(mask);
    sensors +=
        "<sensor type='range' name='R" + bits + "' insert_at='ROOT' range_max='9' visibility_mask='" + bits + "'/>";
  }
  for (std::uint32_t flags = 0; flags < 16; ++flags) {
    Simulation simulation = Simulation::from_string(
        "<s><part name='POST' insert_at='ROOT' shape='box' size='1 1 1' pose_offset='2.5 0 0 0 0 0'/>"
        "<element type='visibility_flags' name='F' insert_at='POST' flags='" +
        std::to_string(flags) + "'/>" + sensors + "</s>");
    simulation.step();
    const auto sees = [&](const std::string& sensor) { return simulation.value(sensor, "range_m") < 2.1; };
    for (std::uint32_t mask = 0; mask < 16; ++mask) {
      CAPTURE(flags);
      CAPTURE(mask);
      CHECK(sees("R" + std::to_string(mask)) == ((flags & mask) != 0));
    }
    CHECK(sees("ALL") == (flags != 0));
  }
}

TEST_CASE("a bumper does not hit what its mask leaves out") {
  for (const bool is_masked : {false, true}) {
    Simulation simulation = Simulation::from_string(
        "<s><part name='ROBOT' insert_at='ROOT' shape='box' size='1 1 1'/>"
        "<part name='POST' insert_at='ROOT' shape='box' size='0.5 0.5 0.5' pose_offset='0.6 0.1 0.1 0 0 0'/>"
        "<element type='visibility_flags' name='F' insert_at='POST' flags='2'/>"
        "<sensor type='bumper' name='B' insert_at='ROBOT' visibility_mask='" +
        std::string(is_masked ? "1" : "3") + "'/></s>");
    simulation.step();
    CHECK(simulation.value("B", "pressed") == (is_masked ? 0 : 1));
  }
}

TEST_CASE("wrong masks and flags are errors that say what is allowed") {
  const auto error = [](const std::string& commands) {
    return error_of(
        [&] { Simulation::from_string("<s><part name='PILLAR' insert_at='ROOT'/>\n" + commands + "</s>"); });
  };
  const std::string range = "<sensor type='range' name='R' insert_at='ROOT' visibility_mask=";
  for (const std::string wrong : {"'walls'", "'-1'", "'1.5'", "'4294967296'", "'0xF'"}) {
    CAPTURE(wrong);
    const std::string message = error(range + wrong + "/>");
    CHECK(contains(message, ":2:"));
    CHECK(contains(message, "\"visibility_mask\""));
    CHECK(contains(message, "4294967295"));
  }
  CHECK(contains(error("<sensor type='range' name='R' insert_at='ROOT' visability_mask='1'/>"), "visibility_mask"));
  const std::string element = "<element type='visibility_flags' name='F' insert_at='ROOT' ";
  CHECK(contains(error(element + "part='PILLAR'/>"), "\"flags\""));
  CHECK(contains(error(element + "part='PILLAR' flags='4294967296'/>"), "4294967295"));
  CHECK(contains(error(element + "part='PILAR' flags='1'/>"), "did you mean \"PILLAR\"?"));
  CHECK(contains(error(element + "flags='1'/>"), "needs the attribute \"part\" or \"parts\""));
  CHECK(contains(error(element + "part='PILLAR' flags='1'/><element type='visibility_flags' name='G' " +
                       "insert_at='PILLAR' flags='2'/>"),
                 "\"PILLAR\" already has visibility flags from element \"F\""));
}

// A rover whose lidar stands in the middle of its housing, a cylinder of 4 cm, above the base. Its optical frame has no
// shapes.
const char* const kRoverUrdf = R"(<robot name="rover">
<link name="base_link"><visual><origin xyz="0 0 0.06"/><geometry><box size="0.4 0.26 0.1"/></geometry></visual></link>
<link name="laser"><visual><geometry><cylinder radius="0.04" length="0.05"/></geometry></visual></link>
<joint name="laser_joint" type="fixed"><parent link="base_link"/><child link="laser"/><origin xyz="0 0 0.2"/></joint>
<link name="laser_frame"/>
<joint name="frame_joint" type="fixed"><parent link="laser"/><child link="laser_frame"/></joint>
</robot>)";

constexpr double kWall_m = 3;  // the face of the wall
const std::string kWallPart =
    "<part name='WALL' insert_at='ROOT' shape='box' size='0.5 20 20' pose_offset='3.25 0 0 0 0 0'/>";

Simulation rover(const std::string& attributes) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "rover.urdf") << kRoverUrdf;
  Simulation simulation = Simulation::from_string(
      "<s>" + kWallPart + "<part name='ROVER' insert_at='ROOT' file='rover.urdf'/>\n<sensor type='laser_scanner' " +
          "name='LIDAR' samples='11' min_angle='-20' max_angle='20' " + attributes + "/></s>",
      {}, folder.path());
  simulation.step();
  return simulation;
}

// Every beam meets the wall at the range that its azimuth says.
bool sees_wall(const Simulation& simulation, const std::string& scanner, double wall_m = kWall_m) {
  const Scan& scan = simulation.scan(scanner);
  bool all = scan.range_m.size() > 0;
  for (std::size_t i = 0; i < scan.range_m.size(); ++i) {
    const double expected_m = wall_m / std::cos(scan.azimuth_rad[i]);
    const double rounding_m = expected_m * 0x1p-24;  // of a range as float32
    all = all && std::abs(scan.range_m[i] - expected_m) <= scan.error_bound_m[i] + rounding_m;
  }
  return all;
}

bool is_blocked(const Simulation& simulation) {
  return std::ranges::all_of(simulation.scan("LIDAR").range_m, [](float range_m) { return range_m == 0; });
}

TEST_CASE("a lidar in the housing of its own link measures the wall at first try, with one warning") {
  for (const std::string method : {"raycast", "planar", "hybrid", "auto"}) {
    CAPTURE(method);
    const Simulation simulation = rover("insert_at='laser' method='" + method + "'");
    CHECK(sees_wall(simulation, "LIDAR"));
    REQUIRE(simulation.warnings().size() == 1);
    CHECK(contains(simulation.warnings()[0], ":2:2: sensor \"LIDAR\" stands inside a shape of its own link \"laser\""));
    CHECK(contains(simulation.warnings()[0], "ignore=\"none\" lets it see everything"));
  }
  // A frame without shapes belongs to the link above it.
  const Simulation framed = rover("insert_at='laser_frame'");
  CHECK(sees_wall(framed, "LIDAR"));
  CHECK(framed.warnings().size() == 1);
  // Names say it without a warning.
  for (const std::string ignore : {"laser", "ROVER", "laser base_link", "l*"}) {
    CAPTURE(ignore);
    const Simulation named = rover("insert_at='laser' ignore='" + ignore + "'");
    CHECK(sees_wall(named, "LIDAR"));
    CHECK(named.warnings().empty());
  }
}

TEST_CASE("a lidar that sees its housing has no range, and the run says so") {
  for (const std::string ignore : {"none", "base_link"}) {
    CAPTURE(ignore);
    const Simulation simulation = rover("insert_at='laser' ignore='" + ignore + "'");
    CHECK(is_blocked(simulation));
    REQUIRE(simulation.warnings().size() == 1);
    CHECK(contains(simulation.warnings()[0], "measures nothing in its first frame: 11 of 11 ranges are 0"));
  }
  // Only shapes of the own link are left out, not those of other links or parts.
  const Simulation elsewhere = rover("insert_at='laser' pose_offset='0 0 -0.13 0 0 0'");
  for (const float range_m : elsewhere.scan("LIDAR").range_m) CHECK(range_m < 0.25);  // the base is 0.4 m long
  // Beside its housing, a sensor sees it.
  const Simulation beside = rover("insert_at='laser' pose_offset='-0.1 0 0 0 0 0'");
  CHECK(beside.scan("LIDAR").range_m[5] == doctest::Approx(0.06).epsilon(1e-6));
  CHECK(beside.warnings().empty());
}

TEST_CASE("a solid that contains most of the scene is a room, which its own sensor sees") {
  const std::string
      room = "<part name='ROOM' insert_at='ROOT' shape='box' size='6 6 6'/>",
      lidar =
          "<sensor type='laser_scanner' name='LIDAR' insert_at='ROOM' samples='11' min_angle='-20' max_angle='20' "
          "method='raycast'/>",
      chair = "<part name='CHAIR' insert_at='ROOM' shape='box' size='1 1 1' pose_offset='-2 0 0 0 0 0'/>",
      table = "<part name='TABLE' insert_at='ROOM' shape='box' size='1 1 1' pose_offset='-2 2 0 0 0 0'/>";
  const auto is_seen = [&](const std::string& more) {
    Simulation simulation = Simulation::from_string("<s>" + room + more + lidar + "</s>");
    simulation.step();
    const bool warns = std::ranges::any_of(simulation.warnings(), [](const std::string& warning) {
      return contains(warning, "sensor \"LIDAR\" stands inside a shape of its own link \"ROOM\"");
    });
    const bool is_seen = sees_wall(simulation, "LIDAR");
    CHECK(warns != is_seen);
    return is_seen;
  };
  const auto tree = [](const std::string& name) {
    return "<part name='" + name + "' insert_at='ROOT' shape='box' size='1 1 1' pose_offset='0 9 0 0 0 0'/>";
  };
  CHECK(is_seen(chair));
  CHECK(is_seen(chair + table + tree("OAK")));
  // With as much outside, or nothing else, it is a housing.
  CHECK_FALSE(is_seen(chair + table + tree("OAK") + tree("ELM")));
  CHECK_FALSE(is_seen(""));
}

TEST_CASE("an unknown name in ignore is a warning with the nearest one") {
  const Simulation simulation = rover("insert_at='laser' ignore='laser base_lonk'");
  CHECK(sees_wall(simulation, "LIDAR"));
  REQUIRE(simulation.warnings().size() == 1);
  CHECK(contains(simulation.warnings()[0],
                 "attribute \"ignore\": there is no part or link \"base_lonk\", did you mean "
                 "\"base_link\"?"));
}

TEST_CASE("a lidar of SDF in its housing measures the wall") {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "bot.sdf") <<
      R"(<sdf version="1.7"><world name="w">
<model name="wall"><static>true</static><pose>3 0 1 0 0 0</pose><link name="l"><visual name="v"><geometry><box><size>0.1 8 2</size></box></geometry></visual></link></model>
<model name="bot"><link name="base_scan"><pose>0 0 0.2 0 0 0</pose><visual name="v"><geometry><cylinder><radius>0.04</radius><length>0.05</length></cylinder></geometry></visual>
<sensor name="lds" type="gpu_lidar"><lidar><scan><horizontal><samples>91</samples><min_angle>-0.7</min_angle><max_angle>0.7</max_angle></horizontal></scan><range><min>0.12</min><max>4.5</max></range></lidar></sensor></link></model>
</world></sdf>)";
  Simulation simulation =
      Simulation::from_string("<s><part file='bot.sdf' name='W' insert_at='ROOT'/></s>", {}, folder.path());
  simulation.step();
  REQUIRE(simulation.measured().size() == 1);
  CHECK(sees_wall(simulation, std::string(simulation.measured()[0]), 2.95));
  REQUIRE(simulation.warnings().size() == 1);
  CHECK(contains(simulation.warnings()[0], "stands inside a shape of its own link"));
}

// A wall behind a screen of two panes, of which the near one is red, in a link that has a sensor as well.
std::string screen_sdf(const std::string& flags, const std::string& mask) {
  const auto pane = [](const std::string& name, const std::string& x, const std::string& rest) {
    return "<visual name='" + name + "'><pose>" + x + " 0 0 0 0 0</pose><geometry><box><size>0.1 8 8</size></box>" +
           "</geometry>" + rest + "</visual>";
  };
  const auto scan =
      "<scan><horizontal><samples>11</samples><min_angle>-0.3</min_angle><max_angle>0.3</max_angle>"
      "</horizontal></scan><range><min>0.1</min><max>9</max></range>";
  return "<sdf version='1.9'><world name='w'><model name='m'><static>true</static><link name='l'>" +
         pane("near", "1.05", flags) + pane("far", "2.05", "") + "</link></model><model name='bot'><link name='eye'>" +
         "<sensor name='lidar' type='gpu_lidar'><lidar>" + scan + mask + "</lidar></sensor>" +
         "<sensor name='depth' type='depth_camera'><camera><image><width>16</width><height>12</height></image>" + mask +
         "</camera></sensor></link></model></world></sdf>";
}

TEST_CASE("<visibility_flags> and <visibility_mask> of SDF: a lidar and a camera see what shares a bit") {
  const Device shared;
  const auto flags = [](const std::string& bits) { return "<visibility_flags>" + bits + "</visibility_flags>"; };
  const auto mask = [](const std::string& bits) { return "<visibility_mask>" + bits + "</visibility_mask>"; };
  struct Row {
    std::string flags, mask;
    double expected_m;
  };
  const Row rows[] = {{"", "", 1},
                      {flags("2"), "", 1},
                      {flags("2"), mask("2"), 1},
                      {flags("0x2"), mask("3"), 1},
                      {flags("2"), mask("1"), 2},
                      {flags("2"), mask("4294967293"), 2},
                      {flags("0"), "", 2},
                      {flags("4294967295"), mask("8"), 1}};
  for (const Row& row : rows) {
    CAPTURE(row.flags);
    CAPTURE(row.mask);
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "w.sdf") << screen_sdf(row.flags, row.mask);
    Simulation simulation =
        Simulation::from_string("<s><part file='w.sdf' name='W' insert_at='ROOT'/></s>", {}, folder.path());
    simulation.step();
    CHECK(simulation.warnings().empty());
    CHECK(sees_wall(simulation, "bot/eye/lidar", row.expected_m));
    const Measurement camera = simulation.measurement("bot/eye/depth");
    REQUIRE(camera.find("depth") != nullptr);
    REQUIRE(camera.find("depth")->count() == 16 * 12);
    for (std::size_t i = 0; i < 16 * 12; ++i) {
      CHECK(camera.find("depth")->number(i) == doctest::Approx(row.expected_m).epsilon(1e-6));
    }
  }
}

TEST_CASE("wrong bits in SDF leave the flags of the link or the sensor out, with a warning") {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "w.sdf") << screen_sdf("<visibility_flags>red</visibility_flags>",
                                                       "<visibility_mask>1e9</visibility_mask>");
  const Simulation simulation =
      Simulation::from_string("<s><part file='w.sdf' name='W' insert_at='ROOT'/></s>", {}, folder.path());
  REQUIRE(simulation.warnings().size() == 3);
  CHECK(contains(simulation.warnings()[0], "element <visibility_flags> is \"red\", expected a whole number"));
  for (const int sensor : {1, 2}) {
    CHECK(contains(simulation.warnings()[static_cast<std::size_t>(sensor)],
                   "element <visibility_mask> is \"1e9\", expected a whole number"));
    CHECK(contains(simulation.warnings()[static_cast<std::size_t>(sensor)], "the sensor is left out"));
  }
}

// A camera that looks down on a floor, a ball above it, and a lamp beside the camera.
std::vector<float> seen_floor(const std::string& camera, const std::string& ball = "shape='sphere' radius='0.3'") {
  Simulation simulation = Simulation::from_string(
      "<s><part name='FLOOR' insert_at='ROOT' shape='box' size='10 10 0.1' pose_offset='0 0 -0.05 0 0 0'/>"
      "<part name='BALL' insert_at='ROOT' " +
      ball +
      " pose_offset='0 0 1 0 0 0'/>"
      "<element type='light' name='SUN' insert_at='ROOT' kind='point' x='1.5' z='3.5' intensity='20' shadows='yes'/>"
      "<sensor type='camera' name='CAM' insert_at='ROOT' pose_offset='0 0 4 0 90 0' width='64' height='64' hfov='60' "
      "outputs='color' " +
      camera + "/></s>");
  simulation.step();
  const auto pixels = simulation.color("CAM").pixels;
  return {pixels.begin(), pixels.end()};
}

TEST_CASE("what a camera ignores is not seen, and casts its shadow") {
  const std::vector<float> with = seen_floor(""), ignoring = seen_floor("ignore='BALL'"), without = seen_floor("", "");
  REQUIRE(with.size() == without.size());
  std::size_t ball = 0, shadow = 0;
  for (std::size_t i = 0; i < with.size(); ++i) {
    if (ignoring[i] != without[i]) {  // the shadow
      CHECK(ignoring[i] < without[i]);
      ++shadow;
    }
    ball += with[i] != ignoring[i];
  }
  CHECK(shadow > 50);
  CHECK(ball > 50);
}

TEST_CASE("a labelled object that a camera ignores has no row in its table") {
  for (const bool ignores : {false, true}) {
    Simulation simulation = Simulation::from_string(
        "<s><part name='FAR' insert_at='ROOT' shape='box' size='0.1 1 1' pose_offset='4 0 0 0 0 0'/>"
        "<part name='NEAR' insert_at='ROOT' shape='box' size='0.1 0.4 0.4' pose_offset='2 0 0 0 0 0'/>"
        "<element type='label' name='L' insert_at='ROOT' parts='*AR' class='box' class_id='1'/>"
        "<sensor type='camera' name='CAM' insert_at='ROOT' width='64' height='48' outputs='instance boxes "
        "silhouettes' " +
        std::string(ignores ? "ignore='NEAR'" : "") + "/></s>");
    simulation.step();
    const Measurement measurement = simulation.measurement("CAM");
    REQUIRE(measurement.find("object") != nullptr);
    CHECK(measurement.find("object")->count() == (ignores ? 1 : 2));
    // Nothing stands in front of the far one then.
    const double fraction = measurement.find("visible_fraction")->number(0);
    if (ignores) CHECK(fraction == 1);
  }
}

TEST_CASE("what sensors ignore costs the others nothing, and nothing where it is not used") {
  const auto counted = [](const std::string& attributes) {
    Simulation simulation = Simulation::from_string(
        scene_with("<part name='POST' insert_at='ROBOT' shape='box' size='0.1 0.3 2' pose_offset='0.6 0 0 0 0 0'/>"
                   "<sensor type='camera' name='CAM' insert_at='ROBOT' outputs='color depth' width='32' height='20' " +
                   attributes + "/><sensor type='laser_scanner' name='SCAN' insert_at='ROBOT' samples='41' " +
                   attributes + "/><sensor type='laser_scanner' name='OTHER' insert_at='ROBOT' samples='41'/>"));
    for (int frame = 0; frame < 3; ++frame) simulation.step();
    return std::pair(simulation.diagnostics().counters(), simulation.diagnostics().ray_counters());
  };
  const auto [frame, rays] = counted("");
  const auto [none_frame, none_rays] = counted("ignore='none'");
  CHECK(none_frame == frame);
  CHECK(none_rays == rays);
  const auto [some_frame, some_rays] = counted("ignore='POST'");
  CHECK(some_rays.item_trees_built == rays.item_trees_built);
  CHECK(some_rays.items_placed == rays.items_placed);
  CHECK(some_rays.meshes_built == rays.meshes_built);
  CHECK(some_frame.triangles < frame.triangles);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
