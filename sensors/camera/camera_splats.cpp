#include "sensors/camera/camera_splats.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string_view>

#include <simvis/effect.h>
#include "engine/base/thread_pool.h"

namespace simvis {
namespace {

constexpr std::string_view kGaussianSplats = "gaussian_splats";  // the effect

}  // namespace

void plan_splat_rays(const DrawList& list, const std::string& rays, std::uint64_t max_rays, const std::string& sensor,
                     FramePlan& plan) {
  std::uint64_t splats = 0;
  for (const DrawItem& item : list.items) {
    const auto& cloud = list.meshes[item.mesh]->splats;
    if (item.visible && cloud != nullptr) splats += cloud->splats.size();
  }
  plan.casts.push_back({.name = sensor,
                        .reason = rays + ", through " + std::to_string(splats) + " Gaussian splats, on the host",
                        .max_rays = max_rays});
  const bool is_planned = std::ranges::any_of(
      plan.effects, [&](const PlannedEffect& each) { return each.sensor == sensor && each.effect == kGaussianSplats; });
  if (is_planned) return;
  plan.effects.push_back(
      {sensor, std::string(kGaussianSplats), std::string(find_effect_type(kGaussianSplats)->source)});
}

CameraSplats::CameraSplats(const CameraLayout& layout, const CameraViews& views, double near_m)
    : rays_(layout, views, near_m), width_px_(layout.width_px) {}

void CameraSplats::plan(const DrawList& list, const std::string& title, const std::string& sensor,
                        FramePlan& plan) const {
  plan_splat_rays(list, "the centre of each pixel of " + title, rays_.directions().size(), sensor, plan);
}

// Depths are along the axis, behind the camera negative.
void CameraSplats::look(const DrawList& list, std::span<const PixelRows> rows, const Image& depth, unsigned threads) {
  const std::shared_ptr<ThreadPool> pool = shared_thread_pool(threads);
  end_m_.assign(rays_.directions().size(), std::numeric_limits<double>::infinity());
  for (std::size_t pixel = 0; pixel < end_m_.size(); ++pixel) {
    const double z = rays_.directions()[pixel].z;
    if (z != 0) end_m_[pixel] = std::abs(static_cast<double>(depth.pixels[pixel]) / z);
  }
  sights_.resize(rays_.directions().size());
  for (const PixelRows& of : rows) {
    const std::size_t first = std::size_t{of.first} * width_px_, count = std::size_t{of.count} * width_px_;
    const std::vector<SeenSplat> splats = see_splats(list, of.world_from_view, of.places);
    see_through(splats,
                {.width_px = width_px_,
                 .directions = std::span(rays_.directions()).subspan(first, count),
                 .near_m = std::span(rays_.near_ranges_m()).subspan(first, count),
                 .end_m = std::span(end_m_).subspan(first, count)},
                *pool, std::span(sights_).subspan(first, count));
  }
}

void CameraSplats::add_to_color(Image& color) const {
  std::vector<float>& pixels = color.pixels.edit();
  for (std::size_t pixel = 0; pixel < sights_.size(); ++pixel) {
    const SplatSight& sight = sights_[pixel];
    if (sight.transmittance == 1) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      float& value = pixels[pixel * color.channels + c];
      value = static_cast<float>(sight.color[static_cast<int>(c)] + sight.transmittance * static_cast<double>(value));
    }
  }
}

void CameraSplats::add_to_depth(Image& depth) const {
  std::vector<float>& pixels = depth.pixels.edit();
  for (std::size_t pixel = 0; pixel < sights_.size(); ++pixel) {
    const SplatSight& sight = sights_[pixel];
    if (sight.half_item != kNoItem) pixels[pixel] = static_cast<float>(sight.half_m * rays_.directions()[pixel].z);
  }
}

void CameraSplats::add_to_disparity(Image& disparity, double disparity_times_depth) const {
  std::vector<float>& pixels = disparity.pixels.edit();
  for (std::size_t pixel = 0; pixel < sights_.size(); ++pixel) {
    const SplatSight& sight = sights_[pixel];
    if (sight.half_item == kNoItem) continue;
    const double depth_m = sight.half_m * rays_.directions()[pixel].z;
    pixels[pixel] = depth_m > 0 ? static_cast<float>(disparity_times_depth / depth_m) : 0;
  }
}

void CameraSplats::add_to_truth(PixelTruth& truth, const IdentifiedList& world) const {
  for (std::uint32_t pixel = 0; pixel < sights_.size(); ++pixel) {
    const SplatSight& sight = sights_[pixel];
    if (sight.half_item == kNoItem) continue;
    truth.cover(pixel, sight.half_item, sight.half_m, rays_.directions()[pixel], world);
  }
}

void CameraSplats::add_to_surfaces(std::span<SeenSurface> seen) const {
  for (std::size_t pixel = 0; pixel < sights_.size(); ++pixel) {
    const SplatSight& sight = sights_[pixel];
    if (sight.half_item == kNoItem) continue;
    seen[pixel] = {.item = sight.half_item,
                   .range_m = sight.half_m,
                   .error_bound_m = std::numeric_limits<double>::infinity(),
                   .normal = -rays_.directions()[pixel]};
  }
}

bool CameraSplats::in_color() const {
  return std::ranges::any_of(sights_, [](const SplatSight& sight) { return sight.transmittance != 1; });
}

bool CameraSplats::in_depth() const {
  return std::ranges::any_of(sights_, [](const SplatSight& sight) { return sight.half_item != kNoItem; });
}

}  // namespace simvis
