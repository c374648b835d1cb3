// Sensors that move within a measurement: a mount that vibrates, and an arm of two joints, against closed forms.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include <simvis/diagnostics.h>
#include <simvis/simulation.h>

TEST_SUITE_BEGIN("effects");

namespace simvis {
namespace {

using Real = long double;

// A wall, and a mount that slides along x towards it and turns about z.
constexpr double kWall_m = 5, kAmplitude_m = 0.02, kAmplitude_deg = 0.5, kVibration_hz = 30;
constexpr double kMeasurements_hz = 10;

Real phase(Real time_s) { return 2 * std::numbers::pi_v<Real> * kVibration_hz * time_s; }

Simulation vibrating(const std::string& sensor, double frames_hz) {
  SimulationDesc desc;
  desc.rate_hz = frames_hz;
  return Simulation::from_string(
      R"(<part name="WALL" insert_at="ROOT" shape="plane" size="100 100" pose_offset="5 0 0 0 90 0"/>
         <part name="MOUNT" insert_at="ROOT"/>
         <element type="joint" name="SLIDE" insert_at="MOUNT" kind="prismatic" axis="1 0 0" lower="-1" upper="1"/>
         <part name="HEAD" insert_at="MOUNT"/>
         <element type="joint" name="TURN" insert_at="HEAD" axis="0 0 1" lower="-180" upper="180"/>)" +
          sensor,
      desc);
}

/// Makes frames up to and with `time_s`.
void vibrate(Simulation& simulation, double frames_hz, double time_s) {
  const auto frames = static_cast<int>(std::lround(time_s * frames_hz));
  for (int frame = 0; frame <= frames; ++frame) {
    const auto sine = static_cast<double>(std::sin(phase(frame / Real(frames_hz))));
    simulation.set("SLIDE", "value", kAmplitude_m * sine);
    simulation.set("TURN", "value", kAmplitude_deg * sine);
    simulation.step();
  }
}

/// A line through the values at frames is off a sine by at most its acceleration times the square of the time between
/// frames over 8.
double chord_error(double amplitude, double frames_hz) {
  const double omega = 2 * std::numbers::pi * kVibration_hz;
  return amplitude * omega * omega / (8 * frames_hz * frames_hz);
}

/// The range of a beam at this angle, which left at this time.
Real range_of(Real azimuth_rad, Real time_s) {
  const Real sine = std::sin(phase(time_s));
  return (kWall_m - kAmplitude_m * sine) /
         std::cos(azimuth_rad + kAmplitude_deg * std::numbers::pi_v<Real> / 180 * sine);
}

TEST_CASE("a scanner on a vibrating mount measures at each beam's time where the mount is then") {
  constexpr int kBeams = 181;
  constexpr double kSweep_s = 0.1, kHalf_deg = 45;
  const auto largest_error = [&](double frames_hz, double& bound_m) {
    Simulation simulation = vibrating(
        "<sensor type='laser_scanner' name='SCAN' insert_at='HEAD' samples='181' min_angle='-45' max_angle='45' "
        "sweep='0.1' rate='10'/>",
        frames_hz);
    vibrate(simulation, frames_hz, 0.3);
    const Scan& scan = simulation.scan("SCAN");
    REQUIRE(scan.range_m.size() == kBeams);
    double error_m = 0;
    bound_m = 0;
    for (std::size_t i = 0; i < kBeams; ++i) {
      const Real share = static_cast<Real>(i) / (kBeams - 1);
      const Real azimuth = (2 * share - 1) * kHalf_deg * std::numbers::pi_v<Real> / 180;
      const Real expected = range_of(azimuth, 0.3L - kSweep_s * (1 - share));
      error_m = std::max(error_m, static_cast<double>(std::abs(static_cast<Real>(scan.range_m[i]) - expected)));
      bound_m = std::max(bound_m, static_cast<double>(scan.error_bound_m[i]));
    }
    return error_m;
  };
  double bound_m = 0;
  for (const double frames_hz : {500.0, 1000.0, 4000.0}) {
    CAPTURE(frames_hz);
    // At 45 degrees a range changes by sqrt(2) times the slide, and by 2 * 5 m for each radian.
    constexpr double kPerRadian_m = 2 * kWall_m;
    const double tolerance_m = std::numbers::sqrt2 * chord_error(kAmplitude_m, frames_hz) +
                               kPerRadian_m * chord_error(kAmplitude_deg * std::numbers::pi / 180, frames_hz);
    // What is left out is of second order in the amplitudes: below a tenth.
    const double error_m = largest_error(frames_hz, bound_m);
    CHECK(error_m <= 1.1 * tolerance_m + bound_m);
    CHECK(error_m > tolerance_m / 10);  // it is this error
  }
  // Frames of 10 Hz show a mount that stands still: three vibrations fit between them.
  CHECK(largest_error(kMeasurements_hz, bound_m) > kAmplitude_m / 2);
}

TEST_CASE("rows of a rolling shutter see a vibrating mount at their times") {
  constexpr int kHeight = 48;
  constexpr double kRow_s = 0.002, kFrames_hz = 2000;
  Simulation simulation = vibrating(
      "<sensor type='camera' name='CAM' insert_at='HEAD' width='4' height='48' hfov='2' outputs='depth' rate='10' "
      "row_time='0.002' rows_per_pose='1'/>",
      kFrames_hz);
  vibrate(simulation, kFrames_hz, 0.2);
  const Image depth = simulation.depth("CAM");
  const double bound_m = simulation.value("CAM", "depth_error_bound_m");
  const double tolerance_m = chord_error(kAmplitude_m, kFrames_hz) + bound_m +
                             // The mount turns by half a degree at most: the wall is slanted, and deeper by 1 / cos.
                             kWall_m * (1 / std::cos(1.5 * std::numbers::pi / 180) - 1) * 2;
  double least_m = kWall_m, most_m = kWall_m;
  for (int row = 0; row < kHeight; ++row) {
    const Real time_s = 0.2L - kRow_s * (kHeight - 1 - row);
    const Real expected = kWall_m - kAmplitude_m * std::sin(phase(time_s));
    const auto measured = static_cast<double>(depth.pixels[static_cast<std::size_t>(4 * row + 2)]);
    CHECK(std::abs(measured - static_cast<double>(expected)) <= tolerance_m);
    least_m = std::min(least_m, measured);
    most_m = std::max(most_m, measured);
  }
  CHECK(most_m - least_m > 1.8 * kAmplitude_m);
}

TEST_CASE("a plate on an arm of two joints is met along the joints, by a sensor that stands and by one on the arm") {
  SimulationDesc desc;
  desc.rate_hz = 10;
  // The plate is the plane z = 0.2 of the hand, which both joints turn.
  Simulation simulation = Simulation::from_string(
      R"(<part name="UPPER" insert_at="ROOT" pose_offset="0 0 0 0 0 0"/>
         <element type="joint" name="SHOULDER" insert_at="UPPER" axis="1 0 0" lower="-180" upper="180"/>
         <part name="LOWER" insert_at="UPPER" pose_offset="0 0.5 1 0 0 0"/>
         <element type="joint" name="ELBOW" insert_at="LOWER" axis="0 1 0" lower="-180" upper="180"/>
         <part name="PLATE" insert_at="LOWER" shape="plane" size="1000 1000" pose_offset="0 0 0.2 0 0 0"/>
         <sensor type="laser_scanner" name="BELOW" insert_at="ROOT" pose_offset="0.1 0.2 -1 0 -90 0" samples="21"
                 min_angle="-20" max_angle="20" sweep="0.1"/>
         <sensor type="laser_scanner" name="ABOARD" insert_at="UPPER" pose_offset="0.1 0.2 -1 0 -90 0" samples="21"
                 min_angle="-20" max_angle="20" sweep="0.1"/>)",
      desc);
  constexpr double kShoulder_deg = 20, kElbow_deg = -30;
  simulation.step();
  simulation.set("SHOULDER", "value", kShoulder_deg);
  simulation.set("ELBOW", "value", kElbow_deg);
  simulation.step();
  const auto cross_axis = [](const glm::vec<3, Real>& v, int axis, Real angle) {  // turned about x (0) or y (1)
    const Real c = std::cos(angle), s = std::sin(angle);
    return axis == 0 ? glm::vec<3, Real>(v.x, c * v.y - s * v.z, s * v.y + c * v.z)
                     : glm::vec<3, Real>(c * v.x + s * v.z, v.y, c * v.z - s * v.x);
  };
  for (const std::string name : {"BELOW", "ABOARD"}) {
    CAPTURE(name);
    const Scan& scan = simulation.scan(name);
    for (std::size_t i = 0; i < scan.range_m.size(); ++i) {
      const Real share = static_cast<Real>(i) / 20, azimuth = (share * 40 - 20) * std::numbers::pi_v<Real> / 180;
      const Real shoulder = share * kShoulder_deg * std::numbers::pi_v<Real> / 180,
                 elbow = share * kElbow_deg * std::numbers::pi_v<Real> / 180;
      // The scanner looks up: its x is z, and its y stays.
      const glm::vec<3, Real> origin(0.1L, 0.2L, -1), direction(0, std::sin(azimuth), std::cos(azimuth));
      // In UPPER for the scanner aboard, else in the world.
      const bool aboard = name == "ABOARD";
      const auto from_upper = [&](const glm::vec<3, Real>& v) { return aboard ? v : cross_axis(v, 0, shoulder); };
      const glm::vec<3, Real> normal = from_upper(cross_axis({0, 0, 1}, 1, elbow));
      const glm::vec<3, Real> point = from_upper(glm::vec<3, Real>(0, 0.5L, 1) + cross_axis({0, 0, 0.2L}, 1, elbow));
      const Real expected = glm::dot(normal, point - origin) / glm::dot(normal, direction);
      const Real slant = 1 / std::abs(glm::dot(normal, direction));
      constexpr double kPoses_m = 40 * 0x1p-53 * 3;  // forty roundings of chained poses within 3 m
      const Real tolerance_m = scan.error_bound_m[i] + expected * 0x1p-24L + kPoses_m * slant;
      CHECK(std::abs(static_cast<Real>(scan.range_m[i]) - expected) <= tolerance_m);
    }
  }
}

