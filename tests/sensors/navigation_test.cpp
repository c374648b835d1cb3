// Sensors of a robot's own motion, in scenes: imu, gnss, odometry, joint_state.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

constexpr double kRate_hz = 100, kFrame_s = 0.01;
// A pose within 10 m has an error of some 30 roundings; differences over a frame, and once more for accelerations.
constexpr double kPoseError = 30 * 10 * 0x1p-53;
constexpr double kVelocityError = 2 * kPoseError / kFrame_s, kAccelerationError = 2 * kVelocityError / kFrame_s;

Simulation moving(const std::string& xml, std::uint64_t seed = 0) {
  SimulationDesc desc;
  desc.rate_hz = kRate_hz;
  desc.seed = seed;
  return Simulation::from_string(xml, desc);
}

glm::dvec3 vector_of(const Simulation& simulation, const std::string& sensor, const std::string& stem,
                     const std::string& unit) {
  return {simulation.value(sensor, stem + "_x_" + unit), simulation.value(sensor, stem + "_y_" + unit),
          simulation.value(sensor, stem + "_z_" + unit)};
}
glm::dvec3 turn_of(const Simulation& simulation) { return vector_of(simulation, "IMU", "angular_velocity", "rad_s"); }
glm::dvec3 force_of(const Simulation& simulation) { return vector_of(simulation, "IMU", "specific_force", "m_s2"); }

TEST_CASE("an imu at rest feels gravity upwards, in its own frame") {
  const Simulation unread = moving(R"(<sensor type="imu" name="IMU" insert_at="ROOT"/>)");
  CHECK(std::isnan(unread.value("IMU", "specific_force_z_m_s2")));
  CHECK(unread.reading("IMU").rows() == 0);
  Simulation simulation = moving(R"(<sensor type="imu" name="IMU" insert_at="ROOT" pose_offset="1 2 3 90 0 40"/>)");
  for (int i = 0; i < 4; ++i) simulation.step();
  CHECK(turn_of(simulation) == glm::dvec3(0));
  CHECK(glm::length(force_of(simulation) - glm::dvec3(0, 9.80665, 0)) <= 10 * 4 * 0x1p-53);
  const Reading& reading = simulation.reading("IMU");
  CHECK(reading.rows() == 1);
  CHECK(reading.arrays.at(0).unit == "rad/s");
  CHECK(reading.time_ns == 30'000'000);
  CHECK(reading.find("specific_force_y_m_s2") == simulation.value("IMU", "specific_force_y_m_s2"));
  CHECK_FALSE(reading.find("specific_force"));
}

TEST_CASE("an imu on a turntable feels its rate and the centripetal acceleration") {
  Simulation simulation = moving(R"(
    <part name="TABLE" insert_at="ROOT" pose_offset="1 -2 0.5 0 0 0"/>
    <element type="joint" name="TURN" insert_at="TABLE" axis="0 0 1" lower="-100000" upper="100000"/>
    <sensor type="imu" name="IMU" insert_at="TABLE" pose_offset="2 0 0 0 0 90"/>)");
  const double turn = glm::radians(90.0);  // per second
  for (int i = 0; i < 10; ++i) {
    simulation.set("TURN", "value", 90 * kFrame_s * i);
    simulation.step();
  }
  // y of the sensor points to the axis, which it turns around with +90 degrees per second about z.
  CHECK(glm::length(turn_of(simulation) - glm::dvec3(0, 0, turn)) <= kVelocityError);
  CHECK(glm::length(force_of(simulation) - glm::dvec3(0, turn * turn * 2, 9.80665)) <= kAccelerationError);
}

