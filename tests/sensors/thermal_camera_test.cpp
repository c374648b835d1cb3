// Thermal cameras: radiance of surfaces, surroundings and sky against numeric integrals, mixtures, noise, pattern, lag,
// counts and false colours.
#include "sensors/thermal_camera/thermal_camera.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include <simvis/diagnostics.h>
#include <simvis/simulation.h>
#include "engine/base/srgb.h"
#include "scenegraph/pictures/png_bytes.h"
#include "sensors/thermal_camera/false_color.h"
#include "tests/sensors/planck_integral.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis::test {
namespace {

// A temperature below 512 K that is stored as a float, and the error of the table of temperatures.
constexpr double kStoredKelvin = 0x1p-16 + 1e-6;

/// The temperature of a black body with this radiance, by bisection of the numeric integral.
double kelvin_of(double radiance) {
  double low = 1, high = 4000;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (planck_integral(middle) < radiance ? low : high) = middle;
  }
  return (low + high) / 2;
}

std::string thermal_camera(const std::string& attributes, const std::string& outputs = "temperature") {
  return R"(<sensor type="thermal_camera" name="T" insert_at="ROOT" width="3" height="3" hfov="90" outputs=")" +
         outputs + "\" " + attributes + "/>";
}

// A wall at x = 2 that fills the picture, or from y on to the left.
std::string thermal_wall(const std::string& name, double x_m = 2, double y_m = 0, double width_m = 40) {
  return "<part name='" + name + "' shape='box' size='0.2 " + format_number(width_m) +
         " 40' insert_at='ROOT' pose_offset='" + format_number(x_m + 0.1) + ' ' + format_number(y_m) + " 0 0 0 0'/>";
}

std::string heat_of(const std::string& part, const std::string& attributes) {
  return "<element type='temperature' name='HEAT_" + part + "' insert_at='ROOT' part='" + part + "' " + attributes +
         "/>";
}

Simulation thermal_scene(const std::string& commands) {
  return Simulation::from_string("<simvis>" + commands + "</simvis>");
}

std::vector<double> thermal_numbers(Simulation& simulation, const char* output = "temperature") {
  simulation.step();
  const Measurement measurement = simulation.measurement("T");
  const MeasuredArray* const array = measurement.find(output);
  REQUIRE(array != nullptr);
  std::vector<double> numbers(array->count());
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = array->number(i);
  return numbers;
}

std::vector<double> thermal_numbers(const std::string& commands, const char* output = "temperature") {
  Simulation simulation = thermal_scene(commands);
  return thermal_numbers(simulation, output);
}

TEST_CASE("a surface appears as warm as a black body of what it emits and reflects") {
  for (const double kelvin : {250.0, 310.0, 450.0}) {
    for (const double emissivity : {1.0, 0.6, 0.0}) {
      CAPTURE(kelvin);
      CAPTURE(emissivity);
      const std::string heat =
          "temperature='" + format_number(kelvin) + "' emissivity='" + format_number(emissivity) + "'";
      const double expected = kelvin_of(emissivity * planck_integral(kelvin) + (1 - emissivity) * planck_integral(280));
      for (const double shown : thermal_numbers(
               "<element type='thermal_surroundings' name='AIR' insert_at='ROOT' ambient='280' sky='200'/>" +
               thermal_wall("WALL") + heat_of("WALL", heat) + thermal_camera(""))) {
        CHECK(std::abs(shown - expected) < kStoredKelvin);
      }
    }
  }
}

TEST_CASE("what no element names is as warm as the surroundings, and the sky has a temperature of its own") {
  const std::string half = thermal_wall("WALL", 2, 20.5);  // the left column of three, whose rays have y > 0.5
  std::vector<double> shown = thermal_numbers(half + thermal_camera(""));
  for (const double kelvin : shown) CHECK(std::abs(kelvin - 293.15) < kStoredKelvin);
  Simulation simulation = thermal_scene(
      half + "<element type='thermal_surroundings' name='AIR' insert_at='ROOT' ambient='300' sky='230'/>" +
      thermal_camera(""));
  shown = thermal_numbers(simulation);
  for (std::size_t i = 0; i < 9; ++i) CHECK(std::abs(shown[i] - (i % 3 == 0 ? 300 : 230)) < kStoredKelvin);
  simulation.set("AIR", "ambient", 310);
  simulation.set("AIR", "sky", 0);
  shown = thermal_numbers(simulation);
  for (std::size_t i = 0; i < 9; ++i) CHECK(std::abs(shown[i] - (i % 3 == 0 ? 310 : 0)) < kStoredKelvin);
}

