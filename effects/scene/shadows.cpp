#include "effects/scene/shadows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include <simvis/effect.h>
#include <simvis/error.h>
#include "effects/scene/shadow_atlas.h"
#include "engine/geometry/view_projection.h"

namespace simvis {
namespace {

const EffectRegistration kShadowsRegistration({
    .name = "shadows",
    .summary = "Objects cast shadows in the light of lights with shadows=\"yes\".",
    .notes = "An edge of a shadow is off by at most half a texel of the shadow map along each axis. Edges are not "
             "smoothed, and surfaces do not shade themselves. A point light has a cube of maps, a spot light one map "
             "(or a cube for cones beyond 60 degrees to a side), and a directional light one map for each view, whose "
             "texels stand still in the world. Surfaces that a laser hits cast shadows. A view takes at most 64 lights "
             "with shadows. There are no cascades.",
    .source = "a light element with shadows=\"yes\"",
    .outputs = kShownInColor,
    .knob = "shadow_resolution",
    .reference = "projective geometry; Williams, Casting Curved Shadows on Curved Surfaces (1978)",
    .plan_frame = plan_shadows,
});

// The widest half angle of a spot light's cone for one pinhole view. Beyond it the sides of a cube have finer texels.
constexpr double kWidestCone_rad = 60 * 3.14159265358979323846 / 180;
// Margin of the depth range of a directional light's map in front of and behind its content, as a share of the distance
// of the content. It is larger than the rounding of vertices.
constexpr double kDepthMargin = 1e-5;

// The properties of an item that matter for shadows.
struct Body {
  WorldBox box;
  bool lit = false, casts = false;
};

std::vector<Body> bodies_of(const DrawList& list) {
  std::vector<Body> bodies;
  for (const DrawItem& item : list.items) {
    const Mesh& mesh = *list.meshes[item.mesh];
    const Material& material = *list.materials[item.material];
    const glm::dvec3 low(mesh.bounds_min), high(mesh.bounds_max);
    const float cover = material.opacity * (material.alpha_mode == AlphaMode::blend ? material.base_color.a : 1);
    bodies.push_back({.box = make_box(list.world_from_node[item.transform], (low + high) * 0.5, (high - low) * 0.5),
                      .lit = item.visible && !material.unlit && cover > 0,
                      .casts = item.visible && mesh.topology == Topology::triangles && cover >= kMinDepthVisibleAlpha});
  }
  return bodies;
}

// The items in a colour view that lights can shine on.
struct Seen {
  std::vector<const Body*> lit{};
  double farthest_m = 0;  // along the optical axis
};

Seen seen_by(const View& view, const std::vector<Body>& bodies) {
  const ViewProjection projection = make_projection(view);
  Seen seen;
  for (const Body& body : bodies) {
    if (!body.lit || outside(projection, body.box)) continue;
    seen.lit.push_back(&body);
    seen.farthest_m = std::max(seen.farthest_m, farthest_depth(projection, body.box));
  }
  return seen;
}

// The rows are right, down and forward of a view along `forward`, in world coordinates.
glm::dmat3 rows_along(const glm::dvec3& forward) {
  const glm::dvec3 beside = std::abs(forward.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 right = glm::normalize(glm::cross(beside, forward));
  return glm::transpose(glm::dmat3(right, glm::cross(forward, right), forward));
}

View map_view(std::uint32_t px, const glm::dmat3& map_from_world, const glm::dvec3& place) {
  View view;
  view.near_m = kLampRadius_m;
  view.view_from_world = glm::dmat4(map_from_world);
  view.view_from_world[3] = glm::dvec4(-(map_from_world * place), 1);
  view.width_px = view.height_px = px;
  view.sees_back_faces = true;
  view.sees_lines_and_points = false;
  return view;
}

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;

  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool empty() const { return low > high; }
};

// A box along the light's axes, relative to the eye of the lit view.
struct LightBox {
  Range range[3];

