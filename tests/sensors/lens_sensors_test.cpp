// Lenses of all sensors with pixels: what each pixel sees is computed from the formulas of the lens models.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <simvis/depth_points.h>
#include <simvis/simulation.h>
#include "sensors/camera/pinhole_view.h"
#include "sensors/camera/pixel_optics.h"
#include "tests/support/error_of.h"
#include "tests/support/made_lens.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis::test {
namespace {

constexpr std::uint32_t kLensWidth_px = 64, kLensHeight_px = 48;
constexpr double kPlate_m = 2, kBaseline_m = 0.1;
// The plate in the view frame at z = 2: x from -0.7 to 1.1 m, y from -0.9 to 0.6 m.
constexpr double kLeft_m = -0.7, kRight_m = 1.1, kTop_m = -0.9, kBottom_m = 0.6;

/// A lens by its formula, with the attributes that make it.
struct FormulaLens {
  MadeLens lens;
  std::string ros_name;
  bool is_fisheye;
  bool is_straight = false;  ///< written as focal lengths and principal point alone
  std::vector<std::optional<glm::dvec3>> rays{};

  std::string attributes() const {
    const Pinhole& p = lens.pinhole;
    const std::string focal = " fx=\"" + format_number(p.fx_px) + "\" fy=\"" + format_number(p.fy_px) + '"';
    const std::string centre =
        " cx=\"" + format_number(p.cx_px - 0.5) + "\" cy=\"" + format_number(p.cy_px - 0.5) + '"';
    const bool has_focal = lens_type(lens).focal_px != nullptr;
    return (is_straight ? "" : lens_attributes(lens)) + (has_focal ? "" : focal) + centre + " ";
  }
  glm::dvec2 pixel(const glm::dvec3& ray) const { return formula_pixel(lens, ray); }
  glm::dvec2 place(const glm::dvec3& ray) const {
    const Pinhole& p = lens.pinhole;
    return (pixel(ray) - glm::dvec2(p.cx_px, p.cy_px)) / glm::dvec2(p.fx_px, p.fy_px);
  }
  /// The ray of a pixel; none beyond 110 degrees.
  const std::optional<glm::dvec3>& ray(std::uint32_t pixel) const { return rays[pixel]; }

