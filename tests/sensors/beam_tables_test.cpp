// Beam tables: files in every form that is read, against what they say and against the formulas of the vendors; and
// files that are wrong.
#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <random>
#include <set>

#include <simvis/scan.h>
#include "sensors/beam_tables/beam_table_file.h"
#include "sensors/beam_tables/device_tables.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

// A dozen operations in double on numbers up to 10 m.
constexpr double kTablePlace_m = 12 * 10 * 0x1p-53;
// Angles in degrees below 1024, rounded a few times.
constexpr double kTableAngle_deg = 8 * 1024 * 0x1p-53;

BeamTable table_of(const std::string& name, std::string_view text, const TableColumns& columns = {},
                   std::optional<double> rate = {}) {
  const TemporaryFolder folder;
  write_text(folder / name, text);
  return read_beam_table(folder / name, columns, rate);
}

std::string table_error(const std::string& name, std::string_view text, const TableColumns& columns = {}) {
  const TemporaryFolder folder;
  write_text(folder / name, text);
  const std::string error = error_of([&] { read_beam_table(folder / name, columns, {}); });
  const std::string path = (folder / name).string();
  return error.starts_with(path) ? error.substr(path.size()) : error;
}

glm::dvec3 direction_of(const BeamTable& table, std::size_t i) {
  return beam_direction(glm::radians(table.azimuth_deg[i]), glm::radians(table.elevation_deg[i]));
}

std::string matrices(const std::vector<float>& numbers) {
  std::string bytes(numbers.size() * sizeof(float), '\0');
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return bytes;
}

constexpr std::string_view kOurCsv =
    "# two channels\r\n"
    "channel, azimuth_deg,elevation_deg,x_m,y_m,z_m,r_m,time_s\n"
    "7,-10.5,2,0.01,0.02,0.03,0,1.000002\n\n"
    "3,20,-1,0,0,0,0.5,1\n"
    "7,30,2,0,0,0,0,1.5\n"
    "3,-180,-1,0,0,0,0,1.000001\n";

constexpr std::string_view kOldOuster =
    R"({"beam_altitude_angles": [10.5, 0.25, -9], "beam_azimuth_angles": [3, -1, 0.5],
 "lidar_origin_to_beam_origin_mm": 15.806, "lidar_mode": "8x10", "prod_line": "OS-1-32",
 "lidar_to_sensor_transform": [-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 36.18, 0, 0, 0, 1],
 "data_format": {"columns_per_frame": 8, "column_window": [0, 7]}})";

constexpr std::string_view kNewOuster = R"({"beam_intrinsics": {"beam_altitude_angles": [10.5, 0.25, -9],
 "beam_azimuth_angles": [3, -1, 0.5], "beam_to_lidar_transform": [1, 0, 0, 27.67, 0, 1, 0, 0, 0, 0, 1, 2.5, 0, 0, 0, 1]},
 "lidar_intrinsics": {"lidar_to_sensor_transform": [0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 38.195, 0, 0, 0, 1]},
 "config_params": {"lidar_mode": "8x20"}, "sensor_info": {"prod_line": "OS-0-32"},
 "lidar_data_format": {"columns_per_frame": 8, "column_window": [6, 1]}})";

constexpr std::string_view kFlowCalibration = R"(lasers:
- {dist_correction: 0.0, focal_distance: 0.0, horiz_offset_correction: 0.026, laser_id: 0, rot_correction: 0.1,
  vert_correction: 0.05, vert_offset_correction: 0.2}
- {laser_id: 1, rot_correction: -0.2, vert_correction: -0.25, two_pt_correction_available: false}
num_lasers: 2
distance_resolution: 0.002
)";

constexpr std::string_view kBlockCalibration = R"(# as gen_calibration.py writes it
lasers:
  - laser_id: 0
    rot_correction: 0.1
    vert_correction: 0.05
    vert_offset_correction: 0.2
    horiz_offset_correction: 0.026
  - laser_id: 1   # lower
    rot_correction: -0.2
    vert_correction: -0.25
)";

