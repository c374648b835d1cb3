// Lenses of all sensors with pixels: what each pixel sees is computed from the formulas of the lens models.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "sensors/camera/pinhole_view.h"
#include "sensors/camera/pixel_optics.h"
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis::test {
namespace {

constexpr std::uint32_t kLensWidth_px = 64, kLensHeight_px = 48;
constexpr double kPlate_m = 2, kBaseline_m = 0.1;
// The plate in the view frame at z = 2: x from -0.7 to 1.1 m, y from -0.9 to 0.6 m.
constexpr double kLeft_m = -0.7, kRight_m = 1.1, kTop_m = -0.9, kBottom_m = 0.6;

/// A lens by its formula: the distorted place of tangents or of an angle, in focal lengths.
struct FormulaLens {
  const char* attributes;
  const char* model;
  std::vector<double> coefficients;
  double focal_px;
  bool fisheye;

  glm::dvec2 place(const glm::dvec3& ray) const {
    if (fisheye) {
      const double across = std::hypot(ray.x, ray.y), theta = std::atan2(across, ray.z);
      const double d = theta * (1 + coefficients[0] * theta * theta);
      return across == 0 ? glm::dvec2(0) : d / across * glm::dvec2(ray);
    }
    const double x = ray.x / ray.z, y = ray.y / ray.z, r2 = x * x + y * y;
    const double s = 1 + coefficients[0] * r2, p1 = coefficients[2];
    return {x * s + 2 * p1 * x * y, y * s + p1 * (r2 + 2 * y * y)};
  }
  glm::dvec2 pixel(const glm::dvec3& ray) const {
    return focal_px * place(ray) + glm::dvec2(kLensWidth_px, kLensHeight_px) / 2.0;
  }
  /// The ray of a pixel; none beyond 110 degrees.
  std::optional<glm::dvec3> ray(std::uint32_t pixel) const {
    const glm::dvec2 target = (glm::dvec2(pixel % kLensWidth_px + 0.5, pixel / kLensWidth_px + 0.5) -
                               glm::dvec2(kLensWidth_px, kLensHeight_px) / 2.0) /
                              focal_px;
    if (!fisheye) {
      glm::dvec2 tangents = target;
      for (int i = 0; i < 200; ++i) tangents += target - place(glm::dvec3(tangents, 1));
      return glm::normalize(glm::dvec3(tangents, 1));
    }
    double low = 0, high = 3;
    for (int i = 0; i < 60; ++i) {
      const double theta = (low + high) / 2;
      (theta * (1 + coefficients[0] * theta * theta) < glm::length(target) ? low : high) = theta;
    }
    if (low > glm::radians(110.0)) return {};
    return glm::dvec3(target / glm::length(target) * std::sin(low), std::cos(low));
  }
};

const FormulaLens kFormulaLenses[] = {
    {R"(distortion="brown_conrady" fx="40" k1="-0.1" p1="0.01")", "plumb_bob", {-0.1, 0, 0.01, 0, 0}, 40, false},
    {R"(distortion="kannala_brandt" fx="20" k1="0.03")", "equidistant", {0.03, 0, 0, 0}, 20, true}};

enum class PlateHit : std::uint8_t { yes, no, near_its_edge };

/// Whether a ray from (offset_m, 0, 0) hits the plate.
PlateHit hits_plate(const std::optional<glm::dvec3>& ray, double offset_m = 0) {
  constexpr double kMargin_m = 0.2;  // 2 pixels at least: samples of cameras with views are interpolated
  if (!ray || ray->z <= 0) return PlateHit::no;
  const double x = kPlate_m * ray->x / ray->z + offset_m, y = kPlate_m * ray->y / ray->z;
  const double inside = std::min({x - kLeft_m, kRight_m - x, y - kTop_m, kBottom_m - y});
  return inside > kMargin_m ? PlateHit::yes : inside < -kMargin_m ? PlateHit::no : PlateHit::near_its_edge;
}

Simulation lens_scene(const std::string& type, const std::string& attributes) {
  // In the sensor frame the plate's front is at x = 2, y from -1.1 to 0.7, z from -0.6 to 0.9.
  return Simulation::from_string(
      R"(<simvis><part name="PLATE" shape="box" size="0.1 1.8 1.5" insert_at="ROOT" pose_offset="2.05 -0.2 0.15 0 0 0"/>
      <element type="light" name="SUN" insert_at="ROOT"/>
      <element type="pose" name="MOVE" insert_at="PLATE"/>
      <element type="temperature" name="HEAT" insert_at="ROOT" part="PLATE" temperature="400" emissivity="1"/>
      <sensor type=")" +
      type + R"(" name="S" insert_at="ROOT" width="64" height="48" )" + attributes + "/></simvis>");
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
  CHECK(calibration->distortion_model == lens.model);
  CHECK(calibration->distortion_coefficients == lens.coefficients);
  CHECK(calibration->pinhole.fx_px == lens.focal_px);
}

TEST_CASE("rays through any point of a pixel project back by the formula of the lens") {
  for (const FormulaLens& lens : kFormulaLenses) {
    CAPTURE(lens.model);
    const std::vector<Command> commands = parse_commands(
        std::string(R"(<sensor type="tof_camera" name="S" insert_at="ROOT" )") + lens.attributes + "/>", "test", ".");
    const std::vector<AttributeSpec> table = all_attributes(*find_sensor_type("tof_camera"));
    const AttributeValues values(commands[0], table, kSensorCommonAttributes);
    const std::vector<ChosenCameraEffect> effects =
        camera_effects(kHasLens, {values, 0, "S", shown_outputs(false, true)});
    REQUIRE(effects.size() == 1);
    const PixelOptics optics(
        "S", camera_layout({.width_px = kLensWidth_px, .height_px = kLensHeight_px, .hfov_rad = 1}, effects), 0.05);
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
      REQUIRE(glm::distance(lens.pixel(there), centre + way_px) < 0.0005 / lens.focal_px * 10);
    }
    CHECK(checked > 4000);
  }
}

TEST_CASE("a stereo camera sees through its lens, and disparity is that of the rectified pair") {
  for (const FormulaLens& lens : kFormulaLenses) {
    CAPTURE(lens.model);
    Simulation simulation = lens_scene(
        "stereo_camera", lens.attributes + std::string(R"( baseline="0.1" outputs="color depth disparity")"));
    simulation.step();
    const Measurement measurement = simulation.measurement("S");
    const double infinity = std::numeric_limits<double>::infinity();
    check_plate(lens, numbers_of(measurement, "left_depth"), infinity, 0, [](const glm::dvec3&) { return kPlate_m; });
    check_plate(lens, numbers_of(measurement, "right_depth"), infinity, kBaseline_m,
                [](const glm::dvec3&) { return kPlate_m; });
    check_plate(lens, numbers_of(measurement, "disparity"), 0, 0,
                [&](const glm::dvec3&) { return lens.focal_px * kBaseline_m / kPlate_m; });
    check_calibration(lens, measurement, "left");
    check_calibration(lens, measurement, "right");
    CHECK(measurement.calibration("right")->baseline_m == kBaseline_m);
  }
}

TEST_CASE("cast outputs of a stereo camera with a lens agree with its drawn ones") {
  Simulation simulation =
      lens_scene("stereo_camera",
                 kFormulaLenses[1].attributes + std::string(R"( baseline="0.1" outputs="depth disparity range")"));
  simulation.step();
  const Measurement measurement = simulation.measurement("S");
  check_plate(kFormulaLenses[1], numbers_of(measurement, "left_range"), std::numeric_limits<double>::infinity(), 0,
              [](const glm::dvec3& ray) { return kPlate_m / ray.z; });
  check_plate(kFormulaLenses[1], numbers_of(measurement, "disparity"), 0, 0,
              [&](const glm::dvec3&) { return kFormulaLenses[1].focal_px * kBaseline_m / kPlate_m; });
}

TEST_CASE("an RGB-D camera measures through its lens what the second viewpoint sees through an equal one") {
  for (const FormulaLens& lens : kFormulaLenses) {
    CAPTURE(lens.model);
    Simulation simulation = lens_scene(
        "rgbd_camera", lens.attributes + std::string(R"( baseline="0.1" outputs="color depth depth_state")"));
    simulation.step();
    const Measurement measurement = simulation.measurement("S");
    check_plate(lens, numbers_of(measurement, "depth"), std::numeric_limits<double>::infinity(), 0,
                [](const glm::dvec3&) { return kPlate_m; });
    check_calibration(lens, measurement, "");
  }
  // The plate shifted to the left border: the second viewpoint sees it farther left, in part beyond its image.
  const FormulaLens& lens = kFormulaLenses[0];
  Simulation simulation =
      lens_scene("rgbd_camera", lens.attributes + std::string(R"( baseline="0.1" outputs="depth depth_state")"));
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
  for (const FormulaLens& lens : kFormulaLenses) {
    CAPTURE(lens.model);
    for (const char* const footprint : {"1", "4"}) {
      Simulation simulation = lens_scene("tof_camera", lens.attributes + std::string(R"( outputs="depth range" )") +
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
  for (const FormulaLens& lens : kFormulaLenses) {
    CAPTURE(lens.model);
    Simulation simulation =
        lens_scene("thermal_camera", lens.attributes + std::string(R"( footprint_rays="4" outputs="temperature")"));
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
  for (const FormulaLens& lens : kFormulaLenses) {
    CAPTURE(lens.model);
    Simulation simulation = lens_scene("event_camera", lens.attributes);
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

TEST_CASE("sensors without a lens or a shutter refuse the attributes of one") {
  const auto error = [](const std::string& type, const std::string& attributes) {
    return error_of([&] { lens_scene(type, attributes); });
  };
  for (const char* const type : {"rgbd_camera", "tof_camera", "thermal_camera", "event_camera"}) {
    CHECK(contains(error(type, R"(row_time="1e-5")"), "unknown attribute \"row_time\""));
    CHECK(contains(error(type, R"(fx="100")"), "\"fx\" is not allowed with distortion=\"none\""));
    CHECK(contains(error(type, R"(distortion="brown_conrady" k1="-2")"), "the lens shows nothing at column"));
  }
  CHECK(contains(error("stereo_camera", R"(distortion="kannala_brandt" fx="20" aperture="0.01" outputs="color")"),
                 "this lens is so wide that it takes several views"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