  bool empty() const { return range[0].empty() || range[1].empty() || range[2].empty(); }
};

LightBox around(const WorldBox& box, const glm::dmat3& map_from_world, const glm::dvec3& eye) {
  const glm::dvec3 center = map_from_world * (box.center - eye);
  glm::dvec3 half(0);
  for (const glm::dvec3& axis : box.axis) half += glm::abs(map_from_world * axis);
  LightBox around;
  for (int i = 0; i < 3; ++i) around.range[i] = {center[i] - half[i], center[i] + half[i]};
  return around;
}

LightBox around_view(const View& view, double farthest_m, const glm::dmat3& map_from_world) {
  const glm::dmat3 map_from_view = map_from_world * glm::transpose(glm::dmat3(view.view_from_world));
  const Pinhole& k = view.pinhole;
  LightBox box;
  for (const double z : {view.near_m, farthest_m}) {
    for (const double u : {0u, view.width_px}) {
      for (const double v : {0u, view.height_px}) {
        const glm::dvec3 corner =
            map_from_view * glm::dvec3((u - k.cx_px) / k.fx_px * z, (v - k.cy_px) / k.fy_px * z, z);
        for (int i = 0; i < 3; ++i) box.range[i].add(corner[i]);
      }
    }
  }
  return box;
}

// The part of the visible items that lies within the view.
LightBox receivers(const View& view, const Seen& seen, const glm::dmat3& map_from_world, const glm::dvec3& eye) {
  const LightBox whole = around_view(view, seen.farthest_m, map_from_world);
  LightBox all;
  for (const Body* body : seen.lit) {
    LightBox part = around(body->box, map_from_world, eye);
    for (int i = 0; i < 3; ++i) {
      part.range[i] = {std::max(part.range[i].low, whole.range[i].low),
                       std::min(part.range[i].high, whole.range[i].high)};
    }
    if (part.empty()) continue;
    for (int i = 0; i < 3; ++i) {
      all.range[i].add(part.range[i].low);
      all.range[i].add(part.range[i].high);
    }
  }
  return all;
}

// Empty if nothing casts a shadow on visible items.
std::optional<View> directional_view(const Light& light, const glm::dvec3& forward, const View& lit, const Seen& seen,
                                     const std::vector<Body>& bodies) {
  const glm::dmat3 map_from_world = rows_along(forward);
  const glm::dvec3 eye = -(glm::transpose(glm::dmat3(lit.view_from_world)) * glm::dvec3(lit.view_from_world[3]));
  const LightBox shown = receivers(lit, seen, map_from_world, eye);
  if (shown.empty()) return {};
  Range depth{std::numeric_limits<double>::infinity(), shown.range[2].high};
  double reach = 0;
  for (const Body& body : bodies) {
    if (!body.casts) continue;
    const LightBox caster = around(body.box, map_from_world, eye);
    const bool before = caster.range[0].low <= shown.range[0].high && caster.range[0].high >= shown.range[0].low &&
                        caster.range[1].low <= shown.range[1].high && caster.range[1].high >= shown.range[1].low &&
                        caster.range[2].low <= shown.range[2].high;
    if (!before) continue;
    depth.low = std::min(depth.low, caster.range[2].low);
    reach = std::max(reach, glm::length(body.box.center - eye) + body.box.radius);
  }
  if (depth.empty()) return {};

  View view = map_view(light.shadow_px, map_from_world, {});
  view.orthographic = true;
  view.near_m = depth.low - kDepthMargin * reach;
  view.far_m = depth.high + kDepthMargin * reach;
  // One texel is reserved for the growth by snapping to the lattice.
  const double extent = std::max(shown.range[0].high - shown.range[0].low, shown.range[1].high - shown.range[1].low);
  const double px = light.shadow_px, least = std::max(extent, std::numeric_limits<double>::min()) * px / (px - 1);
  const double texel_m = std::exp2(std::ceil(std::log2(least))) / px;
  const glm::dvec3 eye_map = map_from_world * eye;
  const auto snap = [&](int axis, double& center_px, double& origin, std::uint32_t& size_px) {
    const double first = std::floor((eye_map[axis] + shown.range[axis].low) / texel_m);
    const double end = std::ceil((eye_map[axis] + shown.range[axis].high) / texel_m);
    const double middle = std::round(eye_map[axis] / texel_m);
    center_px = middle - first;
    origin = middle * texel_m;
    size_px = static_cast<std::uint32_t>(std::clamp(end - first, 1.0, px));
  };
  glm::dvec3 origin = eye_map;
  view.pinhole.fx_px = view.pinhole.fy_px = 1 / texel_m;
  snap(0, view.pinhole.cx_px, origin.x, view.width_px);
  snap(1, view.pinhole.cy_px, origin.y, view.height_px);
  view.view_from_world[3] = glm::dvec4(-origin, 1);
  return view;
}

std::vector<View> lamp_views(const Light& light, const glm::dvec3& forward, const glm::dvec3& place) {
  const double half = light.shadow_px / 2.0;
  if (light.kind == LightKind::spot && light.outer_cone_rad <= kWidestCone_rad) {
    View view = map_view(light.shadow_px, rows_along(forward), place);
    view.pinhole = {half / std::tan(light.outer_cone_rad), half / std::tan(light.outer_cone_rad), half, half};
    return {view};
  }
  std::vector<View> sides;
  for (int axis = 0; axis < 3; ++axis) {  // see ShadowUse
    for (const double sign : {1.0, -1.0}) {
      glm::dmat3 world_from_side(0);
      world_from_side[0][axis] = 1;
      world_from_side[1][(axis + 1) % 3] = world_from_side[2][(axis + 2) % 3] = sign;
      sides.push_back(map_view(light.shadow_px, glm::transpose(world_from_side), place));
      sides.back().pinhole = {half, half, half, half};
      sides.back().x_px = light.shadow_px * static_cast<std::uint32_t>(axis);
      sides.back().y_px = sign < 0 ? light.shadow_px : 0;
    }
  }
  return sides;
}

bool shines(const Light& light) {
  const bool bright = light.intensity > 0 && light.color != glm::vec3(0);
  return bright && (light.kind != LightKind::spot || light.outer_cone_rad > 0);
}

bool reaches(const Light& light, const glm::dvec3& place, const Seen& seen) {
  if (light.kind == LightKind::directional || light.range_m <= 0) return true;
  return std::ranges::any_of(seen.lit, [&](const Body* body) {
    return glm::length(body->box.center - place) <= light.range_m + body->box.radius;
  });
}

class Planner {
 public:
  Planner(const DrawList& list) : list_(list), bodies_(bodies_of(list)) {}