TEST_CASE("errors of an imu: scale and lean of its axes, and angular velocity that a force adds") {
  const std::string turntable = R"(
    <part name="TABLE" insert_at="ROOT"/>
    <element type="joint" name="TURN" insert_at="TABLE" axis="0.36 0.48 0.8"/>
    <sensor type="imu" name="IMU" insert_at="TABLE" gravity="3 -5 -7" )";
  const auto turned = [&](const std::string& errors) {
    Simulation simulation = moving(turntable + errors + "/>");
    for (int i = 0; i < 4; ++i) {
      simulation.set("TURN", "value", 90 * kFrame_s * i);
      simulation.step();
    }
    return std::pair(turn_of(simulation), force_of(simulation));
  };
  const auto [turn, force] = turned("");
  const auto [turn_0, force_0] = turned(R"(gyroscope_scale_error="0 0 0" accelerometer_misalignment="0 0 0")");
  CHECK(turn_0 == turn);
  CHECK(force_0 == force);
  const auto [scaled_turn, scaled_force] =
      turned(R"(gyroscope_scale_error="0.01 -0.02 0.03" accelerometer_scale_error="-0.1 0.2 0.05")");
  constexpr double kRounding = 8 * 0x1p-52;  // of sums of at most four products of numbers below 16
  CHECK(glm::length(scaled_turn - turn * glm::dvec3(1.01, 0.98, 1.03)) <= 16 * kRounding);
  CHECK(glm::length(scaled_force - force * glm::dvec3(0.9, 1.2, 1.05)) <= 16 * kRounding);
  const auto [leaning_turn, leaning_force] =
      turned(R"(gyroscope_misalignment="0.01 0.02 -0.03" accelerometer_misalignment="-0.04 0.05 0.06")");
  const auto lean = [](const glm::dvec3& v, double yx, double zx, double zy) {
    return v + glm::dvec3(0, yx * v.x, zx * v.x + zy * v.y);
  };
  CHECK(glm::length(leaning_turn - lean(turn, 0.01, 0.02, -0.03)) <= 16 * kRounding);
  CHECK(glm::length(leaning_force - lean(force, -0.04, 0.05, 0.06)) <= 16 * kRounding);
  const auto [pushed_turn, pushed_force] = turned(R"(gyroscope_g_sensitivity="0.001 -0.002 0.003")");
  CHECK(glm::length(pushed_turn - (turn + glm::dvec3(0.001, -0.002, 0.003) * force)) <= 16 * kRounding);
  CHECK(pushed_force == force);
  CHECK(glm::length(force) > 5);
  CHECK(std::abs(turn.x) > 0.1);
}

TEST_CASE("an imu gives its orientation on request, with errors about the axes of the world") {
  constexpr std::string_view kScene = R"(<part name="R" insert_at="ROOT"/>
    <element type="pose" name="MOVE" insert_at="R" roll="20" pitch="-35" yaw="130"/>
    <sensor type="imu" name="PLAIN" insert_at="R"/>
    <sensor type="imu" name="EXACT" insert_at="R" orientation="on"/>
    <sensor type="imu" name="BIASED" insert_at="R" orientation="on" orientation_bias_mean="0.3"/>)";
  Simulation simulation = Simulation::from_string(kScene);
  simulation.step();
  CHECK(simulation.measurement("PLAIN").find("qw") == nullptr);
  const auto orientation = [&](const char* sensor) {
    return glm::dquat(simulation.value(sensor, "qw"), simulation.value(sensor, "qx"), simulation.value(sensor, "qy"),
                      simulation.value(sensor, "qz"));
  };
  glm::dmat4 pose;
  REQUIRE(simulation.sensor_pose("EXACT", pose));
  const glm::dquat truth = glm::quat_cast(glm::dmat3(pose));
  constexpr double kRounding = 1e-15;  // some operations on numbers of at most 1
  CHECK(1 - std::abs(glm::dot(orientation("EXACT"), truth)) <= kRounding);
  // Each axis has the bias, so the turn is about (1, 1, 1) of the world by sqrt(3) times it.
  const glm::dquat error = glm::angleAxis(0.3 * std::sqrt(3.0), glm::normalize(glm::dvec3(1)));
  CHECK(1 - std::abs(glm::dot(orientation("BIASED"), error * truth)) <= kRounding);
  const std::string refused = R"(<sensor type="imu" name="I" insert_at="ROOT" orientation_stddev="0.1"/>)";
  CHECK_THROWS_AS(Simulation::from_string(refused), InputError);
}

TEST_CASE("an imu in free fall feels nothing, and its rate does not matter") {
  Simulation simulation = moving(R"(
    <part name="BODY" insert_at="ROOT"/>
    <element type="pose" name="MOVE" insert_at="BODY"/>
    <sensor type="imu" name="IMU" insert_at="BODY" rate="20"/>)");
  for (int i = 0; i <= 10; ++i) {
    const double t = kFrame_s * i;
    simulation.set("MOVE", "z", 5 - 0.5 * 9.80665 * t * t);
    simulation.step();
  }
  CHECK(simulation.reading("IMU").time_ns == 100'000'000);
  CHECK(glm::length(force_of(simulation)) <= kAccelerationError);
}

