// The noise of a sensor reaches each of its values, each with random numbers of its own, and its variance is reported.
#include <doctest/doctest.h>

#include <chrono>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <simvis/simulation.h>

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

constexpr std::string_view kNoisyWorld = R"(
  <part name="ROBOT" insert_at="ROOT"/>
  <element type="joint" name="ELBOW" insert_at="ROBOT" axis="0 1 0" lower="-90" upper="90" value="20"/>
  <element type="joint" name="SLIDE" insert_at="ROBOT" kind="prismatic" axis="1 0 0" lower="-5" upper="5"/>
  <part name="WALL" shape="box" size="0.25 4 4" insert_at="ROOT" pose_offset="3 0 0 0 0 0"/>
  <part name="TAG" insert_at="ROOT" pose_offset="2 0.5 0 0 0 0"/>)";

/// A quantity of a type of sensor: the prefix of its noise and the columns that have it.
struct NoisyQuantity {
  std::string type, prefix;
  std::vector<std::string> columns;
  std::string variance{};  // the constant that says the variance of its white noise
};

const std::vector<NoisyQuantity>& noisy_quantities() {
  static const std::vector<NoisyQuantity> all = {
      {"imu",
       "gyroscope_",
       {"angular_velocity_x_rad_s", "angular_velocity_y_rad_s", "angular_velocity_z_rad_s"},
       "angular_velocity_variance"},
      {"imu",
       "accelerometer_",
       {"specific_force_x_m_s2", "specific_force_y_m_s2", "specific_force_z_m_s2"},
       "specific_force_variance"},
      {"gnss", "horizontal_", {}, "horizontal_variance"},
      {"gnss", "vertical_", {"altitude_m"}, "vertical_variance"},
      {"gnss", "velocity_", {"velocity_east_m_s", "velocity_north_m_s", "velocity_up_m_s"}},
      {"magnetometer", "", {"field_x_t", "field_y_t", "field_z_t"}, "field_variance"},
      {"barometer", "", {"pressure_pa"}, "pressure_variance"},
      {"altimeter", "vertical_position_", {"vertical_position_m"}},
      {"altimeter", "vertical_velocity_", {"vertical_velocity_m_s"}},
      {"joint_state", "position_", {"ELBOW.position_rad", "SLIDE.position_m"}},
      {"joint_state", "velocity_", {"ELBOW.velocity_rad_s", "SLIDE.velocity_m_s"}},
      {"range", "", {"range_m"}, "range_variance"},
      {"sonar", "", {"range_m"}, "range_variance"},
      {"touch", "", {"depth_m"}},
      {"beacon", "", {"range_m"}},
      {"light_sensor", "", {"illuminance_lx"}, "illuminance_variance"},
      {"radar", "range_", {"range_m"}},
      {"radar", "azimuth_", {"azimuth_rad"}},
      {"radar", "speed_", {"radial_speed_m_s"}}};
  return all;
}

Reading reading_with(const NoisyQuantity& quantity, const std::string& noise, double value) {
  const std::string more = quantity.type == "beacon" ? " beacons='TAG'" : "";
  Simulation simulation = Simulation::from_string(std::string(kNoisyWorld) + "<sensor type='" + quantity.type +
                                                  "' name='S' insert_at='ROBOT'" + more + " " + quantity.prefix +
                                                  noise + "='" + std::to_string(value) + "'/>");
  for (int i = 0; i < 2; ++i) simulation.step();
  return simulation.reading("S");
}

TEST_CASE("a bias is added to each value of its quantity") {
  constexpr double kBias = 0.25;
  for (const NoisyQuantity& quantity : noisy_quantities()) {
    const Reading exact = reading_with(quantity, "bias_mean", 0), biased = reading_with(quantity, "bias_mean", kBias);
    for (const std::string& column : quantity.columns) {
      CAPTURE(quantity.type);
      CAPTURE(column);
      REQUIRE(exact.find(column));
      // The sum rounds once, and the position on the ellipsoid some 30 times at 6.4e6 m.
      const double rounding = quantity.type == "gnss" ? 1e-8 : 4 * 0x1p-53 * (std::abs(*exact.find(column)) + kBias);
      CHECK(std::abs(*biased.find(column) - *exact.find(column) - kBias) <= rounding);
    }
  }
}

