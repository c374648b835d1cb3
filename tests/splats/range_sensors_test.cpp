// Range sensors that hit Gaussian splats: laser scanners of all methods, range sensors, sonars, radars and
// time-of-flight cameras.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <simvis/error.h>
#include <simvis/simulation.h>
#include "tests/support/error_of.h"
#include "tests/support/splat_file.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("engine/splats");

namespace simvis {
namespace {

using test::FileSplat;
using test::splat_file;

constexpr double kBall_m = 3, kSize_m = 0.4, kFace_m = 10;
const FileSplat kBall{
    .center_m = {kBall_m, 0, 0}, .sigma_m = glm::dvec3(kSize_m), .opacity = 0.9, .color = {1, 0.25, 0}};
const std::string kBackWall =
    "<part name='WALL' insert_at='ROOT' shape='box' size='0.2 40 40' pose_offset='10.1 0 0 0 0 0'/>";
const std::string kBush = "<part name='S' file='s.ply' insert_at='ROOT'/>";

Simulation with_splats(const std::string& xml, const std::vector<FileSplat>& splats = {kBall}) {
  const TemporaryFolder folder;
  write_text(folder / "s.ply", splat_file(splats));
  Simulation simulation = Simulation::from_string("<s>" + xml + "</s>", {}, folder.path());
  simulation.step();
  return simulation;
}

std::string scanner(const std::string& attributes) {
  return "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='41' min_angle='-20' max_angle='20' " +
         attributes + "/>";
}

// The range of a beam at this azimuth: that of the point nearest to the centre, where at least half of the light stops.
double expected_range_m(double azimuth_rad) {
  const double square = std::pow(kBall_m * std::sin(azimuth_rad) / kSize_m, 2);
  const bool stops = 0.9 * std::exp(-square / 2) >= 0.5;
  return stops ? kBall_m * std::cos(azimuth_rad) : kFace_m / std::cos(azimuth_rad);
}

void check_scan(const Simulation& simulation) {
  const Scan& scan = simulation.scan("SCAN");
  std::size_t of_ball = 0;
  for (std::size_t beam = 0; beam < scan.range_m.size(); ++beam) {
    CAPTURE(beam);
    const double range_m = expected_range_m(scan.azimuth_rad[beam]), of_float_m = range_m * 0x1p-24;
    // The file has the centre, the logarithm of the size and the opacity as float32.
    CHECK(std::abs(static_cast<double>(scan.range_m[beam]) - range_m) <=
          static_cast<double>(scan.error_bound_m[beam]) + of_float_m);
    CHECK(scan.error_bound_m[beam] < 1e-5f);
    of_ball += range_m < kFace_m / 2;
  }
  CHECK(of_ball > 10);
  CHECK(of_ball < scan.range_m.size() / 2);
}

TEST_CASE("scanners of all methods hit the splat where half of the light is left, and the wall beside it") {
  for (const std::string method : {"raycast", "planar", "nearest", "hybrid", "auto"}) {
    CAPTURE(method);
    Simulation simulation = with_splats(kBackWall + kBush + scanner("method='" + method + "'"));
    check_scan(simulation);
    simulation.step();
    check_scan(simulation);
    CHECK(simulation.warnings().empty());
    const FramePlan& plan = simulation.diagnostics().frame_plan();
    CHECK(plan.passes.empty());
    REQUIRE(plan.effects.size() == 1);
    CHECK(plan.effects[0].effect == "gaussian_splats");
    CHECK(contains(plan.casts.at(0).reason, "gaussian_splats"));
  }
}

TEST_CASE("scanners that follow beams, and those with a beam table, hit the splat") {
  for (const std::string attributes : {"intensity='on'", "divergence='0.01'", "return='strongest'", "sweep='0.01'"}) {
    CAPTURE(attributes);
    const Simulation simulation = with_splats(kBackWall + kBush + scanner(attributes + " range_max='20'"));
    const Scan& scan = simulation.scan("SCAN");
    const double middle = static_cast<double>(scan.range_m[20]);
    CHECK(middle == doctest::Approx(kBall_m).epsilon(1e-3));
    CHECK(static_cast<double>(scan.range_m[0]) ==
          doctest::Approx(kFace_m / std::cos(glm::radians(20.0))).epsilon(1e-3));
  }
  const Simulation table =
      with_splats(kBackWall + kBush +
                  "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' pattern='device:velodyne_vlp16'/>");
  const Scan& scan = table.scan("SCAN");
  CHECK(std::ranges::count_if(scan.range_m, [](float range_m) { return range_m > 2.5f && range_m < 3.1f; }) > 100);
}

TEST_CASE("the intensity of a splat is that of a surface of its colour that faces the beam") {
  const Simulation simulation =
      with_splats(kBush + scanner("intensity='on' truth='normal instance hit' range_max='20'"));
  const Scan& scan = simulation.scan("SCAN");
  const double red = 1, green = std::pow((0.25 + 0.055) / 1.055, 2.4);
  const auto intensity = scan.channel("intensity"), item = scan.channel("true_item"),
             normal = scan.channel("true_normal_x"), instance = scan.channel("true_instance");
  CHECK(intensity[20] > 0);
  CHECK(intensity[20] <= std::max(red, green));
  CHECK(item[20] == 0);
  CHECK(instance[20] > 0);
  CHECK(std::isnan(normal[20]));
  CHECK(std::isnan(item[0]));
}

TEST_CASE("range sensors, sonars, radars and time-of-flight cameras see the splat as the wall that it is to them") {
  const Simulation simulation = with_splats(
      kBackWall + kBush + "<sensor type='range' name='RANGE' insert_at='ROOT' range_max='20'/>" +
      "<sensor type='sonar' name='SONAR' insert_at='ROOT' range_max='20' opening='4' threshold='1e-3'/>" +
      "<sensor type='radar' name='RADAR' insert_at='ROOT' horizontal_fov='8' vertical_fov='8'/>" +
      "<sensor type='tof_camera' name='TOF' insert_at='ROOT' width='21' height='15' hfov='60' outputs='range' "
      "bounce_rays='2'/>" +
      "<sensor type='camera' name='CAM' insert_at='ROOT' width='21' height='15' hfov='60' outputs='range'/>");
  CHECK(simulation.warnings().empty());
  CHECK(simulation.value("RANGE", "range_m") == doctest::Approx(kBall_m).epsilon(1e-7));
  CHECK(simulation.value("SONAR", "range_m") == doctest::Approx(kBall_m).epsilon(1e-3));
  const Reading& radar = simulation.reading("RADAR");
  REQUIRE(radar.rows() > 0);
  CHECK(radar.find("range_m", 0) == doctest::Approx(kBall_m).epsilon(1e-2));
  const Image tof = *to_image(*simulation.measurement("TOF").find("range")),
              camera = *to_image(*simulation.measurement("CAM").find("range"));
  std::size_t near = 0;
  for (std::size_t i = 0; i < tof.pixels.size(); ++i) {
    if (!(camera.pixels[i] < 5)) continue;
    ++near;
    // The phase of the light has the range; both are float32.
    CHECK(static_cast<double>(tof.pixels[i]) == doctest::Approx(static_cast<double>(camera.pixels[i])).epsilon(1e-6));
  }
  CHECK(near > 10);
}

// The formula of sensors/psd/psd.h for surfaces that face the sensor: a disc without thickness before a wall.
double distance_of_disc(double disc_m, double radius_m, double wall_m, double opening_rad, int resolution_px) {
  const double rim = std::tan(opening_rad / 2);
  double light = 0, moment = 0;
  for (int pixel = 0; pixel < resolution_px * resolution_px; ++pixel) {
    const double u = ((pixel % resolution_px + 0.5) * 2 / resolution_px - 1) * rim,
                 v = ((pixel / resolution_px + 0.5) * 2 / resolution_px - 1) * rim, square = u * u + v * v;
    if (square > rim * rim) continue;
    const double depth_m = std::sqrt(square) * disc_m < radius_m ? disc_m : wall_m;
    const double returned = std::pow(1 + square, -2.5) / (depth_m * depth_m);
    light += returned;
    moment += returned / depth_m;
  }
  return light / moment;
}

TEST_CASE("a distance sensor sees a flat splat as a disc with the radius at which half of the light is left") {
  constexpr double kDisc_m = 0.3, kWall_m = 0.6, kSigma_m = 0.02;
  const double radius_m = kSigma_m * std::sqrt(2 * std::log(0.9 / 0.5));
  const std::string wall =
      "<part name='WALL' insert_at='ROOT' shape='box' size='0.2 4 4' pose_offset='0.7 0 0 0 0 0'/>";
  const auto range_m = [&](const std::string& scene, double at_m) {
    const Simulation simulation =
        with_splats(scene + "<sensor type='psd' name='PSD' insert_at='ROOT' opening='20' resolution='64'/>",
                    {{.center_m = {at_m, 0, 0}, .sigma_m = {1e-6, kSigma_m, kSigma_m}, .opacity = 0.9}});
    CHECK(simulation.warnings().empty());
    return simulation.value("PSD", "range_m");
  };
  constexpr double kDepth = 1e-6;  // the wall's depth is drawn in float32, the disc's centre is float32
  const double both_m = distance_of_disc(kDisc_m, radius_m, kWall_m, glm::radians(20.0), 64);
  CHECK(both_m < 0.9 * kWall_m);
  CHECK(both_m > 1.1 * kDisc_m);
  CHECK(range_m(wall + kBush, kDisc_m) == doctest::Approx(both_m).epsilon(kDepth));
  CHECK(range_m(kBush, kDisc_m) == doctest::Approx(kDisc_m).epsilon(kDepth));
  // Behind the wall, behind the sensor, and nearer than 1 mm.
  for (const double at_m : {0.8, -0.3, 0.0009}) {
    CHECK(range_m(wall + kBush, at_m) == range_m(wall, at_m));
  }
}

// Two thin splats before and behind a place at 2 m: 0.6 of the light is left behind the first one, 0.36 behind both.
std::vector<FileSplat> two_splats(double first_m) {
  const auto thin = [](double range_m) {
    return FileSplat{.center_m = {range_m, 0, 0}, .sigma_m = glm::dvec3(0.05), .opacity = 0.4};
  };
  return {thin(first_m), thin(kBall_m)};
}

TEST_CASE("a beam that continues behind a pane lacks the light that a splat before the pane has stopped") {
  const std::string pane =
      "<part name='PANE' insert_at='ROOT' shape='box' size='0.01 1 1' pose_offset='2 0 0 0 0 0'/>"
      "<element type='material' name='GLASS' insert_at='ROOT' part='PANE' transmission='1'/>";
  const auto middle = [&](const std::vector<FileSplat>& splats) {
    const Simulation simulation =
        with_splats(kBackWall + kBush + pane + scanner("path_depth='2' range_max='20'"), splats);
    return static_cast<double>(simulation.scan("SCAN").range_m[20]);
  };
  CHECK(middle(two_splats(1)) == doctest::Approx(kBall_m).epsilon(1e-6));
  CHECK(middle({two_splats(1)[1]}) == doctest::Approx(kFace_m).epsilon(1e-6));
}

TEST_CASE("a beam that left before a box came into its way has the light that the splats on the way leave") {
  // The box moves to the beam from the side. The middle beam leaves half a sweep before the frame's time.
  constexpr double kStep_m = 5;
  const std::string box =
      "<part name='AT' insert_at='ROOT'/><element type='pose' name='MOVE' insert_at='AT'/>"
      "<part name='BOX' insert_at='AT' shape='box' size='0.1 0.1 0.1' pose_offset='2 0 0 0 0 0'/>";
  Simulation simulation = with_splats(kBackWall + kBush + box + scanner("sweep='0.01' range_max='20'"), two_splats(1));
  simulation.set("MOVE", "y", kStep_m);
  simulation.step();
  simulation.set("MOVE", "y", 0);
  simulation.step();
  CHECK(static_cast<double>(simulation.scan("SCAN").range_m[20]) == doctest::Approx(kBall_m).epsilon(1e-6));
}

TEST_CASE("a time-of-flight camera does not see splats nearer than near") {
  const auto range_m = [](const std::string& near) {
    const Simulation simulation =
        with_splats(kBackWall + kBush +
                        "<sensor type='tof_camera' name='TOF' insert_at='ROOT' width='3' height='3' hfov='20' "
                        "outputs='range' frequency='1e6' near='" +
                        near + "'/>",
                    two_splats(0.5));
    return static_cast<double>(to_image(*simulation.measurement("TOF").find("range"))->pixels[4]);
  };
  CHECK(range_m("0.1") == doctest::Approx(kBall_m).epsilon(1e-6));
  CHECK(range_m("1") == doctest::Approx(kFace_m).epsilon(1e-6));
}

TEST_CASE("a splat adds the radiance of its colour to a receiver's noise, on every side of it and in every light") {
  constexpr double kGrey = 0.5, kSunlight = 50, kNear = 1e-5;  // far above the rounding of colours to float32
  const double radiance = std::pow((kGrey + 0.055) / 1.055, 2.4);
  const double threshold = radiance / (kBall_m * kBall_m) / std::sqrt(1 + kSunlight * radiance);
  const FileSplat splat{
      .center_m = {kBall_m, 0, 0}, .sigma_m = glm::dvec3(0.2), .opacity = 0.99, .color = glm::dvec3(kGrey)};
  const auto sees = [&](const std::string& height_m, const std::string& sun, double dropout_power) {
    const Simulation simulation = with_splats(
        kBush + "<element type='light' name='SUN' insert_at='ROOT' azimuth='180' elevation='60' intensity='" + sun +
            "'/><sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='1' min_angle='0' " +
            "max_angle='0' dropout_noise='0' sunlight='" + format_number(kSunlight) + "' dropout_power='" +
            format_number(dropout_power) + "' pose_offset='0 0 " + height_m + " 0 0 0'/>",
        {splat});
    return std::isfinite(simulation.scan("SCAN").range_m[0]);
  };
  for (const std::string height_m : {"-0.1", "0.1"}) {
    for (const std::string sun : {"0", "2"}) {
      CAPTURE(height_m);
      CAPTURE(sun);
      CHECK(sees(height_m, sun, threshold * (1 - kNear)));
      CHECK_FALSE(sees(height_m, sun, threshold * (1 + kNear)));
    }
  }
}

TEST_CASE("a splat returns no pulses of other scanners, as a wall does") {
  const auto ranges_of = [](const std::string& target, const std::string& crosstalk) {
    Simulation simulation =
        with_splats(target + "<part name='OTHER' insert_at='ROOT' pose_offset='0 0.5 0 0 0 0'/>" +
                    scanner("sweep='2e-6' beam_diameter='0.3' range_max='80' return='last' " + crosstalk));
    std::vector<float> all;
    for (int frame = 0; frame < 20; ++frame) {
      simulation.step();
      const auto& ranges_m = simulation.scan("SCAN").range_m;
      all.insert(all.end(), ranges_m.begin(), ranges_m.end());
    }
    return all;
  };
  const std::string others = "crosstalk='OTHER'";
  CHECK(ranges_of(kBush, others) == ranges_of(kBush, ""));
  CHECK(ranges_of(kBackWall, others) != ranges_of(kBackWall, ""));
}

TEST_CASE("a scanner and the middle of a camera's image see one range, wherever the cloud stands") {
  std::vector<FileSplat> splats;
  for (int i = 0; i < 300; ++i) {
    FileSplat splat = kBall;
    splat.center_m = {3 + std::sin(i * 1.7), 1.5 * std::sin(i * 0.9), 1.5 * std::cos(i * 2.3)};
    splat.sigma_m = {0.02 + 0.01 * (i % 5), 0.1, 0.03 * (1 + i % 4)};
    splat.opacity = 0.1 + 0.03 * (i % 25);
    splats.push_back(splat);
  }
  Simulation simulation = with_splats(
      kBackWall +
          "<part name='AT' insert_at='ROOT'/><element type='pose' name='MOVE' insert_at='AT'/>"
          "<part name='S' file='s.ply' insert_at='AT'/>"
          "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='1' min_angle='0' max_angle='0'/>"
          "<sensor type='camera' name='CAM' insert_at='ROOT' width='3' height='3' outputs='range'/>",
      splats);
  std::size_t of_cloud = 0, of_wall = 0;
  for (int frame = 0; frame < 60; ++frame) {
    simulation.set("MOVE", "y", 1.3 * std::sin(frame * 0.61));
    simulation.set("MOVE", "z", 1.3 * std::cos(frame * 1.13));
    simulation.set("MOVE", "roll", 7.0 * frame);
    simulation.step();
    const double of_scanner = static_cast<double>(simulation.scan("SCAN").range_m[0]),
                 of_camera = static_cast<double>(to_image(*simulation.measurement("CAM").find("range"))->pixels[4]);
    // Both are rounded to float32; the camera's wall is drawn with a bound of some roundings.
    constexpr double kFloat = 4 * 0x1p-24;
    CHECK(std::abs(of_scanner - of_camera) <= kFloat * of_camera);
    (of_scanner < 6 ? of_cloud : of_wall) += 1;
  }
  CHECK(of_cloud > 10);
  CHECK(of_wall > 10);
}

TEST_CASE("a part of splats moves and hides, and a scanner that ignores it measures as without it") {
  const std::string moved =
      "<part name='AT' insert_at='ROOT'/><element type='visibility' name='SHOW' insert_at='AT'/>"
      "<element type='pose' name='MOVE' insert_at='AT'/>"
      "<part name='S' file='s.ply' insert_at='AT'/>";
  for (const std::string method : {"raycast", "planar", "auto"}) {
    CAPTURE(method);
    const std::string scan = "method='" + method + "'";
    Simulation simulation = with_splats(kBackWall + moved + scanner(scan));
    const auto middle = [&] {
      simulation.step();
      return static_cast<double>(simulation.scan("SCAN").range_m[20]);
    };
    simulation.set("MOVE", "x", 0.5);
    CHECK(middle() == doctest::Approx(kBall_m + 0.5).epsilon(1e-7));
    simulation.set("SHOW", "visible", 0);
    CHECK(middle() == doctest::Approx(kFace_m).epsilon(1e-5));
    CHECK(simulation.diagnostics().frame_plan().effects.empty());
    simulation.set("SHOW", "visible", 1);
    CHECK(middle() == doctest::Approx(kBall_m + 0.5).epsilon(1e-7));
    const Simulation without = with_splats(kBackWall + scanner(scan)),
                     ignoring = with_splats(kBackWall + kBush + scanner(scan + " ignore='S'"));
    CHECK(std::ranges::equal(ignoring.scan("SCAN").range_m, without.scan("SCAN").range_m));
    CHECK(ignoring.diagnostics().frame_plan().effects.empty());
    CHECK(ignoring.diagnostics().frame_plan().passes.size() == without.diagnostics().frame_plan().passes.size());
  }
}

TEST_CASE("hidden splats cost a scanner nothing") {
  const std::string hidden =
      "<part name='AT' insert_at='ROOT'/>"
      "<element type='visibility' name='SHOW' insert_at='AT' visible='0'/>";
  for (const std::string method : {"raycast", "planar", "hybrid"}) {
    CAPTURE(method);
    const std::string scan = scanner("method='" + method + "'");
    const Simulation plain = with_splats(kBackWall + hidden + scan),
                     with = with_splats(kBackWall + hidden + "<part name='S' file='s.ply' insert_at='AT'/>" + scan);
    CHECK(std::ranges::equal(plain.scan("SCAN").range_m, with.scan("SCAN").range_m));
    CHECK(plain.diagnostics().counters() == with.diagnostics().counters());
    CHECK(with.diagnostics().frame_plan().effects.empty());
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
