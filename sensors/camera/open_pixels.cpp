#include "sensors/camera/open_pixels.h"

#include <algorithm>
#include <iterator>

namespace simvis {

void OpenPixels::begin(const DrawList& list, const std::string& name, FramePlan& plan) {
  if (!edges_.begin(list)) return;
  plan.casts.push_back({.name = name,
                        .reason = "the pixels of " + name + " at the outlines of round shapes",
                        .max_rays = std::uint64_t{layout_.width_px} * layout_.height_px});
}

void OpenPixels::cast(RayCaster& caster, std::span<const PixelRows> rows, const IdentifiedList& world,
                      const TruthImages& images) {
  std::vector<std::uint32_t> open;
  const std::span<const std::uint32_t> edges = edges_.pixels();
  const std::span<const std::uint32_t> of_flow =
      images.flow == nullptr ? std::span<const std::uint32_t>() : images.flow->left_open();
  std::ranges::set_union(edges, of_flow, std::back_inserter(open));
  if (open.empty()) return;
  if (!rays_) rays_.emplace(layout_, views_, near_m_);
  rays_->begin(world.list);
  seen_.resize(rays_->directions().size());
  auto next = open.begin();
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const auto end = std::lower_bound(next, open.end(), (rows[r].first + rows[r].count) * layout_.width_px);
    const std::span<const std::uint32_t> pixels(next, end);
    next = end;
    if (pixels.empty()) continue;
    rays_->cast(caster, rows[r], pixels, seen_);
    images.truth.read(rows[r], pixels, rays_->directions(), seen_, world);
    if (images.flow != nullptr) images.flow->set(pixels, r, rays_->directions(), seen_);
    if (images.set_depth == nullptr) continue;
    for (const std::uint32_t pixel : pixels) {
      images.set_depth(pixel, seen_[pixel].range_m * rays_->directions()[pixel].z);
    }
  }
}

}  // namespace simvis
