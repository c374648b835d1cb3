// SDF: heightmaps, polylines, joints that follow others, lenses and noise of cameras.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "tests/support/error_of.h"
#include "tests/support/sdf_scene.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

constexpr double kHalfTurn_deg = 180 / std::numbers::pi;

// Greys 0 51 102 / 153 204 204 as PNG, without compression.
std::string png_of_3_by_2() {
  const unsigned char bytes[] = {
      0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00, 0x00,
      0x03, 0x00, 0x00, 0x00, 0x02, 0x08, 0x00, 0x00, 0x00, 0x00, 0xb8, 0x1f, 0x39, 0xc6, 0x00, 0x00, 0x00, 0x13, 0x49,
      0x44, 0x41, 0x54, 0x78, 0x01, 0x01, 0x08, 0x00, 0xf7, 0xff, 0x00, 0x00, 0x33, 0x66, 0x00, 0x99, 0xcc, 0xcc, 0x07,
      0x67, 0x02, 0xcb, 0xa3, 0xfd, 0x9b, 0x92, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
  return {reinterpret_cast<const char*>(bytes), sizeof bytes};
}

std::string camera_with(const std::string& content, const std::string& type = "camera") {
  return sdf_model("<model name='m'><link name='l'>" + sdf_box("1 1 1") + "<sensor name='s' type='" + type +
                   "'><camera><horizontal_fov>1.5707963267948966</horizontal_fov><image><width>200</width><height>100"
                   "</height></image>" +
                   content + "</camera></sensor></link></model>");
}

double attribute_of(SdfScene& scene, const std::string& name) {
  const std::string text = scene.sensor("l/s", name);
  REQUIRE_FALSE(text.empty());
  return std::stod(text);
}

std::string joints_with(const std::string& axis_of_second, const std::string& type = "prismatic") {
  return sdf_model("<model name='m'><link name='a'>" + sdf_box("1 1 1") + "</link><link name='b'/><link name='c'/>" +
                   "<joint name='j' type='revolute'><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz><limit>"
                   "<lower>-1</lower><upper>1</upper></limit></axis></joint><joint name='k' type='" +
                   type + "'><parent>a</parent><child>c</child><axis><xyz>1 0 0</xyz>" + axis_of_second +
                   "</axis></joint></model>");
}

}  // namespace

TEST_CASE("the highest pixel of an SDF heightmap has the height of its size") {
  SdfScene scene(sdf_world("<model name='m'><link name='l'>" +
                           sdf_visual("<heightmap><uri>h.png</uri><size>4 2 8</size><pos>1 2 3</pos></heightmap>") +
                           "</link></model>"),
                 {{"h.png", png_of_3_by_2()}});
  CHECK(scene.warnings().empty());
  REQUIRE(scene.list().items.size() == 1);
  const std::vector<glm::vec3>& points = scene.mesh(0).positions;
  REQUIRE(points.size() == 6);
  const double kHeight_m = 1e-6;  // float32 below 8 m
  const double expected[] = {0, 2, 4, 6, 8, 8};
  const auto at = [&](std::size_t i) { return glm::dvec3(scene.place(0) * glm::dvec4(points[i], 1)); };
  for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(at(i).z - (3 + expected[i])) < kHeight_m);
  CHECK(glm::dvec2(at(0)) == glm::dvec2(-1, 3));
  CHECK(glm::dvec2(at(5)) == glm::dvec2(3, 1));
}

TEST_CASE("a polyline is a solid from the ground to its height, also where it is not convex") {
  // An L of five unit squares, clockwise.
  SdfScene scene(sdf_world("<model name='m'><link name='l'>" +
                           sdf_visual("<polyline><point>0 0</point><point>0 3</point><point>1 3</point><point>1 1"
                                      "</point><point>3 1</point><point>3 0</point><height>2</height></polyline>") +
                           "</link></model>"));
  CHECK(scene.warnings().empty());
  REQUIRE(scene.list().items.size() == 1);
  const Mesh& mesh = scene.mesh(0);
  double volume = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const auto at = [&](std::size_t k) { return glm::dvec3(mesh.positions[mesh.indices[i + k]]); };
    volume += glm::dot(at(0), glm::cross(at(1), at(2))) / 6;
  }
  CHECK(volume == doctest::Approx(10));
  CHECK(mesh.bounds_min == glm::vec3(0, 0, 0));
  CHECK(mesh.bounds_max == glm::vec3(3, 3, 2));
}

TEST_CASE("polylines that are no polygon are left out with a warning") {
  for (const auto& [points, why] : {std::pair("<point>0 0</point><point>1 0</point>", "has 2 points"),
                                    {"<point>0 0</point><point>1 1</point><point>1 0</point><point>0 1</point>"
                                     "<point>-1 0.5</point><point>0.5 0.6</point>",
                                     "has sides that cross each other"}}) {
    const std::string reason = why;
    CAPTURE(reason);
    SdfScene scene(sdf_world("<model name='m'><link name='l'>" + sdf_box("1 1 1") +
                             sdf_visual("<polyline>" + std::string(points) + "<height>1</height></polyline>") +
                             "</link></model>"));
    REQUIRE(scene.warnings().size() == 1);
    CHECK(contains(scene.warnings()[0], why));
    CHECK(scene.list().items.size() == 1);
  }
}