  std::optional<glm::dvec3> inverse(std::uint32_t pixel) const {
    const Pinhole& p = lens.pinhole;
    const glm::dvec2 target((pixel % kLensWidth_px + 0.5 - p.cx_px) / p.fx_px,
                            (pixel / kLensWidth_px + 0.5 - p.cy_px) / p.fy_px);
    if (!is_fisheye) {
      glm::dvec2 tangents = target;
      for (int i = 0; i < 200; ++i) tangents += target - place(glm::dvec3(tangents, 1));
      return glm::normalize(glm::dvec3(tangents, 1));
    }
    const double length = glm::length(target);
    const glm::dvec2 aside = length == 0 ? glm::dvec2(1, 0) : target / length;
    const auto at = [&](double theta) { return glm::dvec3(std::sin(theta) * aside, std::cos(theta)); };
    double low = 0, high = glm::radians(110.1);
    if (glm::length(place(at(high))) < length) return {};
    for (int i = 0; i < 60; ++i) {
      const double theta = (low + high) / 2;
      (glm::length(place(at(theta))) < length ? low : high) = theta;
    }
    if (low > glm::radians(110.0)) return {};
    return at(low);
  }
};

// Every model. The last one has no distortion: focal lengths and a principal point of its own.
std::vector<FormulaLens> formula_lenses() {
  std::vector<FormulaLens> lenses{
      {{"brown_conrady", {40, 40, 32, 24}, {-0.1, 0, 0.01, 0, 0}}, "plumb_bob", false},
      {{"kannala_brandt", {20, 20, 32, 24}, {0.03, 0, 0, 0}}, "equidistant", true},
      {{"rational_polynomial", {40, 36, 30.5, 25}, {0.5, 0.1, 1e-3, -2e-3, 0.01, 0.7, 0.15, 0.02}},
       "rational_polynomial",
       false},
      {{"rational_polynomial", {40, 40, 32, 24}, {0.5, 0.1, 0, 0, 0, 0.7, 0, 0, 0.01, 0, -0.01, 0.002}},
       "rational_polynomial",
       false},
      {{"rational_polynomial", {38, 40, 32, 24}, {-0.05, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.06, -0.04}},
       "rational_polynomial",
       false},
      {{"double_sphere", {18, 20, 33, 24}, {-0.1, 0.6}}, "double_sphere", true},
      {{"ftheta", {20, 20, 32, 22.5}, {0, 20, -0.5, 0.2}}, "ftheta", true},
      {{"ftheta_backward", {20, 20, 31, 24}, {0, 0.05, -2e-5, 1e-6}}, "ftheta_backward", true},
      {{"brown_conrady", {40, 30, 28, 26.25}, {0, 0, 0, 0, 0}}, "plumb_bob", false, true}};
  for (FormulaLens& lens : lenses) {
    for (std::uint32_t pixel = 0; pixel < kLensWidth_px * kLensHeight_px; ++pixel) {
      lens.rays.push_back(lens.inverse(pixel));
    }
  }
  return lenses;
}

const std::vector<FormulaLens>& all_lenses() {
  static const std::vector<FormulaLens> lenses = formula_lenses();
  return lenses;
}

enum class PlateHit : std::uint8_t { yes, no, near_its_edge };

/// Whether a ray from (offset_m, 0, 0) hits the plate.
PlateHit hits_plate(const std::optional<glm::dvec3>& ray, double offset_m = 0) {
  constexpr double kMargin_m = 0.2;  // 2 pixels at least: samples of cameras with views are interpolated
  if (!ray || ray->z <= 0) return PlateHit::no;
  const double x = kPlate_m * ray->x / ray->z + offset_m, y = kPlate_m * ray->y / ray->z;
  const double inside = std::min({x - kLeft_m, kRight_m - x, y - kTop_m, kBottom_m - y});
  return inside > kMargin_m ? PlateHit::yes : inside < -kMargin_m ? PlateHit::no : PlateHit::near_its_edge;
}

Simulation lens_scene(const std::string& type, const std::string& attributes, const std::string& more = "") {
  // In the sensor frame the plate's front is at x = 2, y from -1.1 to 0.7, z from -0.6 to 0.9.
  return Simulation::from_string(
      R"(<simvis><part name="PLATE" shape="box" size="0.1 1.8 1.5" insert_at="ROOT" pose_offset="2.05 -0.2 0.15 0 0 0"/>
      <element type="light" name="SUN" insert_at="ROOT"/>
      <element type="pose" name="MOVE" insert_at="PLATE"/>
      <element type="temperature" name="HEAT" insert_at="ROOT" part="PLATE" temperature="400" emissivity="1"/>
      <sensor type=")" +
      type + R"(" name="S" insert_at="ROOT" width="64" height="48" )" + attributes + "/>" + more + "</simvis>");
}

std::vector<double> numbers_of(const Measurement& measurement, const std::string& name) {
  const MeasuredArray* const array = measurement.find(name);
  REQUIRE(array != nullptr);
  REQUIRE(array->count() == kLensWidth_px * kLensHeight_px);
  std::vector<double> numbers;
  for (std::size_t i = 0; i < array->count(); ++i) numbers.push_back(array->number(i));
  return numbers;
}

/// Checks each pixel of an image, where it is clear whether it sees the plate. `expected` gives the number there.
template <typename Expected>
void check_plate(const FormulaLens& lens, const std::vector<double>& image, double nothing, double offset_m,
                 const Expected& expected) {
  std::size_t seen = 0, unseen = 0;
  for (std::uint32_t pixel = 0; pixel < image.size(); ++pixel) {
    const std::optional<glm::dvec3> ray = lens.ray(pixel);
    const PlateHit hit = hits_plate(ray, offset_m);
    if (hit == PlateHit::near_its_edge) continue;
    CAPTURE(pixel);
    if (hit == PlateHit::no) {
      REQUIRE(image[pixel] == nothing);
      ++unseen;
    } else {
      REQUIRE(image[pixel] == doctest::Approx(expected(*ray)).epsilon(1e-5));
      ++seen;
    }
  }
  CHECK(seen > 40);
  CHECK(unseen > 400);
}

void check_calibration(const FormulaLens& lens, const Measurement& measurement, const char* view) {
  const CameraCalibration* const calibration = measurement.calibration(view);
  REQUIRE(calibration != nullptr);
  CHECK(calibration->distortion_model == lens.ros_name);
  REQUIRE(calibration->distortion_coefficients.size() == lens.lens.coefficients.size());
  for (std::size_t i = 0; i < lens.lens.coefficients.size(); ++i) {
    // Tilts are written in degrees: three roundings.
    CHECK(calibration->distortion_coefficients[i] == doctest::Approx(lens.lens.coefficients[i]).epsilon(4 * 0x1p-53));
  }
  CHECK(calibration->pinhole == lens.lens.pinhole);
}

TEST_CASE("rays through any point of a pixel project back by the formula of the lens") {
  for (const FormulaLens& lens : all_lenses()) {
    CAPTURE(lens.attributes());
    if (lens.is_straight) continue;
    const std::vector<Command> commands = parse_commands(
        R"(<sensor type="tof_camera" name="S" insert_at="ROOT" )" + lens.attributes() + "/>", "test", ".");
    const std::vector<AttributeSpec> table = all_attributes(*find_sensor_type("tof_camera"));
    const AttributeValues values(commands[0], table, kSensorCommonAttributes);
    const std::vector<ChosenCameraEffect> effects =
        camera_effects(kHasLens, {values, 0, "S", shown_outputs(false, true)});
    REQUIRE(effects.size() == 1);
    const PixelOptics optics("S",
                             camera_layout({.width_px = kLensWidth_px,
                                            .height_px = kLensHeight_px,
                                            .fx_px = lens.lens.pinhole.fx_px,
                                            .fy_px = lens.lens.pinhole.fy_px,
                                            .column_px = lens.lens.pinhole.cx_px - 0.5,
                                            .row_px = lens.lens.pinhole.cy_px - 0.5},
                                           effects),
                             0.05);
    std::size_t checked = 0;
    std::vector<std::uint32_t> pixels;
    for (std::uint32_t pixel = 0; pixel < optics.pixels(); pixel += 7) pixels.push_back(pixel);
    const auto centre_of = [](std::uint32_t pixel) {
      return glm::dvec2(pixel % kLensWidth_px + 0.5, pixel / kLensWidth_px + 0.5);
    };
    const std::vector<PixelFan> fans = optics.footprint(16, pixels);
    REQUIRE(fans.size() == 16);
    for (std::size_t i = 0; i < fans.size(); ++i) {
      const glm::dvec2 offset_px((i % 4 + 0.5) / 4 - 0.5, (i / 4 + 0.5) / 4 - 0.5);
      for (std::size_t k = 0; k < fans[i].pixels.size(); ++k) {
        const glm::dvec3& ray = fans[i].directions[k];
        // Newton's method ends at rounding: pixels are below 100, rays have unit length.
        REQUIRE(glm::distance(lens.pixel(ray), centre_of(fans[i].pixels[k]) + offset_px) < 1e-10);
        REQUIRE(glm::length(ray) == doctest::Approx(1).epsilon(1e-14));
        ++checked;
      }
    }
    for (const std::uint32_t pixel : pixels) {
      const glm::dvec2 centre = centre_of(pixel);
      const PixelSquare square = optics.square(pixel);
      if (square.focal_px == 0) continue;
      // A small way in the square is as long in the image, to first order: lenses bend by at most 1 / focal_px.
      const glm::dvec2 way_px(0.01, -0.02);
      const glm::dvec3 there = glm::inverse(square.square_from_view) * glm::dvec3(way_px / square.focal_px, 1);
      REQUIRE(glm::distance(lens.pixel(there), centre + way_px) < 0.0005 / lens.lens.pinhole.fx_px * 10);
    }
    CHECK(checked > 4000);
  }
}

TEST_CASE("a stereo camera sees through its lens, and disparity is that of the rectified pair") {
  for (const FormulaLens& lens : all_lenses()) {
    CAPTURE(lens.attributes());
    Simulation simulation = lens_scene(
        "stereo_camera", lens.attributes() + std::string(R"( baseline="0.1" outputs="color depth disparity")"));
    simulation.step();
    const Measurement measurement = simulation.measurement("S");
    const double infinity = std::numeric_limits<double>::infinity();
    check_plate(lens, numbers_of(measurement, "left_depth"), infinity, 0, [](const glm::dvec3&) { return kPlate_m; });
    check_plate(lens, numbers_of(measurement, "right_depth"), infinity, kBaseline_m,
                [](const glm::dvec3&) { return kPlate_m; });
    check_plate(lens, numbers_of(measurement, "disparity"), 0, 0,
                [&](const glm::dvec3&) { return lens.lens.pinhole.fx_px * kBaseline_m / kPlate_m; });
    check_calibration(lens, measurement, "left");
    check_calibration(lens, measurement, "right");
    CHECK(measurement.calibration("right")->baseline_m == kBaseline_m);
  }
}

TEST_CASE("cast outputs of a stereo camera with a lens agree with its drawn ones") {
  Simulation simulation =
      lens_scene("stereo_camera",
                 all_lenses()[1].attributes() + std::string(R"( baseline="0.1" outputs="depth disparity range")"));
  simulation.step();
  const Measurement measurement = simulation.measurement("S");
  check_plate(all_lenses()[1], numbers_of(measurement, "left_range"), std::numeric_limits<double>::infinity(), 0,
              [](const glm::dvec3& ray) { return kPlate_m / ray.z; });
  check_plate(all_lenses()[1], numbers_of(measurement, "disparity"), 0, 0,
              [&](const glm::dvec3&) { return all_lenses()[1].lens.pinhole.fx_px * kBaseline_m / kPlate_m; });
}

TEST_CASE("an RGB-D camera measures through its lens what the second viewpoint sees through an equal one") {
  for (const FormulaLens& lens : all_lenses()) {
    CAPTURE(lens.attributes());
    Simulation simulation = lens_scene(
        "rgbd_camera", lens.attributes() + std::string(R"( baseline="0.1" outputs="color depth depth_state")"));
    simulation.step();
    const Measurement measurement = simulation.measurement("S");
    check_plate(lens, numbers_of(measurement, "depth"), std::numeric_limits<double>::infinity(), 0,
                [](const glm::dvec3&) { return kPlate_m; });
    check_calibration(lens, measurement, "");
  }
  // The plate shifted to the left border: the second viewpoint sees it farther left, in part beyond its image.
  const FormulaLens& lens = all_lenses()[0];
  Simulation simulation =
      lens_scene("rgbd_camera", lens.attributes() + std::string(R"( baseline="0.1" outputs="depth depth_state")"));
  simulation.set("MOVE", "y", 1.5);
  simulation.step();
  const std::vector<double> states = numbers_of(simulation.measurement("S"), "depth_state");
  std::size_t outside = 0;
  for (std::uint32_t pixel = 0; pixel < states.size(); ++pixel) {
    const glm::dvec3 ray = *lens.ray(pixel);
    if (hits_plate(ray, 1.5) != PlateHit::yes) continue;
    const double column_px = lens.pixel(kPlate_m / ray.z * ray - glm::dvec3(kBaseline_m, 0, 0)).x;
    if (std::abs(column_px) < 1e-6) continue;
    REQUIRE(states[pixel] == (column_px < 0 ? 3 : 0));
    outside += column_px < 0;
  }
  CHECK(outside > 0);
}

TEST_CASE("a time-of-flight camera measures ranges along the rays of its lens") {
  for (const FormulaLens& lens : all_lenses()) {
    CAPTURE(lens.attributes());
    for (const char* const footprint : {"1", "4"}) {
      Simulation simulation = lens_scene("tof_camera", lens.attributes() + std::string(R"( outputs="depth range" )") +
                                                           "frequency='1e7' footprint_rays='" + footprint + "'");
      simulation.step();
      const Measurement measurement = simulation.measurement("S");
      const double infinity = std::numeric_limits<double>::infinity();
      if (*footprint == '1') {
        check_plate(lens, numbers_of(measurement, "range"), infinity, 0,
                    [](const glm::dvec3& ray) { return kPlate_m / ray.z; });
        check_plate(lens, numbers_of(measurement, "depth"), infinity, 0, [](const glm::dvec3&) { return kPlate_m; });
      } else {
        // The mean over a square of at most 1/20 rad leaves the range at its centre by less than a hundredth.
        const std::vector<double> ranges = numbers_of(measurement, "range");
        for (std::uint32_t pixel = 0; pixel < ranges.size(); ++pixel) {
          const std::optional<glm::dvec3> ray = lens.ray(pixel);
          const PlateHit hit = hits_plate(ray);
          if (hit == PlateHit::yes) REQUIRE(ranges[pixel] == doctest::Approx(kPlate_m / ray->z).epsilon(0.01));
          if (hit == PlateHit::no) REQUIRE(std::isinf(ranges[pixel]));
        }
      }
      check_calibration(lens, measurement, "");
    }
  }
}

TEST_CASE("a thermal camera sees warm surfaces through its lens") {
  for (const FormulaLens& lens : all_lenses()) {
    CAPTURE(lens.attributes());
    Simulation simulation =
        lens_scene("thermal_camera", lens.attributes() + std::string(R"( footprint_rays="4" outputs="temperature")"));
    simulation.step();
    const Measurement measurement = simulation.measurement("S");
    const std::vector<double> temperatures_k = numbers_of(measurement, "temperature");
    std::size_t warm = 0;
    for (std::uint32_t pixel = 0; pixel < temperatures_k.size(); ++pixel) {
      const std::optional<glm::dvec3> ray = lens.ray(pixel);
      const PlateHit hit = hits_plate(ray);
      CAPTURE(pixel);
      if (hit == PlateHit::yes) REQUIRE(temperatures_k[pixel] == doctest::Approx(400).epsilon(1e-5));
      if (hit == PlateHit::no) REQUIRE(temperatures_k[pixel] < 350);
      warm += hit == PlateHit::yes;
    }
    CHECK(warm > 40);
    check_calibration(lens, measurement, "");
  }
}

TEST_CASE("an event camera sees through its lens what comes, and what goes again") {
  for (const FormulaLens& lens : all_lenses()) {
    CAPTURE(lens.attributes());
    Simulation simulation = lens_scene("event_camera", lens.attributes());
    simulation.set("MOVE", "y", 3);  // to the left of where it will be
    simulation.step();
    simulation.set("MOVE", "y", 0);
    simulation.step();
    const Measurement measurement = simulation.measurement("S");
    const MeasuredArray *const x = measurement.find("x"), *const y = measurement.find("y"),
                               *const polarity = measurement.find("polarity");
    REQUIRE(x != nullptr);
    REQUIRE(x->count() > 1000);
    std::vector<int> balance(kLensWidth_px * kLensHeight_px), events(balance.size());
    for (std::size_t i = 0; i < x->count(); ++i) {
      const auto pixel =
          static_cast<std::size_t>(y->number(i)) * kLensWidth_px + static_cast<std::size_t>(x->number(i));
      balance[pixel] += polarity->number(i) > 0 ? 1 : -1;
      ++events[pixel];
    }
    std::size_t seen = 0, passed = 0, never = 0;
    for (std::uint32_t pixel = 0; pixel < balance.size(); ++pixel) {
      const std::optional<glm::dvec3> ray = lens.ray(pixel);
      CAPTURE(pixel);
      const PlateHit hit = hits_plate(ray);
      if (hits_plate(ray, 3) != PlateHit::no) continue;  // it may have been there
      // What has passed leaves the light as it was, to the one event by which a reference may differ.
      if (hit == PlateHit::yes) REQUIRE(std::abs(balance[pixel]) >= 2);
      if (hit == PlateHit::no) REQUIRE(std::abs(balance[pixel]) <= 1);
      seen += hit == PlateHit::yes;
      const double row_m = ray && ray->z > 0 ? kPlate_m * ray->y / ray->z : 99;
      const bool beside = !ray || ray->z <= 0 || row_m < kTop_m - 0.2 || row_m > kBottom_m + 0.2 ||
                          kPlate_m * ray->x / ray->z > kRight_m + 0.2;
      if (beside) REQUIRE(events[pixel] == 0);
      never += beside;
      passed += hit == PlateHit::no && events[pixel] > 0;
    }
    CHECK(seen > 40);
    CHECK(never > 400);
    CHECK(passed > 40);
    check_calibration(lens, measurement, "");
  }
}

// The plate's front in the frame of the plate, and a class, so that there are boxes.
const char* const kCorners =
    R"(<part name="CORNER_1" insert_at="PLATE" pose_offset="-0.05 0.9 0.75 0 0 0"/>
    <part name="CORNER_2" insert_at="PLATE" pose_offset="-0.05 -0.9 -0.75 0 0 0"/>
    <element type="label" name="CLASS" insert_at="ROOT" part="PLATE" class="plate" class_id="3"/>)";