  void add(const Pass& pass, View& view) {
    const Seen seen = seen_by(view, bodies_);
    if (seen.lit.empty()) return;
    for (std::uint32_t i = 0; i < list_.lights.size(); ++i) {
      const Light& light = list_.lights[i].light;
      if (light.shadow_px == 0 || !shines(light)) continue;
      const glm::dmat4& world_from_light = list_.world_from_node[list_.lights[i].transform];
      const glm::dvec3 place(world_from_light[3]), along = glm::dmat3(world_from_light) * light.direction;
      const double length = glm::length(along);
      if ((length == 0 && light.kind != LightKind::point) || !reaches(light, place, seen)) continue;
      const std::string name = "light " + std::to_string(i);
      if (light.kind == LightKind::directional) {
        if (const auto map = directional_view(light, along / length, view, seen, bodies_)) {
          use(view, i, atlas_.add({*map}, light.shadow_px, name, "what it casts in " + view.name + " of " + pass.name));
        }
        continue;
      }
      const auto [known, added] = lamps_.try_emplace(i);
      if (added)
        known->second =
            atlas_.add(lamp_views(light, along / length, place), light.shadow_px, name, "shadows of what it shines on");
      use(view, i, known->second);
    }
    if (view.shadows.size() > SIMVIS_MAX_SHADOWS) {
      throw InputError("view \"" + view.name + "\" shows shadows of " + std::to_string(view.shadows.size()) +
                       " lights, expected at most " + std::to_string(SIMVIS_MAX_SHADOWS));
    }
  }

  ShadowAtlas& atlas() { return atlas_; }

 private:
  static void use(View& view, std::uint32_t light, ShadowAtlas::Map map) {
    view.shadows.push_back({light, map.first_view, map.views});
  }

  const DrawList& list_;
  std::vector<Body> bodies_;
  ShadowAtlas atlas_;
  std::map<std::uint32_t, ShadowAtlas::Map> lamps_;  // by light; all views share them
};

}  // namespace

void plan_shadows(const DrawList& list, const TargetLimits& limits, FramePlan& plan) {
  const bool color = std::ranges::any_of(plan.passes, &Pass::color);
  const auto casts = [](const LightItem& item) { return item.light.shadow_px > 0; };
  if (!color || std::ranges::none_of(list.lights, casts)) return;
  Planner planner(list);
  for (Pass& pass : plan.passes) {
    if (!pass.color) continue;
    std::size_t most = 0;
    for (View& view : pass.views) {
      planner.add(pass, view);
      most = std::max(most, view.shadows.size());
    }
    if (most > 0) plan.effects.push_back({pass.name, "shadows", "lights with shadows: " + std::to_string(most)});
  }
  if (!planner.atlas().empty()) plan.passes.push_back(planner.atlas().pass(limits));
}

}  // namespace simvis
