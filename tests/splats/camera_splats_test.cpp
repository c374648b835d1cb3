// Cameras that see Gaussian splats: colour, depth, ranges and labels, through every kind of lens, with what is drawn.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "engine/base/srgb.h"
#include "tests/support/error_of.h"
#include "tests/support/splat_file.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("engine/splats");

namespace simvis {
namespace {

using test::FileSplat;
using test::splat_file;

constexpr double kRange_m = 3, kSigma_m = 0.4, kWall_m = 10;
const FileSplat kRound{
    .center_m = {kRange_m, 0, 0}, .sigma_m = glm::dvec3(kSigma_m), .opacity = 0.9, .color = {1, 0.25, 0}};
const std::string kWall =
    "<part name='WALL' insert_at='ROOT' shape='box' size='0.2 400 400' pose_offset='10.1 0 0 0 0 0'/>";
const std::string kCloud = "<part name='S' file='s.ply' insert_at='ROOT'/>";
const std::string kLabels =
    "<element type='label' name='L1' insert_at='ROOT' part='WALL' class='wall' class_id='4'/>"
    "<element type='label' name='L2' insert_at='ROOT' part='S' class='bush' class_id='7'/>";

std::string camera(const std::string& attributes) {
  return "<sensor type='camera' name='CAM' insert_at='ROOT' width='65' height='49' " + attributes + "/>";
}

/// A scene with a file s.ply.
class SplatScene {
 public:
  SplatScene(const std::string& xml, const std::vector<FileSplat>& splats = {kRound})
      : simulation_(
            (write_text(folder_ / "s.ply", splat_file(splats)), Simulation::from_string(xml, {}, folder_.path()))) {
    simulation_.step();
  }
  Image image(const std::string& name, const std::string& sensor = "CAM") const {
    const Measurement measurement = simulation_.measurement(sensor);
    const MeasuredArray* const array = measurement.find(name);
    REQUIRE(array != nullptr);
    return *to_image(*array);
  }
  std::vector<std::uint32_t> ids(const std::string& name) const {
    const Measurement measurement = simulation_.measurement("CAM");
    const auto& ids = std::get<SharedArray<std::uint32_t>>(measurement.find(name)->numbers);
    return {ids.begin(), ids.end()};
  }
  /// The number in the only row of a column.
  double cell(const std::string& column) const {
    const Measurement measurement = simulation_.measurement("CAM");
    const MeasuredArray* const array = measurement.find(column);
    REQUIRE(array != nullptr);
    REQUIRE(array->count() == 1);
    return array->number(0);
  }
  Simulation& simulation() { return simulation_; }