// Geodetic to geocentric coordinates of WGS 84: Hofmann-Wellenhof, "GNSS", equation 8.4, in long double.
glm::dvec3 geocentric(double latitude_deg, double longitude_deg, double height_m) {
  constexpr long double kA = 6378137.0L, kF = 1 / 298.257223563L, kPi = std::numbers::pi_v<long double>;
  const long double latitude = latitude_deg * kPi / 180, longitude = longitude_deg * kPi / 180;
  const long double e2 = kF * (2 - kF), n = kA / std::sqrt(1 - e2 * std::sin(latitude) * std::sin(latitude));
  return {static_cast<double>((n + height_m) * std::cos(latitude) * std::cos(longitude)),
          static_cast<double>((n + height_m) * std::cos(latitude) * std::sin(longitude)),
          static_cast<double>((n * (1 - e2) + height_m) * std::sin(latitude))};
}

TEST_CASE("a gnss receiver is where the world stands on the ellipsoid") {
  // A geocentric coordinate of 6.4e6 m rounds to 1e-9 m, an angle of 50 degrees to as much on the ground.
  constexpr double kGeodetic_m = 1e-8;
  const double latitude = 49.44, longitude = 7.75, elevation = 240;
  const double phi = glm::radians(latitude), lambda = glm::radians(longitude);
  const glm::dvec3 east(-std::sin(lambda), std::cos(lambda), 0),
      north(-std::sin(phi) * std::cos(lambda), -std::sin(phi) * std::sin(lambda), std::cos(phi)),
      up(std::cos(phi) * std::cos(lambda), std::cos(phi) * std::sin(lambda), std::sin(phi));
  for (const auto& [heading, place] : {std::pair{0.0, glm::dvec3(0)}, std::pair{0.0, glm::dvec3(1200, -800, 35)},
                                       std::pair{90.0, glm::dvec3(500, 20, -3)}}) {
    Simulation simulation = moving(
        "<sensor type='gnss' name='GPS' insert_at='ROOT' latitude='49.44' longitude='7.75' elevation='240' heading='" +
        std::to_string(heading) + "' pose_offset='" + std::to_string(place.x) + " " + std::to_string(place.y) + " " +
        std::to_string(place.z) + " 0 0 0'/>");
    simulation.step();
    const glm::dvec3 measured =
        geocentric(simulation.value("GPS", "latitude_deg"), simulation.value("GPS", "longitude_deg"),
                   simulation.value("GPS", "altitude_m"));
    const glm::dvec3 x = heading == 0 ? east : north, y = heading == 0 ? north : -east;
    const glm::dvec3 expected = geocentric(latitude, longitude, elevation) + place.x * x + place.y * y + place.z * up;
    CHECK(glm::length(measured - expected) <= kGeodetic_m);
  }
}

TEST_CASE("a gnss receiver measures its velocity along east, north and up, and its errors are in metres") {
  const std::string receiver = R"(
    <part name="BODY" insert_at="ROOT"/>
    <element type="pose" name="MOVE" insert_at="BODY"/>
    <sensor type="gnss" name="GPS" insert_at="BODY" latitude="-33" longitude="151" heading="90")";
  Simulation exact = moving(receiver + "/>"),
             noisy = moving(receiver + R"( horizontal_bias_mean="3" vertical_stddev="2"/>)");
  for (Simulation* each : {&exact, &noisy}) {
    for (int i = 0; i < 3; ++i) {
      each->set("MOVE", "x", 0.2 * i);
      each->set("MOVE", "z", -0.1 * i);
      each->step();
    }
  }
  CHECK(std::abs(exact.value("GPS", "velocity_east_m_s")) <= kVelocityError);
  CHECK(std::abs(exact.value("GPS", "velocity_north_m_s") - 20) <= kVelocityError);
  CHECK(std::abs(exact.value("GPS", "velocity_up_m_s") + 10) <= kVelocityError);
  // 3 m east and 3 m north; a degree of latitude is about 111 km.
  const double north_m = (noisy.value("GPS", "latitude_deg") - exact.value("GPS", "latitude_deg")) * 111e3;
  CHECK(north_m == doctest::Approx(3).epsilon(0.01));
  CHECK(noisy.reading("GPS").constant("vertical_variance") == 4.0);
  CHECK(noisy.reading("GPS").constant("horizontal_variance") == 0.0);
}

