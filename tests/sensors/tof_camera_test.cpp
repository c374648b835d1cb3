// Phases of modulated light: wrapping, mixtures, light of one bounce and noise against their formulas.
#include "sensors/depth_camera/tof_camera.h"

#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;

namespace {

constexpr double kLight_mps = 299792458, kFrequency_hz = 30e6;
constexpr double kWrap_m = kLight_mps / (2 * kFrequency_hz);
// A range that is stored as a float below 8 m, after the rounding of its phase.
constexpr double kStored_m = 0x1p-22;

struct TofImages {
  Image range, amplitude, depth;
};

TofImages tof_images(Simulation& simulation) {
  simulation.step();
  const Measurement measurement = simulation.measurement("T");
  TofImages images;
  for (const auto& [name, image] : {std::pair("range", &images.range), std::pair("amplitude", &images.amplitude),
                                    std::pair("depth", &images.depth)}) {
    REQUIRE(measurement.find(name) != nullptr);
    *image = to_image(*measurement.find(name)).value();
  }
  return images;
}

std::string tof_camera(std::uint32_t width, std::uint32_t height, const std::string& attributes) {
  return R"(<sensor type="tof_camera" name="T" insert_at="ROOT" hfov="90" outputs="depth range amplitude" width=")" +
         std::to_string(width) + R"(" height=")" + std::to_string(height) + "\" " + attributes + "/></simvis>";
}

// A wall with its front at x, of this reflectance.
std::string tof_wall(double x_m, double reflectance, const std::string& size = "40 40", double y_m = 0) {
  const std::string name = "WALL" + std::to_string(static_cast<int>(10 * x_m));
  return R"(<part name=")" + name + R"(" shape="box" size="0.2 )" + size + R"(" insert_at="ROOT" pose_offset=")" +
         format_number(x_m + 0.1) + " " + format_number(y_m) + R"( 0 0 0 0"/><element type="material" name="M)" + name +
         R"(" insert_at="ROOT" part=")" + name + R"(" reflectance=")" + format_number(reflectance) + R"("/>)";
}

TofImages tof_images(const std::string& scene, std::uint32_t width, std::uint32_t height,
                     const std::string& attributes) {
  Simulation simulation = Simulation::from_string("<simvis>" + scene + tof_camera(width, height, attributes));
  return tof_images(simulation);
}

TEST_CASE("ranges begin again at c / 2f, and amplitudes are R cos(i) / r^2") {
  for (const double wall_m : {1.0, 4.5, 5.5, 12.0}) {
    CAPTURE(wall_m);
    const TofImages images = tof_images(tof_wall(wall_m, 0.5), 9, 7, "");
    for (std::uint32_t pixel = 0; pixel < 63; ++pixel) {
      CAPTURE(pixel);
      const double x = (pixel % 9 + 0.5 - 4.5) / 4.5, y = (pixel / 9 + 0.5 - 3.5) / 4.5;
      const double slant = std::sqrt(1 + x * x + y * y), range_m = wall_m * slant;
      const double wrapped_m = range_m - kWrap_m * std::floor(range_m / kWrap_m);
      REQUIRE(std::abs(images.range.pixels[pixel] - wrapped_m) < kStored_m);
      REQUIRE(std::abs(images.depth.pixels[pixel] - wrapped_m / slant) < kStored_m);
      REQUIRE(images.amplitude.pixels[pixel] == doctest::Approx(0.5 / slant / (range_m * range_m)).epsilon(1e-6));
    }
  }
}

TEST_CASE("a pixel that sees two walls measures the mixture of its footprint") {
  // The near wall covers y > 0.15 at 2 m, x < -0.075 in the image plane. The footprint of the only pixel has columns at
  // -3/4, -1/4, 1/4 and 3/4: two see the near wall, two the far one.
  const std::string scene = tof_wall(2, 0.9, "20 40", 10.15) + tof_wall(3, 0.4);
  const TofImages images = tof_images(scene, 1, 1, R"(footprint_rays="16")");
  std::complex<double> phasor = 0;
  for (const double x : {-0.75, -0.25, 0.25, 0.75}) {
    for (const double y : {-0.75, -0.25, 0.25, 0.75}) {
      const double slant = std::sqrt(1 + x * x + y * y), depth_m = x < 0 ? 2 : 3, range_m = depth_m * slant;
      phasor +=
          std::polar((x < 0 ? 0.9 : 0.4) / slant / (range_m * range_m) / 16, 2 * std::numbers::pi * range_m / kWrap_m);
    }
  }
  const double turn = std::arg(phasor) / (2 * std::numbers::pi);  // from -1/2 to 1/2
  const double range_m = (turn < 0 ? turn + 1 : turn) * kWrap_m;
  REQUIRE(range_m > 2.1);
  REQUIRE(range_m < 2.9);
  CHECK(std::abs(images.range.pixels[0] - range_m) < kStored_m);
  CHECK(images.amplitude.pixels[0] == doctest::Approx(std::abs(phasor)).epsilon(1e-6));
}

