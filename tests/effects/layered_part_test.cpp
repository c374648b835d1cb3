// Transparent layers are composited only where a transparent surface may be seen: the picture is that of a view in
// which they are composited everywhere.
#include <doctest/doctest.h>

#include "tests/support/renderer_scene.h"

TEST_SUITE_BEGIN("effects");

namespace simvis::test {
namespace {

Material pane(glm::vec4 color) {
  Material material = colored(color);
  material.alpha_mode = AlphaMode::blend;
  material.double_sided = true;
  return material;
}

// A pane at a place in front of a wall. `everywhere`: with another one that fills the view and whose vertices have an
// alpha of 0, so that it changes nothing but where layers are looked for.
RendererScene scene_with_pane(const glm::dmat4& place, bool everywhere) {
  RendererScene scene = scene_with_ambient(1);
  scene.add(rectangle(-20, -20, 20, 20), colored({0.5f, 0.5f, 0.5f, 1}), at(0, 0, 9));
  scene.add(rectangle(-0.5, -0.5, 0.5, 0.5), pane({1, 0, 0, 0.5f}), place);
  if (!everywhere) return scene;
  Mesh clear = rectangle(-20, -20, 20, 20);
  clear.attributes.resize(clear.positions.size());
  for (VertexAttributes& attributes : clear.attributes) attributes.color = glm::vec4(1, 1, 1, 0);
  scene.add(clear, pane({1, 1, 1, 1}), at(0, 0, 8));
  return scene;
}

std::vector<glm::vec4> picture(const glm::dmat4& place, bool everywhere, std::uint32_t supersampling) {
  static Renderer renderer(device());
  FramePlan plan = plan_of(48, 32, 16, true, false);
  plan.passes[0].supersampling = supersampling;
  return copy(renderer.render(scene_with_pane(place, everywhere).list, plan)[0].color);
}

TEST_CASE("layers are composited wherever a pane is, within the view, at its edges and across the eye") {
  glm::dmat4 along(0);  // through the eye, along the optical axis
  along[0] = {0, 0, 8, 0};
  along[1] = {0, 1, 0, 0};
  along[2] = {1, 0, 0, 0};
  along[3] = {0.1, 0, 0, 1};
  const std::vector<glm::vec4> nothing = picture(at(0, 0, -5), false, 1);
  for (const glm::dmat4& place :
       {at(0, 0, 2), at(0.3, -0.7, 1.1), at(-6, 0, 4), at(2.9, 1.9, 2), at(0, 4.2, 4), at(0, 0, 0.2), along}) {
    CAPTURE(place[3].x);
    CAPTURE(place[3].z);
    CHECK(picture(place, false, 1) != nothing);
    for (const std::uint32_t supersampling : {1u, 2u}) {
      CHECK(picture(place, false, supersampling) == picture(place, true, supersampling));
    }
  }
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
