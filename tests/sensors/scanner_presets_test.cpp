// Presets of commercial laser scanners: compared with the numbers in the data sheets and combined with attributes of a
// command.
#include <algorithm>
#include <map>

#include <simvis/simulation.h>
#include "program/report/scan_variant.h"
#include "sensors/laser_scanner/laser_scanner.h"
#include "tests/support/element_scene.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis::test {
namespace {

std::string preset_scanner(const std::string& attributes) {
  return R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" )" + attributes + "/>";
}

Simulation simulation_of(const std::string& attributes, double rate_hz = 15) {
  SimulationDesc desc;
  desc.rate_hz = rate_hz;
  return Simulation::from_string(preset_scanner(attributes), desc, ".", "s.xml");
}

double attribute(const Simulation& simulation, std::string_view name) {
  double value = 0;
  REQUIRE(parse_number(simulation.diagnostics().command("SCAN").require(name).value, value));
  return value;
}

// A second copy of the data sheets' numbers: a typing error would have to be made twice.
struct DataSheet {
  const char* preset;
  std::uint32_t rings, beams;
  double first_deg, step_deg, lowest_deg, ring_step_deg;
  double range_min_m, range_max_m, resolution_m, sigma_m, rate_hz;
};
constexpr DataSheet kDataSheets[] = {
    {"sick_lms200", 1, 361, -90, 0.5, 0, 0, 0.05, 80, 0.01, 0.005, 37.5},
    {"hokuyo_utm30lx", 1, 1081, -135, 360.0 / 1440, 0, 0, 0.1, 30, 0.001, 0.01, 40},
};

// Presets whose beams are those of a table, see beam_tables_test.cpp.
struct TableSheet {
  const char* preset;
  std::uint32_t rings, beams;
  double resolution_m;
};
constexpr TableSheet kTableSheets[] = {
    {"velodyne_vlp16", 16, 1800, 0.002},  {"velodyne_hdl32e", 32, 2160, 0.002}, {"velodyne_vls128", 128, 1875, 0.004},
    {"ouster_os0_32", 32, 1024, 0.001},   {"ouster_os0_128", 128, 1024, 0.001}, {"ouster_os1_32", 32, 1024, 0.001},
    {"ouster_os1_64", 64, 1024, 0.001},   {"ouster_os1_128", 128, 1024, 0.001}, {"ouster_os2_32", 32, 1024, 0.001},
    {"ouster_os2_128", 128, 1024, 0.001}, {"hesai_xt32", 32, 2000, 0.004},      {"hesai_xt16", 16, 2000, 0.004},
    {"hesai_pandar64", 64, 1800, 0.004},  {"hesai_qt64", 64, 600, 0.004},
};

}  // namespace

TEST_CASE("each preset has the beams, the limits, the noise and the rate of its data sheet") {
  CHECK(find_sensor_type("laser_scanner")->presets.size() == std::size(kDataSheets) + std::size(kTableSheets));
  constexpr double kRounding_deg = 360 * 0x1p-50;
  for (const DataSheet& sheet : kDataSheets) {
    CAPTURE(sheet.preset);
    Simulation simulation = simulation_of("preset='" + std::string(sheet.preset) + "'", 2 * sheet.rate_hz);
    simulation.step();
    const Scan& scan = simulation.scan("SCAN");
    REQUIRE(scan.rings == sheet.rings);
    REQUIRE(scan.beams == sheet.beams);
    for (const std::uint32_t i : {0u, 1u, sheet.beams / 2, sheet.beams - 1}) {
      CHECK(std::abs(glm::degrees(scan.azimuth_rad[i]) - (sheet.first_deg + i * sheet.step_deg)) <= kRounding_deg);
    }
    for (std::uint32_t i = 0; i < sheet.rings; ++i) {
      CHECK(std::abs(glm::degrees(scan.elevation_rad[i]) - (sheet.lowest_deg + i * sheet.ring_step_deg)) <=
            kRounding_deg);
    }
    CHECK(attribute(simulation, "range_min") == sheet.range_min_m);
    CHECK(attribute(simulation, "range_max") == sheet.range_max_m);
    CHECK(attribute(simulation, "range_resolution") == sheet.resolution_m);
    CHECK(attribute(simulation, "range_noise") == sheet.sigma_m);
    for (int frame = 1; frame < 5; ++frame) simulation.step();
    CHECK(simulation.sensors().at(0).frames == 3);  // of five frames at twice the rate
  }
}

TEST_CASE("presets with a beam table have its rings and beams, and the unit of the device's packets") {
  for (const TableSheet& sheet : kTableSheets) {
    CAPTURE(sheet.preset);
    Simulation simulation = simulation_of("preset='" + std::string(sheet.preset) + "'", 10);
    simulation.step();
    const Scan& scan = simulation.scan("SCAN");
    CHECK(scan.rings == sheet.rings);
    CHECK(scan.beams == sheet.beams);
    CHECK(scan.azimuth_rad.size() == std::size_t{sheet.rings} * sheet.beams);
    // The files of angles that Hesai publishes have no places.
    CHECK(scan.origin_m.empty() == std::string_view(sheet.preset).starts_with("hesai"));
    CHECK(attribute(simulation, "range_resolution") == sheet.resolution_m);
    CHECK(attribute(simulation, "rate") == 10);
  }
}