TEST_CASE("a pixel that sees two walls has the mean of their radiance, the better the more rays it has") {
  // The only pixel looks from y = -2 to 2 at walls at x = 2; the warm one covers y > 0.9, or 0.275 of it. Of n columns
  // of rays at (k + 1/2) / n those below 0.275 see it.
  const std::string walls = thermal_wall("WARM", 2, 20.9) + thermal_wall("COLD", 2, -19.1) +
                            heat_of("WARM", "temperature='350'") + heat_of("COLD", "temperature='290'");
  for (const int side : {1, 2, 4, 8}) {
    CAPTURE(side);
    int warm = 0;
    for (int k = 0; k < side; ++k) warm += (k + 0.5) / side < 0.275;
    const double share = static_cast<double>(warm) / side;
    CHECK(std::abs(share - 0.275) <= 0.5 / side);  // so the end of the knob is the exact mean
    const double expected = kelvin_of(share * planck_integral(350) + (1 - share) * planck_integral(290));
    const std::vector<double> shown = thermal_numbers(
        walls +
        "<sensor type='thermal_camera' name='T' insert_at='ROOT' width='1' height='1' hfov='90' footprint_rays='" +
        std::to_string(side * side) + "'/>");
    CHECK(std::abs(shown.at(0) - expected) < kStoredKelvin);
  }
}

TEST_CASE(
    "noise and pattern have the standard deviation of their attributes at 300 K, and that of radiance elsewhere") {
  // The normalised errors of n pixels have a mean square whose standard deviation is sqrt(2 / n): six of it are
  // allowed, and six of the mean's. The slope changes over the noise of 0.5 K by 0.5 %, which moves the mean square by
  // 1e-4.
  constexpr double kNoise_k = 0.5, kCurvature = 2e-4;
  for (const double kelvin : {280.0, 300.0, 400.0}) {
    CAPTURE(kelvin);
    const double sigma_k = kNoise_k * planck_integral(300, true) / planck_integral(kelvin, true);
    for (const bool pattern : {false, true}) {
      CAPTURE(pattern);
      Simulation simulation =
          thermal_scene(thermal_wall("WALL") + heat_of("WALL", "temperature='" + format_number(kelvin) + "'") +
                        "<sensor type='thermal_camera' name='T' insert_at='ROOT' width='200' height='100' hfov='90' " +
                        (pattern ? "fixed_pattern" : "netd") + "='0.5'/>");
      const std::vector<double> first = thermal_numbers(simulation), second = thermal_numbers(simulation);
      const double n = 20000;
      REQUIRE(first.size() == 20000);
      double squares = 0, sum = 0, both = 0;
      for (std::size_t i = 0; i < first.size(); ++i) {
        const double a = (first[i] - kelvin) / sigma_k, b = (second[i] - kelvin) / sigma_k;
        squares += a * a;
        sum += a;
        both += a * b;
      }
      CHECK(std::abs(squares / n - 1) < 6 * std::sqrt(2 / n) + kCurvature);
      CHECK(std::abs(sum / n) < 6 / std::sqrt(n) + kNoise_k * 0.01);  // the mean of T is not that of the radiance
      if (pattern) CHECK(first == second);
      if (!pattern) CHECK(std::abs(both / n) < 6 / std::sqrt(n));
    }
  }
}

TEST_CASE("a camera with a time constant lags behind its scene") {
  // At 10 measurements per second the radiance falls from one to the next, then stays.
  Simulation simulation = thermal_scene(thermal_wall("WALL") + heat_of("WALL", "temperature='350'") +
                                        thermal_camera("time_constant='0.05'"));
  double time_s = 0, signal = planck_integral(350);
  const double cold = planck_integral(290), warm = signal;
  CHECK(std::abs(thermal_numbers(simulation).at(4) - 350) < kStoredKelvin);
  simulation.set("HEAT_WALL", "temperature", 290);
  for (int frame = 1; frame <= 4; ++frame) {
    CAPTURE(frame);
    const double shown = thermal_numbers(simulation).at(4);
    const double now_s = static_cast<double>(simulation.measurement("T").time_ns) / 1e9, between_s = now_s - time_s;
    time_s = now_s;
    const double per_s = frame == 1 ? (cold - warm) / between_s : 0;
    signal = cold - per_s * 0.05 + (signal - (frame == 1 ? warm : cold) + per_s * 0.05) * std::exp(-between_s / 0.05);
    CHECK(std::abs(shown - kelvin_of(signal)) < kStoredKelvin);
    CHECK(shown > 290.001);
  }
  CHECK(contains(error_of([&] { simulation.skip_frame(); }), "sensor \"T\" of type thermal_camera"));
}