TEST_CASE("an SDF joint follows another as its <mimic> says") {
  SdfScene scene(joints_with(
      "<mimic joint='j'><multiplier>0.5</multiplier><offset>0.1</offset><reference>0.2</reference></mimic>"));
  CHECK(scene.warnings().empty());
  scene.set("j", 0.4 * kHalfTurn_deg);
  // 0.5 (0.4 - 0.2) + 0.1, in metres.
  CHECK(scene.point("c")[3].x == doctest::Approx(0.2));
  SdfScene turns(joints_with("<mimic joint='j'><multiplier>-2</multiplier></mimic>", "revolute"));
  turns.set("j", 10);
  CHECK(std::atan2(turns.point("c")[1].z, turns.point("c")[1].y) * kHalfTurn_deg == doctest::Approx(-20));
}

TEST_CASE("a <mimic> that cannot be followed is ignored with a warning") {
  for (const auto& [mimic, why] :
       {std::pair("<mimic joint='x'/>", "mimics joint \"x\", which is not there; it moves by itself"),
        {"<mimic joint='k'/>", "mimics itself in a circle"}}) {
    const std::string reason = why;
    CAPTURE(reason);
    SdfScene scene(joints_with(mimic));
    REQUIRE(scene.warnings().size() == 1);
    CHECK(contains(scene.warnings()[0], why));
    scene.set("k", 0.25);
    CHECK(scene.point("c")[3].x == doctest::Approx(0.25));
  }
}

TEST_CASE("intrinsics of an SDF camera count from the corner of the picture") {
  SdfScene scene(camera_with("<lens><intrinsics><fx>150</fx><fy>140</fy><cx>90</cx><cy>60</cy></intrinsics></lens>"));
  CHECK(scene.warnings().empty());
  CHECK(attribute_of(scene, "fx") == 150);
  CHECK(attribute_of(scene, "fy") == 140);
  CHECK(attribute_of(scene, "cx") == 89.5);
  CHECK(attribute_of(scene, "cy") == 59.5);
  CHECK(scene.sensor("l/s", "hfov").empty());
  CHECK(scene.sensor("l/s", "distortion").empty());
}

TEST_CASE("wide-angle cameras have the projection of their lens") {
  const auto lens = [](const std::string& type) {
    return camera_with("<lens><type>" + type + "</type></lens>", "wideanglecamera");
  };
  const double quarter = std::numbers::pi / 4;  // half of the field of view
  struct Projection {
    const char *type, *distortion, *alpha;
    double radius;
  };
  for (const Projection& each : {Projection{"equidistant", "kannala_brandt", "", quarter},
                                 {"stereographic", "double_sphere", "0.5", 2 * std::tan(quarter / 2)},
                                 {"equisolid_angle", "kannala_brandt", "", 2 * std::sin(quarter / 2)},
                                 {"orthographic", "double_sphere", "1", std::sin(quarter)}}) {
    CAPTURE(each.type);
    SdfScene scene(lens(each.type));
    CHECK(scene.warnings().empty());
    CHECK(scene.sensor("l/s", "distortion") == each.distortion);
    CHECK(scene.sensor("l/s", "alpha") == each.alpha);
    CHECK(scene.sensor("l/s", "hfov").empty());
    // The next term of the series of `equisolid_angle` is below 3e-6 at 45 degrees.
    CHECK(attribute_of(scene, "fx") == doctest::Approx(100 / each.radius).epsilon(3e-6));
  }
  SdfScene pinhole(lens("gnomonical"));
  CHECK(pinhole.sensor("l/s", "distortion").empty());
  SdfScene custom(lens("custom"));
  REQUIRE(custom.warnings().size() == 1);
  CHECK(contains(custom.warnings()[0], "lens of type \"custom\" is not taken over"));
}

TEST_CASE("Gaussian noise of pictures becomes read noise") {
  SdfScene scene(camera_with("<noise><type>gaussian</type><mean>0</mean><stddev>0.02</stddev></noise>"));
  CHECK(scene.warnings().empty());
  CHECK(attribute_of(scene, "read_noise_e") / attribute_of(scene, "full_well_e") == doctest::Approx(0.02));
}

TEST_CASE("Gazebo's colours are those of its own list") {
  for (const auto& [name, color] : {std::pair("SkyBlue", glm::vec3(0, 0, 1)), {"Gray", glm::vec3(0.4479884f)}}) {
    SdfScene scene(sdf_world(
        "<model name='m'><link name='l'>" +
        sdf_box("1 1 1", "<material><script><name>Gazebo/" + std::string(name) + "</name></script></material>") +
        "</link></model>"));
    CHECK(scene.warnings().empty());
    CHECK(glm::length(glm::vec3(scene.material(0).base_color) - color) < 1e-6f);
  }
}
