// RGB-D cameras that see Gaussian splats from two viewpoints, against closed forms, a slow reference and other sensors.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "tests/splats/random_splats.h"
#include "tests/support/error_of.h"
#include "tests/support/splat_file.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("engine/splats");

namespace simvis {
namespace {

using test::FileSplat;
using test::splat_file;

constexpr double kNowhere_m = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kColumns = 64, kRows = 48;
constexpr double kNear_m = 0.05;
const double kFocalRgbd_px = kColumns / 2 / std::tan(glm::radians(30.0));
constexpr std::uint8_t kSeen = 0, kNothingSeen = 1, kCovered = 2, kBesideImage = 3, kBeyondLimits = 4;
const std::string kSplatPart = "<part name='S' file='s.ply' insert_at='ROOT'/>";

std::string rgbd(const std::string& attributes, const std::string& outputs = "color depth depth_state") {
  return "<sensor type='rgbd_camera' name='D' insert_at='ROOT' width='64' height='48' outputs='" + outputs + "' " +
         attributes + "/>";
}

/// A square that faces the camera.
struct Plate {
  double x_m, y_m, half_m;
};

std::string part_of(const Plate& plate, const std::string& name) {
  const std::string size = format_number(2 * plate.half_m);
  return "<part name='" + name + "' insert_at='ROOT' shape='box' size='0.0002 " + size + " " + size +
         "' pose_offset='" + format_number(plate.x_m + 1e-4) + " " + format_number(plate.y_m) + " 0 0 0 0'/>";
}

const Plate kFarWall{10, 0, 200};

struct RgbdFrame {
  Image color, depth;
  std::vector<std::uint8_t> state;
};

RgbdFrame frame_of(const Simulation& simulation) {
  const Measurement measured = simulation.measurement("D");
  const auto image = [&](const char* name) {
    const MeasuredArray* const array = measured.find(name);
    return array == nullptr ? Image() : *to_image(*array);
  };
  RgbdFrame frame{image("color"), image("depth"), {}};
  if (const MeasuredArray* const state = measured.find("depth_state")) {
    const auto& states = std::get<SharedArray<std::uint8_t>>(state->numbers);
    frame.state.assign(states.begin(), states.end());
  }
  return frame;
}

Simulation loaded(const std::string& xml, const std::vector<FileSplat>& splats) {
  const TemporaryFolder folder;
  write_text(folder / "s.ply", splat_file(splats));
  return Simulation::from_string("<s>" + xml + "</s>", {}, folder.path());
}

RgbdFrame frame_of(const std::string& xml, const std::vector<FileSplat>& splats) {
  Simulation simulation = loaded(xml, splats);
  simulation.step();
  for (const std::string& warning : simulation.warnings()) CHECK(warning.find("does not see") == warning.npos);
  return frame_of(simulation);
}

// A disc without thickness: on the plane at x_m half of the light is left at the distance kHalfRadius from its centre.
FileSplat disc(double x_m, double y_m = 0) {
  return {.center_m = {x_m, y_m, 0}, .sigma_m = {1e-6, 0.3, 0.3}, .opacity = 0.9};
}
const double kHalfRadius_m = 0.3 * std::sqrt(2 * std::log(0.9 / 0.5));

TEST_CASE("a flat splat is a disc with a shadow of f B (1/Z1 - 1/Z2) pixels") {
  constexpr double kDisc_m = 2, kBaseline_m = 0.3;
  const RgbdFrame frame = frame_of(part_of(kFarWall, "WALL") + kSplatPart + rgbd("baseline='0.3'"), {disc(kDisc_m)});
  const double radius_px = kFocalRgbd_px * kHalfRadius_m / kDisc_m,
               shadow_px = kFocalRgbd_px * kBaseline_m * (1 / kDisc_m - 1 / kFarWall.x_m),
               band_px = kFocalRgbd_px * kBaseline_m / kFarWall.x_m;
  // The file has radius and opacity as float32, the disc bends by the square of its thickness over its radius, 1e-11.
  constexpr double kEdge_px = 1e-4, kDepth = 1e-6;
  std::size_t on_disc = 0, in_shadow = 0;
  for (std::size_t pixel = 0; pixel < frame.state.size(); ++pixel) {
    const double x = static_cast<double>(pixel % kColumns) + 0.5, across = x - kColumns / 2,
                 down = static_cast<double>(pixel / kColumns) + 0.5 - kRows / 2, distance_px = std::hypot(across, down),
                 // The disc as the second viewpoint sees it stands so far to the left before the wall.
        shadow_distance_px = std::hypot(across + shadow_px, down);
    CAPTURE(pixel);
    if (std::abs(distance_px - radius_px) < kEdge_px || std::abs(shadow_distance_px - radius_px) < kEdge_px) continue;
    const bool is_disc = distance_px < radius_px, is_shadow = !is_disc && shadow_distance_px < radius_px;
    REQUIRE(frame.state[pixel] == (is_shadow ? kCovered : !is_disc && x < band_px ? kBesideImage : kSeen));
    if (frame.state[pixel] == kSeen) {
      REQUIRE(static_cast<double>(frame.depth.pixels[pixel]) ==
              doctest::Approx(is_disc ? kDisc_m : kFarWall.x_m).epsilon(kDepth));
    } else {
      REQUIRE(std::isinf(frame.depth.pixels[pixel]));
    }
    on_disc += is_disc;
    in_shadow += is_shadow;
  }
  CHECK(on_disc > 50);
  CHECK(in_shadow > 50);
}

// The wall is a pixel of disparity behind the disc, and a little more or less.
TEST_CASE(
    "what the second viewpoint sees instead of a surface hides it if their disparities differ by more than 1 px") {
  constexpr double kBaseline_m = 0.3, kDisc_m = 2;
  const auto hidden = [&](double difference_px) {
    const double wall_m = 1 / (1 / kDisc_m - difference_px / (kFocalRgbd_px * kBaseline_m));
    const RgbdFrame frame =
        frame_of(part_of({wall_m, 0, 20}, "WALL") + kSplatPart + rgbd("baseline='0.3'"), {disc(kDisc_m)});
    return std::ranges::count(frame.state, kCovered);
  };
  CHECK(hidden(0.999) == 0);
  CHECK(hidden(1.001) > 10);
}

// The second splat behind the first leaves 0.36 of the light; alone it leaves 0.6.
TEST_CASE("a surface that only one viewpoint sees has no depth") {
  constexpr double kFirst_m = 1, kSecond_m = 3;
  const auto thin = [](double range_m) {
    return FileSplat{.center_m = {range_m, 0, 0}, .sigma_m = glm::dvec3(0.05), .opacity = 0.4};
  };
  const auto middle = [&](double baseline_m, const std::string& more) {
    const RgbdFrame frame =
        frame_of(more + kSplatPart +
                     "<sensor type='rgbd_camera' name='D' insert_at='ROOT' width='65' height='49' outputs='depth "
                     "depth_state' baseline='" +
                     format_number(baseline_m) + "'/>",
                 {thin(kFirst_m), thin(kSecond_m)});
    constexpr std::size_t kMiddle = 24 * 65 + 32;
    return std::pair(frame.state[kMiddle], static_cast<double>(frame.depth.pixels[kMiddle]));
  };
  const std::string wall = part_of(kFarWall, "WALL");
  for (const std::string& behind : {std::string(), wall}) {
    CAPTURE(behind);
    // Nearly one viewpoint: both rays pass both splats.
    CHECK(middle(0.001, behind).first == kSeen);
    CHECK(middle(0.001, behind).second == doctest::Approx(kSecond_m).epsilon(1e-4));
    // The ray from 0.3 m beside passes the first splat at 0.2 m, four standard deviations.
    CHECK(middle(0.3, behind).first == kCovered);
  }
  // A post before the second viewpoint alone.
  CHECK(middle(0.01, part_of({0.3, -0.12, 0.11}, "POST") + wall).first == kSeen);
  CHECK(middle(0.02, part_of({0.3, -0.12, 0.11}, "POST") + wall).first == kCovered);
}

TEST_CASE("splats nearer than near hide nothing from either viewpoint") {
  const std::string scene = part_of(kFarWall, "WALL") + kSplatPart + rgbd("baseline='0.02'");
  FileSplat close = disc(0.04);
  close.sigma_m = {1e-6, 0.1, 0.1};
  const RgbdFrame with = frame_of(scene, {close}), without = frame_of(scene, {disc(-1)});
  CHECK(with.depth.pixels == without.depth.pixels);
  CHECK(with.state == without.state);
  CHECK(with.color.pixels == without.color.pixels);
  CHECK(std::ranges::count(with.state, kSeen) > 1000);
}

/// What a ray sees: every splat in order, then the plates. Points and directions are those of the world.
class SlowSight {
 public:
  SlowSight(std::vector<FileSplat> splats, std::vector<Plate> plates)
      : splats_(std::move(splats)), plates_(std::move(plates)) {}

