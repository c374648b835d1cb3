// Items that a view leaves out: it draws what it would draw of a list in which they are not visible.
#include <doctest/doctest.h>

#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include <simvis/pose.h>
#include "tests/support/random_room.h"
#include "tests/support/renderer_scene.h"

TEST_SUITE_BEGIN("engine");

namespace simvis::test {
namespace {

struct DrawnRoom {
  std::vector<float> depth;
  std::vector<std::uint32_t> items;
  std::vector<glm::vec4> color;
  bool operator==(const DrawnRoom&) const = default;
};

DrawnRoom draw(Renderer& renderer, const DrawList& list, FramePlan& depth, FramePlan& color) {
  DrawnRoom drawn;
  const PassResult& result = renderer.render(list, depth)[0];
  drawn.depth = copy(result.depth);
  drawn.items = copy(result.items);
  drawn.color = copy(renderer.render(list, color)[0].color);
  return drawn;
}

}  // namespace

TEST_CASE("a view draws nothing of the items that it ignores, and all else as before") {
  Renderer renderer(device());
  std::mt19937 random(5);
  std::size_t differ = 0, views = 0;
  for (int room = 0; room < 4; ++room) {
    const DrawList list = random_room(static_cast<std::uint32_t>(room), 30, 16);
    for (const bool culled : {true, false}) {
      for (const double max_error_px : {0.0, 2.0}) {
        auto ignored = std::make_shared<std::vector<std::uint32_t>>();
        DrawList seen = list;
        for (std::uint32_t i = 0; i < list.items.size(); ++i) {
          if (random() % 3 != 0) continue;
          ignored->push_back(i);
          seen.items[i].visible = false;
        }
        FramePlan depth = plan_of(160, 120, 90, false, true), color = plan_of(160, 120, 90, true, false);
        depth.passes[0].items = true;
        for (FramePlan* const plan : {&depth, &color}) {
          view_of(*plan).culled = culled;
          view_of(*plan).view_from_world = rigid_inverse(at(0, 0, 1.2) * random_turn(random));
        }
        view_of(color).max_error_px = max_error_px;
        const DrawnRoom whole = draw(renderer, list, depth, color);
        view_of(depth).ignored = view_of(color).ignored = ignored;
        const DrawnRoom drawn = draw(renderer, list, depth, color);
        view_of(depth).ignored = view_of(color).ignored = nullptr;
        CHECK(drawn == draw(renderer, seen, depth, color));
        differ += !(drawn == whole);
        ++views;
      }
    }
  }
  CHECK(views == 16);
  CHECK(differ > 12);
}

}  // namespace simvis::test

TEST_SUITE_END();
