// Depths at the outlines of round shapes, of shapes narrower than a pixel, and flow on them: every finite bound holds,
// whatever else is measured.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <simvis/device.h>
#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "tests/support/exact_shapes.h"
#include "tests/support/infinity.h"
#include "tests/support/long_count.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

constexpr std::uint32_t kWide_px = 64, kHigh_px = 48;

std::string camera(const std::string& outputs, double hfov_deg) {
  return "<sensor type='camera' name='CAM' insert_at='ROOT' width='64' height='48' near='0.01' hfov='" +
         std::to_string(hfov_deg) + "' outputs='" + outputs + "'/>";
}

// A shape whose radius is a share of a pixel up to many pixels, in front of nothing or of a wall.
std::string random_shape(std::mt19937& random, double hfov_deg) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const double focal_px = kWide_px / 2.0 / std::tan(glm::radians(hfov_deg / 2));
  const double away_m = std::pow(10, 1 + unit(random)), radius_m = away_m / focal_px * std::pow(10, 0.3 + unit(random)),
               length_m = radius_m * std::pow(10, 0.5 + unit(random));
  const auto number = [](double value) { return std::to_string(value); };
  const std::string sizes = " radius='" + number(radius_m) + "'",
                    with_length = sizes + " length='" + number(length_m) + "'";
  const std::string shapes[] = {"'sphere'" + sizes, "'cylinder'" + with_length, "'cone'" + with_length,
                                "'capsule'" + with_length};
  const double reach = std::tan(glm::radians(hfov_deg / 2));
  return "<part name='S' insert_at='ROOT' shape=" + shapes[random() % 4] + " pose_offset='" + number(away_m) + " " +
         number(away_m * reach * 0.8 * unit(random)) + " " + number(away_m * reach * 0.5 * unit(random)) + " " +
         number(180 * unit(random)) + " " + number(90 * unit(random)) + " " + number(180 * unit(random)) + "'/>" +
         (random() % 2 == 0
              ? ""
              : "<part name='WALL' insert_at='ROOT' shape='box' size='1 99 99' pose_offset='150 0 0 0 0 0'/>");
}

double range_of(const DrawList& list, const glm::dvec3& ray_in_view) {
  double nearest_m = kInfinity;
  for (const DrawItem& item : list.items) {
    const Mesh& mesh = *list.meshes[item.mesh];
    if (!mesh.surface) continue;
    nearest_m = std::min(nearest_m,
                         static_cast<double>(reference::nearest_hit(*mesh.surface, list.world_from_node[item.transform],
                                                                    sensor_from_view(), ray_in_view)
                                                 .range_m));
  }
  // The wall's front is at x = 149.5.
  if (list.items.size() > 1) nearest_m = std::min(nearest_m, 149.5 / ray_in_view.z);
  return nearest_m;
}

Image image_of(const Simulation& simulation, const std::string& name) {
  return to_image(*simulation.measurement("CAM").find(name)).value();
}

TEST_CASE("the depth of each pixel of a round shape and around it lies within its bound, with all outputs alike") {
  const Device shared;  // all simulations use it, which is not opened again for each
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::size_t on_shape = 0, beyond = 0, unbounded = 0;
  const int scenes = count_of("SIMVIS_TEST_ROUND_OUTLINES", 60);
  for (int scene = 0; scene < scenes; ++scene) {
    const double hfov_deg = std::round(40 + 30 * unit(random));  // as it is written
    const std::string shape = random_shape(random, hfov_deg);
    std::vector<float> first, first_bounds;
    const std::vector<std::string> all_outputs = {"depth depth_error_bound", "depth depth_error_bound instance",
                                                  "color depth depth_error_bound boxes", "depth", "color depth"};
    for (const std::string& outputs : all_outputs) {
      CAPTURE(shape);
      CAPTURE(outputs);
      const bool boxes = outputs.ends_with("boxes");
      Simulation simulation = Simulation::from_string(
          shape + camera(outputs, hfov_deg) +
          (boxes ? "<element type='label' name='L' insert_at='ROOT' part='S' class='s' class_id='1'/>" : ""));
      simulation.step();
      const Image depth = image_of(simulation, "depth");
      if (first.empty()) first.assign(depth.pixels.begin(), depth.pixels.end());
      CHECK(std::ranges::equal(depth.pixels, first));
      if (outputs.find("depth_error_bound") == outputs.npos) continue;
      const Image bound = image_of(simulation, "depth_error_bound");
      if (first_bounds.empty()) first_bounds.assign(bound.pixels.begin(), bound.pixels.end());
      CHECK(std::ranges::equal(bound.pixels, first_bounds));
      if (outputs != "depth depth_error_bound") continue;
      double largest_m = 0;
      for (std::uint32_t y = 0; y < kHigh_px; ++y) {
        for (std::uint32_t x = 0; x < kWide_px; ++x) {
          const double focal_px = kWide_px / 2.0 / std::tan(glm::radians(hfov_deg / 2));
          const glm::dvec3 ray = glm::normalize(
              glm::dvec3((x + 0.5 - kWide_px / 2.0) / focal_px, (y + 0.5 - kHigh_px / 2.0) / focal_px, 1));
          const double expected_m = range_of(simulation.diagnostics().draw_list(), ray) * ray.z;
          const std::size_t at = std::size_t{y} * kWide_px + x;
          const double z = depth.pixels[at], allowed_m = bound.pixels[at];
          on_shape += expected_m < 149;
          unbounded += std::isfinite(z) && !std::isfinite(allowed_m);
          if (z == expected_m) continue;
          const double error_m = std::abs(z - expected_m);
          CHECK_MESSAGE(error_m <= allowed_m, "pixel ", x, " ", y, " has ", z, ", not ", expected_m);
          beyond += !(error_m <= allowed_m);
          if (std::isfinite(error_m)) largest_m = std::max(largest_m, error_m);
        }
      }
      const std::optional<double> whole = simulation.measurement("CAM").value("depth_error_bound_m");
      REQUIRE(whole.has_value());
      CHECK(largest_m <= *whole);
    }
  }
  MESSAGE(on_shape << " pixels on round shapes, " << unbounded << " without a bound");
  CHECK(beyond == 0);
  CHECK(unbounded == 0);
  CHECK(on_shape > 100 * static_cast<std::size_t>(scenes));
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
