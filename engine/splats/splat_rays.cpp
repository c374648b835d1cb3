#include "engine/splats/splat_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/splats/ray_cone.h"
#include "engine/splats/splat_mixture.h"

namespace simvis {
namespace {

constexpr std::uint32_t kTile_px = 8, kTilePixels = kTile_px * kTile_px;

using SplatNumbers = std::vector<std::uint32_t>;

// The pixels of one tile.
class SplatTile {
 public:
  SplatTile(const SplatRays& rays, std::uint32_t left, std::uint32_t top) {
    const auto rows = static_cast<std::uint32_t>(rays.directions.size() / rays.width_px);
    for (std::uint32_t y = top; y < std::min(top + kTile_px, rows); ++y) {
      for (std::uint32_t x = left; x < std::min(left + kTile_px, rays.width_px); ++x) {
        add(rays, std::size_t{y} * rays.width_px + x);
      }
    }
    open_ = count_;
  }

  // Splats come by the least range that they can have, in batches: before the least range of the next batch, all hits
  // are known.
  void look(std::span<const SeenSplat> splats, SplatNumbers numbers, std::span<SplatSight> sights) {
    std::ranges::sort(numbers, {}, [&](std::uint32_t number) { return splats[number].nearest_m; });
    constexpr std::size_t kBatch = 64;
    for (std::size_t first = 0; first < numbers.size() && open_ > 0; first += kBatch) {
      const std::size_t end = std::min(first + kBatch, numbers.size());
      for (std::size_t i = first; i < end; ++i) add_hits(splats[numbers[i]]);
      const double known_m =
          end < numbers.size() ? splats[numbers[end]].nearest_m : std::numeric_limits<double>::infinity();
      for (std::uint32_t i = 0; i < count_; ++i) {
        if (pixels_[i].is_open) mix_before(known_m, pixels_[i]);
      }
    }
    for (std::uint32_t i = 0; i < count_; ++i) sights[pixels_[i].number] = pixels_[i].mixture.sight();
  }

 private:
  struct Pixel {
    std::size_t number = 0;
    double near_m = 0, end_m = 0;
    bool is_open = true;
    std::vector<SplatHit> waiting{};  // hits that are not mixed yet
    std::size_t in_order = 0;         // of them, from the first
    SplatMixture mixture{};
  };

  void add(const SplatRays& rays, std::size_t number) {
    const glm::dvec3& direction = rays.directions[number];
    if (direction == glm::dvec3(0)) return;
    x_[count_] = direction.x;
    y_[count_] = direction.y;
    z_[count_] = direction.z;
    pixels_[count_++] = {.number = number, .near_m = rays.near_m[number], .end_m = rays.end_m[number]};
  }

  void add_hits(const SeenSplat& splat) {
    std::array<SplatPeak, kTilePixels> peaks;
    for (std::uint32_t i = 0; i < count_; ++i) peaks[i] = peak_along(splat, x_[i], y_[i], z_[i]);
    for (std::uint32_t i = 0; i < count_; ++i) {
      const auto [range_m, square_distance] = peaks[i];
      Pixel& pixel = pixels_[i];
      if (!(square_distance <= splat.square_reach) || !pixel.is_open) continue;
      if (!(range_m > pixel.near_m && range_m < pixel.end_m)) continue;
      const double alpha = alpha_at(splat, square_distance);
      if (alpha > 0) pixel.waiting.push_back({range_m, alpha, &splat});
    }
  }

  void mix_before(double known_m, Pixel& pixel) {
    const auto fresh = pixel.waiting.begin() + static_cast<std::ptrdiff_t>(pixel.in_order);
    std::sort(fresh, pixel.waiting.end(), comes_before);
    std::inplace_merge(pixel.waiting.begin(), fresh, pixel.waiting.end(), comes_before);
    auto hit = pixel.waiting.begin();
    for (; hit != pixel.waiting.end() && hit->range_m < known_m && !pixel.mixture.complete(); ++hit) {
      pixel.mixture.add(*hit);
    }
    pixel.waiting.erase(pixel.waiting.begin(), hit);
    pixel.in_order = pixel.waiting.size();
    if (!pixel.mixture.complete() && known_m < pixel.end_m) return;
    pixel.is_open = false;
    --open_;
  }

  std::array<double, kTilePixels> x_{}, y_{}, z_{};  // of the rays
  std::array<Pixel, kTilePixels> pixels_;
  std::uint32_t count_ = 0, open_ = 0;
};

// Splats in nearly the same direction.
struct SplatGroup {
  RayCone cone;
  SplatNumbers numbers;
};

// The place of a direction on a curve that fills the octahedron around the origin, so that neighbours on the curve are
// neighbours in direction (a Z-order of 10 bits on each axis of the unfolded octahedron).
std::uint32_t place_on_curve(const glm::dvec3& direction) {
  const double size = std::abs(direction.x) + std::abs(direction.y) + std::abs(direction.z);
  if (!(size > 0)) return 0;
  glm::dvec2 flat(direction.x / size, direction.y / size);
  if (direction.z < 0) {
    flat = {std::copysign(1 - std::abs(flat.y), flat.x), std::copysign(1 - std::abs(flat.x), flat.y)};
  }
  std::uint32_t place = 0;
  for (int axis = 0; axis < 2; ++axis) {
    const auto cell = static_cast<std::uint32_t>(std::clamp((flat[axis] + 1) * 512, 0.0, 1023.0));
    for (std::uint32_t bit = 0; bit < 10; ++bit) place |= (cell >> bit & 1) << (2 * bit + static_cast<unsigned>(axis));
  }
  return place;
}

std::vector<SplatGroup> groups_of(std::span<const SeenSplat> splats) {
  constexpr std::size_t kGroup = 64;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> order;  // by place, then by number
  order.reserve(splats.size());
  for (std::uint32_t i = 0; i < splats.size(); ++i) order.emplace_back(place_on_curve(splats[i].center_m), i);
  std::ranges::sort(order);
  std::vector<SplatGroup> groups;
  std::vector<RayCone> cones;
  for (std::size_t first = 0; first < order.size(); first += kGroup) {
    cones.clear();
    SplatGroup& group = groups.emplace_back();
    for (std::size_t i = first; i < std::min(first + kGroup, order.size()); ++i) {
      group.numbers.push_back(order[i].second);
      cones.push_back(cone_of(splats[order[i].second]));
    }
    group.cone = cone_around(cones);
  }
  return groups;
}

struct TileRect {
  std::uint32_t left = 0, top = 0, right = 0, bottom = 0;