constexpr std::string_view kVehicle = R"(
  <part name="CAR" insert_at="ROOT" pose_offset="3 4 0 0 0 30"/>
  <element type="pose" name="MOVE" insert_at="CAR"/>
  <sensor type="odometry" name="TRUE" insert_at="CAR"/>
  <sensor type="odometry" name="WHEELS" insert_at="CAR" kind="wheel" wheel_separation="0.4"/>
  <sensor type="odometry" name="WRONG" insert_at="CAR" kind="wheel" wheel_separation="0.4" right_scale_error="0.02"/>
  <sensor type="odometry" name="SHORT" insert_at="CAR" kind="wheel" wheel_separation="0.4" left_scale_error="-0.02"/>
  <sensor type="odometry" name="SLIPS" insert_at="CAR" kind="wheel" wheel_separation="0.4" slip_stddev="0.01"/>)";

/// Drives along a circle of radius 2 m with 1 m/s for `frames` frames.
void drive_circle(Simulation& simulation, int frames) {
  for (int i = 0; i <= frames; ++i) {
    const double turn = kFrame_s * i / 2;
    simulation.set("MOVE", "x", 2 * std::sin(turn));
    simulation.set("MOVE", "y", 2 - 2 * std::cos(turn));
    simulation.set("MOVE", "yaw", glm::degrees(turn));
    simulation.step();
  }
}

TEST_CASE("odometry along a circle: the true one, that of perfect wheels, and that of a wheel that counts too much") {
  Simulation simulation = moving(std::string(kVehicle));
  constexpr int kFrames = 200;
  drive_circle(simulation, kFrames);
  const double turn = kFrame_s * kFrames / 2;
  // Each of the steps adds its rounding.
  constexpr double kSummed = kFrames * kPoseError;
  for (const char* sensor : {"TRUE", "WHEELS"}) {
    CAPTURE(sensor);
    CHECK(std::abs(simulation.value(sensor, "x_m") - 2 * std::sin(turn)) <= kSummed);
    CHECK(std::abs(simulation.value(sensor, "y_m") - (2 - 2 * std::cos(turn))) <= kSummed);
    CHECK(std::abs(simulation.value(sensor, "qz") - std::sin(turn / 2)) <= kSummed);
    CHECK(std::abs(simulation.value(sensor, "velocity_x_m_s") - 1) <= kVelocityError);
    CHECK(std::abs(simulation.value(sensor, "angular_velocity_z_rad_s") - 0.5) <= kVelocityError);
  }
  // The wheels drive 0.9 m and 1.1 m per second; the right one counts 1.122 m.
  const double speed = (0.9 + 1.122) / 2, rate = (1.122 - 0.9) / 0.4, counted = rate * kFrame_s * kFrames;
  CHECK(std::abs(simulation.value("WRONG", "angular_velocity_z_rad_s") - rate) <= kVelocityError / 0.4);
  CHECK(std::abs(simulation.value("SHORT", "angular_velocity_z_rad_s") - (1.1 - 0.9 * 0.98) / 0.4) <=
        kVelocityError / 0.4);
  CHECK(std::abs(simulation.value("WRONG", "x_m") - speed / rate * std::sin(counted)) <= 10 * kSummed);
  CHECK(std::abs(simulation.value("WRONG", "y_m") - speed / rate * (1 - std::cos(counted))) <= 10 * kSummed);
}

