// Readings as messages: each type from its columns, and a recording of sensors of all kinds.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include <simvis/simulation.h>
#include "exchange/messages/from_reading.h"
#include "tests/messages/mcap_file.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("messages");

namespace simvis {
namespace {

using ros::test::McapFile;
using ros::test::McapReader;

constexpr std::string_view kSensingRobot = R"(
<part name="ROBOT" insert_at="ROOT"/>
<part name="WALL" shape="box" size="0.25 4 4" insert_at="ROOT" pose_offset="3 0 0 0 0 0"/>
<element type="pose" name="MOVE" insert_at="ROBOT" z="0.5"/>
<element type="joint" name="ELBOW" insert_at="ROBOT" axis="0 1 0" lower="-90" upper="90"/>
<sensor type="imu" name="IMU" insert_at="ROBOT" gyroscope_noise_density="0.1" accelerometer_stddev="0.5"/>
<sensor type="imu" name="AHRS" insert_at="ROBOT" orientation="on" orientation_stddev="0.02" pose_offset="0 0 0 0 0 90"/>
<sensor type="gnss" name="GPS" insert_at="ROBOT" latitude="49" longitude="8" horizontal_stddev="2" vertical_stddev="3" velocity_stddev="0.5"/>
<sensor type="magnetometer" name="MAG" insert_at="ROBOT" stddev="1e-7"/>
<sensor type="barometer" name="BARO" insert_at="ROBOT" stddev="2"/>
<sensor type="altimeter" name="ALT" insert_at="ROBOT"/>
<sensor type="odometry" name="ODOM" insert_at="ROBOT"/>
<sensor type="joint_state" name="JOINTS" insert_at="ROBOT"/>
<sensor type="range" name="RANGE" insert_at="ROBOT" stddev="0.01"/>
<sensor type="sonar" name="SONAR" insert_at="ROBOT" rays="64"/>
<sensor type="light_sensor" name="LUX" insert_at="ROBOT" resolution="8"/>
<sensor type="radar" name="RADAR" insert_at="ROBOT" angle_step="2"/>
<sensor type="bumper" name="BUMPER" insert_at="ROBOT"/>)";

TEST_CASE("a recording has the own message of each sensor, with the values of the API") {
  const TemporaryFolder folder;
  SimulationDesc desc;
  desc.rate_hz = 10;
  Simulation simulation = Simulation::from_string(kSensingRobot, desc);
  simulation.record({.file = folder / "run.mcap"});
  for (int i = 0; i < 2; ++i) {
    simulation.set("MOVE", "x", 0.1 * i);
    simulation.set("ELBOW", "value", 10.0 * i);
    simulation.step();
  }
  simulation.finish_recording();
  const McapFile file = McapReader::read(read_text(folder / "run.mcap"));
  const auto value = [&](const char* sensor, const char* name) { return simulation.value(sensor, name); };

  const auto imu = file.all<ros::Imu>("/IMU/imu");
  REQUIRE(imu.size() == 2);
  CHECK(imu[1].header.frame_id == "IMU");
  CHECK(imu[1].header.stamp.nanosec == 100'000'000);
  CHECK(imu[1].orientation_covariance[0] == -1);
  CHECK(imu[1].angular_velocity.y == value("IMU", "angular_velocity_y_rad_s"));
  CHECK(imu[1].linear_acceleration.z == value("IMU", "specific_force_z_m_s2"));
  CHECK(imu[1].angular_velocity_covariance[4] == doctest::Approx(0.1 * 0.1 / 0.1).epsilon(1e-12));
  CHECK(imu[1].linear_acceleration_covariance[8] == 0.25);
  const auto turned = file.all<ros::Imu>("/AHRS/imu");
  REQUIRE(turned.size() == 2);
  CHECK(turned[1].orientation.z == value("AHRS", "qz"));
  CHECK(turned[1].orientation.w == value("AHRS", "qw"));
  CHECK(turned[1].orientation_covariance[4] == doctest::Approx(0.02 * 0.02).epsilon(1e-12));
  const auto speeds = file.all<ros::TwistWithCovarianceStamped>("/GPS/fix_velocity");
  REQUIRE(speeds.size() == 2);
  CHECK(speeds[1].header.frame_id == "GPS");
  CHECK(speeds[1].header.stamp.nanosec == 100'000'000);
  CHECK(speeds[1].twist.twist.linear.x == value("GPS", "velocity_east_m_s"));
  CHECK(speeds[1].twist.twist.linear.y == value("GPS", "velocity_north_m_s"));
  CHECK(speeds[1].twist.twist.linear.z == value("GPS", "velocity_up_m_s"));
  CHECK(speeds[1].twist.covariance[0] == 0.25);
  CHECK(speeds[1].twist.covariance[7] == 0.25);
  CHECK(speeds[1].twist.covariance[14] == 0.25);
  CHECK(speeds[1].twist.covariance[21] == -1);
  CHECK(file.counts().count("/GPS/velocity_east_m_s") == 0);
  const auto fixes = file.all<ros::NavSatFix>("/GPS/fix");
  REQUIRE(fixes.size() == 2);
  CHECK(fixes[1].status.status == 0);
  CHECK(fixes[1].longitude == value("GPS", "longitude_deg"));
  CHECK(fixes[1].position_covariance[4] == 4);
  CHECK(fixes[1].position_covariance[8] == 9);
  CHECK(fixes[1].position_covariance_type == 2);
  CHECK(file.all<ros::MagneticField>("/MAG/magnetic_field").at(1).magnetic_field.z == value("MAG", "field_z_t"));
  CHECK(file.all<ros::FluidPressure>("/BARO/pressure").at(1).fluid_pressure == value("BARO", "pressure_pa"));
  CHECK(file.all<ros::FluidPressure>("/BARO/pressure").at(1).variance == 4);
  CHECK(file.all<ros::Float64>("/ALT/vertical_position_m").at(1).data == value("ALT", "vertical_position_m"));
  const auto ways = file.all<ros::Odometry>("/ODOM/odometry");
  REQUIRE(ways.size() == 2);
  CHECK(ways[1].header.frame_id == "odom");
  CHECK(ways[1].child_frame_id == "ROBOT");
  CHECK(ways[1].pose.pose.position.x == value("ODOM", "x_m"));
  CHECK(ways[1].pose.pose.orientation.y == value("ODOM", "qy"));
  CHECK(ways[1].twist.twist.linear.x == value("ODOM", "velocity_x_m_s"));
  const auto joints = file.all<ros::JointState>("/JOINTS/joint_states");
  REQUIRE(joints.size() == 2);
  CHECK(joints[1].name == std::vector<std::string>{"ELBOW"});
  CHECK(joints[1].position == std::vector<double>{value("JOINTS", "ELBOW.position_rad")});
  CHECK(joints[1].velocity == std::vector<double>{value("JOINTS", "ELBOW.velocity_rad_s")});
  CHECK(joints[1].effort.empty());
  const auto ranges = file.all<ros::Range>("/RANGE/range"), sonars = file.all<ros::Range>("/SONAR/range");
  CHECK(ranges.at(1).range == static_cast<float>(value("RANGE", "range_m")));
  CHECK(ranges.at(1).radiation_type == 1);
  CHECK(ranges.at(1).variance == 0.0001f);
  CHECK(sonars.at(1).radiation_type == 0);
  CHECK(sonars.at(1).field_of_view == static_cast<float>(glm::radians(25.0)));
  CHECK(sonars.at(1).max_range == 5);
  CHECK(file.all<ros::Illuminance>("/LUX/illuminance").at(1).illuminance == value("LUX", "illuminance_lx"));
  CHECK(file.all<ros::Float64>("/BUMPER/pressed").at(1).data == 0);
  for (const auto& [sensor, number] : {std::pair("BARO", "altitude_m"), {"SONAR", "echo"}}) {
    CAPTURE(number);
    const auto seen = file.all<ros::Float64>("/" + std::string(sensor) + "/" + number);
    REQUIRE(seen.size() == 2);
    CHECK(seen[1].data == value(sensor, number));
  }

  const auto clouds = file.all<ros::PointCloud2>("/RADAR/points");
  REQUIRE(clouds.size() == 2);
  const Reading& radar = simulation.reading("RADAR");
  REQUIRE(radar.rows() > 0);
  CHECK(clouds[1].width == radar.rows());
  // x, y and z are float32, the other columns float64.
  CHECK(clouds[1].point_step == (radar.arrays.size() - 3) * sizeof(double) + 3 * sizeof(float));
  CHECK(clouds[1].data.size() == radar.rows() * clouds[1].point_step);
  const std::vector<double>& values = radar.values();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const ros::PointField& field = clouds[1].fields[i % radar.arrays.size()];
    const std::uint8_t* const at =
        clouds[1].data.data() + i / radar.arrays.size() * clouds[1].point_step + field.offset;
    const bool single = field.name.size() == 1;
    CHECK(field.datatype == (single ? 7 : 8));
    const auto number = static_cast<float>(values[i]);
    CHECK((single ? std::memcmp(at, &number, sizeof number) : std::memcmp(at, &values[i], sizeof(double))) == 0);
  }
  CHECK(clouds[1].fields.back().name == "z");
  CHECK(clouds[1].fields.front().name == "range_m");
  CHECK(clouds[1].is_dense);
}