  std::uint32_t count() const { return (right - left) * (bottom - top); }
};

// Divides the image again and again, and gives each half the splats that its rays may meet.
class DividedImage {
 public:
  DividedImage(std::span<const SeenSplat> splats, const SplatRays& rays, ThreadPool& pool, std::span<SplatSight> sights)
      : splats_(splats), rays_(rays), pool_(pool), sights_(sights) {
    const auto rows = static_cast<std::uint32_t>(rays.directions.size() / rays.width_px);
    columns_ = (rays.width_px + kTile_px - 1) / kTile_px;
    rows_ = (rows + kTile_px - 1) / kTile_px;
    for (std::uint32_t y = 0; y < rows_; ++y) {
      for (std::uint32_t x = 0; x < columns_; ++x) cones_.push_back(tile_cone(x, y, rows));
    }
  }

  void look() {
    const std::vector<SplatGroup> groups = groups_of(splats_);
    std::vector<const SplatGroup*> all;
    all.reserve(groups.size());
    for (const SplatGroup& group : groups) all.push_back(&group);
    look_at_groups({0, 0, columns_, rows_}, all);
  }

 private:
  RayCone tile_cone(std::uint32_t x, std::uint32_t y, std::uint32_t rows) const {
    std::vector<glm::dvec3> directions;
    const std::uint32_t left = x * kTile_px, right = std::min(left + kTile_px, rays_.width_px);
    for (std::uint32_t row = y * kTile_px; row < std::min((y + 1) * kTile_px, rows); ++row) {
      const auto of_row = rays_.directions.subspan(std::size_t{row} * rays_.width_px, rays_.width_px);
      directions.insert(directions.end(), of_row.begin() + left, of_row.begin() + right);
    }
    return cone_of(directions);
  }

  RayCone cone_of_rect(const TileRect& rect) const {
    std::vector<RayCone> cones;
    for (std::uint32_t y = rect.top; y < rect.bottom; ++y) {
      const auto row = cones_.begin() + static_cast<std::ptrdiff_t>(y) * columns_;
      cones.insert(cones.end(), row + rect.left, row + rect.right);
    }
    return cone_around(cones);
  }

  // Groups are divided down to this size of a rectangle, in which their cones are about as wide as that of its rays.
  static constexpr std::uint32_t kGroupTiles = 16;

  void look_at_groups(const TileRect& rect, const std::vector<const SplatGroup*>& groups) {
    const RayCone cone = cone_of_rect(rect);
    if (cone.empty()) return;
    std::vector<const SplatGroup*> met;
    std::ranges::copy_if(groups, std::back_inserter(met),
                         [&](const SplatGroup* group) { return may_overlap(cone, group->cone); });
    if (rect.count() <= kGroupTiles) {
      SplatNumbers numbers;
      for (const SplatGroup* const group : met) {
        numbers.insert(numbers.end(), group->numbers.begin(), group->numbers.end());
      }
      return look(rect, numbers);
    }
    divide(rect, [&](const TileRect& half) { look_at_groups(half, met); });
  }

  template <class Look>
  void divide(const TileRect& rect, const Look& look_at) {
    TileRect first = rect, second = rect;
    if (rect.right - rect.left > rect.bottom - rect.top) {
      first.right = second.left = (rect.left + rect.right) / 2;
    } else {
      first.bottom = second.top = (rect.top + rect.bottom) / 2;
    }
    pool_.parallel_both([&] { look_at(first); }, [&] { look_at(second); });
  }

  void look(const TileRect& rect, const SplatNumbers& numbers) {
    const RayCone cone = cone_of_rect(rect);
    if (cone.empty()) return;
    SplatNumbers met;
    std::ranges::copy_if(numbers, std::back_inserter(met),
                         [&](std::uint32_t number) { return may_meet(cone, splats_[number]); });
    if (met.empty()) return;
    if (rect.count() == 1) {
      SplatTile(rays_, rect.left * kTile_px, rect.top * kTile_px).look(splats_, std::move(met), sights_);
      return;
    }
    divide(rect, [&](const TileRect& half) { look(half, met); });
  }

  std::span<const SeenSplat> splats_;
  const SplatRays& rays_;
  ThreadPool& pool_;
  std::span<SplatSight> sights_;
  std::uint32_t columns_ = 0, rows_ = 0;  // of tiles
  std::vector<RayCone> cones_;            // of the tiles
};

}  // namespace

void see_through(std::span<const SeenSplat> splats, const SplatRays& rays, ThreadPool& pool,
                 std::span<SplatSight> sights) {
  std::ranges::fill(sights, SplatSight{});
  if (!splats.empty() && !rays.directions.empty()) DividedImage(splats, rays, pool, sights).look();
}

}  // namespace simvis