TEST_CASE("the noise of wheels grows with the square root of their way, whatever the step") {
  constexpr int kSensors = 200;  // each has random numbers of its own
  std::string scene = R"(
      <part name="CAR" insert_at="ROOT"/><element type="pose" name="MOVE" insert_at="CAR"/>)";
  for (int i = 0; i < kSensors; ++i) {
    scene += "<sensor type=\"odometry\" name=\"SLIPS" + std::to_string(i) +
             "\" insert_at=\"CAR\" kind=\"wheel\" slip_stddev=\"0.01\"/>";
  }
  Simulation simulation = moving(scene);
  for (int i = 0; i <= 8; ++i) {
    simulation.set("MOVE", "x", 0.5 * i);
    simulation.step();
  }
  double sum = 0;
  for (int i = 0; i < kSensors; ++i) {
    const double heading = 2 * std::asin(simulation.value("SLIPS" + std::to_string(i), "qz"));
    sum += heading * heading;
  }
  // After 4 m each wheel is off by 0.02 m; the heading by sqrt(2) 0.02 m / 0.5 m. The tolerance is that of chi-square.
  CHECK(std::abs(sum / kSensors / (2 * 0.02 * 0.02 / 0.25) - 1) <= 5 * std::sqrt(2.0 / kSensors));
}

TEST_CASE("the errors of slipping wheels are as large as their covariances say: chi-square over 200 runs") {
  constexpr int kRuns = 200;
  std::string scene = R"(
      <part name="CAR" insert_at="ROOT"/><element type="pose" name="MOVE" insert_at="CAR"/>
      <sensor type="odometry" name="TRUE" insert_at="CAR"/>)";
  // With this slip a heading is off by some 0.007 rad in the end. What the covariance, which is of first order, leaves
  // out is the square of that over two, times 4 m: 1e-4 m, where the ways alone are off by 2e-3 m.
  for (int i = 0; i < kRuns; ++i) {
    scene += "<sensor type=\"odometry\" name=\"RUN" + std::to_string(i) +
             "\" insert_at=\"CAR\" kind=\"wheel\" slip_stddev=\"0.001\"/>";
  }
  Simulation simulation = moving(scene);
  drive_circle(simulation, 600);  // 6 m along a circle of 2 m
  const auto heading = [&](const std::string& sensor) {
    return 2 * std::atan2(simulation.value(sensor, "qz"), simulation.value(sensor, "qw"));
  };
  double of_poses = 0, of_twists = 0;
  for (int i = 0; i < kRuns; ++i) {
    const std::string run = "RUN" + std::to_string(i);
    const auto value = [&](const char* column) { return simulation.value(run, column); };
    const auto error = [&](const char* column) { return value(column) - simulation.value("TRUE", column); };
    const glm::dvec3 pose(error("x_m"), error("y_m"), heading(run) - heading("TRUE"));
    const double xy = value("covariance_x_y_m2"), xt = value("covariance_x_yaw_m_rad"),
                 yt = value("covariance_y_yaw_m_rad");
    const glm::dmat3 covariance(value("variance_x_m2"), xy, xt, xy, value("variance_y_m2"), yt, xt, yt,
                                value("variance_yaw_rad2"));
    of_poses += glm::dot(pose, glm::inverse(covariance) * pose);
    const glm::dvec2 twist(error("velocity_x_m_s"), error("angular_velocity_z_rad_s"));
    const double vw = value("covariance_velocity_x_angular_velocity_z_m_rad_s2");
    const glm::dmat2 of_twist(value("variance_velocity_x_m2_s2"), vw, vw, value("variance_angular_velocity_z_rad2_s2"));
    of_twists += glm::dot(twist, glm::inverse(of_twist) * twist);
  }
  // A sum of n squares of normal numbers has the mean n and the variance 2 n.
  for (const auto& [sum, degrees] : {std::pair{of_poses, 3.0 * kRuns}, std::pair{of_twists, 2.0 * kRuns}}) {
    CHECK(std::abs(sum / degrees - 1) <= 5 * std::sqrt(2 / degrees));
  }
}

TEST_CASE("wheels that do not slip, and ideal ones, have no covariances") {
  Simulation simulation = moving(std::string(kVehicle));
  simulation.step();
  CHECK(simulation.reading("SLIPS").find("variance_x_m2"));
  CHECK_FALSE(simulation.reading("WHEELS").find("variance_x_m2"));
  CHECK_FALSE(simulation.reading("TRUE").find("variance_x_m2"));
}

constexpr std::string_view kJoints = R"(
  <part name="ARM" insert_at="ROOT"/>
  <part name="OTHER" insert_at="ROOT"/>
  <element type="joint" name="ELBOW" insert_at="ARM" axis="0 1 0" lower="-180" upper="180"/>
  <element type="joint" name="SLIDE" insert_at="ARM" kind="prismatic" axis="1 0 0" lower="-5" upper="5"/>
  <element type="joint" name="WHEEL" insert_at="OTHER" axis="0 1 0" lower="-180" upper="180"/>
  <sensor type="joint_state" name="J" insert_at="ARM"/>
  <sensor type="joint_state" name="ALL" insert_at="ROOT" rate="50" position_precision="0.5"/>)";

