#include "elements/lamp.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <simvis/node.h>
#include "engine/base/even_points.h"
#include "scenegraph/clone_graph.h"
#include "shaders/interop.h"

namespace simvis {

glm::dvec3 place_of_point(const Lamp& lamp, std::uint32_t i) {
  return lamp.points == 1 ? glm::dvec3(0) : lamp.radius * even_point_of_ball(i, lamp.points);
}

glm::dvec3 direction_of_point(const Lamp& lamp, const glm::dvec3& direction, std::uint32_t i) {
  if (lamp.points == 1) return direction;
  const glm::dvec3 other = std::abs(direction.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 right = glm::normalize(glm::cross(other, direction)), up = glm::cross(direction, right);
  const glm::dvec2 at = std::tan(lamp.radius) * even_point_of_disc(i, lamp.points);
  return glm::normalize(direction + at.x * right + at.y * up);
}

void check_shadow_count(const ElementContext& context, std::uint32_t more) {
  const auto others = std::ranges::count_if(nodes_of(context.scene.root()), [](const NodePtr& node) {
    return node->kind() == NodeKind::light && static_cast<const LightNode&>(*node).light().shadow_px > 0;
  });
  if (others + more <= SIMVIS_MAX_SHADOWS) return;
  const CommandAttribute* const written = context.command.find("shadows");
  fail_at((written != nullptr ? *written : context.command.require("name")).where,
          "attribute \"shadows\": too many lights have shadows, expected at most " +
              std::to_string(SIMVIS_MAX_SHADOWS) + ", where each of a lamp's points counts");
}

}  // namespace simvis