 private:
  TemporaryFolder folder_;
  Simulation simulation_;
};

bool same_pixels(const Image& a, const Image& b) { return std::ranges::equal(a.pixels, b.pixels); }

// What the pixel sees of the round splat on the axis. `cosine` is that of its ray's angle with the axis.
struct RoundSight {
  double range_m, alpha;
};
RoundSight round_sight(double cosine) {
  const double square = kRange_m * kRange_m * (1 - cosine * cosine) / (kSigma_m * kSigma_m);
  const double alpha = 0.9 * std::exp(-square / 2);
  return {kRange_m * cosine, cosine > 0 && alpha >= 1.0 / 255 ? alpha : 0};
}

// The cosine is a quotient of float32 and the wall's depth is interpolated between pixels: 1e-6, which changes the
// square of the distance by 2 * 9 / 0.16 times as much, alpha by half of this, and colours that are below 1 by alpha.
constexpr double kAlphaTolerance = 6e-5, kRangeTolerance_m = 1e-5;

// Compares images with and without the splat, by the rays that the wall gives.
void check_round_splat(const std::string& attributes) {
  const std::string sensor = camera(attributes + " outputs='color depth range instance semantic'");
  const SplatScene plain(kWall + kLabels.substr(0, kLabels.find("/>") + 2) + sensor);
  const SplatScene seen(kWall + kCloud + kLabels + sensor);
  const Image wall_depth = plain.image("depth"), wall_range = plain.image("range"), depth = seen.image("depth"),
              range = seen.image("range"), drawn = plain.image("color"), color = seen.image("color");
  const auto wall_ids = plain.ids("instance"), ids = seen.ids("instance"), classes = seen.ids("semantic");
  std::size_t of_splat = 0, of_wall = 0;
  for (std::size_t i = 0; i < wall_depth.pixels.size(); ++i) {
    CAPTURE(i);
    if (!std::isfinite(wall_depth.pixels[i])) continue;
    const double cosine = static_cast<double>(wall_depth.pixels[i]) / static_cast<double>(wall_range.pixels[i]);
    const auto [range_m, alpha] = round_sight(cosine);
    if (std::abs(alpha - 1.0 / 255) < kAlphaTolerance || std::abs(alpha - 0.5) < kAlphaTolerance) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      const double expected = alpha * decode_srgb(kRound.color[static_cast<int>(c)]) +
                              (1 - alpha) * static_cast<double>(drawn.pixels[4 * i + c]);
      REQUIRE(std::abs(static_cast<double>(color.pixels[4 * i + c]) - expected) < kAlphaTolerance);
    }
    if (alpha < 0.5) {
      ++of_wall;
      REQUIRE(depth.pixels[i] == wall_depth.pixels[i]);
      REQUIRE(ids[i] == wall_ids[i]);
      REQUIRE(classes[i] == 4);
    } else {
      ++of_splat;
      REQUIRE(std::abs(static_cast<double>(range.pixels[i]) - range_m) < kRangeTolerance_m);
      REQUIRE(std::abs(static_cast<double>(depth.pixels[i]) - range_m * cosine) < kRangeTolerance_m);
      REQUIRE(ids[i] != wall_ids[i]);
      REQUIRE(ids[i] != 0);
      REQUIRE(classes[i] == 7);
    }
  }
  CHECK(of_splat > 15);
  CHECK(of_wall > 500);
}

}  // namespace

TEST_CASE("a camera sees a splat in front of a wall: colour, depth, range and labels") {
  check_round_splat("");
  SUBCASE("with samples, whose depth is drawn apart") { check_round_splat("supersampling='4'"); }
  SUBCASE("in rows of several times") { check_round_splat("row_time='1e-4' rows_per_pose='8'"); }
  SUBCASE("through a lens, whose pixels are cast") { check_round_splat("distortion='brown_conrady' k1='-0.2'"); }
  SUBCASE("through a double sphere") { check_round_splat("distortion='double_sphere' xi='-0.1' alpha='0.6'"); }
  SUBCASE("off the optical axis") { check_round_splat("fx='60' fy='50' cx='20' cy='18'"); }
  SUBCASE("through a fisheye") { check_round_splat("distortion='kannala_brandt' fx='20'"); }
}

TEST_CASE("truth that is cast sees the same splats as truth that is drawn") {
  const std::string scene = kWall + kCloud;
  const SplatScene drawn(scene + camera("outputs='color depth instance object_coordinates'"));
  const SplatScene cast(scene + camera("outputs='color depth instance object_coordinates normal'"));
  const Image drawn_depth = drawn.image("depth"), cast_depth = cast.image("depth"), normal = cast.image("normal"),
              coordinates = drawn.image("object_coordinates");
  CHECK(same_pixels(drawn.image("color"), cast.image("color")));
  CHECK(drawn.ids("instance") == cast.ids("instance"));
  std::size_t of_splat = 0;
  for (std::size_t i = 0; i < drawn_depth.pixels.size(); ++i) {
    if (!(drawn_depth.pixels[i] < 5)) continue;
    ++of_splat;
    CHECK(drawn_depth.pixels[i] == cast_depth.pixels[i]);
    CHECK(std::isnan(normal.pixels[3 * i]));
    CHECK(std::isnan(coordinates.pixels[3 * i]));
  }
  CHECK(of_splat > 15);
}

