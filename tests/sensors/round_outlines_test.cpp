// Round shapes at the borders of views, their flow and object coordinates, and a bound in a narrow view.
// tests/combinations has depths at outlines.
#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include <simvis/device.h>
#include <simvis/simulation.h>

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

std::string camera(const std::string& outputs, double hfov_deg) {
  return "<sensor type='camera' name='CAM' insert_at='ROOT' width='64' height='48' near='0.01' hfov='" +
         std::to_string(hfov_deg) + "' outputs='" + outputs + "'/>";
}

Image image_of(const Simulation& simulation, const std::string& name) {
  return to_image(*simulation.measurement("CAM").find(name)).value();
}

// Of camera() with this field of view.
constexpr double kHfov_deg = 60;
constexpr glm::dvec2 kCentre_px(32, 24);
const double kFocal_px = kCentre_px.x / std::tan(kHfov_deg / 2 * std::numbers::pi / 180);

// A sphere, in the optical frame.
constexpr double kRadius_m = 2, kDistance_m = 5;

// The centre of the sphere whose outline towards the axis ends so far from it.
glm::dvec3 sphere_at(const glm::dvec2& side, double outline_px) {
  const double angle = std::atan(outline_px / kFocal_px) + std::asin(kRadius_m / kDistance_m);
  const glm::dvec3 centre_m = kDistance_m * glm::dvec3(side * std::sin(angle), std::cos(angle));
  return glm::round(1e6 * centre_m) / 1e6;  // the digits that std::to_string() writes
}

// The depth of the sphere along the ray (tangents, 1); infinite: it is not hit.
double depth_of_sphere(const glm::dvec3& centre, const glm::dvec2& tangents) {
  const glm::dvec3 ray(tangents, 1);
  const double a = glm::dot(ray, ray), b = glm::dot(ray, centre);
  const double square = b * b - a * (glm::dot(centre, centre) - kRadius_m * kRadius_m);
  return square < 0 ? std::numeric_limits<double>::infinity() : (b - std::sqrt(square)) / a;
}

// How many depths of a sphere are wrong, in an image of camera().
std::size_t wrong_depths(const glm::dvec3& centre, double turn_deg, const std::string& attributes) {
  std::string pose;
  for (const double number : {centre.z, -centre.x, -centre.y, turn_deg, 2 * turn_deg, 3 * turn_deg}) {
    pose += std::to_string(number) + " ";
  }
  Simulation simulation =
      Simulation::from_string("<part name='S' insert_at='ROOT' shape='sphere' radius='" + std::to_string(kRadius_m) +
                              "' pose_offset='" + pose + "'/>" + camera("depth" + attributes, kHfov_deg));
  simulation.step();
  const Image depth = image_of(simulation, "depth");
  const double bound_m = *simulation.measurement("CAM").value("depth_error_bound_m");
  std::size_t hits = 0, wrong = 0;
  for (std::size_t i = 0; i < depth.pixels.size(); ++i) {
    const glm::dvec2 at_px(static_cast<double>(i % depth.width) + 0.5, static_cast<double>(i / depth.width) + 0.5);
    const double expected_m = depth_of_sphere(centre, (at_px - kCentre_px) / kFocal_px), got_m = depth.pixels[i];
    hits += std::isfinite(expected_m) ? 1 : 0;
    wrong += got_m == expected_m || std::abs(got_m - expected_m) <= bound_m ? 0 : 1;
  }
  CHECK(hits > 0);
  return wrong;
}

// The outline passes a line of pixel centres by less than the tenth of a pixel that the mesh may lie farther in. With a
// row time, each row or group of rows is a view of its own.
TEST_CASE("what a round shape shows in the border of a view alone is measured") {
  const Device shared;  // all simulations use it, which is not opened again for each
  for (const std::string rows : {"", "' row_time='1e-4' rows_per_pose='1", "' row_time='1e-4' rows_per_pose='8"}) {
    for (const glm::dvec2& side : {glm::dvec2(0, 1), glm::dvec2(0, -1), glm::dvec2(1, 0), glm::dvec2(-1, 0)}) {
      const double border_px = glm::dot(kCentre_px, glm::abs(side)) - 0.5;
      for (const double line_px : {border_px, 7.5, 8.5}) {
        for (const double beyond_px : {0.02, 0.05}) {
          for (const double turn_deg : {0.0, 3.0, 17.0, 41.0}) {
            CAPTURE(rows);
            CAPTURE(side.x);
            CAPTURE(side.y);
            CAPTURE(line_px);
            CAPTURE(beyond_px);
            CAPTURE(turn_deg);
            CHECK(wrong_depths(sphere_at(side, line_px - beyond_px), turn_deg, rows) == 0);
          }
        }
      }
    }
  }
}

// Drawn, and cast for the sake of normals.
TEST_CASE("flow and object coordinates of round shapes are those of the shape, drawn or cast") {
  for (const char* const shape : {"'sphere' radius='0.7'", "'cylinder' radius='0.5' length='1.5'",
                                  "'cone' radius='0.7' length='1.2'", "'capsule' radius='0.4' length='0.9'"}) {
    CAPTURE(shape);
    const auto images_with = [&](const std::string& more) {
      Simulation simulation = Simulation::from_string(
          "<part name='S' insert_at='ROOT' pose_offset='3 0.1 0.2 20 30 40' shape=" + std::string(shape) +
          "/><element type='pose' name='MOVE' insert_at='S'/>" +
          camera("flow_backward object_coordinates instance" + more, 60));
      simulation.step();
      simulation.set("MOVE", "roll", 12);
      simulation.set("MOVE", "y", 0.2);
      simulation.step();
      return std::pair(image_of(simulation, "flow_backward"), image_of(simulation, "object_coordinates"));
    };
    const auto [flow, places] = images_with("");
    const auto [cast_flow, cast_places] = images_with(" normal");
    constexpr double kFlow_px = 1e-4, kPlace_m = 1e-6;  // documented; float32 of a metre, several times
    std::size_t seen = 0;
    for (std::size_t i = 0; i < flow.pixels.size(); ++i) {
      if (!std::isfinite(cast_flow.pixels[i])) continue;
      CHECK(std::abs(static_cast<double>(flow.pixels[i]) - cast_flow.pixels[i]) <= kFlow_px);
      ++seen;
    }
    for (std::size_t i = 0; i < places.pixels.size(); ++i) {
      if (!std::isfinite(cast_places.pixels[i])) continue;
      CHECK(std::abs(static_cast<double>(places.pixels[i]) - cast_places.pixels[i]) <= kPlace_m);
    }
    CHECK(seen > 200);
  }
}

TEST_CASE("a plain wall has a finite bound in a narrow view") {
  Simulation simulation = Simulation::from_string(
      "<part name='WALL' insert_at='ROOT' shape='box' size='1 99 99' pose_offset='10.5 0 0 0 0 0'/>" +
      camera("depth depth_error_bound", 0.01));
  simulation.step();
  const Image depth = image_of(simulation, "depth"), bound = image_of(simulation, "depth_error_bound");
  constexpr double kFloat_m = 10 * 0x1p-24;  // half a unit in the last place of 10 m
  for (std::size_t i = 0; i < depth.pixels.size(); ++i) {
    CHECK(std::abs(static_cast<double>(depth.pixels[i]) - 10) <= bound.pixels[i]);
    CHECK(static_cast<double>(bound.pixels[i]) <= 4 * kFloat_m);
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