void check_flow(const FormulaLens& lens, const Measurement& measurement) {
  // The plate has moved by 0.1 m along +y, which is -x of the view. Flow is a float of up to some tens of pixels.
  constexpr double kFlowRounding_px = 1e-4;
  const MeasuredArray& flow = *measurement.find("flow_backward");
  std::size_t seen = 0;
  for (std::uint32_t pixel = 0; pixel < kLensWidth_px * kLensHeight_px; ++pixel) {
    const std::optional<glm::dvec3> ray = lens.ray(pixel);
    if (hits_plate(ray) != PlateHit::yes) continue;
    const glm::dvec2 before = lens.pixel(kPlate_m / ray->z * *ray + glm::dvec3(0.1, 0, 0));
    const glm::dvec2 centre(pixel % kLensWidth_px + 0.5, pixel / kLensWidth_px + 0.5);
    REQUIRE(glm::distance(glm::dvec2(flow.number(2 * pixel), flow.number(2 * pixel + 1)), before - centre) <
            kFlowRounding_px);
    ++seen;
  }
  CHECK(seen > 40);
}

// Pixels of the plate and their box are those whose rays hit it; no ray passes its edge within rounding.
void check_boxes(const FormulaLens& lens, const Measurement& measurement) {
  double count = 0, left = kLensWidth_px, right = 0, top = kLensHeight_px, bottom = 0;
  for (std::uint32_t pixel = 0; pixel < kLensWidth_px * kLensHeight_px; ++pixel) {
    const std::optional<glm::dvec3> ray = lens.ray(pixel);
    if (!ray || ray->z <= 0) continue;
    const double x = kPlate_m * ray->x / ray->z, y = kPlate_m * ray->y / ray->z;
    if (!(x > kLeft_m && x < kRight_m && y > kTop_m && y < kBottom_m)) continue;
    const double column = pixel % kLensWidth_px, row = pixel / kLensWidth_px;
    ++count;
    left = std::min(left, column), right = std::max(right, column + 1);
    top = std::min(top, row), bottom = std::max(bottom, row + 1);
  }
  const auto cell = [&](const char* name) { return measurement.find(name)->number(0); };
  CHECK(cell("visible_pixels") == count);
  CHECK(cell("visible_x_min") == left);
  CHECK(cell("visible_x_max") == right);
  CHECK(cell("visible_y_min") == top);
  CHECK(cell("visible_y_max") == bottom);
}

