// Radiances of black bodies against numeric integrals, temperatures against radiances, and the bolometer against its
// differential equation.
#include "sensors/thermal_camera/band_radiance.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <vector>

#include "sensors/thermal_camera/bolometer.h"
#include "sensors/thermal_camera/false_color.h"
#include "tests/sensors/planck_integral.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis::test {
namespace {

TEST_CASE("the radiance of a black body, and its slope, are the integrals of Planck's law over the band") {
  for (const double kelvin : {100.0, 233.15, 273.15, 293.15, 300.0, 310.15, 373.15, 655.35, 1500.0, 3000.0}) {
    CAPTURE(kelvin);
    const double radiance = planck_integral(kelvin), slope = planck_integral(kelvin, true);
    CHECK(std::abs(band_radiance(kelvin) / radiance - 1) < kPlanckError);
    CHECK(std::abs(band_radiance_slope(kelvin) / slope - 1) < kPlanckError);
  }
  // It is no power of the temperature: the exponent T L' / L falls from about 4.9 at 293 K to 1.2 at 3000 K.
  CHECK(293.15 * band_radiance_slope(293.15) / band_radiance(293.15) > 4.5);
  CHECK(3000 * band_radiance_slope(3000) / band_radiance(3000) < 1.5);
  for (const double nothing : {0.0, 1e-300, 0.5}) {
    CHECK(band_radiance(nothing) == 0);
    CHECK(band_radiance_slope(nothing) == 0);
  }
}

// The temperature with this logarithm of its radiance, by Newton's method on the series itself.
double solved_temperature_k(double log_radiance, double start_k) {
  double kelvin = start_k;
  for (int i = 0; i < 50; ++i) {
    const double radiance = band_radiance(kelvin);
    kelvin += (log_radiance - std::log(radiance)) * radiance / band_radiance_slope(kelvin);
  }
  return kelvin;
}

TEST_CASE("the temperature of a radiance is that of the body, within the error of the interpolation") {
  // Cubic Hermite interpolation of u = 1 / T errs by h^4 / 384 u''''; h^4 u'''' is the fourth difference of u over
  // nodes at a distance h. Half of it again covers its change between the nodes. T then errs by T^2 times that of u.
  // The radiance itself is exact to 1e-12, T by less than that share of itself; storing nothing else rounds.
  constexpr double kMargin = 1.5, kRounding = 1e-12;
  double largest_k = 0;
  for (double kelvin = kColdest_k + 0.5; kelvin < 3000; kelvin *= 1.0137) {
    CAPTURE(kelvin);
    const double y = std::log(band_radiance(kelvin));
    double difference = 0;
    for (int k = -2; k <= 2; ++k) {
      constexpr double kWeights[] = {1, -4, 6, -4, 1};
      difference += kWeights[k + 2] / solved_temperature_k(y + k * kRadianceStep, kelvin);
    }
    const double bound_k = kMargin * kelvin * kelvin * std::abs(difference) / 384 + kRounding * kelvin;
    const double error_k = std::abs(band_temperature_k(band_radiance(kelvin)) - kelvin);
    CHECK(error_k < bound_k);
    largest_k = std::max(largest_k, kelvin < 1000 ? error_k : 0);
  }
  CHECK(largest_k < 1e-6);  // the header's promise
  CHECK(band_temperature_k(0) == 0);
  CHECK(band_temperature_k(-1) == 0);
  CHECK(band_temperature_k(std::nan("")) == 0);
  CHECK(band_temperature_k(1e9) == kHottest_k);
  CHECK(band_temperature_k(INFINITY) == kHottest_k);
}

TEST_CASE("a pixel follows its radiance as the differential equation says, whatever the time between measurements") {
  constexpr double kConstant_s = 0.012;
  Bolometer bolometer({.time_constant_s = kConstant_s}, 1, "T", 2);
  struct Moment {
    double time_s, radiance;
  };
  const Moment moments[] = {{0, 40}, {0.01, 40}, {0.02, 55}, {0.05, 30}, {0.0505, 80}, {1, 80}};
  // dS/dt = (L - S) / T by the classic Runge-Kutta method with L linear in between. A step of h T errs by (h / T)^5 /
  // 120 of the largest difference L - S, 50; 20,000 steps of at most 1 / 200 of T make less than 3e-10.
  double expected = moments[0].radiance;
  std::vector<double> signal{moments[0].radiance, 2 * moments[0].radiance};
  bolometer.read({.index = 0, .time_ns = 0}, signal);
  CHECK(signal[0] == moments[0].radiance);
  for (std::size_t k = 1; k < std::size(moments); ++k) {
    CAPTURE(k);
    const double between_s = moments[k].time_s - moments[k - 1].time_s;
    constexpr int kSteps = 20000;
    const double h = between_s / kSteps;
    const auto slope = [&](double s, double t) {
      const double l = moments[k - 1].radiance + (moments[k].radiance - moments[k - 1].radiance) * t / between_s;
      return (l - s) / kConstant_s;
    };
    for (int i = 0; i < kSteps; ++i) {
      const double t = i * h, a = slope(expected, t), b = slope(expected + h / 2 * a, t + h / 2),
                   c = slope(expected + h / 2 * b, t + h / 2), d = slope(expected + h * c, t + h);
      expected += h / 6 * (a + 2 * b + 2 * c + d);
    }
    const FrameTime time{.index = k, .time_ns = static_cast<std::int64_t>(std::llround(moments[k].time_s * 1e9))};
    for (int attempt = 0; attempt < 2; ++attempt) {  // a frame that is repeated does not count twice
      signal = {moments[k].radiance, 2 * moments[k].radiance};
      bolometer.read(time, signal);
      CHECK(signal[0] == doctest::Approx(expected).epsilon(1e-9));
      CHECK(signal[1] == doctest::Approx(2 * expected).epsilon(1e-9));
    }
  }
}

TEST_CASE("false colours go from black to white, and their brightness rises evenly") {
  CHECK(false_color(0) == glm::dvec3(0));
  CHECK(false_color(1) == glm::dvec3(1));
  double before = -1;
  for (int i = 0; i <= 255; ++i) {
    const glm::dvec3 color = false_color(i / 255.0);
    // The brightness of the article, of which the helix is built: exact unless a channel is clipped.
    const double brightness = 0.30 * color.r + 0.59 * color.g + 0.11 * color.b;
    CHECK(brightness > before);
    // The article's numbers have five digits: an error of 5e-6 at most, times an amplitude of 1/8.
    CHECK(std::abs(brightness - i / 255.0) < 1e-6);
    before = brightness;
  }
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