TEST_CASE("splats behind what is drawn change no byte, and those nearer than near are not seen") {
  const std::string sensor = camera("outputs='color depth'");
  const SplatScene plain(kWall + sensor);
  for (const double x_m : {11.0, 0.04, -3.0}) {
    CAPTURE(x_m);
    FileSplat splat = kRound;
    splat.center_m.x = x_m;
    splat.sigma_m = glm::dvec3(0.005);
    const SplatScene hidden(kWall + kCloud + sensor, {splat});
    CHECK(same_pixels(plain.image("color"), hidden.image("color")));
    CHECK(same_pixels(plain.image("depth"), hidden.image("depth")));
  }
}

TEST_CASE("a splat between two surfaces hides one and is hidden by the other") {
  const std::string box = "<part name='B' insert_at='ROOT' shape='box' size='0.1 0.3 0.3' pose_offset='2 0 0 0 0 0'/>";
  const SplatScene seen(kWall + box + kCloud + camera("hfov='40' outputs='depth'"));
  const Image depth = seen.image("depth");
  const auto at = [&](std::size_t x, std::size_t y) { return depth.pixels[y * 65 + x]; };
  CHECK(at(32, 24) == doctest::Approx(1.95).epsilon(1e-6));  // the box
  CHECK(at(32 + 8, 24) > 2.9f);                              // the splat: 0.27 m beside the axis, the box ends at 0.15
  CHECK(at(32 + 8, 24) < 3.0f);
  CHECK(at(2, 2) == doctest::Approx(kWall_m).epsilon(1e-6));
}

TEST_CASE("the order in the file and that of the parts change no byte") {
  std::vector<FileSplat> splats;
  for (int i = 0; i < 60; ++i) {
    FileSplat splat = kRound;
    splat.center_m += glm::dvec3(0.03 * (i % 7), 0.1 * (i % 5 - 2), 0.08 * (i % 11 - 5));
    splat.sigma_m = {0.05, 0.1 + 0.01 * (i % 3), 0.3};
    splat.opacity = 0.2 + 0.01 * i;
    splat.color = {0.01 * i, 0.5, 1 - 0.01 * i};
    splats.push_back(splat);
  }
  const std::string second = "<part name='T' file='s.ply' insert_at='ROOT' pose_offset='0.5 0.2 0 0 0 40'/>";
  const std::string sensor = camera("outputs='color depth'");
  const SplatScene first(kWall + kCloud + second + sensor, splats);
  std::ranges::reverse(splats);
  const SplatScene other(second + kCloud + kWall + sensor, splats);
  CHECK(same_pixels(first.image("color"), other.image("color")));
  CHECK(same_pixels(first.image("depth"), other.image("depth")));
}

TEST_CASE("effects of the camera act on what the splats add") {
  const SplatScene plain(kWall + kCloud + camera("")), bright(kWall + kCloud + camera("exposure='2'"));
  const Image once = plain.image("color"), twice = bright.image("color");
  for (std::size_t i = 0; i < once.pixels.size(); ++i) {
    if (i % 4 != 3) REQUIRE(twice.pixels[i] == doctest::Approx(2 * once.pixels[i]).epsilon(1e-6));
  }
}

TEST_CASE("a part moves with its pose, and a hidden one is not planned") {
  SplatScene scene(kWall + kCloud + "<element type='pose' name='POSE' insert_at='S'/>" +
                   camera("outputs='color depth'"));
  const std::size_t middle = 24 * 65 + 32;
  CHECK(scene.image("depth").pixels[middle] == 3);
  scene.simulation().set("POSE", "x", 0.25);
  scene.simulation().step();
  CHECK(scene.image("depth").pixels[middle] == 3.25);

  const std::string at = "<part name='AT' insert_at='ROOT'/>", sensor = camera("outputs='color'");
  SplatScene plain(kWall + at + sensor),
      hidden(kWall + at + "<element type='visibility' name='SHOW' insert_at='AT' visible='0'/>" +
             "<part name='S' file='s.ply' insert_at='AT'/>" + sensor);
  CHECK(same_pixels(plain.image("color"), hidden.image("color")));
  const FramePlan &without = plain.simulation().diagnostics().frame_plan(),
                  &with_hidden = hidden.simulation().diagnostics().frame_plan();
  CHECK(with_hidden.effects.empty());
  CHECK(with_hidden.casts.empty());
  CHECK(without.passes.size() == with_hidden.passes.size());
  CHECK(plain.simulation().diagnostics().counters() == hidden.simulation().diagnostics().counters());
  hidden.simulation().set("SHOW", "visible", 1);
  hidden.simulation().step();
  const FramePlan& shown = hidden.simulation().diagnostics().frame_plan();
  REQUIRE(shown.effects.size() == 1);
  CHECK(shown.effects[0].effect == "gaussian_splats");
  REQUIRE(shown.casts.size() == 1);
  CHECK(contains(shown.casts[0].reason, "the centre of each pixel of camera CAM, through 1 Gaussian splats"));
  CHECK_FALSE(same_pixels(plain.image("color"), hidden.image("color")));
}

