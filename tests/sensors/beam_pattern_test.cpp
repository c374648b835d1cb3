// Laser scanners with a beam table: ranges and points by closed form, beams that start off the sensor's origin under
// every effect, firing times, patterns that run on, and attributes that do not go together.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include <simvis/simulation.h>
#include "exchange/messages/from_scan.h"
#include "tests/support/error_of.h"
#include "tests/support/reference_directions.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

constexpr double kWall_m = 4;

// A table of 3 channels with 4 beams each, whose origins and times differ.
std::string crooked_table() {
  std::string csv = "azimuth_deg,elevation_deg,x_m,y_m,z_m,time_s,channel\n";
  for (int channel = 0; channel < 3; ++channel) {
    for (int beam = 0; beam < 4; ++beam) {
      const int i = 4 * channel + beam;
      csv += std::to_string(10 * beam - 14 + channel) + "." + std::to_string(i % 10) + "," +
             std::to_string(3 * channel - 2) + ",0.0" + std::to_string(i % 3) + ",-0.1" + std::to_string(beam) +
             ",0.2" + std::to_string(channel) + ",0.00" + std::to_string(i % 7) + "," + std::to_string(10 + channel) +
             "\n";
    }
  }
  return csv;
}

struct PatternScene {
  TemporaryFolder folder;
  std::filesystem::path scene;
  SimulationDesc desc;

  PatternScene(const std::string& table, const std::string& attributes, const std::string& more = {}) {
    write_text(folder / "table.csv", table);
    scene = write_wall_scene(
        folder.path(), R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" )" + attributes + "/>" + more);
    desc.rate_hz = 10;
  }
  Simulation load() const { return Simulation::load(scene, desc); }
  Scan scan() const {
    Simulation simulation = load();
    simulation.step();
    return simulation.scan("SCAN");
  }
  std::string error() const {
    return error_of([&] { load(); });
  }
};

// The range of the wall, which is perpendicular to x, along beam i.
double wall_range_m(const Scan& scan, std::size_t i) { return (kWall_m - scan.origin(i).x) / scan.direction(i).x; }

std::string row(double azimuth_deg, double elevation_deg) {
  char text[100];
  std::snprintf(text, sizeof text, "%.17g,%.17g", azimuth_deg, elevation_deg);
  return text;
}

}  // namespace

TEST_CASE("a table of an even grid gives the same ranges and bounds as the grid, to the bit") {
  const PatternScene grid("azimuth_deg,elevation_deg\n0,0\n",
                          R"(samples="31" min_angle="-60" max_angle="60" vertical_samples="5" vertical_min_angle="-20"
                             vertical_max_angle="30")");
  const Scan even = grid.scan();
  std::string table = "azimuth_deg,elevation_deg,channel\n";
  for (int ring = 0; ring < 5; ++ring) {
    for (int beam = 0; beam < 31; ++beam) {
      table += row(-60 + beam * 120.0 / 30, -20 + ring * 50.0 / 4) + "," + std::to_string(ring) + "\n";
    }
  }
  const Scan same = PatternScene(table, R"(pattern="table.csv")").scan();
  CHECK(same.rings == 5);
  CHECK(same.beams == 31);
  CHECK(same.range_m == even.range_m);
  CHECK(same.error_bound_m == even.error_bound_m);
  CHECK(same.points() == even.points());
  CHECK(even.azimuth_rad.size() == 31);
  CHECK(even.elevation_rad.size() == 5);
  CHECK(same.azimuth_rad.size() == 155);
  CHECK(std::ranges::count_if(even.range_m, [](float range) { return range > 0 && std::isfinite(range); }) > 100);
}

