#include "sensors/camera/pixel_rays.h"

#include "engine/base/assert.h"

namespace simvis {

PixelRays::PixelRays(const CameraLayout& layout, const CameraViews& views, double near_m)
    : width_px_(layout.width_px), directions_(layout.rays) {
  const std::size_t pixels = std::size_t{layout.width_px} * layout.height_px;
  near_range_m_.resize(pixels);
  if (!directions_.empty()) {
    for (std::size_t i = 0; i < pixels; ++i) {
      if (views.taps[i].view == PixelTap::kNone) continue;
      near_range_m_[i] = near_m / (views.views[views.taps[i].view].face_from_view * directions_[i]).z;
    }
    return;
  }
  directions_.reserve(pixels);
  const Pinhole& p = layout.pinhole;
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::size_t column = i % layout.width_px, row = i / layout.width_px;
    const double x = static_cast<double>(column) + 0.5, y = static_cast<double>(row) + 0.5;
    directions_.push_back(glm::normalize(glm::dvec3((x - p.cx_px) / p.fx_px, (y - p.cy_px) / p.fy_px, 1)));
    near_range_m_[i] = near_m / directions_[i].z;
  }
}

void PixelRays::begin(const DrawList& list) {
  list_ = &list;
  moved_.set(list);
}

void PixelRays::cast(RayCaster& caster, const PixelRows& rows, std::span<SeenSurface> seen) {
  choose_pixels(rows);
  cast(caster, rows, chosen_, seen);
}

void PixelRays::cast(RayCaster& caster, const PixelRows& rows, std::span<const std::uint32_t> pixels,
                     std::span<SeenSurface> seen) {
  SIMVIS_ASSERT(list_ != nullptr);
  cast_directions_.clear();
  behind_m_.clear();
  for (const std::uint32_t pixel : pixels) {
    cast_directions_.push_back(directions_[pixel]);
    behind_m_.push_back(near_range_m_[pixel]);
  }
  met_.resize(pixels.size());
  const bool elsewhere = !rows.places.empty();
  const DrawList& world = elsewhere ? moved_.place(rows.places, caster.threads()) : *list_;
  rays_.cast(elsewhere ? moved_.caster() : caster, world, rows.world_from_view, cast_directions_, behind_m_, met_);
  for (std::size_t i = 0; i < pixels.size(); ++i) seen[pixels[i]] = met_[i];
}

// All pixels of the rows that see something.
void PixelRays::choose_pixels(const PixelRows& rows) {
  chosen_.clear();
  for_tiled_pixels(rows.first, rows.count, width_px_, [&](std::uint32_t pixel) {
    if (directions_[pixel] != glm::dvec3(0)) chosen_.push_back(pixel);
  });
}

}  // namespace simvis
