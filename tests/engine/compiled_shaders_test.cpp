// The driver compiles no shader in the frames of a still scene. FrameCounters::pipelines_made cannot see that:
// lavapipe compiles shaders again behind a pipeline if a branch depends on uniforms alone.
#include <doctest/doctest.h>

#include <fstream>
#include <set>
#include <string>

#include "tests/support/renderer_scene.h"

TEST_SUITE_BEGIN("engine");

namespace simvis::test {
namespace {

// The executable mappings of the process without a file: where drivers for CPUs keep compiled shaders.
std::set<std::string> compiled_code() {
  std::set<std::string> mappings;
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    const std::size_t rights = line.find(' ') + 1;
    if (line.compare(rights + 2, 1, "x") == 0 && line.find('/') == std::string::npos) {
      mappings.insert(line.substr(0, rights));
    }
  }
  return mappings;
}

TEST_CASE("the frames of a still scene compile no shader") {
  RendererScene scene = scene_with_ambient(0.25);
  Material glossy = colored({1, 1, 1, 1});
  glossy.roughness = 0.5f;
  scene.add(rectangle(-2, -2, 2, 2), glossy, at(0, 0, 4));
  scene.add_light({.kind = LightKind::directional}, at(0, 0, 0));
  scene.add_light({.kind = LightKind::point, .range_m = 9}, at(1, 0, 0));
  scene.add_light({.kind = LightKind::spot}, at(-1, 0, 0));
  FramePlan plan = plan_of(64, 64, 32, true, true);
  FramePlan other = plan;
  view_of(other).view_from_world = at(0.5, 0, 0);
  Renderer renderer(device());
  for (int frame = 0; frame < 2; ++frame) {
    renderer.render(scene.list, plan);
    renderer.render(scene.list, other);
  }
  const std::set<std::string> before = compiled_code();
  for (int frame = 0; frame < 3; ++frame) {
    renderer.render(scene.list, plan);
    renderer.render(scene.list, other);
  }
  CHECK(compiled_code() == before);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