TEST_CASE("beams stand exactly where the table says, and their ranges and points are those of the geometry") {
  const PatternScene scene(crooked_table(), R"(pattern="table.csv" truth="range")");
  const Scan scan = scene.scan();
  REQUIRE(scan.rings == 3);
  REQUIRE(scan.beams == 4);
  const SharedNumbers<double> truth = scan.channel("true_range_m");
  REQUIRE(truth.size() == 12);
  for (std::size_t i = 0; i < 12; ++i) {
    const auto channel = static_cast<double>(i / 4), beam = static_cast<double>(i % 4), n = static_cast<double>(i);
    const double azimuth_deg = 10 * beam - 14 + channel;
    // The text "-14.3" is 0.3 further from 0, not 0.3 larger.
    const double fraction = std::fmod(n, 10) / 10;
    CHECK(scan.azimuth(i) == glm::radians(std::stod(std::to_string(static_cast<int>(azimuth_deg)) + "." +
                                                    std::to_string(static_cast<int>(std::lround(10 * fraction))))));
    CHECK(scan.elevation(i) == glm::radians(3 * channel - 2));
    CHECK(scan.ring_of(i) == 10 + i / 4);
    const double expected_m = wall_range_m(scan, i);
    CHECK(std::abs(static_cast<double>(scan.range_m[i]) - expected_m) <= static_cast<double>(scan.error_bound_m[i]));
    CHECK(static_cast<double>(scan.error_bound_m[i]) <= 1e-6 * expected_m);
    // The exact range: both sides round a few numbers below 8 m.
    CHECK(std::abs(truth[i] - expected_m) <= 40 * 8 * 0x1p-53);
    CHECK(std::abs(scan.point(i).x - kWall_m) <= static_cast<double>(scan.error_bound_m[i]) + 8 * 0x1p-50);
  }
  const ros::PointCloud2 cloud = ros::point_cloud(scan, "SCAN");
  for (std::size_t i = 0; i < 12; ++i) {
    std::uint16_t ring = 0;
    std::memcpy(&ring, &cloud.data[i * cloud.point_step + 4 * sizeof(float)], sizeof ring);
    CHECK(ring == 10 + i / 4);
    float x = 0;
    std::memcpy(&x, &cloud.data[i * cloud.point_step], sizeof x);
    CHECK(x == static_cast<float>(scan.point(i).x));
  }
  CHECK(!ros::laser_scan(scan, "SCAN", {0, 80}, 0.1));
}

TEST_CASE("a beam that starts at a place measures as a scanner there, under every effect, to the rounding of places") {
  const std::string world = R"(<element type="fog" name="FOG" insert_at="ROOT" kind="rain" rain_rate="20"/>)"
                            R"(<element type="material" name="M" insert_at="ROOT" part="WALL" mirror="0.3"/>)";
  const auto scan_of = [&](const std::string& where, const std::string& table, const std::string& effects) {
    return PatternScene(table, R"(pattern="table.csv" pose_offset=")" + where + R"( 0 0 0" )" + effects,
                        effects.find("path_depth") != std::string::npos || effects.find("least") != std::string::npos
                            ? world
                            : "")
        .scan();
  };
  const std::string angles = "azimuth_deg,elevation_deg,x_m,y_m,z_m,channel\n";
  std::string moved = angles, still = angles;
  for (int i = 0; i < 40; ++i) {
    const std::string beam = row(-30 + 1.5 * i, 5 - 0.25 * i);
    moved += beam + ",0.5,-0.25,0.125,0\n";
    still += beam + ",0,0,0,0\n";
  }
  for (const std::string effects :
       {"", R"(truth="range")", R"(intensity="on")", R"(range_noise="0.02" range_noise_rel="0.01")", R"(dropout="0.3")",
        R"(angular_noise="0.5")", R"(divergence="0.5" divergence_samples="8")", R"(divergence="1" return="last")",
        R"(path_depth="2" intensity="on")", R"(least_power="1e-5" beam_diameter="0.02")"}) {
    CAPTURE(effects);
    const Scan a = scan_of("0 0 0", moved, effects), b = scan_of("0.5 -0.25 0.125", still, effects);
    REQUIRE(a.range_m.size() == 40);
    std::size_t hits = 0;
    for (std::size_t i = 0; i < 40; ++i) {
      const double range = a.range_m[i], other = b.range_m[i];
      CHECK(std::isfinite(range) == std::isfinite(other));
      if (!std::isfinite(range)) continue;
      hits += range > 0;
      // Both are the float32 of ranges that differ by the rounding of places, 1e-15 m.
      CHECK(std::abs(range - other) <= 1e-6 * range);
      CHECK(a.point(i).x == doctest::Approx(b.point(i).x + 0.5).epsilon(1e-6));
    }
    CHECK(hits > 10);
    REQUIRE(a.channels().size() == b.channels().size());
  }
}

