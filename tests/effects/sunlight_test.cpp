// The effect `sunlight` against its closed form: the radiance that a beam sees, the noise, and what is lost.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <simvis/simulation.h>
#include "engine/light/surface_shares.h"
#include "tests/support/infinity.h"
#include "tests/support/made_up_scan.h"

TEST_SUITE_BEGIN("effects");

namespace simvis::test::sunlit {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kReflectance = 0.5, kAmbient = 0.1, kSky = 0.8, kSun = 2, kHeight_deg = 30;

// A wall at 4 m across the beams, the sun behind the scanner, and something in the sunlight that no beam meets.
std::string scene(const std::string& attributes, const std::string& more = {}, double wall_m = 4) {
  return R"(<simvis>
  <part shape="box" size="0.02 20 20" name="WALL" insert_at="ROOT" pose_offset=")" +
         format_number(wall_m + 0.01) + R"( 0 0 0 0 0"/>
  <element type="material" name="PAINT" insert_at="ROOT" part="WALL" reflectance="0.5"/>
  <element type="light" name="SUN" insert_at="ROOT" intensity="2" azimuth="180" elevation="30"/>
  <element type="sky" name="SKY" insert_at="ROOT" red="0.8" green="0.8" blue="0.8"
           ambient_red="0.1" ambient_green="0.1" ambient_blue="0.1"/>)" +
         more + R"(
  <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="5000" min_angle="0" max_angle="0" )" +
         attributes + "/>\n</simvis>\n";
}
const std::string kAwning = R"(<part shape="box" size="1 1 1" name="AWNING" insert_at="ROOT"
  pose_offset="1.4 0 1.5 0 0 0"/>)";

std::string with(const std::string& name, double value) { return name + "=\"" + format_number(value) + "\" "; }

double lost_in(const std::string& xml) {
  Simulation simulation = Simulation::from_string(xml);
  simulation.step();
  return static_cast<double>(std::ranges::count(simulation.scan("SCAN").range_m, kInfinity));
}

double cosine() { return std::cos(kHeight_deg * kPi / 180); }
double radiance_of_wall(double sun) { return kReflectance * (kAmbient + sun * cosine() / kPi); }
double noise(double sunlight, double radiance) { return std::sqrt(1 + sunlight * radiance); }

// Colours and lights are float32.
constexpr double kColor = 4 * 0x1p-24;

}  // namespace

TEST_CASE("an echo is lost as an amplitude in the noise of receiver and light is, also beside dropout") {
  constexpr double kPower = kReflectance / 16, kSpread = 0.25, kBeams = 5000;
  const double radiance = radiance_of_wall(kSun);
  // The power is far above the first threshold in the dark, and one deviation above the second.
  for (const double threshold : {0.01, kPower / (1 + kSpread)}) {
    for (const double sigmas : {-1.5, 0.0, 0.5}) {
      CAPTURE(threshold);
      CAPTURE(sigmas);
      // The noise q for which the power is this many deviations above the threshold: P = q T (1 + s sigmas).
      const double q = kPower / (threshold * (1 + kSpread * sigmas)), sunlight = (q * q - 1) / radiance;
      const double seen = normal_below(sigmas);
      const double lost = lost_in(
          scene(with("sunlight", sunlight) + with("dropout_power", threshold) + with("dropout_noise", kSpread)));
      CHECK(std::abs(lost - kBeams * (1 - seen)) <= binomial_bound(5000, seen) + kBeams * kColor);
    }
  }
}

TEST_CASE("the range falls with the root of the noise; without dropout_power it is that of a reflectance of 0.1") {
  constexpr double kSunlight = 500, kNear = 1e-5;  // far above what float32 colours do to the radiance
  for (const auto& each :
       {std::pair(with("dropout_power", 0.002), 0.002), std::pair(with("range_max", 30), 0.1 / 900)}) {
    const auto [attributes, threshold] = each;
    CAPTURE(each.first);
    const std::string on = with("sunlight", kSunlight) + attributes + with("dropout_noise", 0);
    // reflectance / r^2 = q T
    const double limit_m = std::sqrt(kReflectance / (noise(kSunlight, radiance_of_wall(kSun)) * threshold));
    CHECK(lost_in(scene(on, "", limit_m * (1 - kNear))) == 0);
    CHECK(lost_in(scene(on, "", limit_m * (1 + kNear))) == 5000);
    CHECK(lost_in(scene(with("sunlight", 0) + attributes + with("dropout_noise", 0), "", limit_m * (1 + kNear))) == 0);
  }
}

namespace {

// Whether the threshold for this radiance lies between two that differ by 1e-5.
bool sees(const std::string& more, double radiance, const std::string& attributes, double power) {
  constexpr double kSunlight = 50, kNear = 1e-5;
  const double threshold = power / noise(kSunlight, radiance);
  const auto lost = [&](double share) {
    return lost_in(scene(
        attributes + with("sunlight", kSunlight) + with("dropout_noise", 0) + with("dropout_power", threshold * share),
        more));
  };
  return lost(1 - kNear) == 0 && lost(1 + kNear) == 5000;
}

}  // namespace

TEST_CASE(
    "what hides the sun leaves the ambient light; a pane dims it; point lights and the backs of walls count not") {
  constexpr double kPower = kReflectance / 16;
  CHECK(sees("", radiance_of_wall(kSun), "", kPower));
  CHECK(sees(kAwning, radiance_of_wall(0), "", kPower));
  const double pane = 1 - pane_reflectance(1.5, cosine());  // light enters and leaves the box through its sides
  CHECK(sees(kAwning + R"(<element type="material" name="GLASS" insert_at="ROOT" part="AWNING" transmission="1"/>)",
             radiance_of_wall(kSun * pane * pane), "", kPower));
  CHECK(sees(R"(<element type="light" name="LAMP" insert_at="ROOT" kind="point" x="2" intensity="100"/>
    <element type="light" name="BEHIND" insert_at="ROOT" intensity="100" azimuth="0" elevation="30"/>)",
             radiance_of_wall(kSun), "", kPower));
}

TEST_CASE("the share of a beam that meets nothing sees the sky") {
  // The wall ends at y = 0, so that every second ray of a cone meets it.
  const std::string half = R"(<simvis>
  <part shape="box" size="0.02 20 20" name="WALL" insert_at="ROOT" pose_offset="4.01 10 0 0 0 0"/>
  <element type="material" name="PAINT" insert_at="ROOT" part="WALL" reflectance="0.5"/>
  <element type="light" name="SUN" insert_at="ROOT" intensity="0"/>
  <element type="sky" name="SKY" insert_at="ROOT" red="0.8" green="0.8" blue="0.8"
           ambient_red="0.1" ambient_green="0.1" ambient_blue="0.1"/>
  <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="200" min_angle="0" max_angle="0"
          divergence="0.01" divergence_samples="2" sunlight="50" dropout_noise="0" )";
  const double radiance = (kReflectance * kAmbient + kSky) / 2;
  // Rays leave by 0.005 degrees at most, which changes range and cosine by less than 1e-8.
  const double threshold = kReflectance / 2 / 16 / noise(50, radiance);
  CHECK(lost_in(half + with("dropout_power", threshold * (1 - 1e-5)) + "/></simvis>") == 0);
  CHECK(lost_in(half + with("dropout_power", threshold * (1 + 1e-5)) + "/></simvis>") == 200);
}

}  // namespace simvis::test::sunlit

TEST_SUITE_END();
