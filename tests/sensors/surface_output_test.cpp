// An output of cameras that only this program has: one registration brings it
// everywhere.
#include "sensors/surface_output.h"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis::test {
namespace {

// Twice the range, and the height of the point below the optical axis.
const SurfaceOutputRegistration kMadeUpOutput({.name = "made_up",
                                               .value_type = ValueType::f64,
                                               .channels = 2,
                                               .unit = "m",
                                               .meaning = "an output of a test",
                                               .nothing = -1,
                                               .fill = [](const PixelSurface& surface, std::span<double> numbers) {
                                                 numbers[0] = 2 * surface.range_m;
                                                 numbers[1] = surface.point_m.y;
                                               }});

// Whether the normal of the triangle is known, which takes a ray.
const SurfaceOutputRegistration kMadeUpCastOutput({.name = "made_up_cast",
                                                   .value_type = ValueType::u8,
                                                   .meaning = "an output of a test",
                                                   .nothing = 7,
                                                   .needs = kSurfaceCast,
                                                   .fill = [](const PixelSurface& surface, std::span<double> numbers) {
                                                     numbers[0] = surface.normal.z < 0 ? 1 : 0;
                                                   }});

constexpr double kMadeUpWall_m = 3, kMadeUpFocal_px = 16;  // hfov 90 degrees

// A wall in the right half of the image.
Simulation made_up_scene(const std::string& type, const std::string& attributes) {
  return Simulation::from_string(
      R"(<simvis><part shape="box" size="0.2 40 80" name="WALL" insert_at="ROOT" pose_offset="3.1 -20 0 0 0 0"/>)"
      "<sensor name='S' insert_at='ROOT' type='" +
      type + "' width='32' height='20' hfov='90' " + attributes + "/></simvis>");
}

void check_made_up(const Measurement& measurement, const std::string& prefix, double shift_px) {
  const MeasuredArray* const array = measurement.find(prefix + "made_up");
  REQUIRE(array != nullptr);
  CHECK(array->unit == "m");
  REQUIRE(array->shape == OutputShape{20, 32, 2});
  for (std::uint32_t pixel = 0; pixel < 640; ++pixel) {
    const double right = (pixel % 32 + 0.5 - 16) / kMadeUpFocal_px, down = (pixel / 32 + 0.5 - 10) / kMadeUpFocal_px;
    const bool seen = pixel % 32 + 0.5 - 16 > -shift_px;
    const double range_m = kMadeUpWall_m * std::sqrt(1 + right * right + down * down);
    CAPTURE(pixel);
    // Drawn depth is a float.
    REQUIRE(array->number(2 * pixel) == doctest::Approx(seen ? 2 * range_m : -1).epsilon(1e-5));
    REQUIRE(array->number(2 * pixel + 1) == doctest::Approx(seen ? kMadeUpWall_m * down : -1).epsilon(1e-5));
  }
}

TEST_CASE(
    "an output that is registered is described, promised and measured, "
    "drawn and cast") {
  for (const std::string outputs : {"color made_up", "made_up normal"}) {
    CAPTURE(outputs);
    Simulation simulation = made_up_scene("camera", "outputs='" + outputs + "'");
    simulation.step();
    check_made_up(simulation.measurement("S"), "", 0);
  }
  // 0.1875 m are one pixel at 3 m.
  Simulation simulation = made_up_scene("stereo_camera", "baseline='0.1875' outputs='disparity made_up made_up_cast'");
  simulation.step();
  const Measurement measurement = simulation.measurement("S");
  check_made_up(measurement, "left_", 0);
  check_made_up(measurement, "right_", 1);
  const MeasuredArray* const cast = measurement.find("right_made_up_cast");
  REQUIRE(cast != nullptr);
  CHECK(cast->number(0) == 7);
  CHECK(cast->number(31) == 1);
}

TEST_CASE("what lists the outputs of cameras has one that is registered") {
  for (const auto& [type, name] : {std::pair("camera", "made_up"), {"stereo_camera", "left_made_up"}}) {
    CAPTURE(type);
    const SensorType& camera = *find_sensor_type(type);
    const OutputSpec* const spec = find_output(all_outputs(camera), name);
    CHECK(find_output(all_outputs(camera), name) != nullptr);
    CHECK(spec != nullptr);
    const std::string text = describe(camera.name, camera.summary, all_attributes(camera), {});
    CHECK(contains(text, "made_up_cast"));
    CHECK(contains(error_of([&] { made_up_scene(type, "outputs='nonsense'"); }), "made_up"));
  }
  const std::vector<Command> commands =
      parse_commands("<sensor type='camera' name='S' insert_at='ROOT' outputs='made_up'/>", "test", ".");
  const std::vector<OutputSpec> outputs = outputs_of(*find_sensor_type("camera"), commands[0]);
  const OutputSpec* const promised = find_output(outputs, "made_up");
  REQUIRE(promised != nullptr);
  CHECK(promised->given);
  CHECK(promised->meaning == "an output of a test");
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