TEST_CASE("a stereo camera: both views, and the disparity of the splat") {
  const std::string sensor =
      "<sensor type='stereo_camera' name='CAM' insert_at='ROOT' width='65' height='49' baseline='0.2' "
      "outputs='color depth disparity'/>";
  const SplatScene seen(kWall + kCloud + sensor);
  const double focal_px = 32.5 / std::tan(glm::radians(30.0));
  const Image left = seen.image("left_depth"), right = seen.image("right_depth"), disparity = seen.image("disparity");
  const std::size_t middle = 24 * 65 + 32;
  CHECK(left.pixels[middle] == 3);
  CHECK(disparity.pixels[middle] == doctest::Approx(focal_px * 0.2 / 3).epsilon(1e-6));
  // The right camera stands 0.2 m to the right: it sees the splat 3.75 pixels to the left.
  CHECK(right.pixels[middle - 4] == doctest::Approx(3).epsilon(1e-3));
  for (const char* const name : {"left", "right"}) {
    const Image color = seen.image(name);
    CHECK(color.pixels[4 * middle] > 0.6f);
    CHECK(color.pixels[4 * middle + 2] < 0.2f);
  }
}

TEST_CASE("a sensor that does not see splats says so once, and measures as without them") {
  const std::string sensor =
      "<sensor type='thermal_camera' name='CAM' insert_at='ROOT' width='20' height='10' outputs='temperature'/>";
  SplatScene plain(kWall + sensor), seen(kWall + kCloud + sensor);
  seen.simulation().step();
  CHECK(same_pixels(plain.image("temperature"), seen.image("temperature")));
  CHECK(plain.simulation().warnings().empty());
  REQUIRE(seen.simulation().warnings().size() == 1);
  CHECK(contains(seen.simulation().warnings()[0], "sensor \"CAM\" does not see the Gaussian splats of the scene"));
  SplatScene with_camera(kWall + kCloud + camera(""));
  CHECK(with_camera.simulation().warnings().empty());
}

TEST_CASE("depths of splats have no bound, and boxes are of what is seen between splats") {
  const std::string thing =
      "<part name='B' insert_at='ROOT' shape='box' size='0.2 1.6 1.6' pose_offset='5 0 0 0 0 0'/>"
      "<element type='label' name='L' insert_at='ROOT' part='B' class='box' class_id='9'/>";
  const std::string sensor = camera("outputs='depth depth_error_bound instance boxes'");
  SplatScene plain(thing + kWall + sensor), seen(thing + kWall + kCloud + sensor);
  CHECK(std::isfinite(plain.simulation().value("CAM", "depth_error_bound_m")));
  CHECK(std::isinf(seen.simulation().value("CAM", "depth_error_bound_m")));
  const auto ids = plain.ids("instance"), seen_ids = seen.ids("instance");
  const Image bound = seen.image("depth_error_bound"), depth = seen.image("depth");
  std::size_t visible = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (depth.pixels[i] < 4) CHECK(std::isinf(bound.pixels[i]));
    visible += ids[i] == seen_ids[i] && ids[i] == ids[24 * 65 + 32];
  }
  CHECK(visible > 0);
  CHECK(seen.cell("visible_pixels") == static_cast<double>(visible));
  CHECK(plain.cell("visible_pixels") > static_cast<double>(visible));
}

TEST_SUITE_END();

}  // namespace simvis
