// A floor with blocks on it that cast shadows, seen from above, with shadow maps and without.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "effects/scene/shadows.h"
#include "scenegraph/primitive_meshes.h"
#include "tests/support/reference_directions.h"
#include "tests/support/renderer_scene.h"

namespace simvis::test {

inline constexpr double kAmbient = 0.25;
inline constexpr std::uint32_t kFloorSide_px = 128;
inline constexpr double kHeight_m = 6;

struct Block {
  glm::dvec3 low, high;
};

// The floor z = 0 with blocks on or above it, lit by one light and seen from straight above, at `origin` of the world.
struct Floor {
  std::vector<Block> blocks{};
  Light light{};
  glm::dvec3 place{0};   // of the light
  glm::dvec3 origin{0};  // the rest is relative to it
  std::uint32_t supersampling = 1, msaa = 1;

  RendererScene scene() const {
    RendererScene made = scene_with_ambient(kAmbient);
    glm::dmat4 upwards(1);
    upwards[1][1] = upwards[2][2] = -1;
    upwards[3] = glm::dvec4(origin, 1);
    made.add(rectangle(-6, -6, 6, 6), colored({1, 1, 1, 1}), upwards);
    for (const Block& block : blocks) {
      const glm::dvec3 middle = origin + (block.low + block.high) * 0.5;
      made.add(box_mesh(block.high - block.low), colored({1, 1, 1, 1}), at(middle.x, middle.y, middle.z));
    }
    made.add_light(light, at(origin.x + place.x, origin.y + place.y, origin.z + place.z));
    return made;
  }
  FramePlan plan() const {
    FramePlan made = plan_of(kFloorSide_px, kFloorSide_px, kFloorSide_px / 2.0, true, false);
    made.passes[0].supersampling = supersampling;
    made.passes[0].msaa = msaa;
    glm::dmat4 down(1);
    down[1][1] = down[2][2] = -1;
    view_of(made).view_from_world = down * at(-origin.x, -origin.y, -origin.z - kHeight_m);
    return made;
  }
};

inline FramePlan with_shadows(const RendererScene& scene, FramePlan plan) {
  plan_shadows(scene.list, device().target_limits(), plan);
  return plan;
}

inline std::vector<glm::vec4> picture(const RendererScene& scene, const FramePlan& plan) {
  static Renderer renderer(device());
  return copy(renderer.render(scene.list, plan)[0].color);
}

inline std::vector<glm::vec4> picture_without(RendererScene scene, const FramePlan& plan) {
  for (LightItem& item : scene.list.lights) item.light.shadow_px = 0;
  return picture(scene, plan);
}

inline glm::dvec2 in_map(const Floor& floor, const View& map, const glm::dvec3& point) {
  const glm::dvec3 p(map.view_from_world * glm::dvec4(point + floor.origin, 1));
  const double w = map.orthographic ? 1 : p.z;
  return {map.pinhole.cx_px + map.pinhole.fx_px * p.x / w, map.pinhole.cy_px + map.pinhole.fy_px * p.y / w};
}

inline Light sun(double azimuth_deg, double elevation_deg, std::uint32_t px = 256) {
  const double a = azimuth_deg * kPi / 180, e = elevation_deg * kPi / 180;
  return {.kind = LightKind::directional,
          .intensity = 3,
          .direction = {-std::cos(e) * std::cos(a), -std::cos(e) * std::sin(a), -std::sin(e)},
          .shadow_px = px};
}

inline const Block kLifted{{-1, -0.7, 0.5}, {0.6, 0.9, 1.3}}, kStanding{{-1, -0.7, 0}, {0.6, 0.9, 1.1}};

}  // namespace simvis::test