  struct Surface {
    double range_m = kNowhere_m;
    bool is_splat = false;
  };

  /// Rounding may decide: so near is the transmittance to a half, an alpha to 1/255, or a ray to the edge of a plate.
  bool is_doubtful = false;

  Surface see(const glm::dvec3& from_m, const glm::dvec3& way) {
    Surface surface;
    for (const Plate& plate : plates_) {
      const double range_m = (plate.x_m - from_m.x) / way.x;
      const glm::dvec3 at_m = from_m + range_m * way;
      const double beside_m = std::max(std::abs(at_m.y - plate.y_m), std::abs(at_m.z)) - plate.half_m;
      is_doubtful |= std::abs(beside_m) < kEdge_m;
      if (beside_m < 0) surface.range_m = std::min(surface.range_m, range_m);
    }
    std::vector<std::pair<double, double>> met;  // range, alpha
    for (const FileSplat& splat : splats_) meet(splat, from_m, way, surface.range_m, met);
    std::ranges::sort(met);
    double left = 1;
    for (const auto& [range_m, alpha] : met) {
      left *= 1 - alpha;
      is_doubtful |= std::abs(left - 0.5) < kShare;
      if (left <= 0.5) return {range_m, true};
    }
    return surface;
  }

 private:
  // Plates are 0.2 mm thick. The file has logarithms of sizes, below 10, and of odds as float32, 6e-7: the exponent,
  // at most 11, is off by 1.3e-5.
  static constexpr double kEdge_m = 1e-3, kShare = 3e-5;