// What ouster-sdk's make_xyz_lut() computes for a range of r mm along beam (ring, column), in the sensor frame, metres.
glm::dvec3 ouster_point_m(const OusterPackets& o, std::size_t ring, std::uint32_t column, double range_mm) {
  const double encoder = 2 * M_PI - 2 * M_PI * column / o.columns;
  const double azimuth = -o.azimuth_deg[ring] * M_PI / 180, altitude = o.elevation_deg[ring] * M_PI / 180;
  const glm::dvec3 direction(std::cos(encoder + azimuth) * std::cos(altitude),
                             std::sin(encoder + azimuth) * std::cos(altitude), std::sin(altitude));
  const double reach_mm = std::hypot(o.beam_radius_mm, o.beam_z_mm);
  const glm::dvec3 offset =
      glm::dvec3(std::cos(encoder) * o.beam_radius_mm, std::sin(encoder) * o.beam_radius_mm, o.beam_z_mm) -
      reach_mm * direction;
  const glm::dvec3 lidar_mm = range_mm * direction + offset;
  glm::dvec3 sensor_mm;
  for (std::size_t row = 0; row < 3; ++row) {
    const double* const m = &o.lidar_to_sensor[4 * row];
    sensor_mm[static_cast<glm::length_t>(row)] = m[0] * lidar_mm.x + m[1] * lidar_mm.y + m[2] * lidar_mm.z + m[3];
  }
  return sensor_mm / 1000.0;
}

void check_ouster(const BeamTable& table) {
  REQUIRE(table.device != nullptr);
  const OusterPackets& o = table.device->ouster;
  REQUIRE(table.origin_m.size() == table.size());
  constexpr double kRange_m = 7.5;
  const double range_mm = 1000 * kRange_m + std::hypot(o.beam_radius_mm, o.beam_z_mm);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto column = static_cast<std::uint32_t>((o.first_column + i % table.beams) % o.columns);
    const glm::dvec3 expected = ouster_point_m(o, i / table.beams, column, range_mm);
    REQUIRE(glm::length(table.origin_m[i] + kRange_m * direction_of(table, i) - expected) <= 4 * kTablePlace_m);
  }
}

}  // namespace

TEST_CASE("our CSV: columns in any order, rings by channel, origins and times") {
  const BeamTable table = table_of("beams.csv", kOurCsv);
  CHECK(table.rings == 2);
  CHECK(table.beams == 2);
  CHECK(table.channel == std::vector<std::uint32_t>{3, 3, 7, 7});
  CHECK(table.azimuth_deg == std::vector<double>{20, -180, -10.5, 30});
  CHECK(table.elevation_deg == std::vector<double>{-1, -1, 2, 2});
  CHECK(table.time_ns == std::vector<std::int64_t>{0, 1000, 2000, 500'000'000});
  REQUIRE(table.origin_m.size() == 4);
  const double a = glm::radians(20.0);
  CHECK(table.origin_m[0] == glm::dvec3(0.5 * std::cos(a), 0.5 * std::sin(a), 0));
  CHECK(table.origin_m[2] == glm::dvec3(0.01, 0.02, 0.03));
  CHECK(table.device == nullptr);
}

TEST_CASE("a table whose channels differ in length has one ring, in the order of the file") {
  const BeamTable table = table_of("b.csv", "azimuth_deg,elevation_deg,channel\n1,0,2\n2,0,1\n3,0,2\n");
  CHECK(table.rings == 1);
  CHECK(table.beams == 3);
  CHECK(table.azimuth_deg == std::vector<double>{1, 2, 3});
  CHECK(table.channel == std::vector<std::uint32_t>{2, 1, 2});
  CHECK(table.origin_m.empty());
  CHECK(table.time_ns.empty());
}

