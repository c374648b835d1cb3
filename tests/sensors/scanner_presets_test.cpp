// Presets of commercial laser scanners: compared with the numbers in the data sheets and combined with attributes of a
// command.
#include <algorithm>
#include <map>

#include <simvis/simulation.h>
#include "engine/base/words.h"
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
  double first_deg, step_deg;  // of the azimuth; 0: the beams are those of a table, see beam_tables_test.cpp
  double range_min_m, range_max_m, resolution_m;
  double sigma_m, sigma_rel, bias_m, bias_rel;
  double rate_hz;
  double sweep_s;  // from the first beam to the last; 0: all leave at once
};
constexpr double kTurn10_s = 0.1;
constexpr DataSheet kDataSheets[] = {
    {"sick_lms200", 1, 361, -90, 0.5, 0.05, 80, 0.01, 0.005, 0, 0, 0, 37.5, 0},
    {"sick_tim551", 1, 271, -135, 1, 0.05, 10, 0, 0.02, 0, 0.06, 0, 15, 270.0 / 360 / 15},
    {"hokuyo_utm30lx", 1, 1081, -135, 0.25, 0.1, 30, 0.001, 0.01, 0, 0, 0, 40, 1080.0 / 1440 / 40},
    {"hokuyo_urg04lx", 1, 682, -340 * 360.0 / 1024, 360.0 / 1024, 0.02, 5.6, 0.001, 0, 0, 0, 0, 10,
     681.0 / 1024 * kTurn10_s},
    {"rplidar_a1", 1, 360, -180, 1, 0.15, 12, 0, 0, 0, 0, 0, 5.5, 359.0 / 360 / 5.5},
    {"rplidar_a2", 1, 800, -180, 0.45, 0.05, 12, 0, 0, 0, 0, 0, 10, 799.0 / 800 * kTurn10_s},
    {"lds_01", 1, 360, -180, 1, 0.12, 3.5, 0, 0, 0.035, 0, 0.05, 5, 0},
    {"lds_02", 1, 360, -180, 1, 0.16, 8, 0, 0, 0, 0, 0.03, 5, 0},
    {"velodyne_vlp16", 16, 1800, 0, 0, 1, 100, 0.002, 0, 0, 0.03, 0, 10, 1799 * 55296e-9 + 15 * 2304e-9},
    {"velodyne_hdl32e", 32, 2160, 0, 0, 1, 100, 0.002, 0, 0, 0, 0, 10, 2159 * 46080e-9 + 31 * 1152e-9},
    {"velodyne_vls128", 128, 1875, 0, 0, 0.4, 300, 0.004, 0, 0, 0, 0, 10, 1874 * 53300e-9 + 16 * 2665e-9},
    {"ouster_os0_32", 32, 1024, 0, 0, 0.3, 55, 0.001, 0, 0, 0, 0, 10, 1023.0 / 1024 * kTurn10_s},
    {"ouster_os0_128", 128, 1024, 0, 0, 0.3, 55, 0.001, 0, 0, 0, 0, 10, 1023.0 / 1024 * kTurn10_s},
    {"ouster_os1_32", 32, 1024, 0, 0, 0.3, 120, 0.001, 0.01, 0, 0.03, 0, 10, 1023.0 / 1024 * kTurn10_s},
    {"ouster_os1_64", 64, 1024, 0, 0, 0.8, 120, 0.001, 0.015, 0, 0, 0, 10, 1023.0 / 1024 * kTurn10_s},
    {"ouster_os1_128", 128, 1024, 0, 0, 0.3, 120, 0.001, 0.01, 0, 0.03, 0, 10, 1023.0 / 1024 * kTurn10_s},
    {"ouster_os2_32", 32, 1024, 0, 0, 0.3, 240, 0.001, 0, 0, 0, 0, 10, 1023.0 / 1024 * kTurn10_s},
    {"ouster_os2_128", 128, 1024, 0, 0, 0.3, 240, 0.001, 0, 0, 0, 0, 10, 1023.0 / 1024 * kTurn10_s},
    {"hesai_xt32", 32, 2000, 0, 0, 0.05, 120, 0.004, 0, 0, 0, 0, 10, 1999 * 50e-6 + 31 * 1512e-9},
    {"hesai_xt16", 16, 2000, 0, 0, 0.05, 120, 0.004, 0, 0, 0, 0, 10, 1999 * 50e-6 + 15 * 3024e-9},
    {"hesai_pandar64", 64, 1800, 0, 0, 0.3, 200, 0.004, 0, 0, 0, 0, 10, 1799.0 / 1800 * kTurn10_s},
    {"hesai_qt64", 64, 600, 0, 0, 0.1, 60, 0.004, 0, 0, 0, 0, 10, 599.0 / 600 * kTurn10_s},
};