TEST_CASE("counts are temperatures in steps, as far as 16 bits go") {
  struct Row {
    double kelvin;
    const char* attributes;
    double count;
  };
  for (const Row& row : {Row{300, "", 30000}, Row{655.35, "", 65535}, Row{900, "", 65535},
                         Row{900, "kelvin_per_count='0.1'", 9000}, Row{0, "", 0}}) {
    CAPTURE(row.kelvin);
    const std::string scene = thermal_wall("WALL") + heat_of("WALL", "temperature='" + format_number(row.kelvin) + "'");
    for (const double count : thermal_numbers(scene + thermal_camera(row.attributes, "raw16"), "raw16")) {
      CHECK(count == row.count);
    }
  }
}

TEST_CASE("false colours stretch from the coldest to the warmest pixel, or between the given temperatures") {
  const std::string scene = thermal_wall("WALL", 2, 20.5) + heat_of("WALL", "temperature='330'") +
                            "<element type='thermal_surroundings' name='AIR' insert_at='ROOT' sky='300'/>";
  const std::vector<double> full = thermal_numbers(scene + thermal_camera("", "color"), "color");
  const std::vector<double> fixed =
      thermal_numbers(scene + thermal_camera("color_min='280' color_max='380'", "color"), "color");
  for (std::size_t i = 0; i < 9; ++i) {
    const bool warm = i % 3 == 0;
    for (std::size_t c = 0; c < 3; ++c) {
      CAPTURE(i);
      CHECK(full[4 * i + c] == (warm ? 1 : 0));
      const double code = false_color(warm ? 0.5 : 0.2)[static_cast<int>(c)];
      // A temperature errs by 1e-6 K of 100 K, and no channel is steeper than 10 per share.
      CHECK(std::abs(fixed[4 * i + c] - decode_srgb(code)) < 1e-6);
    }
    CHECK(full[4 * i + 3] == 1);
  }
  // Of one temperature only, everything is black.
  const std::vector<double> even =
      thermal_numbers("<part name='P' insert_at='ROOT'/>" + thermal_camera("", "color"), "color");
  CHECK(even[0] == 0);
}

TEST_CASE("glass is opaque, and back faces of single-sided surfaces are not seen") {
  const std::string pane =
      "<part name='PANE' shape='box' size='0.02 40 40' insert_at='ROOT' pose_offset='1 0 0 0 0 0' "
      "opacity='0.1'/>";
  for (const double kelvin : thermal_numbers(thermal_wall("WALL") + heat_of("WALL", "temperature='350'") + pane +
                                             heat_of("PANE", "temperature='285'") + thermal_camera(""))) {
    CHECK(std::abs(kelvin - 285) < kStoredKelvin);
  }
  // The camera stands in a closed box, whose faces are seen from behind.
  const std::string around = "<part name='AROUND' shape='box' size='1 1 1' insert_at='ROOT'/>";
  const std::vector<double> shown =
      thermal_numbers(thermal_wall("WALL") + heat_of("WALL", "temperature='350'") + around +
                      heat_of("AROUND", "temperature='285'") + thermal_camera(""));
  const std::vector<double> depth = [&] {
    Simulation simulation = thermal_scene(thermal_wall("WALL") + around +
                                          "<sensor type='camera' name='C' insert_at='ROOT' width='3' height='3' "
                                          "hfov='90' outputs='depth'/>");
    simulation.step();
    const Image image = simulation.depth("C");
    return std::vector<double>(image.pixels.begin(), image.pixels.end());
  }();
  for (std::size_t i = 0; i < 9; ++i) {
    CHECK(std::abs(shown[i] - (depth[i] > 1 ? 350 : 285)) < kStoredKelvin);  // as a camera sees it
  }
}

TEST_CASE("a picture spreads the temperatures over a surface") {
  const TemporaryFolder folder;
  const auto grey = [](std::uint8_t code) { return std::vector<std::uint8_t>{code, code, code}; };
  std::vector<std::uint8_t> row;
  for (const std::uint8_t code : {0, 51, 204, 255}) {
    for (const std::uint8_t each : grey(code)) row.push_back(each);
  }
  write_text(folder / "heat.png", png_bytes({.width = 4, .height = 1}, row));
  // A plane that faces the camera; its texture runs once over it.
  const std::string plane =
      "<part name='PLATE' shape='plane' size='4 4' insert_at='ROOT' pose_offset='2 0 0 0 -90 0'/>";
  const std::string heat =
      heat_of("PLATE", "texture='heat.png' temperature='300' temperature_white='400' emissivity='0.9'");
  Simulation simulation = Simulation::from_string(
      "<simvis>" + plane + heat +
          "<sensor type='thermal_camera' name='T' insert_at='ROOT' width='4' height='4' hfov='90'/></simvis>",
      {}, folder.path());
  std::vector<double> shown = thermal_numbers(simulation);
  std::sort(shown.begin(), shown.end());
  // Each pixel's ray meets the middle of a texel; four pixels see each texel, whichever way the texture runs.
  for (std::size_t i = 0; i < 16; ++i) {
    const double kelvin = 300 + 100 * (std::vector<double>{0, 51, 204, 255}[i / 4] / 255);
    const double radiance = 0.9 * planck_integral(kelvin) + 0.1 * planck_integral(293.15);
    // Texture coordinates are float32: 2^-24 of a picture of 4 texels of at most 60 K each, rounded a few times.
    CHECK(std::abs(shown[i] - kelvin_of(radiance)) < kStoredKelvin + 4 * 4 * 0x1p-24 * 60);
  }
  simulation.set("HEAT_PLATE", "temperature_white", 300);
  const double flat = kelvin_of(0.9 * planck_integral(300) + 0.1 * planck_integral(293.15));
  for (const double kelvin : thermal_numbers(simulation)) CHECK(std::abs(kelvin - flat) < kStoredKelvin);
}