TEST_CASE("Livox's CSV: zenith angles, and times unless they are the numbers of the beams") {
  const BeamTable timed =
      table_of("l.csv", "Time/s,Azimuth/deg,Zenith/deg\n0.5,268.99,37.838\n0.500005,0,90\n0.50001,1,180\n");
  CHECK(timed.elevation_deg == std::vector<double>{90 - 37.838, 0, -90});
  CHECK(timed.time_ns == std::vector<std::int64_t>{0, 5000, 10000});
  const std::string numbered = "Time/s,Azimuth/deg,Zenith/deg\n1,268.99,37.838\n2,0,90\n3,1,180\n";
  CHECK(table_of("l.csv", numbered).time_ns.empty());
  CHECK(table_of("l.csv", numbered, {}, 200'000).time_ns == std::vector<std::int64_t>{0, 5000, 10000});
}

TEST_CASE("RGL's matrices: a beam along the third column, from the fourth") {
  const float c = std::cos(0.3f), s = std::sin(0.3f);
  const BeamTable table = table_of(
      "p.mat3x4f", matrices({0, 0, c, 0.25f, 1, 0, 0, -0.5f, 0, 1, s, 1.5f, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0}));
  REQUIRE(table.size() == 2);
  CHECK(table.rings == 1);
  CHECK(table.origin_m[0] == glm::dvec3(0.25, -0.5, 1.5));
  const glm::dvec3 stored = glm::normalize(glm::dvec3(static_cast<double>(c), 0, static_cast<double>(s)));
  CHECK(glm::length(direction_of(table, 0) - stored) <= 12 * 0x1p-53);
  CHECK(table.elevation_deg[1] == -90);
}

TEST_CASE("Ouster's metadata of both forms give the points of Ouster's own formula") {
  const BeamTable old = table_of("os.json", kOldOuster);
  CHECK(old.rings == 3);
  CHECK(old.beams == 8);
  CHECK(old.device->name == "Ouster OS-1-32");
  CHECK(old.time_ns[9] == 12'500'000);
  CHECK(std::abs(old.azimuth_deg[0] - 177) <= kTableAngle_deg);
  check_ouster(old);
  const BeamTable window = table_of("os.json", kNewOuster);
  CHECK(window.beams == 4);
  CHECK(window.device->ouster.first_column == 6);
  CHECK(window.device->ouster.rate_hz == 20);
  check_ouster(window);
}

TEST_CASE("Velodyne's calibration in both styles gives the points of the driver") {
  const TableColumns columns{5, -180, 108};
  const BeamTable table = table_of("vlp.yaml", kFlowCalibration, columns);
  const BeamTable block = table_of("vlp.yml", kBlockCalibration, columns);
  CHECK(table.azimuth_deg == block.azimuth_deg);
  CHECK(table.origin_m == block.origin_m);
  CHECK(table.rings == 2);
  CHECK(table.beams == 5);
  // Ring 1 is laser 0: velodyne_pointcloud's computation with its clockwise angles, x forward there being our y.
  for (std::size_t column = 0; column < 5; ++column) {
    const double head = -glm::radians(-180 + 72.0 * static_cast<double>(column)), rotation = head - 0.1;
    const double v = 0.2, h = 0.026, e = 0.05, range_m = 12;
    const double xy = range_m * std::cos(e) - v * std::sin(e);
    const double x = xy * std::sin(rotation) - h * std::cos(rotation),
                 y = xy * std::cos(rotation) + h * std::sin(rotation);
    const glm::dvec3 expected(y, -x, range_m * std::sin(e) + v * std::cos(e));
    const std::size_t i = 5 + column;
    CHECK(glm::length(table.origin_m[i] + range_m * direction_of(table, i) - expected) <= 4 * kTablePlace_m);
  }
}

TEST_CASE("the tables of devices: lasers, rings, steps and times as the manuals have them") {
  std::set<std::string_view> names;
  for (const DeviceTable& device : device_tables()) {
    CAPTURE(device.name);
    CHECK(names.insert(device.name).second);
    CHECK(!device.source.empty());
    const BeamTable table = device.make(device.index);
    REQUIRE(table.size() == std::size_t{table.rings} * table.beams);
    CHECK(table.elevation_deg.size() == table.size());
    CHECK(table.time_ns.size() == table.size());
    REQUIRE((table.device != nullptr) == !device.name.starts_with("hesai"));
    if (table.device == nullptr) continue;
    if (table.device->format == PacketFormat::ouster) {
      CHECK(table.beams == 1024);
      CHECK(device.name.ends_with(std::to_string(table.rings)));
      check_ouster(table);
    }
  }
  const DeviceTable* const vlp16 = find_device_table("velodyne_vlp16");
  REQUIRE(vlp16 != nullptr);
  const BeamTable table = vlp16->make(vlp16->index);
  CHECK(table.rings == 16);
  CHECK(table.beams == 1800);
  for (std::uint32_t ring = 0; ring < 16; ++ring) {
    // VLP-16 User Manual: even lasers from -15 degrees, odd ones from 1 degree, every two degrees.
    const std::uint32_t laser = ring < 8 ? 2 * ring : 2 * ring - 15;
    CHECK(table.device->velodyne.laser_of_ring[ring] == laser);
    for (const std::uint32_t column : {0u, 1u, 900u, 1799u}) {
      const std::size_t i = ring * 1800 + column;
      CHECK(table.elevation_deg[i] == -15.0 + 2.0 * ring);
      CHECK(table.time_ns[i] == 55296 * std::int64_t{column} + 2304 * laser);
      const double turned_deg =
          0.2 * column + laser / 120.0;  // a firing cycle turns 0.2 degrees, 2.304 us a 24th of it
      CHECK(std::abs(std::remainder(table.azimuth_deg[i] + 180 + turned_deg, 360)) <= kTableAngle_deg);
      CHECK(std::abs(table.origin_m[i].z + 0.04191 * std::tan(glm::radians(table.elevation_deg[i]))) <= kTablePlace_m);
    }
  }
  const BeamTable vls = find_device_table("velodyne_vls128")->make(2);
  CHECK(vls.rings == 128);
  CHECK(vls.elevation_deg.front() == -25);
  CHECK(vls.elevation_deg.back() == 15);
  // The manual's cycle: 16 groups of eight lasers, a pause of one group after the eighth.
  const std::uint32_t last = 127;
  for (std::uint32_t ring = 0; ring < 128; ++ring) {
    if (vls.device->velodyne.laser_of_ring[ring] != last) continue;
    CHECK(vls.time_ns[std::size_t{ring} * vls.beams + 1] == 53300 + 16 * 2665);
  }
}

TEST_CASE("Hesai tables have the SDK's angles, clockwise, and the times of a PandarXT") {
  const BeamTable xt = find_device_table("hesai_xt32")->make(0), xt16 = find_device_table("hesai_xt16")->make(1);
  CHECK(xt.rings == 32);
  CHECK(xt16.rings == 16);
  for (std::uint32_t ring = 0; ring < 32; ++ring) {
    for (const std::uint32_t column : {0u, 1u, 1999u}) {
      const std::size_t i = std::size_t{ring} * 2000 + column, of_16 = std::size_t{ring / 2} * 2000 + column;
      CHECK(xt.elevation_deg[i] == 15.0 - ring);
      CHECK(xt.time_ns[i] == 50000 * std::int64_t{column} + 1512 * ring);
      // A column of 50 us turns 0.18 degrees; the first channel fires 0.368 us after it begins.
      const double turned_deg = 0.18 * (column + (0.368 + 1.512 * ring) / 50);
      CHECK(std::abs(std::remainder(xt.azimuth_deg[i] + 180 + turned_deg, 360)) <= kTableAngle_deg);
      if (ring % 2 == 1) continue;
      CHECK(xt16.elevation_deg[of_16] == xt.elevation_deg[i]);
      CHECK(std::abs(std::remainder(xt16.azimuth_deg[of_16] - xt.azimuth_deg[i], 360)) <= kTableAngle_deg);
    }
  }
  const BeamTable pandar = find_device_table("hesai_pandar64")->make(2), qt = find_device_table("hesai_qt64")->make(3);
  // Channel 9 of the Pandar64 (laser id 10) and channel 63 of the QT, in columns 900 and 300: half a turn.
  CHECK(pandar.elevation_deg[9 * 1800 + 900] == 1.272);
  CHECK(std::abs(std::remainder(pandar.azimuth_deg[9 * 1800 + 900] - 5.208, 360)) <= kTableAngle_deg);
  CHECK(qt.elevation_deg[63 * 600 + 300] == 52.133);
  CHECK(std::abs(std::remainder(qt.azimuth_deg[63 * 600 + 300] - 7.892, 360)) <= kTableAngle_deg);
}

TEST_CASE("wrong tables are refused with their place, what was seen and what is allowed") {
  struct Wrong {
    const char *file, *text, *error;
  };
  const std::string columns =
      ", expected azimuth_deg and elevation_deg, and any of x_m, y_m, z_m, r_m, time_s, channel; or Time/s, "
      "Azimuth/deg "
      "and Zenith/deg";
  CHECK(table_error("b.csv", "azimuth_deg,elevatoin_deg\n") ==
        ":1:13: error: unknown column \"elevatoin_deg\"" + columns);
  CHECK(table_error("b.csv", "azimuth_deg\n1\n") ==
        ":1:1: error: these columns do not say where beams point" + columns);
  CHECK(table_error("b.csv", "# nothing\n") == ": error: the file names no columns" + columns);
  for (const Wrong& wrong : {
           Wrong{"b.csv", "azimuth_deg,elevation_deg\n", ": error: the table has no beams, expected at least one"},
           {"b.csv", "azimuth_deg,elevation_deg,azimuth_deg\n",
            ":1:27: error: the column \"azimuth_deg\" is there twice, expected it once"},
           {"b.csv", "azimuth_deg,elevation_deg\n1,2,3\n",
            ":2:1: error: 3 values in a line, expected 2, one for each column"},
           {"b.csv", "azimuth_deg,elevation_deg\n1,nan\n",
            ":2:3: error: \"nan\" is not allowed in the column elevation_deg, expected a number from -90 to 90"},
           {"b.csv", "azimuth_deg,elevation_deg\n1,1e308\n",
            ":2:3: error: \"1e308\" is not allowed in the column elevation_deg, expected a number from -90 to 90"},
           {"b.csv", "azimuth_deg,elevation_deg,channel\n1,2,0.5\n",
            ":2:5: error: \"0.5\" is not allowed as a channel, expected a whole number"},
           {"b.csv", "azimuth_deg,elevation_deg,x_m\n1,2,-11\n",
            ":2:5: error: \"-11\" is not allowed in the column x_m, expected a number from -10 to 10"},
           {"b.txt", "1 2",
            ": error: a beam table with the extension \".txt\", expected .csv, .mat3x4f, .json, .yaml or .yml"},
           {"b.mat3x4f", "123", ": error: has 3 bytes, expected 48 for each beam, and from 1 to 4194304 beams"},
           {"b.json", "[", ":1:2: error: is not JSON here, expected the metadata of a sensor"},
           {"b.json", "3", ":1:1: error: is no JSON object, expected the metadata of a sensor"},
           {"b.json", "{}", ": error: beam_altitude_angles is missing, expected the metadata of a sensor"},
           {"b.json", "{\n \"beam_altitude_angles\": [1, 91]}",
            ":2:2: error: beam_altitude_angles has \"91\" as number 1, expected numbers from -90 to 90"},
           {"b.json", "{\"beam_altitude_angles\": [1], \"beam_azimuth_angles\": [1, 2]}",
            ":1:31: error: beam_azimuth_angles is no array of that length, expected 1 numbers"},
           {"b.json", "{\"beam_altitude_angles\": [1], \"beam_azimuth_angles\": [1], \"lidar_mode\": \"1024y10\"}",
            ":1:59: error: lidar_mode is \"1024y10\", expected columns and turns per second, such as \"1024x10\""},
           {"b.yaml", "lasers:\n  - laser_id: 0\n    rot_correction: 0\n",
            ":2:3: error: a laser has no vert_correction, expected laser_id, rot_correction and vert_correction"},
           {"b.yaml", "lasers:\n- {laser_id: 0.5}\n",
            ":2:14: error: \"0.5\" is not allowed as laser_id, expected a whole number from 0 to 1023"},
           {"b.yaml", "lasers:\n- {laser_idd: 0}\n",
            ":2:4: error: unknown key \"laser_idd\", expected those of a Velodyne calibration, did you mean "
            "\"laser_id\"?"},
           {"b.yaml", "num_lasers: 3\n", ": error: has no lasers, expected a list of them below lasers:"},
           {"b.yaml", "lasers:\n- laser_id:\n", ":2:3: error: laser_id has no value, expected one"},
       }) {
    CAPTURE(wrong.text);
    CHECK(table_error(wrong.file, wrong.text) == wrong.error);
  }
  CHECK(contains(table_error("v.yaml", kBlockCalibration, {kMaxTableBeams, -180, 180}), "are too many beams"));
  const float nan = std::nanf("");
  CHECK(contains(table_error("n.mat3x4f", matrices({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, nan, 0})),
                 "matrix 0 has a number that is not finite"));
  CHECK(contains(table_error("n.mat3x4f", matrices({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2, 0})), "no unit vector"));
  CHECK(contains(table_error("n.mat3x4f", matrices({1, 0, 0, 1e30f, 0, 1, 0, 0, 0, 0, 1, 0})), "more than 10 m"));
  CHECK(contains(error_of([] { read_beam_table("/nowhere/t.csv", {}, {}); }), "/nowhere/t.csv"));
}

TEST_CASE("truncated and damaged tables are read or refused with their name, and never anything else") {
  const std::map<std::string, std::string> tables{{"a.csv", std::string(kOurCsv)},
                                                  {"b.json", std::string(kOldOuster)},
                                                  {"c.json", std::string(kNewOuster)},
                                                  {"d.yaml", std::string(kFlowCalibration)},
                                                  {"e.yaml", std::string(kBlockCalibration)},
                                                  {"f.mat3x4f", matrices(std::vector<float>(24, 0.57735f))}};
  const TemporaryFolder folder;
  std::size_t read = 0, refused = 0;
  const auto attempt = [&](const std::string& name, const std::string& text) {
    write_text(folder / name, text);
    try {
      const BeamTable table = read_beam_table(folder / name, {7, -10, 10}, {});
      REQUIRE(table.size() >= 1);
      REQUIRE(table.size() <= kMaxTableBeams);
      for (const double angle : table.azimuth_deg) REQUIRE(std::abs(angle) <= 360);
      for (const double angle : table.elevation_deg) REQUIRE(std::abs(angle) <= 90);
      ++read;
    } catch (const InputError& error) {
      REQUIRE(std::string(error.what()).starts_with((folder / name).string()));
      ++refused;
    }
  };
  std::mt19937 random(5);
  constexpr std::string_view kPieces[] = {"nan", "1e308", "-1e999", "4294967296", ":",   "[[[[",
                                          "{",   "-",     ",",      "\"",         "\xff"};
  for (const auto& [name, text] : tables) {
    for (std::size_t length = 0; length < text.size(); length += 1 + length / 64) attempt(name, text.substr(0, length));
    for (int damage = 0; damage < 150; ++damage) {
      std::string damaged = text;
      const std::size_t place = random() % text.size();
      if (damage % 2 == 0) {
        damaged[place] = static_cast<char>(random());
      } else {
        damaged.replace(place, random() % 5, kPieces[random() % std::size(kPieces)]);
      }
      attempt(name, damaged);
    }
  }
  attempt("deep.json", std::string(100'000, '['));
  attempt("deep.json", R"({"beam_altitude_angles": [)" + std::string(50'000, '[') + std::string(50'000, ']') + "]}");
  CHECK(read > 50);
  CHECK(refused > 500);
}

}  // namespace simvis

TEST_SUITE_END();