/// The range at which a beam leaves the ball of this radius around the sensor. The beam starts within the ball.
double range_to_ball_m(const Scan& scan, std::size_t beam, double radius_m) {
  const glm::dvec3 origin = scan.origin(beam), direction = scan.direction(beam);
  const double along = glm::dot(origin, direction);
  return std::sqrt(along * along - glm::dot(origin, origin) + radius_m * radius_m) - along;
}

/// A scan of the inside of a ball, without errors of the range.
Scan scan_of_ball(const DataSheet& sheet, double radius_m) {
  const std::string exact = std::string(" range_noise='0' range_noise_rel='0' range_bias='0' range_bias_rel='0'") +
                            " range_resolution='0' ignore='none'";
  Simulation simulation = Simulation::from_string(
      "<simvis><part shape='sphere' name='BALL' insert_at='ROOT' radius='" + format_number(radius_m) + "'/>" +
      preset_scanner("preset='" + std::string(sheet.preset) + "'" + exact) + "</simvis>");
  simulation.step();
  return simulation.scan("SCAN");
}

}  // namespace

TEST_CASE("each preset has the beams, the limits, the errors, the times and the rate of its data sheet") {
  CHECK(find_sensor_type("laser_scanner")->presets.size() == std::size(kDataSheets));
  constexpr double kRounding_deg = 360 * 0x1p-50;
  constexpr double kTimes_s = 1.5e-9;  // tables have whole nanoseconds, the first and the last one rounded
  for (const DataSheet& sheet : kDataSheets) {
    CAPTURE(sheet.preset);
    Simulation simulation = simulation_of("preset='" + std::string(sheet.preset) + "'", 2 * sheet.rate_hz);
    simulation.step();
    const Scan& scan = simulation.scan("SCAN");
    REQUIRE(scan.rings == sheet.rings);
    REQUIRE(scan.beams == sheet.beams);
    if (sheet.step_deg > 0) {
      for (const std::uint32_t i : {0u, 1u, sheet.beams / 2, sheet.beams - 1}) {
        CHECK(std::abs(glm::degrees(scan.azimuth_rad[i]) - (sheet.first_deg + i * sheet.step_deg)) <= kRounding_deg);
      }
      CHECK(scan.elevation_rad[0] == 0);
    } else {
      CHECK(scan.azimuth_rad.size() == std::size_t{sheet.rings} * sheet.beams);
      // The files of angles that Hesai publishes have no places.
      CHECK(scan.origin_m.empty() == std::string_view(sheet.preset).starts_with("hesai"));
    }
    const AttributeValues values(simulation.diagnostics().command("SCAN"),
                                 all_attributes(*find_sensor_type("laser_scanner")), kSensorCommonAttributes);
    CHECK(values.number("range_min") == sheet.range_min_m);
    CHECK(values.number("range_max") == sheet.range_max_m);
    CHECK(values.number("range_resolution") == sheet.resolution_m);
    CHECK(values.number("range_noise") == sheet.sigma_m);
    CHECK(values.number("range_noise_rel") == sheet.sigma_rel);
    CHECK(values.number("range_bias") == sheet.bias_m);
    CHECK(values.number("range_bias_rel") == sheet.bias_rel);
    const SharedNumbers<double> times_s = scan.channel("time_s");
    REQUIRE(times_s.empty() == (sheet.sweep_s == 0));
    if (!times_s.empty()) {
      const auto [first, last] = std::ranges::minmax(times_s.numbers());
      CHECK(last == 0);
      CHECK(std::abs(last - first - sheet.sweep_s) <= kTimes_s);
    }
    for (int frame = 1; frame < 5; ++frame) simulation.step();
    CHECK(simulation.sensors().at(0).frames == 3);  // of five frames at twice the rate
  }
}

