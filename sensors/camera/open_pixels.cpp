#include "sensors/camera/open_pixels.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace simvis {

bool OpenPixels::begin(const DrawList& list, bool clouds) {
  unbounded_.clear();
  round_ = edges_.begin(list, clouds);
  return round_;
}

void OpenPixels::plan(const std::string& name, FramePlan& plan) const {
  if (!round_) return;
  plan.casts.push_back({.name = name,
                        .reason = "the pixels of " + name + " at the outlines of round shapes",
                        .max_rays = std::uint64_t{layout_.width_px} * layout_.height_px});
}

void OpenPixels::read(const Pass& pass, const View& view, const PassResult& result, std::uint32_t first_row, bool whole,
                      std::span<const double> depth_bounds_m) {
  edges_.add(pass, view, result, layout_.width_px, first_row, whole);
  for (std::size_t i = 0; i < depth_bounds_m.size(); ++i) {
    if (std::isfinite(depth_bounds_m[i])) continue;
    const std::size_t row = i / layout_.width_px, column = i % layout_.width_px;
    const std::uint32_t item = result.item_of((view.y_px + row) * pass.width_px + view.x_px + column);
    if (item == kNoItem || !edges_.meets_rays(item)) continue;
    unbounded_.push_back(first_row * layout_.width_px + static_cast<std::uint32_t>(i));
  }
}

void OpenPixels::cast(RayCaster& caster, std::span<const PixelRows> rows, const IdentifiedList& world,
                      const TruthImages& images) {
  std::vector<std::uint32_t> drawn, open;
  std::ranges::set_union(edges_.pixels(), unbounded_, std::back_inserter(drawn));
  const std::span<const std::uint32_t> of_flow =
      images.flow == nullptr ? std::span<const std::uint32_t>() : images.flow->left_open();
  std::ranges::set_union(drawn, of_flow, std::back_inserter(open));
  bound_m_ = 0;
  pixels_ = std::make_shared<const std::vector<std::uint32_t>>(open);
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
    for (const std::uint32_t pixel : pixels) {
      images.set_depth(pixel, seen_[pixel].range_m * rays_->directions()[pixel].z);
      if (seen_[pixel].item == kNoItem) continue;
      bound_m_ = std::max(bound_m_, cast_depth_bound(seen_[pixel], rays_->directions()[pixel]));
    }
  }
}

}  // namespace simvis
