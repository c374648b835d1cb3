// A picture that is drawn with culling and without.
#pragma once

#include <doctest/doctest.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "engine/render/renderer.h"

namespace simvis::test {

struct DrawnTriangles {
  std::uint64_t culled = 0, whole = 0;  ///< with culling, and without
};

/// Draws the first view of the first pass both ways, and checks that the pictures are the same bytes.
inline DrawnTriangles draw_both_ways(Renderer& renderer, const DrawList& list, FramePlan plan) {
  const auto draw = [&](bool culled) {
    plan.passes[0].views[0].culled = culled;
    const PassResult result = renderer.render(list, plan)[0];
    return std::pair(std::vector<float>(result.depth.begin(), result.depth.end()),
                     std::vector<glm::vec4>(result.color.begin(), result.color.end()));
  };
  DrawnTriangles drawn;
  const auto seen = draw(true);
  drawn.culled = renderer.counters().triangles;
  CHECK(seen == draw(false));
  drawn.whole = renderer.counters().triangles;
  CHECK(drawn.culled <= drawn.whole);
  return drawn;
}

}  // namespace simvis::test