TEST_CASE("every output of a camera is that of the formula of its lens") {
  for (const FormulaLens& lens : all_lenses()) {
    CAPTURE(lens.attributes());
    Simulation simulation =
        lens_scene("camera", lens.attributes() + R"(outputs="color depth range normal instance flow_backward boxes")",
                   R"(<sensor type="keypoints" name="K" insert_at="ROOT" width="64" height="48" points="CORNER_?" )" +
                       lens.attributes() + "/>" + kCorners);
    simulation.set("MOVE", "y", -0.1);
    simulation.step();
    simulation.set("MOVE", "y", 0);
    simulation.step();
    const Measurement measurement = simulation.measurement("S");
    const double infinity = std::numeric_limits<double>::infinity();
    check_calibration(lens, measurement, "");
    check_plate(lens, numbers_of(measurement, "depth"), infinity, 0, [](const glm::dvec3&) { return kPlate_m; });
    check_plate(lens, numbers_of(measurement, "range"), infinity, 0,
                [](const glm::dvec3& ray) { return kPlate_m / ray.z; });
    std::vector<double> seen = numbers_of(measurement, "instance");
    for (double& each : seen) each = each != 0;
    check_plate(lens, seen, 0, 0, [](const glm::dvec3&) { return 1; });
    std::uint32_t clear = 0;
    while (!lens.ray(clear) || hits_plate(lens.ray(clear)) != PlateHit::no) ++clear;
    const double sky = measurement.find("color")->number(4 * clear);
    std::vector<double> bright, towards;
    for (std::uint32_t pixel = 0; pixel < kLensWidth_px * kLensHeight_px; ++pixel) {
      const double red = measurement.find("color")->number(4 * pixel);
      bright.push_back(red != sky && red != 0);  // black beyond the lens
      const double z = measurement.find("normal")->number(3 * pixel + 2);
      towards.push_back(std::isnan(z) ? 0 : z);
    }
    check_plate(lens, bright, 0, 0, [](const glm::dvec3&) { return 1; });
    check_plate(lens, towards, 0, 0, [](const glm::dvec3&) { return -1; });
    check_flow(lens, measurement);
    check_boxes(lens, measurement);
    const std::optional<std::vector<glm::dvec3>> points = depth_points(measurement);
    REQUIRE(points);
    std::vector<double> along;
    for (const glm::dvec3& each : *points) along.push_back(std::isnan(each.x) ? 0 : each.x);
    check_plate(lens, along, 0, 0, [](const glm::dvec3&) { return kPlate_m; });
    const Measurement keys = simulation.measurement("K");
    const glm::dvec3 corners[] = {{kLeft_m, kTop_m, kPlate_m}, {kRight_m, kBottom_m, kPlate_m}};
    for (std::size_t i = 0; i < 2; ++i) {
      // Poses of parts are rounded to double, in metres; a pixel is at most 1/18 of a radian wide.
      constexpr double kPose_px = 1e-9;
      const glm::dvec2 place(keys.find("x_px")->number(i), keys.find("y_px")->number(i));
      CHECK(glm::distance(place, lens.pixel(corners[i])) < kPose_px);
    }
  }
}