TEST_CASE("light of one bounce in a corner is that of the integral over the other wall") {
  // A back wall at x = 2 and a side wall at y = 1, both of reflectance 0.8, and a camera with a field of view of 90
  // degrees. For the point P in the middle of the pixel the integral over the lit part of the side wall, x from 1 to 2,
  // where |z| < x and |y| < x, is taken by the midpoint rule.
  constexpr double kReflectance = 0.8;
  const std::string scene =
      tof_wall(2, kReflectance) +
      R"(<part name="SIDE" shape="box" size="4 0.2 20" insert_at="ROOT" pose_offset="0 1.1 0 0 0 0"/>
         <element type="material" name="MS" insert_at="ROOT" part="SIDE" reflectance="0.8"/>)";
  constexpr std::uint32_t kPixels = 9;
  const TofImages images = tof_images(scene, kPixels, kPixels, R"(bounce_rays="4096")");
  const TofImages direct = tof_images(scene, kPixels, kPixels, "");
  const std::uint32_t column = 3, row = 4;  // y = (4.5 - 3.5) / 4.5 x 2 on the back wall
  const glm::dvec3 p(2, (4.5 - (column + 0.5)) / 4.5 * 2, 0);
  const double r_p = glm::length(p);
  const auto turn = [](double length_m) { return 2 * std::numbers::pi * length_m / (2 * kWrap_m); };
  std::complex<double> phasor = std::polar(kReflectance * (p.x / r_p) / (r_p * r_p), turn(2 * r_p));
  const double of_direct = std::abs(phasor);
  constexpr int kSteps = 400;
  for (int i = 0; i < kSteps; ++i) {
    for (int k = 0; k < 2 * kSteps; ++k) {
      const double x = 1 + (i + 0.5) / kSteps, z = 2 * x * ((k + 0.5) / (2 * kSteps) - 0.5),
                   area = 1.0 / kSteps * x / kSteps;
      const glm::dvec3 q(x, 1, z);
      const double r_q = glm::length(q), way = glm::length(p - q);
      const double irradiance = (q.y / r_q) / (r_q * r_q);                      // of Q by the lamp
      const double form = (p.x - q.x) / way * (q.y - p.y) / way / (way * way);  // of P by Q
      phasor +=
          std::polar(kReflectance * kReflectance / std::numbers::pi * irradiance * form * area, turn(r_q + way + r_p));
    }
  }
  const double range_m = std::arg(phasor) / (2 * std::numbers::pi) * kWrap_m;
  const std::size_t pixel = row * kPixels + column;
  // The corner is seen too far by centimetres; without bounces the range is that of the wall.
  CHECK(range_m - r_p > 0.02);
  CHECK(std::abs(direct.range.pixels[pixel] - r_p) < kStored_m);
  CHECK(direct.amplitude.pixels[pixel] == doctest::Approx(of_direct).epsilon(1e-6));
  // The mean of 4096 independent rays would have a standard error of at most a 64th of the bounced light's root mean
  // square, which is below 3 times its mean: 5 %. Evenly spread rays are better. Of the bias of range that is 5 %.
  CHECK(std::abs(images.range.pixels[pixel] - range_m) < 0.05 * (range_m - r_p));
  CHECK(std::abs(images.amplitude.pixels[pixel] - std::abs(phasor)) < 0.05 * (std::abs(phasor) - of_direct));
}

TEST_CASE("what is nearer than near keeps no light of the lamp back") {
  const std::string corner =
      tof_wall(2, 0.8) +
      R"(<part name="SIDE" shape="box" size="4 0.2 20" insert_at="ROOT" pose_offset="0 1.1 0 0 0 0"/>)";
  const std::string cover =
      R"(<part name="COVER" shape="box" size="0.002 0.4 0.4" insert_at="ROOT" pose_offset="0.02 0 0 0 0 0"/>)";
  const TofImages without = tof_images(corner, 9, 9, R"(bounce_rays="64")");
  CHECK(tof_images(corner + cover, 9, 9, R"(bounce_rays="64")").range.pixels == without.range.pixels);
  CHECK(tof_images(corner, 9, 9, "").range.pixels != without.range.pixels);
}

