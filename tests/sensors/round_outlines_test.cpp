// Flow and object coordinates of round shapes, and a bound in a narrow view. tests/combinations has depths at outlines.
#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

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
