#include "engine/render/shadow_map_cache.h"

#include <algorithm>
#include <cstring>

namespace simvis {
namespace {

bool same_bytes(const void* a, const void* b, std::size_t size) { return size == 0 || std::memcmp(a, b, size) == 0; }

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
              .runs = {},
              .instances = {},
              .comparable = true};
  drawn.block.lights = {};  // a place in a buffer of this frame
  for (const DrawRun& run : runs.subspan(draws.first_run, draws.end_run - draws.first_run)) {
    drawn.comparable = drawn.comparable && !run.own_indices && !run.key.cpu_selected;
    if (!drawn.comparable) return drawn;
    for (const std::uint64_t number :
         {run.key.bits(), reinterpret_cast<std::uint64_t>(run.texture), std::uint64_t{run.range.first_index},
          std::uint64_t{run.range.index_count}, static_cast<std::uint64_t>(run.range.vertex_offset),
          std::uint64_t{drawn.instances.size()}}) {
      drawn.runs.push_back(number);
    }
    const auto own = instances.subspan(run.first_instance, run.instance_count);
    drawn.instances.insert(drawn.instances.end(), own.begin(), own.end());
  }
  return drawn;
}

bool ShadowMapCache::same(const Drawn& a, const Drawn& b) {
  return a.comparable && b.comparable && a.x_px == b.x_px && a.y_px == b.y_px && a.width_px == b.width_px &&
         a.height_px == b.height_px && same_bytes(&a.block, &b.block, sizeof a.block) && a.runs == b.runs &&
         a.instances.size() == b.instances.size() &&
         same_bytes(a.instances.data(), b.instances.data(), a.instances.size() * sizeof(shader::Instance));
}

void ShadowMapCache::update(std::uint64_t target, const Pass& maps, std::span<const ViewDraws> views,
                            std::span<const DrawRun> runs, std::span<const shader::Instance> instances, bool uploaded) {
  new_ = target_ != target;
  target_ = target;
  std::vector<Drawn> now;
  due_.clear();
  for (std::size_t i = 0; i < views.size(); ++i) {
    now.push_back(drawn(maps.views[i], views[i], runs, instances));
    due_.push_back(new_ || uploaded || i >= drawn_.size() || !same(now[i], drawn_[i]));
  }
  drawn_ = std::move(now);
}

bool ShadowMapCache::any_due() const {
  return std::ranges::any_of(due_, [](bool due) { return due; });
}

}  // namespace simvis