TEST_CASE("each preset sees from its smallest to its largest range, and a wall at 95 m by its data sheet") {
  // What may hide whether a range is within a limit: rounding of the ball's radius and of the range to float32.
  constexpr double kUndecided_rel = 0x1p-20;
  for (const DataSheet& sheet : kDataSheets) {
    for (const double radius_m : {95.0, 0.99 * sheet.range_min_m, 1.01 * sheet.range_min_m, 0.99 * sheet.range_max_m,
                                  1.01 * sheet.range_max_m}) {
      CAPTURE(sheet.preset);
      CAPTURE(radius_m);
      const Scan scan = scan_of_ball(sheet, radius_m);
      std::size_t wrong = 0, decided = 0, returns = 0, expected = 0;
      for (std::size_t beam = 0; beam < scan.range_m.size(); ++beam) {
        if (glm::length(scan.origin(beam)) >= radius_m) continue;  // it starts outside
        const double range_m = range_to_ball_m(scan, beam, radius_m);
        const double reported_m = scan.range_m[beam];
        if (std::abs(range_m - sheet.range_min_m) <= kUndecided_rel * range_m ||
            std::abs(range_m - sheet.range_max_m) <= kUndecided_rel * range_m) {
          continue;
        }
        ++decided;
        const bool is_near = range_m<sheet.range_min_m, is_far = range_m> sheet.range_max_m;
        if (is_near) wrong += reported_m == 0 ? 0 : 1;
        if (is_far) wrong += std::isinf(reported_m) ? 0 : 1;
        if (is_near || is_far) continue;
        ++expected;
        returns += std::isfinite(reported_m) && reported_m > 0 ? 1 : 0;
        wrong += std::abs(reported_m - range_m) <= kUndecided_rel * range_m ? 0 : 1;
      }
      CHECK(wrong == 0);
      CHECK(decided > 0);
      CHECK(returns == expected);
      if (radius_m == 95) CHECK((expected > 0) == (sheet.range_max_m >= 95));
    }
  }
}

TEST_CASE("every preset of every sensor says on which conditions its numbers hold and what its source does not say") {
  std::size_t presets = 0;
  for (const SensorType* type : sensor_types()) {
    for (const SensorPreset& preset : type->presets) {
      CAPTURE(preset.name);
      ++presets;
      CHECK(!preset.source.empty());
      CHECK(!preset.notes.empty());
      CHECK(preset.notes.ends_with('.'));
    }
  }
  CHECK(presets >= std::size(kDataSheets) + 16);
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
        R"(sick_tim551, hokuyo_utm30lx, hokuyo_urg04lx, rplidar_a1, rplidar_a2, lds_01, lds_02, )"
        R"(velodyne_vlp16, velodyne_hdl32e, velodyne_vls128, ouster_os0_32, ouster_os0_128, )"
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
  const std::string wrapped = describe_presets(*find_sensor_type("laser_scanner"));
  std::string page;
  for (const std::string_view word : words_of(wrapped)) page += (page.empty() ? "" : " ") + std::string(word);
  for (const SensorPreset& preset : find_sensor_type("laser_scanner")->presets) {
    CHECK(contains(page, "preset " + std::string(preset.name) + ": "));
    CHECK(contains(page, std::string(preset.source)));
  }
  CHECK(contains(page, "pattern=\"device:velodyne_vlp16\""));
  CHECK(describe_presets(*find_sensor_type("psd")).empty());
}

}  // namespace simvis::test

TEST_SUITE_END();
