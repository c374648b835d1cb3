#include "sensors/camera/round_edges.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/draw/solid_cloud.h"
#include "engine/geometry/item_extent.h"

namespace simvis {
namespace {

constexpr float kNoSurface = -1;  // no ray meets lines and points, so their pixels stay as they are drawn

}  // namespace

bool RoundEdges::begin(const DrawList& list) {
  pixels_.clear();
  deviation_m_.assign(list.items.size(), 0);
  clouds_.clear();
  any_ = false;
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    const DrawItem& item = list.items[i];
    const Mesh& mesh = *list.meshes[item.mesh];
    if (item.visible && is_solid_cloud(mesh)) {
      clouds_.push_back({static_cast<std::uint32_t>(i), list.world_from_node[item.transform],
                         glm::dvec3(mesh.bounds_min), glm::dvec3(mesh.bounds_max)});
      any_ = true;
      continue;
    }
    if (mesh.topology != Topology::triangles) deviation_m_[i] = kNoSurface;
    // A view that names items draws a shape within 0.1 pixels, see round_levels.h, or with finer sides than these.
    if (!item.visible || !mesh.surface || mesh.surface->deviation_m == 0) continue;
    deviation_m_[i] =
        static_cast<float>(stretch_of(glm::dmat3(list.world_from_node[item.transform])) * mesh.surface->deviation_m);
    any_ = true;
  }
  return any_;
}

// A metre across the ray covers most pixels where it lies along the radius of the image. One pixel more makes up for
// the outline's place in its pixel, and for the rounding of the deviation.
std::uint32_t RoundEdges::reach_px(const View& view, double depth_m, std::uint32_t column, std::uint32_t row,
                                   double deviation_m) const {
  const Pinhole& p = view.pinhole;
  const double tx = (column + 0.5 - p.cx_px) / p.fx_px, ty = (row + 0.5 - p.cy_px) / p.fy_px;
  const double pixels = std::max(p.fx_px, p.fy_px) * (1 + tx * tx + ty * ty) * deviation_m / depth_m;
  return static_cast<std::uint32_t>(std::min(pixels, 1e6)) + 2;
}

// One pixel more than between two corners, for rounding.
void RoundEdges::open(const View& view, const glm::dvec2& low_px, const glm::dvec2& high_px) {
  const glm::dvec2 size(view.width_px, view.height_px);
  const glm::dvec2 low = glm::clamp(glm::floor(low_px) - 1.0, glm::dvec2(0), size),
                   high = glm::clamp(glm::ceil(high_px) + 1.0, glm::dvec2(0), size);
  open({static_cast<std::uint32_t>(low.x), static_cast<std::uint32_t>(high.x)},
       {static_cast<std::uint32_t>(low.y), static_cast<std::uint32_t>(high.y)}, view.width_px);
}

void RoundEdges::open(const Span& columns, const Span& rows, std::uint32_t width_px) {
  for (std::uint32_t row = rows.first; row < rows.end; ++row) {
    ++begins_[std::size_t{row} * (width_px + 1) + columns.first];
    --begins_[std::size_t{row} * (width_px + 1) + columns.end];
  }
}

void RoundEdges::open_cloud(const View& view, const Cloud& cloud) {
  const auto moved = std::ranges::lower_bound(view.places, cloud.item, {}, &ItemPlace::item);
  const bool is_moved = moved != view.places.end() && moved->item == cloud.item;
  const glm::dmat4 view_from_mesh = view.view_from_world * (is_moved ? moved->world_from_mesh : cloud.world_from_mesh);
  const Pinhole& p = view.pinhole;
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 at(corner & 1 ? cloud.high.x : cloud.low.x, corner & 2 ? cloud.high.y : cloud.low.y,
                        corner & 4 ? cloud.high.z : cloud.low.z);
    const glm::dvec3 q(view_from_mesh * glm::dvec4(at, 1));
    if (!(q.z > view.near_m)) return open(view, glm::dvec2(0), glm::dvec2(view.width_px, view.height_px));
    const glm::dvec2 px(p.cx_px + p.fx_px * q.x / q.z, p.cy_px + p.fy_px * q.y / q.z);
    low = glm::min(low, px);
    high = glm::max(high, px);
  }
  open(view, low, high);
}

void RoundEdges::add(const Pass& pass, const View& view, const PassResult& result, std::uint32_t width_px,
                     std::uint32_t first_row) {
  if (!any_) return;
  const std::uint32_t width = view.width_px, height = view.height_px;
  const auto place = [&](std::uint32_t x, std::uint32_t y) {
    return std::size_t{view.y_px + y} * pass.width_px + view.x_px + x;
  };
  begins_.assign((std::size_t{width} + 1) * height, 0);
  for (const Cloud& cloud : clouds_) open_cloud(view, cloud);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::uint32_t item = result.item_of(place(x, y));
      if (item == kNoItem || deviation_m_[item] <= 0) continue;
      const bool inside = x > 0 && y > 0 && x + 1 < width && y + 1 < height &&
                          result.item_of(place(x - 1, y)) == item && result.item_of(place(x + 1, y)) == item &&
                          result.item_of(place(x, y - 1)) == item && result.item_of(place(x, y + 1)) == item;
      if (inside) continue;
      const double depth_m = view.near_m / static_cast<double>(result.depth[place(x, y)]);
      const std::uint32_t reach = reach_px(view, depth_m, x, y, static_cast<double>(deviation_m_[item]));
      const auto around = [&](std::uint32_t at, std::uint32_t size) {
        return Span{at - std::min(at, reach), std::min(size, at + reach + 1)};
      };
      open(around(x, width), around(y, height), width);
    }
  }
  for (std::uint32_t y = 0; y < height; ++y) {
    std::int32_t squares = 0;
    for (std::uint32_t x = 0; x < width; ++x) {
      squares += begins_[std::size_t{y} * (width + 1) + x];
      if (squares == 0) continue;
      const std::uint32_t item = result.item_of(place(x, y));
      if (item != kNoItem && deviation_m_[item] == kNoSurface) continue;
      pixels_.push_back((first_row + y) * width_px + x);
    }
  }
}

}  // namespace simvis
