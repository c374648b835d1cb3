#include "engine/render/view_draw_list.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/draw/light_block.h"

namespace simvis {
namespace {

// Rasterisation moves what is drawn by less than this, and samples lie within their pixel.
constexpr double kMargin_px = 2;

// Along one axis of the image: the pixels of points whose coordinate and depth are in these ranges.
void grow(double& low, double& high, double focal_px, double center_px, const glm::dvec2& coordinate,
          const glm::dvec2& depth) {
  for (const double x : {coordinate[0], coordinate[1]}) {
    for (const double z : {depth[0], depth[1]}) {
      low = std::min(low, focal_px * x / z + center_px);
      high = std::max(high, focal_px * x / z + center_px);
    }
  }
}

// The pixels that the content of the boxes may cover.
PixelRect pixels_of(std::span<const ViewBox> boxes, const View& view) {
  const glm::uvec2 size(view.width_px, view.height_px);
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const ViewBox& box : boxes) {
    const glm::dvec3 first = box.center - box.half_size - box.slack_m, last = box.center + box.half_size + box.slack_m;
    if (!view.orthographic && first.z <= view.near_m) return {{0, 0}, size};
    const glm::dvec2 depth = view.orthographic ? glm::dvec2(1) : glm::dvec2(first.z, last.z);
    grow(low.x, high.x, view.pinhole.fx_px, view.pinhole.cx_px, {first.x, last.x}, depth);
    grow(low.y, high.y, view.pinhole.fy_px, view.pinhole.cy_px, {first.y, last.y}, depth);
  }
  if (!(low.x <= high.x && low.y <= high.y)) return {{0, 0}, size};  // not numbers
  const glm::dvec2 limit(size);
  return {glm::uvec2(glm::clamp(glm::floor(low - kMargin_px), glm::dvec2(0), limit)),
          glm::uvec2(glm::clamp(glm::ceil(high + kMargin_px), glm::dvec2(0), limit))};
}

// The pixels that the candidates may cover. Lines and points are wider than their places, so they count as everywhere.
PixelRect pixels_of(std::span<const DrawCandidate> candidates, const ViewContext& context) {
  std::vector<ViewBox> boxes;
  for (const DrawCandidate& candidate : candidates) {
    if (candidate.drawable->key.topology != Topology::triangles) {
      return {{0, 0}, {context.view.width_px, context.view.height_px}};
    }
    boxes.push_back(view_box(context.projection, *candidate.box));
  }
  return boxes.empty() ? PixelRect{} : pixels_of(boxes, context.view);
}

shader::ViewBlock view_block(const ViewContext& context) {
  const ViewProjection& p = context.projection;
  const DrawList& list = context.list;
  shader::ViewBlock block{};
  block.projection = glm::vec4(glm::dvec4(p.scale_x, p.shift_x, p.scale_y, p.shift_y));
  block.ambient = glm::vec4(list.environment.ambient, static_cast<float>(context.view.near_m));
  block.airlight = glm::vec4(list.medium.airlight, static_cast<float>(list.medium.extinction_per_m));
  return block;
}

}  // namespace

void ViewDrawList::update(const View& view, const Pass& pass, const StripColumns* columns, const DrawList& list,
                          const DrawCache& cache, ColumnOcclusionBuffer& strip) {
  draws_ = {};
  const ViewContext context{.view = view,
                            .pass = pass,
                            .list = list,
                            .cache = cache,
                            .raster = raster_,
                            .strip = columns != nullptr ? &strip : nullptr,
                            .projection = make_projection(view),
                            .draws = draws_};
  draws_.block = view_block(context);
  if (columns != nullptr) strip.begin(view, *columns);
  lights_.clear();
  if (pass.color && cache.any_lit()) add_lights(context);
  candidates_.begin(context);
  visible_.begin(context);
  runs_.clear();
  add_queue(context, pass.color ? cache.solid() : cache.depth());
  draws_.first_layer = runs_.size();
  if (pass.color) draws_.layered = pixels_of(add_queue(context, cache.blended()), context);
  draws_.first_depth_visible = runs_.size();
  if (pass.depth) runs_.repeat_for_depth(draws_.first_layer, draws_.first_depth_visible);
  draws_.end_run = runs_.size();
  runs_.finish(context);
}

// Returns the candidates of the queue, valid until the next call.
std::span<const DrawCandidate> ViewDrawList::add_queue(const ViewContext& context, const RenderQueue& queue) {
  const std::span<const DrawCandidate> candidates = candidates_.select(context, queue);
  visible_.add_occluders(context, candidates);
  runs_.record(context, visible_.cull(context, candidates));
  if (context.strip) runs_.record_strip(context, context.strip->visible(), candidates);
  return candidates;
}

void ViewDrawList::add_lights(const ViewContext& context) {
  const DrawList& list = context.list;
  const std::span<const std::uint32_t> lights = context.cache.lights();
  for (const std::uint32_t light : lights) {
    const LightItem& item = list.lights[light];
    lights_.push_back(
        make_light_block(item.light, context.projection.view_from_world * list.world_from_node[item.transform]));
  }
  const std::span<const ShadowUse> shadows = context.view.shadows;
  for (std::size_t i = 0; i < shadows.size(); ++i) {
    const auto place = std::ranges::find(lights, shadows[i].light) - lights.begin();
    lights_[static_cast<std::size_t>(place)].shadow.x = static_cast<float>(i + 1);
  }
}

}  // namespace simvis