TEST_CASE("noise and resolution of a preset show in its ranges") {
  World world({{"plates.gltf",
                [] {
                  GltfBuilder file;
                  add_plate(file, {.x = 4}, file.append("materials", painted("Paint", {1, 1, 1, 1})));
                  return file;
                }()}},
              R"(<part file="plates.gltf" name="PLATES" insert_at="ROOT" up="z"/>)" +
                  preset_scanner("preset='sick_lms200' min_angle='0' max_angle='0' samples='1000'"));
  world->step();
  const Scan& scan = world->scan("SCAN");
  std::map<float, int> readings;
  for (const float range_m : scan.range_m) ++readings[range_m];
  for (const auto& [range_m, count] : readings) {
    CHECK(range_m == static_cast<float>(std::llround(range_m * 100.0) * 0.01));
  }
  // Half a step of 4 m is one standard deviation, and P(|X| < 1) = 0.6827 for a normal distribution. The count of 1000
  // has a deviation of 14.7, and 4.9 times that covers all but one in a million.
  CHECK(std::abs(readings[4.0f] - 682.7) <= 4.9 * 14.7);
}

TEST_CASE("attributes of a command and of the command line override the preset") {
  Simulation own = simulation_of("preset='hokuyo_utm30lx' samples='5' range_noise='0'");
  own.step();
  CHECK(own.scan("SCAN").beams == 5);
  CHECK(attribute(own, "range_noise") == 0);
  CHECK(attribute(own, "range_max") == 30);
  SimulationDesc desc;
  desc.overrides = {{"laser_scanner", "rate", "5", "--rate"}};
  const Simulation overridden = Simulation::from_string(preset_scanner("preset='hokuyo_utm30lx'"), desc);
  CHECK(attribute(overridden, "rate") == 5);
  CHECK(attribute(overridden, "samples") == 1081);
  // The log has the command as it was written, so its repetition means the same.
  CHECK(own.parameters().changes().back().find("preset=\"hokuyo_utm30lx\"") != std::string::npos);
  CHECK(own.parameters().changes().back().find("range_max") == std::string::npos);
}

TEST_CASE("a variant of a preset keeps its beams and measures in every frame") {
  Simulation simulation = simulation_of(
      "preset='sick_lms200' samples='90' vertical_samples='16' vertical_max_angle='30' method='planar'", 75);
  const Command command = simulation.diagnostics().command("SCAN");
  CHECK(scan_variants(command).own.resolution_px == kRingsResolution);
  simulation.add_variant("SCAN", with_variant(command, {"nearest", 256, {}}, "SCAN.0"));
  for (int frame = 0; frame < 4; ++frame) simulation.step();
  CHECK(simulation.scan("SCAN.0").rings == 16);
  CHECK(simulation.sensors().at(0).frames == 2);
  CHECK(simulation.sensors().at(1).frames == 4);
}

TEST_CASE("errors name their place") {
  CHECK(error_of([] { simulation_of("preset='sick_lms20'"); }) ==
        R"(s.xml:1:59: error: attribute "preset": "sick_lms20" is not allowed, expected one of: sick_lms200, )"
        R"(hokuyo_utm30lx, velodyne_vlp16, velodyne_hdl32e, velodyne_vls128, ouster_os0_32, ouster_os0_128, )"
        R"(ouster_os1_32, ouster_os1_64, ouster_os1_128, ouster_os2_32, ouster_os2_128, hesai_xt32, )"
        R"(hesai_xt16, hesai_pandar64, hesai_qt64, did you mean "sick_lms200"?)");
  CHECK(contains(error_of([] { simulation_of("preset=''"); }), "\"\" is not allowed"));
  // The error about a conflict with the preset names the place of the preset.
  CHECK(contains(error_of([] { simulation_of("preset='hokuyo_utm30lx' min_angle='140'"); }),
                 R"(s.xml:1:59: error: attribute "max_angle": 135 is not allowed with min_angle="140")"));
  CHECK(contains(error_of([] {
                   Simulation::from_string(R"(<sensor type="psd" name="IR" insert_at="ROOT" preset="gp2y0a21yk"/>)");
                 }),
                 "unknown attribute \"preset\""));
}

TEST_CASE("--describe shows presets with their devices, data sheets and attributes") {
  const std::string page = describe_presets(*find_sensor_type("laser_scanner"));
  for (const SensorPreset& preset : find_sensor_type("laser_scanner")->presets) {
    CHECK(contains(page, "preset " + std::string(preset.name) + ": "));
    CHECK(contains(page, std::string(preset.source)));
  }
  CHECK(contains(page, "pattern=\"device:velodyne_vlp16\""));
  CHECK(describe_presets(*find_sensor_type("psd")).empty());
}

}  // namespace simvis::test

TEST_SUITE_END();