TEST_CASE("a fix by satellites has the whole covariance, and there is no velocity without a fix") {
  const TemporaryFolder folder;
  SimulationDesc desc;
  desc.rate_hz = 10;
  Simulation simulation = Simulation::from_string(
      "<s><part name='ROBOT' insert_at='ROOT'/><element type='gnss_jammer' name='JAM' insert_at='ROBOT' range='0'/>"
      "<sensor type='gnss' name='GPS' insert_at='ROBOT' satellites='10:20 80:35 140:60 200:15 290:40' "
      "pseudorange_stddev='2' horizontal_stddev='3' vertical_stddev='4'/></s>",
      desc);
  simulation.record({.file = folder / "run.mcap"});
  simulation.step();
  simulation.set("JAM", "range", 1);
  simulation.step();
  simulation.finish_recording();
  const McapFile file = McapReader::read(read_text(folder / "run.mcap"));
  const auto fixes = file.all<ros::NavSatFix>("/GPS/fix");
  REQUIRE(fixes.size() == 2);
  glm::dmat3 normal(0);
  glm::dvec3 mean(0);
  std::vector<glm::dvec3> sky;
  for (const auto& [azimuth_deg, elevation_deg] : {std::pair(10, 20), {80, 35}, {140, 60}, {200, 15}, {290, 40}}) {
    const double a = glm::radians(double(azimuth_deg)), e = glm::radians(double(elevation_deg));
    sky.emplace_back(std::cos(e) * std::sin(a), std::cos(e) * std::cos(a), std::sin(e));
    mean += sky.back() / 5.0;
  }
  for (const glm::dvec3& each : sky) normal += glm::outerProduct(each - mean, each - mean);
  glm::dmat3 expected = 4.0 * glm::inverse(normal);
  for (int i = 0; i < 3; ++i) expected[i][i] += i < 2 ? 9 : 16;
  CHECK(fixes[0].status.status == 0);
  CHECK(fixes[0].position_covariance_type == 3);
  for (std::size_t i = 0; i < 9; ++i) {
    CHECK(fixes[0].position_covariance[i] == doctest::Approx(expected[int(i / 3)][int(i % 3)]).epsilon(1e-12));
  }
  CHECK(fixes[1].status.status == -1);
  CHECK(fixes[1].position_covariance_type == 0);
  CHECK(fixes[1].position_covariance[0] == 0);
  CHECK(std::isnan(fixes[1].altitude));
  CHECK(file.all<ros::TwistWithCovarianceStamped>("/GPS/fix_velocity").size() == 1);
  CHECK(file.all<ros::Float64>("/GPS/satellites_used").at(0).data == 5);
  CHECK(file.all<ros::Float64>("/GPS/satellites_used").at(1).data == 0);
}