TEST_CASE("the values of a quantity have random numbers of their own") {
  int vectors = 0;
  for (const NoisyQuantity& quantity : noisy_quantities()) {
    if (quantity.columns.size() < 2) continue;
    CAPTURE(quantity.prefix);
    const Reading exact = reading_with(quantity, "stddev", 0), noisy = reading_with(quantity, "stddev", 1);
    std::set<float> errors;  // the same error would differ by its rounding alone
    for (const std::string& column : quantity.columns) {
      errors.insert(static_cast<float>(*noisy.find(column) - *exact.find(column)));
    }
    CHECK(errors.size() == quantity.columns.size());
    CHECK_FALSE(errors.contains(0.0f));
    ++vectors;
  }
  CHECK(vectors == 6);
  // East and north of a place on the equator, where a degree of longitude is 0.7 % longer than one of latitude.
  const NoisyQuantity place{"gnss", "horizontal_", {}};
  const Reading exact = reading_with(place, "stddev", 0), noisy = reading_with(place, "stddev", 1);
  const double east = *noisy.find("longitude_deg") - *exact.find("longitude_deg"),
               north = *noisy.find("latitude_deg") - *exact.find("latitude_deg");
  CHECK(std::abs(east - north) > 0.1 * std::abs(east));
}

TEST_CASE("white noise in continuous units is that of the time from sample to sample") {
  constexpr double kDensity = 0.5, kStep_s = 0.002;
  const auto variance = [&](const std::string& rate, std::optional<double> step_s) {
    Simulation simulation = Simulation::from_string("<sensor type='imu' name='S' insert_at='ROOT' " + rate +
                                                    " gyroscope_noise_density='" + std::to_string(kDensity) + "'/>");
    for (int i = 0; i < 3; ++i) {
      if (step_s) {
        simulation.step(std::chrono::nanoseconds(std::llround(*step_s * 1e9)));
      } else {
        simulation.step();
      }
    }
    return simulation.reading("S").constant("angular_velocity_variance").value();
  };
  // Sigma^2 = density^2 / period. The frames come at 15 Hz unless a step says otherwise; their period is whole ns.
  constexpr double kPeriod = 1e-8;
  CHECK(variance("", {}) == doctest::Approx(kDensity * kDensity * 15).epsilon(kPeriod));
  CHECK(variance("", kStep_s) == doctest::Approx(kDensity * kDensity / kStep_s).epsilon(kPeriod));
  CHECK(variance("rate='200'", {}) == doctest::Approx(kDensity * kDensity * 15).epsilon(kPeriod));
  CHECK(variance("rate='200'", kStep_s) == doctest::Approx(kDensity * kDensity * 200).epsilon(kPeriod));
  CHECK(variance("rate='5'", {}) == doctest::Approx(kDensity * kDensity * 5).epsilon(kPeriod));
}

TEST_CASE("a reading has the variance of each quantity's white noise, and of no other") {
  int told = 0;
  for (const NoisyQuantity& quantity : noisy_quantities()) {
    if (quantity.variance.empty()) continue;
    CAPTURE(quantity.variance);
    CHECK(reading_with(quantity, "stddev", 0.5).constant(quantity.variance) == 0.25);
    for (const NoisyQuantity& other : noisy_quantities()) {
      if (other.type != quantity.type || other.prefix == quantity.prefix || other.variance.empty()) continue;
      CHECK(reading_with(quantity, "stddev", 0.5).constant(other.variance) == 0.0);
    }
    ++told;
  }
  CHECK(told == 9);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