TEST_CASE("frames between the measurements of sensors that take all at once record no poses") {
  Simulation simulation = vibrating("<sensor type='laser_scanner' name='SCAN' insert_at='HEAD' rate='10'/>", 100);
  vibrate(simulation, 100, 0.2);
  CHECK(simulation.diagnostics().motions_followed() == 0);
}

TEST_CASE("other sensors do not change how a sensor moves where sensors decide which frames there are") {
  const auto append = [](const Simulation& simulation, std::vector<double>& values) {
    for (const char* const name : {"SCAN", "IMU", "GNSS", "ODOMETRY", "JOINTS", "RADAR"}) {
      for (const MeasuredArray& each : simulation.measurement(name).arrays) {
        for (std::size_t i = 0; i < each.count(); ++i) values.push_back(each.number(i));
      }
    }
  };
  const auto measure = [&](const std::string& more) {
    SimulationDesc desc;
    desc.frames_when_due = true;
    Simulation simulation = Simulation::from_string(
        R"(<part name="WALL" insert_at="ROOT" shape="plane" size="100 100" pose_offset="5 0 0 0 90 0"/>
           <part name="BODY" insert_at="ROOT"/>
           <element type="joint" name="SLIDE" insert_at="BODY" kind="prismatic" axis="1 0 0" lower="-1" upper="1"/>
           <part name="HEAD" insert_at="BODY"/>
           <element type="joint" name="TURN" insert_at="HEAD" axis="0 0 1" lower="-180" upper="180"/>
           <sensor type="laser_scanner" name="SCAN" insert_at="HEAD" samples="31" min_angle="-30" max_angle="30"
                   sweep="0.1" truth="velocity" rate="10"/>
           <sensor type="imu" name="IMU" insert_at="HEAD" rate="10"/>
           <sensor type="gnss" name="GNSS" insert_at="HEAD" rate="10"/>
           <sensor type="odometry" name="ODOMETRY" insert_at="HEAD" rate="10"/>
           <sensor type="joint_state" name="JOINTS" insert_at="HEAD" rate="10"/>
           <sensor type="radar" name="RADAR" insert_at="HEAD" rate="10"/>)" +
            more,
        desc);
    std::vector<double> values;
    while (simulation.next_frame().time_ns <= 400'000'000) {
      const double time_s = static_cast<double>(simulation.next_frame().time_ns) / 1e9;
      simulation.set("SLIDE", "value", 0.1 * std::sin(20 * time_s));
      simulation.set("TURN", "value", 10 * std::cos(15 * time_s));
      simulation.step();
      if (simulation.last_frame()->time_ns % 100'000'000 != 0) continue;
      append(simulation, values);
    }
    return values;
  };
  const std::vector<double> alone = measure(""),
                            in_company =
                                measure("<sensor type='altimeter' name='ALTITUDE' insert_at='ROOT' rate='37'/>");
  REQUIRE(alone.size() > 100);
  REQUIRE(alone.size() == in_company.size());
  std::size_t others = 0;
  for (std::size_t i = 0; i < alone.size(); ++i) {
    others += !(alone[i] == in_company[i] || (std::isnan(alone[i]) && std::isnan(in_company[i])));
  }
  CHECK(others == 0);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
