// Cameras with light="path" in scenes: what they need, what they refuse, and what they cost if nobody asks for them.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <simvis/diagnostics.h>
#include <simvis/simulation.h>
#include "tests/support/error_of.h"
#include "tests/support/sky_files.h"
#include "tests/support/splat_file.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("engine/light");

namespace simvis::test {
namespace {

namespace fs = std::filesystem;

const std::string kRoom =
    "<part name='FLOOR' insert_at='ROOT' shape='plane' size='9 7' color='0.5 0.45 0.4'/>"
    "<part name='BALL' insert_at='ROOT' shape='sphere' radius='0.5' pose_offset='3 0 0.5 0 0 0'/>"
    "<element type='light' name='LAMP' insert_at='ROOT' kind='point' x='2' z='3' intensity='20'/>";

const std::string kSmall = "width='16' height='12' ";

std::string camera(const std::string& attributes) {
  return "<sensor type='camera' name='C' insert_at='ROOT' pose_offset='0 0 1 0 10 0' " + attributes + "/>";
}

TEST_CASE("a path camera opens no device, has its error as an output, and the depth that a drawn one has") {
  Simulation paths = Simulation::from_string(
      "<simvis>" + kRoom +
      camera(kSmall + "light='path' samples='4' bounces='2' outputs='color color_stddev depth instance'") +
      "</simvis>");
  const bool at_once = paths.diagnostics().device() != nullptr;
  CHECK_FALSE(at_once);
  paths.step();
  const Measurement measured = paths.measurement("C");
  const MeasuredArray* const stddev = measured.find("color_stddev");
  REQUIRE(stddev != nullptr);
  CHECK(stddev->shape == OutputShape{12, 16, 3});
  REQUIRE(measured.find("color") != nullptr);
  CHECK(measured.find("color")->number(4 * (11 * 16 + 8)) > 0);
  Simulation drawn =
      Simulation::from_string("<simvis>" + kRoom + camera(kSmall + "outputs='depth instance'") + "</simvis>");
  drawn.step();
  const Measurement expected = drawn.measurement("C");
  for (std::size_t i = 0; i < 16 * 12; ++i) {
    CHECK(measured.find("instance")->number(i) == expected.find("instance")->number(i));
    const double depth = measured.find("depth")->number(i), drawn_depth = expected.find("depth")->number(i);
    if (std::isfinite(drawn_depth)) CHECK(std::abs(depth - drawn_depth) <= 1e-4 * drawn_depth);
  }
}

// The radiance of one pixel that looks along +x at a wall, which shines from y = `edge_m` on to the left at x = 3. The
// camera goes from y = -0.3 to 0.1 in the last of two frames.
struct OnePixel {
  double mean, stddev;
};

OnePixel pixel_at_edge(double edge_m, const std::string& attributes) {
  Simulation simulation = Simulation::from_string(
      "<simvis><part name='WALL' insert_at='ROOT' shape='box' size='0.2 4 4' color='0 0 0' pose_offset='3.1 " +
      format_number(edge_m + 2) +
      " 0 0 0 0'/><element type='material' name='SHINE' insert_at='ROOT' part='WALL' emission_red='1'/>"
      "<element type='sky' name='SKY' insert_at='ROOT' red='0' green='0' blue='0'/>"
      "<part name='CARRIER' insert_at='ROOT'/><element type='pose' name='MOVE' insert_at='CARRIER'/>"
      "<sensor type='camera' name='C' insert_at='CARRIER' width='1' height='1' hfov='1e-6' light='path' bounces='0' "
      "samples='4000' outputs='color color_stddev' " +
      attributes + "/></simvis>");
  for (const double y_m : {-0.3, 0.1}) {
    simulation.set("MOVE", "y", y_m);
    simulation.step();
  }
  const Measurement measured = simulation.measurement("C");
  return {measured.find("color")->number(0), measured.find("color_stddev")->number(0)};
}

TEST_CASE("samples fill the exposure: an edge that passes the pixel") {
  // Half of the frame's 1/15 s, in which the camera goes from y = -0.1 to 0.1.
  const OnePixel pixel = pixel_at_edge(0.05, "exposure_time='0.03333333333333333'");
  CHECK(std::abs(pixel.mean - 0.25) <= 5 * pixel.stddev);
  CHECK(std::abs(pixel.stddev - std::sqrt(0.25 * 0.75 / 4000)) < 1e-3);
}

TEST_CASE("samples fill the lens: a circle of confusion that an edge cuts") {
  // A point of the lens at y sees y + 2 (-y) = -2 y of the wall, relative to the camera at y = 0.1. The lens has the
  // radius 0.05, and what is beyond y = -0.02 sees the wall: a segment of the disc.
  const OnePixel pixel = pixel_at_edge(0.14, "aperture='0.1' focus_distance='1'");
  const double height = 0.4, share = (std::acos(height) - height * std::sqrt(1 - height * height)) / std::acos(-1.0);
  CHECK(std::abs(pixel.mean - share) <= 5 * pixel.stddev);
  CHECK(pixel.stddev > 0);
}

// Beyond 110 degrees a fisheye sees nothing: the circle r = fx theta crosses a pixel from x = 30 to 31 and y = 0 to 1.
TEST_CASE("a pixel at the edge of a fisheye has the light of the part of its square that sees something") {
  constexpr double kFocal_px = 16, kSamples = 4000;
  Simulation simulation = Simulation::from_string(
      "<simvis><element type='sky' name='SKY' insert_at='ROOT' red='1' green='1' blue='1'/>"
      "<sensor type='camera' name='C' insert_at='ROOT' width='64' height='2' distortion='kannala_brandt' fx='16' "
      "light='path' bounces='0' samples='4000' outputs='color color_stddev'/></simvis>");
  simulation.step();
  const double radius_px = kFocal_px * 110 * std::acos(-1.0) / 180;
  const double under_arc =
      (std::sqrt(radius_px * radius_px - 1) + radius_px * radius_px * std::asin(1 / radius_px)) / 2;
  const double share = under_arc - 30, deviation = std::sqrt(share * (1 - share) / kSamples);
  REQUIRE(share > 0.5);
  const Measurement measured = simulation.measurement("C");
  constexpr std::size_t kPixel = 64 + 32 + 30;  // of the lower row
  CHECK(std::abs(measured.find("color")->number(4 * kPixel) - share) <= 5 * deviation);
  CHECK(measured.find("color_stddev")->number(3 * kPixel) == doctest::Approx(deviation).epsilon(0.1));
}

// The message about a camera with these attributes in the third line of a scene.
std::string refusal(const std::string& attributes, const std::string& more = "", const fs::path& folder = ".") {
  return error_of([&] {
    Simulation simulation = Simulation::from_string(
        "<simvis>\n" + kRoom + "\n" + camera(attributes) + "\n" + more + "</simvis>", {}, folder, "s.xml");
    simulation.step();
  });
}

TEST_CASE("what contradicts the light is refused at its place, with what is allowed") {
  const TemporaryFolder folder;
  write_text(folder.path() / "splats.ply", splat_file({{.center_m = {3, 0, 0}}}));
  write_text(folder.path() / "dots.ply",
             "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
             "end_header\n3 0 0\n");
  write_text(folder.path() / "lines.obj", "v 3 0 0\nv 3 1 0\nl 1 2\n");
  struct Row {
    std::string attributes, at, says, part = "";
  };
  const std::string drawn = "a drawn picture has none, expected light=\"path\" beside it";
  const std::string whole = "paths go through the whole square of each pixel, expected light=\"drawn\" beside it";
  const std::vector<Row> rows{
      {"samples='4'", "samples", "attribute \"samples\": " + drawn},
      {"noise='0.1'", "noise", "attribute \"noise\": " + drawn},
      {"light='path' noise='0'", "noise", "expected a number greater than 0"},
      {"light='path' noise='-1'", "noise", "expected a number greater than 0"},
      {"light='path' noise='0.1' samples='4'", "samples", "noise decides how many there are, expected one of the two"},
      {"bounces='4'", "bounces", "attribute \"bounces\": " + drawn},
      {"outputs='color_stddev'", "outputs", "attribute \"outputs\": color_stddev: " + drawn},
      {"light='paths'", "light", "expected one of: drawn, path"},
      {"light='path' samples='0'", "samples", "expected a whole number from 1 to 65536"},
      {"light='path' samples='65537'", "samples", "expected a whole number from 1 to 65536"},
      {"light='path' samples='1.5'", "samples", "expected a whole number from 1 to 65536"},
      {"light='path' bounces='-1'", "bounces", "expected a whole number from 0 to 64"},
      {"light='path' bounces='65'", "bounces", "expected a whole number from 0 to 64"},
      {"light='path' samples='1' outputs='color_stddev'", "samples", "expected at least 2 with color_stddev"},
      {"light='path' outputs='depth'", "light", "expected color or color_stddev among outputs"},
      {"light='path' supersampling='4'", "supersampling", whole},
      {"light='path' msaa='4'", "msaa", whole},
      {"light='path' max_error_px='1'", "max_error_px", "paths hit every triangle, expected 0"},
      {"light='path' width='4000' height='4000'", "height", "too many pixels"},
      {"light='path' color_magnification='1 1 1.01'", "color_magnification", "expected light=\"drawn\""},
      {"light='path' width='64' height='48' distortion='kannala_brandt' fx='20' aperture='0.01'", "aperture",
       "this lens is so wide that it takes several views"},
      {"light='path'", "light", "paths do not reflect at Gaussian splats, which the scene has, expected \"drawn\"",
       "splats.ply"},
      {"light='path'", "light", "paths do not hit lines, and points without a size, which the scene has, expected",
       "dots.ply"},
      {"light='path'", "light", "paths do not hit lines, and points without a size, which the scene has, expected",
       "lines.obj"}};
  for (const Row& row : rows) {
    CAPTURE(row.attributes);
    const std::string more = row.part.empty() ? "" : "<part name='MORE' insert_at='ROOT' file='" + row.part + "'/>";
    const std::string message = refusal(row.attributes, more, folder.path());
    const std::size_t column = camera(row.attributes).find(" " + row.at + "='") + 2;
    CHECK(contains(message, "s.xml:3:" + std::to_string(column) + ": "));
    CHECK(contains(message, row.says));
    // Without the part, or for a camera that does not see it, there is no error.
    if (row.part.empty()) continue;
    CHECK(refusal(row.attributes, "", folder.path()) == "nothing was thrown");
    CHECK(refusal(row.attributes + " ignore='MORE'", more, folder.path()) == "nothing was thrown");
  }
}

TEST_CASE("several pictures of the sky are refused, and one is not") {
  const TemporaryFolder folder;
  write_text(folder.path() / "even.exr",
             sky_exr(sky_picture(8, [](std::uint32_t, std::uint32_t) { return glm::vec3(1); })));
  const auto sky = [](const std::string& name) {
    return "<element type='sky_light' insert_at='ROOT' picture='even.exr' name='" + name + "'/>";
  };
  const std::string small = kSmall + "light='path' samples='1' bounces='1'";
  CHECK(contains(refusal(small, sky("DAY") + sky("NIGHT"), folder.path()),
                 "paths take the light of one picture of the sky, and the scene has several, expected \"drawn\""));
  CHECK(refusal(small, sky("DAY"), folder.path()) == "nothing was thrown");
}

// A room whose far half is dark, so that its tiles need no more than the pilot.
TEST_CASE(
    "with noise, tiles take the samples that they need, for any number of threads, and a report says what they reach") {
  const auto run = [](unsigned threads, const std::string& attributes) {
    SimulationDesc desc;
    desc.threads = threads;
    Simulation simulation = Simulation::from_string(
        "<simvis>" + kRoom +
            camera("width='48' height='32' light='path' bounces='1' outputs='color color_stddev' " + attributes) +
            "</simvis>",
        desc);
    simulation.step();
    return simulation;
  };
  const Simulation once = run(1, "noise='0.004'");
  const Measurement measured = once.measurement("C");
  const auto numbers = [](const Measurement& of, const char* name) {
    std::vector<double> all;
    const MeasuredArray& array = *of.find(name);
    for (std::size_t i = 0; i < array.count(); ++i) all.push_back(array.number(i));
    return all;
  };
  for (const unsigned threads : {2u, 5u}) {
    const Simulation other = run(threads, "noise='0.004'");
    CHECK(numbers(other.measurement("C"), "color") == numbers(measured, "color"));
    CHECK(numbers(other.measurement("C"), "color_stddev") == numbers(measured, "color_stddev"));
  }
  const SensorInfo info = once.sensors().front();
  CHECK(contains(info.report.explanation, "paths of C: "));
  CHECK(contains(info.report.explanation, " of 6 tiles are above 0.004\n"));
  CHECK(*info.number("path_samples") >= 18);
  CHECK(*info.number("max_path_samples") > *info.number("path_samples"));
  CHECK(*info.number("max_path_noise") < 1.5 * 0.004);
  double square = 0;
  for (const double deviation : numbers(measured, "color_stddev")) square += deviation * deviation;
  CHECK(std::sqrt(square / (3 * 48 * 32)) == doctest::Approx(*info.number("path_noise")).epsilon(1e-5));
  CHECK(run(1, "samples='2'").sensors().front().report.explanation.empty());
}

TEST_CASE("a scene with a path camera that is off costs what it costs without it") {
  const auto costs = [](const std::string& more) {
    SimulationDesc desc;
    desc.sensors = {"D"};
    Simulation simulation = Simulation::from_string(
        "<simvis>" + kRoom + "<sensor type='thermal_camera' name='D' insert_at='ROOT' width='8' height='6'/>" + more +
            "</simvis>",
        desc);
    simulation.step();
    return std::pair(simulation.diagnostics().ray_counters().rays, simulation.diagnostics().device() != nullptr);
  };
  CHECK(costs(camera("light='path'")) == costs(""));
}

}  // namespace
}  // namespace simvis::test
