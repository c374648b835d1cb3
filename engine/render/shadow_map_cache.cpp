#include "engine/render/shadow_map_cache.h"

#include <algorithm>
#include <cstring>
#include <glm/glm.hpp>
#include <iterator>
#include <limits>
#include <utility>

namespace simvis {
namespace {

// Rasterisation moves what is drawn by less than this, and the rounding of kMinDepthShare adds a fraction of a pixel.
constexpr double kCasterMargin_px = 2;
// A corner whose depth is a smaller share of the terms that it is the sum of has no certain place in float32. For the
// others, places are off by at most some 2^-23 / kMinDepthShare of the view's width.
constexpr double kMinDepthShare = 1e-3;

bool same_bytes(const void* a, const void* b, std::size_t size) { return size == 0 || std::memcmp(a, b, size) == 0; }

PixelRect whole(const View& view) { return {{0, 0}, {view.width_px, view.height_px}}; }

PixelRect around(const PixelRect& a, const PixelRect& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {glm::min(a.first, b.first), glm::max(a.last, b.last)};
}

bool overlap(const PixelRect& a, const PixelRect& b) {
  return !PixelRect{glm::max(a.first, b.first), glm::min(a.last, b.last)}.empty();
}

}  // namespace

// Vertices and indices that the host selected for this frame lie in buffers that are written in each frame, so such
// views are not comparable.
ShadowMapCache::Drawn ShadowMapCache::drawn(const View& view, const ViewDraws& draws, std::span<const DrawRun> runs,
                                            std::span<const shader::Instance> instances) {
  Drawn drawn{.x_px = view.x_px,
              .y_px = view.y_px,
              .width_px = view.width_px,
              .height_px = view.height_px,
              .block = draws.block,
              .casters = {},
              .comparable = true};
  drawn.block.lights = {};  // a place in a buffer of this frame
  for (const DrawRun& run : runs) {
    drawn.comparable = drawn.comparable && !run.own_indices && !run.key.cpu_selected;
    if (!drawn.comparable) return drawn;
    Caster caster{.draw = {run.key.bits(), reinterpret_cast<std::uint64_t>(run.texture), run.range.first_index,
                           run.range.index_count, static_cast<std::uint64_t>(run.range.vertex_offset)},
                  .instance = {},
                  .low = run.range.bounds_min,
                  .high = run.range.bounds_max};
    for (const shader::Instance& instance : instances.subspan(run.first_instance, run.instance_count)) {
      caster.instance = instance;
      drawn.casters.push_back(caster);
    }
  }
  return drawn;
}

bool ShadowMapCache::same_place(const Drawn& a, const Drawn& b) {
  return a.comparable && b.comparable && a.x_px == b.x_px && a.y_px == b.y_px && a.width_px == b.width_px &&
         a.height_px == b.height_px && same_bytes(&a.block, &b.block, sizeof a.block);
}

// Any order is enough in which different casters differ.
int ShadowMapCache::compare(const Caster& a, const Caster& b) {
  if (a.draw != b.draw) return a.draw < b.draw ? -1 : 1;
  return std::memcmp(&a.instance, &b.instance, sizeof a.instance);
}

// The pixels that a caster may cover: all if it comes too near to the light.
PixelRect ShadowMapCache::covered(const Caster& caster, const View& view) {
  if (view.orthographic) return whole(view);
  const glm::dvec2 size(view.width_px, view.height_px);
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec4 p(corner & 1 ? caster.high.x : caster.low.x, corner & 2 ? caster.high.y : caster.low.y,
                       corner & 4 ? caster.high.z : caster.low.z, 1);
    const glm::dvec4 depth_terms = glm::dvec4(caster.instance.clip_w) * p;
    const double depth = glm::dot(depth_terms, glm::dvec4(1));
    if (!(depth > kMinDepthShare * glm::dot(glm::abs(depth_terms), glm::dvec4(1)) + view.near_m)) return whole(view);
    const glm::dvec2 place(glm::dot(glm::dvec4(caster.instance.clip_x), p),
                           glm::dot(glm::dvec4(caster.instance.clip_y), p));
    const glm::dvec2 px = 0.5 * size * (place / depth + 1.0);
    low = glm::min(low, px);
    high = glm::max(high, px);
  }
  return {glm::uvec2(glm::clamp(glm::floor(low - kCasterMargin_px), glm::dvec2(0), size)),
          glm::uvec2(glm::clamp(glm::ceil(high + kCasterMargin_px), glm::dvec2(0), size))};
}

// The pixels of the casters that only one of them has.
PixelRect ShadowMapCache::changed(const Drawn& a, const Drawn& b, const View& view) {
  const auto less = [](const Caster* x, const Caster* y) { return compare(*x, *y) < 0; };
  std::vector<const Caster*> all[2], different;
  for (const Drawn* const drawn : {&a, &b}) {
    std::vector<const Caster*>& casters = all[drawn == &b];
    for (const Caster& caster : drawn->casters) casters.push_back(&caster);
    std::ranges::sort(casters, less);
  }
  std::ranges::set_symmetric_difference(all[0], all[1], std::back_inserter(different), less);
  PixelRect pixels;
  for (const Caster* const caster : different) pixels = around(pixels, covered(*caster, view));
  return pixels;
}

// Neighbours that are due stay one draw.
void ShadowMapCache::add_due(const PixelRect& pixels, const View& view, const Drawn& now,
                             std::span<const DrawRun> runs) {
  Due& due = due_.emplace_back(Due{.pixels = pixels, .first_run = due_runs_.size()});
  const bool all = pixels == whole(view);
  std::size_t caster = 0;
  for (const DrawRun& run : runs) {
    if (pixels.empty()) break;
    if (all) {
      due_runs_.push_back(run);
      continue;
    }
    bool open = false;
    for (std::uint32_t i = 0; i < run.instance_count; ++i) {
      const bool reaches = overlap(pixels, covered(now.casters[caster++], view));
      if (reaches && open) {
        ++due_runs_.back().instance_count;
      } else if (reaches) {
        DrawRun& added = due_runs_.emplace_back(run);
        added.first_instance = run.first_instance + i;
        added.instance_count = 1;
      }
      open = reaches;
    }
  }
  due.end_run = due_runs_.size();
}

void ShadowMapCache::update(std::uint64_t target, const Pass& maps, std::span<const ViewDraws> views,
                            std::span<const DrawRun> runs, std::span<const shader::Instance> instances, bool uploaded) {
  new_ = target_ != target;
  target_ = target;
  std::vector<Drawn> now;
  due_.clear();
  due_runs_.clear();
  for (std::size_t i = 0; i < views.size(); ++i) {
    const View& view = maps.views[i];
    const auto own = runs.subspan(views[i].first_run, views[i].first_layer - views[i].first_run);
    now.push_back(drawn(view, views[i], own, instances));
    const bool known = !new_ && !uploaded && i < drawn_.size() && same_place(now[i], drawn_[i]);
    add_due(known ? changed(drawn_[i], now[i], view) : whole(view), view, now[i], own);
  }
  drawn_ = std::move(now);
}

std::span<const DrawRun> ShadowMapCache::due_runs(std::size_t i) const {
  return std::span(due_runs_).subspan(due_[i].first_run, due_[i].end_run - due_[i].first_run);
}

bool ShadowMapCache::any_due() const {
  return std::ranges::any_of(due_, [](const Due& due) { return !due.pixels.empty(); });
}

}  // namespace simvis
