// Cameras of MJCF models: the intrinsics of MuJoCo, and where each pixel looks.
#include <doctest/doctest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "tests/support/error_of.h"
#include "tests/support/mjcf_scene.h"

TEST_SUITE_BEGIN("import");

namespace simvis::test {
namespace {

struct MjcfCamera {
  explicit MjcfCamera(const std::string& camera, const std::string& around = "") {
    write_text(folder / "m.xml", "<mujoco><worldbody>" + around + "<body name='b' pos='0 0 1'><camera name='eye' " +
                                     camera + "/></body></worldbody></mujoco>");
    write_text(folder / "s.xml", "<simvis><part file='m.xml' name='M' insert_at='ROOT'/></simvis>");
    simulation.emplace(Simulation::load(folder / "s.xml"));
    simulation->step();
  }
  Pinhole pinhole() const { return simulation->measurement("eye").calibration("")->pinhole; }
  TemporaryFolder folder;
  std::optional<Simulation> simulation;
};

constexpr double kRounding_px = 1e-9;

TEST_CASE("fovy is the vertical field of view, of 640 x 480 pixels unless the file has a resolution") {
  // f = height / 2 / tan(fovy / 2)
  const Pinhole plain = MjcfCamera("").pinhole();
  CHECK(std::abs(plain.fy_px - 240 / std::tan(glm::radians(22.5))) <= kRounding_px);
  CHECK(plain.cx_px == 320);
  CHECK(plain.cy_px == 240);
  const Pinhole small = MjcfCamera("fovy='90' resolution='64 32'").pinhole();
  CHECK(std::abs(small.fx_px - 16) <= kRounding_px);
  CHECK(std::abs(small.fy_px - 16) <= kRounding_px);
  CHECK(small.cx_px == 32);
}

TEST_CASE("focal lengths and a principal point in metres or pixels, as MuJoCo's frustum has them") {
  // 64 x 32 pixels on 0.008 x 0.004 m: 8000 pixels for a metre.
  const std::string sensor = "resolution='64 32' sensorsize='0.008 0.004' ";
  for (const char* const own :
       {"focal='0.005 0.004' principal='0.0005 0.00025'", "focalpixel='40 32' principalpixel='4 2'"}) {
    CAPTURE(own);
    const Pinhole pinhole = MjcfCamera(sensor + own).pinhole();
    CHECK(std::abs(pinhole.fx_px - 40) <= kRounding_px);
    CHECK(std::abs(pinhole.fy_px - 32) <= kRounding_px);
    // engine_vis_visualize.c, getFrustum(): left = (32 - 4) / 40 of the near distance, top = (16 + 2) / 32 of it.
    CHECK(std::abs(pinhole.cx_px - (32 - 4)) <= kRounding_px);
    CHECK(std::abs(pinhole.cy_px - (16 + 2)) <= kRounding_px);
  }
}

TEST_CASE("a camera looks along -z of its frame, with y upwards") {
  // A red plate in front of the upper half, 2 m below the body in z: the camera looks down, and y is up in its picture.
  const MjcfCamera down("fovy='90' resolution='8 8' output='rgb depth'",
                        "<geom type='box' size='4 2 0.1' pos='0 2.001 -1.1' rgba='1 0 0 1'/>");
  const Image depth = down.simulation->depth("eye");
  REQUIRE(depth.width == 8);
  for (std::uint32_t y = 0; y < 8; ++y) {
    CAPTURE(y);
    const float seen = depth.pixels[y * 8 + 4];
    if (y < 4) CHECK(seen == doctest::Approx(2).epsilon(1e-6));
    if (y >= 4) CHECK(std::isinf(seen));
  }
}

TEST_CASE("each camera is a sensor, whatever characters its name has") {
  MjcfScene scene(
      "<worldbody><camera name='a.b'/><camera name='a_b'/><camera name='/eye'/><camera name='c//d'/>"
      "<camera name='arm/'/><camera name='/'/></worldbody>");
  std::vector<std::string> names;
  for (const BuiltSensor& each : scene.built().sensors) names.push_back(each.name);
  CHECK(names == std::vector<std::string>{"a_b", "a_b_2", "eye", "c/d", "arm", "sensor"});
}

TEST_CASE("a value that the sensor does not take leaves out its camera alone") {
  MjcfScene scene(
      "<worldbody><camera name='wide' sensorsize='1 1' resolution='8 8' focalpixel='1e-20 1e-20'/>"
      "<camera name='other'/></worldbody>");
  REQUIRE(scene.built().sensors.size() == 1);
  CHECK(scene.built().sensors[0].name == "other");
  REQUIRE(scene.warnings().size() == 1);
  CHECK(contains(scene.warnings()[0], "the sensor \"wide\" is left out"));
}

TEST_CASE("cameras that no pinhole shows are left out with a warning, and modes are reported") {
  MjcfScene parallel("<worldbody><camera name='c' orthographic='true'/></worldbody>");
  REQUIRE(parallel.warnings().size() == 1);
  CHECK(contains(parallel.warnings()[0], "has parallel rays"));
  CHECK(contains(parallel.warnings()[0], "the camera is left out"));
  MjcfScene focal("<worldbody><camera name='c' sensorsize='1 1'/></worldbody>");
  CHECK(contains(focal.warnings().at(0), "expected focal or focalpixel"));
  MjcfScene tracks("<worldbody><camera name='c' mode='track'/></worldbody>");
  CHECK(contains(tracks.warnings().at(0), "mode \"track\" of a camera is not taken over"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