TEST_CASE("beams that leave at the pattern's times start where the scanner was then") {
  // Half a metre towards the wall in the 0.1 s between two frames.
  const PatternScene scene(
      "azimuth_deg,elevation_deg,x_m,y_m,z_m,time_s,channel\n"
      "0,0,0.25,0,0,0,0\n10,0,0.25,0,0,0.02,0\n0,5,0,0.5,0,0.05,1\n-20,5,0,0,0,0.08,1\n",
      R"(pattern="table.csv" firing="pattern")");
  write_text(scene.folder / "moving.xml",
             std::string(kWallPart) +
                 R"(<part file="wall.gltf" name="R" insert_at="ROOT" pose_offset="90 0 0 0 0 0"/>
      <element type="pose" name="MOVE" insert_at="R" x="0"/>
      <sensor type="laser_scanner" name="SCAN" insert_at="R" pattern="table.csv" firing="pattern"
              pose_offset="-90 0 0 0 0 0"/>)");
  Simulation simulation = Simulation::load(scene.folder / "moving.xml", scene.desc);
  simulation.step();
  const Scan first = simulation.scan("SCAN");
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(std::abs(static_cast<double>(first.range_m[i]) - wall_range_m(first, i)) <=
          static_cast<double>(first.error_bound_m[i]));
  }
  simulation.parameters().set(simulation.parameters().index("MOVE", "x"), 0.5);
  simulation.step();
  const Scan& scan = simulation.scan("SCAN");
  const SharedNumbers<double> times_s = scan.channel("time_s");
  REQUIRE(times_s.size() == 4);
  const double ages_s[] = {0.08, 0.06, 0.03, 0};
  for (std::size_t i = 0; i < 4; ++i) {
    // The scanner stood 5 m/s x age behind its place of now.
    const double expected_m = wall_range_m(scan, i) + (5 * ages_s[i] - 0.5) / scan.direction(i).x;
    CHECK(std::abs(static_cast<double>(scan.range_m[i]) - expected_m) <=
          static_cast<double>(scan.error_bound_m[i]) + 40 * 0x1p-53);
    // One rounding of a difference below 1 s, and that of the times.
    CHECK(std::abs(times_s[i] - (static_cast<double>(scan.time_ns) / 1e9 - ages_s[i])) <= 4 * 0x1p-53);
  }
}

TEST_CASE("a pattern that runs on gives each beam once, by simulated time, and starts again after its end") {
  std::string table = "Time/s,Azimuth/deg,Zenith/deg\n";
  for (int i = 0; i < 50; ++i) table += std::to_string(i * 0.01) + "," + std::to_string(i) + ",90\n";
  const PatternScene scene(table, R"(pattern="table.csv" pattern_beams="10")");
  Simulation simulation = scene.load();
  std::map<long, int> seen;
  for (int frame = 0; frame < 12; ++frame) {
    simulation.step();
    const Scan& scan = simulation.scan("SCAN");
    REQUIRE(scan.rings == 1);
    REQUIRE(scan.beams == 10);
    for (std::size_t i = 0; i < 10; ++i) {
      // At 10 Hz and 100 beams a second the last beam of frame k is beam 10 k.
      const long expected = ((10 * frame - 9 + static_cast<long>(i)) % 50 + 50) % 50;
      CHECK(std::lround(glm::degrees(scan.azimuth(i))) == expected);
      if (frame > 1 && frame <= 6) ++seen[expected];
      CHECK(std::abs(static_cast<double>(scan.range_m[i]) - wall_range_m(scan, i)) <=
            static_cast<double>(scan.error_bound_m[i]));
    }
  }
  CHECK(seen.size() == 50);
  CHECK(std::ranges::all_of(seen, [](const auto& each) { return each.second == 1; }));
}

TEST_CASE("what does not go with a pattern is refused at its attribute") {
  const std::string table = "azimuth_deg,elevation_deg\n0,0\n";
  const auto error = [&](const std::string& attributes) { return PatternScene(table, attributes).error(); };
  const std::string pattern = R"(pattern="table.csv" )";
  CHECK(contains(error(pattern + R"(samples="5")"),
                 R"(attribute "samples": is not for a scanner with a pattern, whose beams are those of the table)"));
  CHECK(contains(error(pattern + R"(max_error_m="0.1")"),
                 R"(attribute "max_error_m": is not for a scanner with a pattern)"));
  CHECK(contains(error(pattern + R"(method="planar")"),
                 R"(attribute "method": "planar" renders an even grid, expected raycast with a pattern)"));
  CHECK(contains(error(pattern + R"(sweep="0.1")"), R"(attribute "sweep": is not for a scanner with a pattern)"));
  CHECK(contains(
      error(pattern + R"(firing="pattern")"),
      R"(attribute "firing": the pattern "table.csv" does not say when its beams fire, expected pattern_rate)"));
  CHECK(contains(error(pattern + R"(pattern_beams="1")"),
                 R"(attribute "pattern_beams": the pattern "table.csv" does not say)"));
  CHECK(contains(error(R"(pattern_beams="1")"), R"(attribute "pattern_beams": needs a pattern)"));
  CHECK(contains(error(R"(firing="pattern")"), R"(attribute "firing": "pattern" needs a pattern with times)"));
  CHECK(contains(error(R"(pattern="missing.csv")"), "missing.csv: error: cannot be read"));
  CHECK(contains(error(R"(pattern="device:velodyne_vlp61")"), R"(did you mean "velodyne_vlp16"?)"));
  CHECK(error(pattern + R"(method="raycast")") == "nothing was thrown");
  const std::string two = "azimuth_deg,elevation_deg,time_s\n0,0,0\n1,0,1\n";
  CHECK(contains(PatternScene(two, pattern + R"(pattern_beams="3")").error(),
                 R"(attribute "pattern_beams": 3 is not allowed, expected at most the 2 beams of the pattern)"));
}

}  // namespace simvis

TEST_SUITE_END();
