// A scene without physics has none of it. The file comes first: what is loaded once stays.
#include <doctest/doctest.h>

#include <fstream>
#include <iterator>

#include "elements/dynamics/world/engine_module.h"
#include "tests/support/moving_scene.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

bool is_mapped(const std::string& library) {
  std::ifstream maps("/proc/self/maps");
  const std::string text{std::istreambuf_iterator<char>(maps), {}};
  return text.find(library) != std::string::npos;
}

TEST_CASE("a scene without physics loads no engine, and its elements do not move by themselves") {
  MovingScene scene(
      "<part name='A' insert_at='ROOT' shape='box' size='1 1 1'/>"
      "<element type='pose' name='P' insert_at='A'/>");
  scene.go_to(1);
  CHECK_FALSE(dynamics_engine_is_loaded());
  CHECK_FALSE(is_mapped("Bullet"));
  CHECK_FALSE(is_mapped("simvis-dynamics"));
  CHECK_FALSE(has_motion(*scene));
}

TEST_CASE("a scene with physics loads it") {
  MovingScene scene(kPhysics);
  CHECK(dynamics_engine_is_loaded());
  CHECK(is_mapped("libBulletDynamics-float64"));
  CHECK(has_motion(*scene));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