TEST_CASE("ranges out of limits, a lost fix, and readings without rows") {
  const std::vector<TableColumn> columns = {{.name = "range_m", .format = "%.9g"}};
  Reading reading(columns);
  CHECK_FALSE(ros::message_of(reading, "sensor_msgs/msg/Range", "R"));
  CHECK(ros::message_of(reading, "sensor_msgs/msg/PointCloud2", "R"));
  CHECK_FALSE(ros::message_of(reading, "sensor_msgs/msg/Sound", "R"));
  CHECK_FALSE(ros::reading_topic(""));
  reading = Reading(columns, {0});
  const auto range_of = [&] {
    return std::get<ros::Range>(ros::message_of(reading, "sensor_msgs/msg/Range", "R")->message).range;
  };
  CHECK(range_of() == -std::numeric_limits<float>::infinity());
  reading = Reading(columns, {std::numeric_limits<double>::infinity()});
  CHECK(range_of() == std::numeric_limits<float>::infinity());
  const auto is_dense = [&] {
    return std::get<ros::PointCloud2>(ros::message_of(reading, "sensor_msgs/msg/PointCloud2", "R")->message).is_dense;
  };
  CHECK(is_dense());
  reading = Reading(columns, {std::numeric_limits<double>::quiet_NaN()});
  CHECK_FALSE(is_dense());
  const std::vector<TableColumn> of_fix = {{.name = "latitude_deg", .format = "%.9g"},
                                           {.name = "longitude_deg", .format = "%.9g"},
                                           {.name = "altitude_m", .format = "%.9g"}};
  const Reading fix(of_fix, std::vector(3, std::numeric_limits<double>::quiet_NaN()));
  const auto lost = std::get<ros::NavSatFix>(ros::message_of(fix, "sensor_msgs/msg/NavSatFix", "G")->message);
  CHECK(lost.status.status == -1);
  CHECK(lost.position_covariance_type == 0);
  std::vector<TableColumn> of_velocity;
  for (const char* const name : {"velocity_east_m_s", "velocity_north_m_s", "velocity_up_m_s"}) {
    of_velocity.push_back({.name = name, .format = "%.9g"});
  }
  const std::string twist = "geometry_msgs/msg/TwistWithCovarianceStamped";
  CHECK(ros::message_of(Reading(of_velocity, {1, 2, 3}), twist, "G"));
  CHECK_FALSE(
      ros::message_of(Reading(of_velocity, std::vector(3, std::numeric_limits<double>::quiet_NaN())), twist, "G"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