TEST_CASE("light does not bounce from where the lamp does not shine") {
  // The side wall stands beside the field of view, so that nothing but the back wall is lit.
  const std::string side =
      R"(<part name="SIDE" shape="box" size="1 0.2 20" insert_at="ROOT" pose_offset="1.2 3 0 0 0 0"/>)";
  const TofImages with = tof_images(tof_wall(2, 0.8) + side, 9, 9, R"(bounce_rays="64")");
  const TofImages without = tof_images(tof_wall(2, 0.8), 9, 9, "");
  CHECK(with.range.pixels == without.range.pixels);
  CHECK(with.amplitude.pixels == without.amplitude.pixels);
}

TEST_CASE("noise of a range is that of shot noise and read noise over the amplitude") {
  // A white wall at 2 m in the middle of a narrow field of view. n values: as in rgbd_camera_test.cpp.
  constexpr double kSignal_e = 20000, kAmbient_e = 3000, kRead_e = 40, kContrast = 0.8;
  Simulation simulation = Simulation::from_string(
      "<simvis>" + tof_wall(2, 1) +
      R"(<sensor type="tof_camera" name="T" insert_at="ROOT" hfov="1" outputs="depth range amplitude" width="40"
          height="40" signal_e="20000" ambient_e="3000" read_noise_e="40" contrast="0.8"/></simvis>)");
  double n = 0, chi_square = 0, sum = 0;
  for (int frame = 0; frame < 20; ++frame) {
    const TofImages images = tof_images(simulation);
    for (std::uint32_t pixel = 0; pixel < 1600; ++pixel) {
      const double tangent = std::tan(std::numbers::pi / 360), x = (pixel % 40 - 19.5) / 20 * tangent,
                   y = (pixel / 40 - 19.5) / 20 * tangent, range_m = 2 * std::sqrt(1 + x * x + y * y);
      const double light = (2 / range_m) / (range_m * range_m), mean_e = kSignal_e * light + kAmbient_e;
      const double sigma_m = kWrap_m / (2 * std::numbers::pi) * std::sqrt((mean_e + kRead_e * kRead_e) / 2) /
                             (kSignal_e * kContrast * light);
      const double error = (images.range.pixels[pixel] - range_m) / sigma_m;
      n += 1;
      sum += error;
      chi_square += error * error;
    }
  }
  // The phase has a standard deviation of s = 0.0173: the next term of the arc tangent changes the variance by s^2 of
  // it.
  CHECK(n == 32000);
  CHECK(std::abs(chi_square - n) < 6 * std::sqrt(2 * n) + 1e-3 * n);
  CHECK(std::abs(sum / n) < 6 / std::sqrt(n));
}

TEST_CASE("what is off leaves the bytes of before, and nothing is measured where no light returns") {
  const TofImages plain = tof_images(tof_wall(2, 0.8), 9, 9, "");
  const TofImages off = tof_images(tof_wall(2, 0.8), 9, 9,
                                   R"(footprint_rays="1" bounce_rays="0" signal_e="0" read_noise_e="5" ambient_e="7")");
  CHECK(off.range.pixels == plain.range.pixels);
  CHECK(off.depth.pixels == plain.depth.pixels);
  CHECK(off.amplitude.pixels == plain.amplitude.pixels);
  const TofImages none = tof_images("", 9, 9, "");
  CHECK(std::isinf(none.range.pixels[40]));
  CHECK(std::isinf(none.depth.pixels[40]));
  CHECK(none.amplitude.pixels[40] == 0);
  const TofImages dim = tof_images(tof_wall(2, 0.8), 9, 9, R"(amplitude_min="0.15")");
  CHECK(std::isfinite(dim.range.pixels[40]));  // 0.2 in the middle
  CHECK(std::isinf(dim.range.pixels[0]));      // 0.8 / 4 / slant^3 below 0.05 in the corner
}

TEST_CASE("more pixels than the limit are refused at the attribute, before there is memory for them") {
  const auto refused = [](const std::string& size) {
    return error_of(
        [&] { Simulation::from_string("<sensor type='tof_camera' name='T' insert_at='ROOT' " + size + "/>"); });
  };
  CHECK(contains(refused("width='16384' height='16384'"), "attribute \"height\": 16384 x 16384 are too many pixels"));
  CHECK(contains(refused("width='2048' height='2049'"), "expected at most 4194304"));
  CHECK(refused("width='2048' height='2048'") == "nothing was thrown");
}

TEST_CASE("the preset is a device, whose ranges end at 5 m") {
  Simulation simulation = Simulation::from_string(
      R"(<simvis><sensor type="tof_camera" name="T" insert_at="ROOT" preset="mesa_sr4000"/></simvis>)");
  simulation.step();
  CHECK(simulation.depth("T").width == 176);
  CHECK(TofCameraDesc{}.wrap_m() == doctest::Approx(4.9965).epsilon(1e-4));
}

}  // namespace

TEST_SUITE_END();