  void meet(const FileSplat& splat, const glm::dvec3& from_m, const glm::dvec3& way, double end_m,
            std::vector<std::pair<double, double>>& met) {
    const glm::dvec3 from = (from_m - splat.center_m) / splat.sigma_m, along = way / splat.sigma_m;
    const double range_m = -glm::dot(from, along) / glm::dot(along, along);
    const glm::dvec3 nearest = from + range_m * along;
    const double alpha = std::min(splat.opacity * std::exp(-glm::dot(nearest, nearest) / 2), 0.99);
    is_doubtful |= std::abs(255 * alpha - 1) < 255 * kShare;
    if (alpha < 1.0 / 255 || range_m * way.x <= kNear_m || range_m >= end_m) return;
    met.emplace_back(range_m, alpha);
  }

  std::vector<FileSplat> splats_;
  std::vector<Plate> plates_;
};

struct RgbdSetting {
  std::string attributes;
  double baseline_m, second_focal_px, min_m = 0, max_m = kNowhere_m;
};

/// What the camera at `camera_m` gives for a pixel, and its depth before noise.
std::pair<std::uint8_t, double> expected_pixel(SlowSight& sight, const RgbdSetting& setting, const glm::dvec3& camera_m,
                                               std::size_t pixel) {
  const double across = (static_cast<double>(pixel % kColumns) + 0.5 - kColumns / 2) / kFocalRgbd_px,
               down = (static_cast<double>(pixel / kColumns) + 0.5 - kRows / 2) / kFocalRgbd_px;
  const glm::dvec3 way = glm::normalize(glm::dvec3(1, -across, -down));
  const SlowSight::Surface first = sight.see(camera_m, way);
  if (std::isinf(first.range_m)) return {kNothingSeen, 0};
  const glm::dvec3 point_m = camera_m + first.range_m * way, second_m = camera_m - glm::dvec3(0, setting.baseline_m, 0),
                   to_point_m = point_m - second_m;
  const double depth_m = point_m.x - camera_m.x;
  const double column_px = kColumns / 2 - setting.second_focal_px * to_point_m.y / depth_m,
               row_px = kRows / 2 - setting.second_focal_px * to_point_m.z / depth_m;
  constexpr double kSide_px = 1e-3;  // depths of splats are off by 1e-5 of themselves
  for (const double side_px : {column_px, column_px - kColumns, row_px, row_px - kRows}) {
    sight.is_doubtful |= std::abs(side_px) < kSide_px;
  }
  if (column_px < 0 || column_px >= kColumns || row_px < 0 || row_px >= kRows) return {kBesideImage, 0};
  const glm::dvec3 back = glm::normalize(to_point_m);
  const SlowSight::Surface second = sight.see(second_m, back);
  bool is_hidden = std::isinf(second.range_m) && first.is_splat;
  if (!first.is_splat && !second.is_splat) {
    is_hidden = second.range_m < (1 - 1e-6) * glm::length(to_point_m);
  } else if (!is_hidden) {
    const double px = kFocalRgbd_px * setting.baseline_m * std::abs(1 / (second.range_m * back.x) - 1 / depth_m);
    sight.is_doubtful |= std::abs(px - 1) < 1e-3;
    is_hidden = px > 1;
  }
  if (is_hidden) return {kCovered, 0};
  for (const double limit_m : {setting.min_m, setting.max_m}) {
    sight.is_doubtful |= std::abs(depth_m - limit_m) < 1e-4;
  }
  return {depth_m < setting.min_m || depth_m > setting.max_m ? kBeyondLimits : kSeen, depth_m};
}

// A cloud whose half has no smooth surface: discs and needles along the axes.
std::vector<FileSplat> random_cloud(std::uint32_t seed) {
  std::mt19937 numbers(seed);
  std::vector<FileSplat> splats;
  for (int i = 0; i < 60; ++i) {
    FileSplat splat{.center_m = test::uniform_vec(numbers, -1, 1) * glm::dvec3(0.6, 1, 0.8) + glm::dvec3(3, 0, 0)};
    const glm::dvec3 magnitude = test::uniform_vec(numbers, -1.6, -0.6);
    splat.sigma_m = {std::pow(10, magnitude.x), std::pow(10, magnitude.y), std::pow(10, magnitude.z)};
    splat.opacity = test::uniform(numbers, 0.1, 0.95);
    splats.push_back(splat);
  }
  return splats;
}

struct RgbdCase {
  const char* what;
  bool has_cloud;
  std::vector<Plate> plates;
};

// One frame elsewhere comes before if something moves.
struct RgbdMotion {
  const char* what;
  glm::dvec3 cloud_m{0}, camera_m{0};
};

RgbdFrame moved_frame(const RgbdCase& shown, const RgbdSetting& setting, const RgbdMotion& motion,
                      const std::vector<FileSplat>& splats) {
  std::string xml =
      "<part name='AT_S' insert_at='ROOT'/><element type='pose' name='S_POSE' insert_at='AT_S'/>"
      "<part name='S' file='s.ply' insert_at='AT_S'/><part name='AT_D' insert_at='ROOT'/>"
      "<element type='pose' name='D_POSE' insert_at='AT_D'/>";
  for (std::size_t i = 0; i < shown.plates.size(); ++i) xml += part_of(shown.plates[i], "P" + std::to_string(i));
  std::string sensor = rgbd(setting.attributes);
  sensor.replace(sensor.find("ROOT"), 4, "AT_D");
  Simulation simulation = loaded(xml + sensor, splats);
  simulation.step();
  const auto place = [&](const std::string& element, const glm::dvec3& at_m) {
    simulation.set(element, "x", at_m.x);
    simulation.set(element, "y", at_m.y);
    simulation.set(element, "z", at_m.z);
  };
  place("S_POSE", motion.cloud_m);
  place("D_POSE", motion.camera_m);
  simulation.step();
  CHECK(simulation.warnings().empty());
  return frame_of(simulation);
}

TEST_CASE("states and depths are those of a slow reference, for every scene, setting and motion") {
  const std::vector<RgbdCase> cases{{"splats alone", true, {}},
                                    {"splats before a wall", true, {kFarWall}},
                                    {"splats at a wall, which they cover in part", true, {{3.05, 0, 200}}},
                                    {"a plate before splats", true, {{1.5, 0.2, 0.3}, kFarWall}},
                                    {"a plate before the second viewpoint alone", true, {{0.4, -0.15, 0.12}}}};
  const std::vector<RgbdSetting> settings{
      {"baseline='0.05'", 0.05, kFocalRgbd_px},
      {"baseline='0.3'", 0.3, kFocalRgbd_px},
      {"baseline='0.1' second_hfov='40'", 0.1, kColumns / 2 / std::tan(glm::radians(20.0))},
      {"baseline='0.1' depth_min='2.8' depth_max='3.2'", 0.1, kFocalRgbd_px, 2.8, 3.2}};
  const std::vector<RgbdMotion> motions{
      {"nothing moves"}, {"the cloud moves", {0.2, 0.1, -0.1}}, {"the camera moves", {0, 0, 0}, {-0.1, 0.2, 0.1}}};
  std::array<std::size_t, 5> states{};
  std::size_t doubtful = 0, all = 0;
  std::uint32_t seed = 0;
  for (const RgbdCase& shown : cases) {
    for (const RgbdSetting& setting : settings) {
      for (const RgbdMotion& motion : motions) {
        CAPTURE(shown.what);
        CAPTURE(setting.attributes);
        CAPTURE(motion.what);
        const std::vector<FileSplat> splats = random_cloud(seed++);
        const RgbdFrame frame = moved_frame(shown, setting, motion, splats);
        std::vector<FileSplat> placed = splats;
        for (FileSplat& each : placed) each.center_m += motion.cloud_m;
        SlowSight sight(placed, shown.plates);
        for (std::size_t pixel = 0; pixel < frame.state.size(); ++pixel) {
          CAPTURE(pixel);
          sight.is_doubtful = false;
          const auto expected = expected_pixel(sight, setting, motion.camera_m, pixel);
          ++all;
          doubtful += sight.is_doubtful;
          if (sight.is_doubtful) continue;
          REQUIRE(int{frame.state[pixel]} == int{expected.first});
          ++states[expected.first];
          // Sizes in the file are off by 6e-7, and so is where a ray is nearest to a centre, in widths of the cloud.
          if (expected.first == kSeen) {
            REQUIRE(static_cast<double>(frame.depth.pixels[pixel]) == doctest::Approx(expected.second).epsilon(1e-5));
          } else {
            REQUIRE(std::isinf(frame.depth.pixels[pixel]));
          }
        }
      }
    }
  }
  for (const std::size_t count : states) CHECK(count > 500);
  CHECK(doubtful < all / 20);
}

TEST_CASE("noise and steps of disparity act on the depths of splats as on those of a wall") {
  constexpr double kBaseline_m = 0.2, kWall_m = 4;
  const double scale = kFocalRgbd_px * kBaseline_m;
  const auto depths = [&](const std::string& attributes, bool has_wall) {
    const std::string wall = has_wall ? part_of({kWall_m, 0, 200}, "WALL") : "";
    return frame_of(wall + kSplatPart + rgbd("baseline='0.2' " + attributes), {disc(has_wall ? 6 : 2)});
  };
  // The noise of a pixel is the same, whatever it sees.
  const RgbdFrame wall = depths("disparity_noise='0.1'", true), splat = depths("disparity_noise='0.1'", false),
                  stepped = depths("disparity_step='0.25'", false);
  std::size_t compared = 0;
  for (std::size_t pixel = 0; pixel < splat.state.size(); ++pixel) {
    if (splat.state[pixel] != kSeen || wall.state[pixel] != kSeen) continue;
    ++compared;
    const double noise_px = scale / static_cast<double>(wall.depth.pixels[pixel]) - scale / kWall_m;
    CHECK(static_cast<double>(splat.depth.pixels[pixel]) ==
          doctest::Approx(scale / (scale / 2 + noise_px)).epsilon(2e-6));
    CHECK(static_cast<double>(stepped.depth.pixels[pixel]) ==
          doctest::Approx(scale / (std::round(scale / 2 / 0.25) * 0.25)).epsilon(1e-6));
  }
  CHECK(compared > 50);
}

TEST_CASE("each output has the same bytes without the others, and colour and depth are those of a camera") {
  const std::vector<FileSplat> splats = random_cloud(77);
  const std::string scene = part_of(kFarWall, "WALL") + kSplatPart;
  for (const std::string lens : {"", "distortion='brown_conrady' k1='-0.2'", "distortion='kannala_brandt' fx='30'",
                                 "supersampling='4'", "exposure='2'"}) {
    CAPTURE(lens);
    const std::string attributes = "baseline='0.1' " + lens;
    const RgbdFrame all = frame_of(scene + rgbd(attributes), splats);
    CHECK(frame_of(scene + rgbd(attributes, "color"), splats).color.pixels == all.color.pixels);
    CHECK(frame_of(scene + rgbd(attributes, "depth"), splats).depth.pixels == all.depth.pixels);
    CHECK(frame_of(scene + rgbd(attributes, "depth_state"), splats).state == all.state);
    const std::string camera = "<sensor type='camera' name='D' insert_at='ROOT' width='64' height='48' " + lens;
    CHECK(frame_of(scene + camera + " outputs='color'/>", splats).color.pixels == all.color.pixels);
    const Image depth = frame_of(scene + camera + " outputs='color depth normal'/>", splats).depth;
    std::size_t of_splats = 0;
    for (std::size_t pixel = 0; pixel < depth.pixels.size(); ++pixel) {
      if (all.state[pixel] != kSeen) continue;
      REQUIRE(all.depth.pixels[pixel] == depth.pixels[pixel]);
      of_splats += depth.pixels[pixel] < 5;
    }
    CHECK(of_splats > 50);
  }
}

TEST_CASE("an RGB-D camera, a time-of-flight camera and a range sensor at one place see one range") {
  const std::string pixels = " insert_at='ROOT' width='65' height='49' ";
  Simulation simulation = loaded(part_of(kFarWall, "WALL") + kSplatPart +
                                     "<sensor type='rgbd_camera' name='D' baseline='0.01' outputs='depth depth_state'" +
                                     pixels + "/><sensor type='tof_camera' name='TOF' outputs='depth' frequency='1e6'" +
                                     pixels + "/><sensor type='range' name='RANGE' insert_at='ROOT' range_max='20'/>",
                                 random_cloud(9));
  simulation.step();
  const RgbdFrame frame = frame_of(simulation);
  const Image tof = *to_image(*simulation.measurement("TOF").find("depth"));
  constexpr double kPhase = 1e-5;  // ranges are phases of 150 m, in double, of float32 amplitudes
  std::size_t of_splats = 0;
  for (std::size_t pixel = 0; pixel < tof.pixels.size(); ++pixel) {
    if (frame.state[pixel] != kSeen) continue;
    CAPTURE(pixel);
    REQUIRE(static_cast<double>(frame.depth.pixels[pixel]) ==
            doctest::Approx(static_cast<double>(tof.pixels[pixel])).epsilon(kPhase));
    of_splats += frame.depth.pixels[pixel] < 5;
  }
  CHECK(of_splats > 300);
  constexpr std::size_t kMiddle = 24 * 65 + 32;
  REQUIRE(frame.state[kMiddle] == kSeen);
  CHECK(simulation.value("RANGE", "range_m") ==
        doctest::Approx(static_cast<double>(frame.depth.pixels[kMiddle])).epsilon(0x1p-23));
}

TEST_CASE("the plan names the splats, depths of splats have no bound, and a hidden cloud costs nothing") {
  const std::string wall = part_of(kFarWall, "WALL"), sensor = rgbd("baseline='0.1'");
  Simulation plain = loaded(wall + sensor, {disc(2)}), seen = loaded(wall + kSplatPart + sensor, {disc(2)}),
             hidden = loaded(wall +
                                 "<part name='AT' insert_at='ROOT'/><element type='visibility' name='SHOW' "
                                 "insert_at='AT' visible='0'/><part name='S' file='s.ply' insert_at='AT'/>" +
                                 sensor,
                             {disc(2)});
  for (Simulation* const each : {&plain, &seen, &hidden}) each->step();
  CHECK(std::isfinite(plain.value("D", "depth_error_bound_m")));
  CHECK(std::isinf(seen.value("D", "depth_error_bound_m")));
  const FramePlan &without = plain.diagnostics().frame_plan(), &with = seen.diagnostics().frame_plan(),
                  &with_hidden = hidden.diagnostics().frame_plan();
  REQUIRE(with.casts.size() == 3);
  CHECK(contains(with.casts[0].reason, "the centre of each pixel of RGB-D camera D, through 1 Gaussian splats"));
  CHECK(contains(with.casts[2].reason, "from both viewpoints, through 1 Gaussian splats"));
  REQUIRE(with.effects.size() == 1);  // although both colour and depth show splats
  CHECK(with.effects[0].effect == "gaussian_splats");
  CHECK(without.casts.size() == 1);
  CHECK(without.effects.empty());
  CHECK(with_hidden.casts.size() == 1);
  CHECK(with_hidden.effects.empty());
  CHECK(plain.diagnostics().counters() == hidden.diagnostics().counters());
  CHECK(frame_of(plain).depth.pixels == frame_of(hidden).depth.pixels);
}

TEST_CASE("the number of threads changes no byte") {
  const std::vector<FileSplat> splats = random_cloud(3);
  const TemporaryFolder folder;
  write_text(folder / "s.ply", splat_file(splats));
  const auto frame = [&](unsigned threads) {
    SimulationDesc desc;
    desc.threads = threads;
    Simulation simulation = Simulation::from_string(
        "<s>" + part_of(kFarWall, "WALL") + kSplatPart + rgbd("baseline='0.1'") + "</s>", desc, folder.path());
    simulation.step();
    return frame_of(simulation);
  };
  const RgbdFrame one = frame(1), three = frame(3);
  CHECK(one.depth.pixels == three.depth.pixels);
  CHECK(one.state == three.state);
  CHECK(one.color.pixels == three.color.pixels);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