TEST_CASE("a focal length, or a lens that has one, replaces the field of view of a preset") {
  const auto focal_px = [](const std::string& attributes) {
    Simulation simulation = lens_scene("rgbd_camera", "preset='zed_2i' " + attributes);
    simulation.step();
    return simulation.measurement("S").calibration("")->pinhole.fx_px;
  };
  CHECK(focal_px("fx='40'") == 40);
  CHECK(focal_px("distortion='ftheta' polynomial='0 30 -1'") == 30);
  CHECK(contains(error_of([] { lens_scene("rgbd_camera", "preset='zed_2i' fx='40' hfov='60'"); }),
                 "\"hfov\" is allowed only without fx"));
}

TEST_CASE("sensors without a lens or a shutter refuse the attributes of one") {
  const auto error = [](const std::string& type, const std::string& attributes) {
    return error_of([&] { lens_scene(type, attributes); });
  };
  for (const char* const type : {"rgbd_camera", "tof_camera", "thermal_camera", "event_camera"}) {
    CHECK(contains(error(type, R"(row_time="1e-5")"), "unknown attribute \"row_time\""));
    CHECK(contains(error(type, R"(fx="100" hfov="60")"), "\"hfov\" is allowed only without fx"));
    CHECK(contains(error(type, R"(distortion="brown_conrady" k1="-2")"), "the lens shows nothing at column"));
  }
  CHECK(contains(error("stereo_camera", R"(distortion="kannala_brandt" fx="20" aperture="0.01" outputs="color")"),
                 "this lens is so wide that it takes several views"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