TEST_CASE("joints have positions and velocities in SI units, of a part or of all") {
  Simulation simulation = moving(std::string(kJoints));
  for (int i = 0; i < 5; ++i) {
    simulation.set("ELBOW", "value", 2.0 * i);
    simulation.set("SLIDE", "value", -0.01 * i);
    simulation.set("WHEEL", "value", 30.0 * i);
    simulation.step();
    if (i == 0) CHECK(simulation.value("J", "ELBOW.velocity_rad_s") == 0);
  }
  CHECK(simulation.value("J", "ELBOW.position_rad") == glm::radians(8.0));
  CHECK(std::abs(simulation.value("J", "ELBOW.velocity_rad_s") - glm::radians(200.0)) <= 200 * 0x1p-52);
  CHECK(simulation.value("J", "SLIDE.position_m") == -0.04);
  CHECK(std::abs(simulation.value("J", "SLIDE.velocity_m_s") + 1) <= 1e-13);
  CHECK_FALSE(simulation.find_value("J", "WHEEL.position_rad"));
  CHECK(simulation.value("ALL", "WHEEL.position_rad") == 2);  // 2.09 rad in steps of 0.5
  CHECK(simulation.reading("J").arrays.size() == 4);
  Simulation none = moving(R"(<part name="P" insert_at="ROOT"/><sensor type="joint_state" name="J" insert_at="P"/>)");
  CHECK(
      error_of([&] { none.step(); }) ==
      "sensor \"J\": the part \"P\" has no joint, expected a part with elements of type joint, or ROOT for all joints");
}

std::vector<double> values_of(const Simulation& simulation) {
  std::vector<double> all;
  for (const SensorInfo& sensor : simulation.sensors()) {
    const std::vector<double>& values = simulation.reading(sensor.name).values();
    all.insert(all.end(), values.begin(), values.end());
  }
  return all;
}

TEST_CASE("frames between skipped ones measure what they measure in a run that makes all frames") {
  const std::string scene = std::string(kVehicle) + std::string(kJoints) + R"(
    <sensor type="imu" name="IMU" insert_at="CAR" gyroscope_noise_density="0.01" gyroscope_random_walk="0.1"
            accelerometer_dynamic_bias_stddev="0.1" accelerometer_dynamic_bias_correlation_time="5"/>
    <sensor type="imu" name="SLOW" insert_at="CAR" rate="25" gyroscope_noise_density="0.01"/>
    <sensor type="gnss" name="GPS" insert_at="CAR" horizontal_random_walk="0.3"/>)";
  Simulation all = moving(scene, 5), some = moving(scene, 5);
  int compared = 0;
  for (int i = 0; i < 40; ++i) {
    for (Simulation* each : {&all, &some}) {
      each->set("MOVE", "x", 0.001 * i * i);
      each->set("MOVE", "yaw", 3 * std::sin(0.3 * i));
      each->set("ELBOW", "value", i % 7);
    }
    all.step();
    if (i % 4 != 0 || i == 20) {
      some.skip_frame();
    } else {
      some.step();
      CHECK(values_of(all) == values_of(some));
      ++compared;
    }
  }
  CHECK(compared == 9);
}

TEST_CASE("motion is followed only for sensors that need it and are on") {
  Simulation plain = moving(std::string(kJoints) + R"(<sensor type="odometry" name="O" insert_at="ARM"/>)");
  plain.enable("J", false);
  plain.enable("ALL", false);
  for (int i = 0; i < 3; ++i) plain.step();
  CHECK(plain.diagnostics().motions_followed() == 0);
  plain.enable("J", true);
  plain.step();
  CHECK(plain.diagnostics().motions_followed() == 2);  // ELBOW and SLIDE
  Simulation one =
      moving(R"(<sensor type="imu" name="A" insert_at="ROOT"/><sensor type="imu" name="B" insert_at="ROOT"/>)");
  one.enable("B", false);
  one.step();
  CHECK(one.diagnostics().motions_followed() == 1);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