TEST_CASE("elements of heat change no byte and no counter of other sensors, and what is off changes none of its own") {
  const auto work = [](const std::string& commands) {
    Simulation simulation =
        thermal_scene(thermal_wall("WALL") + commands +
                      "<sensor type='camera' name='C' insert_at='ROOT' width='16' height='12' outputs='color depth'/>");
    simulation.step();
    simulation.step();
    const Diagnostics diagnostics = simulation.diagnostics();
    return std::tuple(diagnostics.counters(), diagnostics.ray_counters().rays, diagnostics.device_memory_bytes(),
                      simulation.color("C").pixels.numbers(), simulation.depth("C").pixels.numbers());
  };
  CHECK(work("") == work(heat_of("WALL", "temperature='400'") +
                         "<element type='thermal_surroundings' name='AIR' insert_at='ROOT' ambient='300'/>"));
  const std::string scene = thermal_wall("WALL", 2, 20.5) + heat_of("WALL", "temperature='330'");
  CHECK(thermal_numbers(scene + thermal_camera("netd='0' fixed_pattern='0' time_constant='0' footprint_rays='1'")) ==
        thermal_numbers(scene + thermal_camera("")));
}

TEST_CASE("wrong thermal scenes are refused where they are wrong") {
  const auto refused = [](const std::string& commands) { return error_of([&] { thermal_scene(commands); }); };
  const std::string wall = thermal_wall("WALL");
  CHECK(contains(refused(wall + heat_of("WALL", "temperature='-1'")), "temperature"));
  CHECK(contains(refused(wall + heat_of("WALL", "temperature='nan'")), "temperature"));
  CHECK(contains(refused(wall + heat_of("WALL", "emissivity='1.1'")), "emissivity"));
  CHECK(contains(refused(wall + heat_of("WALL", "temperature_white='300'")),
                 "attribute \"temperature_white\" is allowed only with a texture"));
  CHECK(contains(refused(wall + heat_of("WALL", "texture='none.png'")), "there is no picture"));
  CHECK(contains(refused(wall + heat_of("WALL", "texture='/dev/zero'")), "there is no picture"));
  CHECK(contains(
      refused(wall + heat_of("WALL", "") + "<element type='temperature' name='B' insert_at='ROOT' parts='W*'/>"),
      "\"WALL\" already has a temperature from element \"HEAT_WALL\""));
  CHECK(contains(refused("<element type='temperature' name='B' insert_at='ROOT'/>"),
                 "a temperature needs the attribute"));
  CHECK(contains(refused("<element type='thermal_surroundings' name='A' insert_at='ROOT'/>"
                         "<element type='thermal_surroundings' name='B' insert_at='ROOT'/>"),
                 "already has an element of type thermal_surroundings"));
  CHECK(contains(refused(thermal_camera("color_min='300' color_max='300'")), "expected more than color_min"));
  CHECK(contains(refused("<sensor type='thermal_camera' name='T' insert_at='ROOT' width='4096' height='4096'/>"),
                 "too many pixels"));
  CHECK(contains(refused(thermal_camera("kelvin_per_count='0'")), "kelvin_per_count"));
  CHECK(contains(refused(thermal_camera("netd='inf'")), "netd"));
  CHECK(contains(refused(thermal_camera("preset='lepton'")), "lepton_3_5"));
}

TEST_CASE("presets are devices") {
  Simulation simulation =
      thermal_scene("<sensor type='thermal_camera' name='T' insert_at='ROOT' preset='lepton_3_5' outputs='raw16'/>");
  CHECK(thermal_numbers(simulation, "raw16").size() == 160 * 120);
  CHECK(thermal_numbers("<sensor type='thermal_camera' name='T' insert_at='ROOT' preset='boson_640' hfov='50'/>")
            .size() == 640 * 512);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
