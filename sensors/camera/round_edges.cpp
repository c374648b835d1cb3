#include "sensors/camera/round_edges.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/draw/solid_cloud.h"
#include "engine/geometry/item_extent.h"

namespace simvis {
namespace {

// A shape that appears at least so wide has a pixel centre in its mesh, which is up to 0.1 pixels narrower, within
// 2 pixels of each of its own: a disc of 1.5 pixels contains one, wherever it lies.
constexpr double kWide_px = 3;
constexpr int kSlices = 16;

// Whether a point of the mesh's frame lies within a shape, which has no outline from there.
bool encloses(const ExactSurface& shape, const glm::dvec3& point) {
  const double along_m = point[shape.axis], half_m = shape.length_m / 2;
  const double out_m = std::hypot(point[(shape.axis + 1) % 3], point[(shape.axis + 2) % 3]);
  switch (shape.kind) {
    case SurfaceKind::sphere:
    case SurfaceKind::capsule:
      return std::hypot(out_m, std::max(std::abs(along_m) - half_m, 0.0)) < shape.radius_m;
    case SurfaceKind::cylinder:
      return std::abs(along_m) < half_m && out_m < shape.radius_m;
    case SurfaceKind::cone:
      return along_m > -half_m && out_m * shape.length_m < shape.radius_m * (half_m - along_m);
    default:
      return false;
  }
}

}  // namespace

bool RoundEdges::begin(const DrawList& list, bool clouds) {
  pixels_.clear();
  deviation_m_.assign(list.items.size(), 0);
  clouds_.clear();
  rounds_.clear();
  any_ = false;
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    const DrawItem& item = list.items[i];
    const Mesh& mesh = *list.meshes[item.mesh];
    if (clouds && item.visible && is_solid_cloud(mesh)) {
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
    rounds_.push_back({{static_cast<std::uint32_t>(i), list.world_from_node[item.transform],
                        glm::dvec3(mesh.bounds_min), glm::dvec3(mesh.bounds_max)},
                       *mesh.surface});
    any_ = true;
  }
  return any_;
}

// A metre across the ray covers most pixels where it lies along the radius of the image. One pixel more makes up for
// the outline's place in its pixel, and for the rounding of the deviation.
std::uint32_t RoundEdges::reach_px(const View& view, double depth_m, std::uint32_t column, std::uint32_t row,
                                   double deviation_m) {
  const Pinhole& p = view.pinhole;
  const double tx = (column + 0.5 - p.cx_px) / p.fx_px, ty = (row + 0.5 - p.cy_px) / p.fy_px;
  const double pixels = std::max(p.fx_px, p.fy_px) * (1 + tx * tx + ty * ty) * deviation_m / depth_m;
  return static_cast<std::uint32_t>(std::min(pixels, 1e6)) + 2;
}

void RoundEdges::open(const View& view, const glm::dvec2& low_px, const glm::dvec2& high_px) {
  const glm::dvec2 size(view.width_px, view.height_px);
  const glm::dvec2 low = glm::clamp(low_px, glm::dvec2(0), size), high = glm::clamp(high_px, glm::dvec2(0), size);
  open({static_cast<std::uint32_t>(low.x), static_cast<std::uint32_t>(high.x)},
       {static_cast<std::uint32_t>(low.y), static_cast<std::uint32_t>(high.y)}, view.width_px);
}

void RoundEdges::open(const Span& columns, const Span& rows, std::uint32_t width_px) {
  for (std::uint32_t row = rows.first; row < rows.end; ++row) {
    ++begins_[std::size_t{row} * (width_px + 1) + columns.first];
    --begins_[std::size_t{row} * (width_px + 1) + columns.end];
  }
}

glm::dmat4 RoundEdges::view_from_mesh(const View& view, const Box& box) {
  const auto moved = std::ranges::lower_bound(view.places, box.item, {}, &ItemPlace::item);
  const bool is_moved = moved != view.places.end() && moved->item == box.item;
  return view.view_from_world * (is_moved ? moved->world_from_mesh : box.world_from_mesh);
}

// One pixel more than between two corners, for rounding.
RoundEdges::BoxPixels RoundEdges::pixels_of(const View& view, const Box& box) {
  const glm::dmat4 view_from_mesh = RoundEdges::view_from_mesh(view, box);
  const Pinhole& p = view.pinhole;
  const glm::dvec2 everywhere(std::numeric_limits<double>::infinity());
  BoxPixels pixels{everywhere, -everywhere, std::numeric_limits<double>::infinity()};
  double farthest_m = -pixels.nearest_m;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 at(corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                        corner & 4 ? box.high.z : box.low.z);
    const glm::dvec3 q(view_from_mesh * glm::dvec4(at, 1));
    pixels.nearest_m = std::min(pixels.nearest_m, q.z);
    farthest_m = std::max(farthest_m, q.z);
    const glm::dvec2 px(p.cx_px + p.fx_px * q.x / q.z, p.cy_px + p.fy_px * q.y / q.z);
    pixels.low_px = glm::min(pixels.low_px, glm::floor(px) - 1.0);
    pixels.high_px = glm::max(pixels.high_px, glm::ceil(px) + 1.0);
  }
  if (pixels.nearest_m > view.near_m) return pixels;
  if (farthest_m < view.near_m) return {};
  return {-everywhere, everywhere, view.near_m};
}

void RoundEdges::open_box(const View& view, const Box& box) {
  const BoxPixels pixels = pixels_of(view, box);
  open(view, pixels.low_px, pixels.high_px);
}

// The pixels of the mesh beside which those between both outlines lie may be beyond the border.
void RoundEdges::open_border(const View& view, const Round& round) {
  const BoxPixels pixels = pixels_of(view, round.box);
  const glm::dvec2 size(view.width_px, view.height_px);
  const bool left = pixels.low_px.x < 0;
  const bool above = pixels.low_px.y < 0;
  const bool right = pixels.high_px.x > size.x;
  const bool below = pixels.high_px.y > size.y;
  if (!left && !above && !right && !below) return;
  const double reach = border_reach_px(view, round, pixels.nearest_m);
  const glm::dvec2 low = pixels.low_px - reach, high = pixels.high_px + reach;
  if (left) open(view, low, {std::min(high.x, reach), high.y});
  if (above) open(view, low, {high.x, std::min(high.y, reach)});
  if (right) open(view, {std::max(low.x, size.x - reach), low.y}, high);
  if (below) open(view, {low.x, std::max(low.y, size.y - reach)}, high);
}

// The largest reach at the border. The depth of the shape there is at least that of its box, and that which a corner of
// the view has at the distance of the box.
double RoundEdges::border_reach_px(const View& view, const Round& round, double nearest_m) const {
  const glm::dmat4 mesh_from_view = glm::inverse(view_from_mesh(view, round.box));
  const glm::dvec3 camera(mesh_from_view[3]);
  if (encloses(round.shape, camera)) return 0;
  const glm::dvec3 away = glm::max(glm::max(round.box.low - camera, camera - round.box.high), 0.0);
  const double distance_m = glm::length(away) / stretch_of(glm::dmat3(mesh_from_view));
  const Pinhole& p = view.pinhole;
  std::uint32_t reach = 0;
  for (const std::uint32_t column : {0u, view.width_px - 1}) {
    for (const std::uint32_t row : {0u, view.height_px - 1}) {
      const glm::dvec3 ray((column + 0.5 - p.cx_px) / p.fx_px, (row + 0.5 - p.cy_px) / p.fy_px, 1);
      const double depth_m = std::max(nearest_m, distance_m / glm::length(ray));
      reach = std::max(reach, reach_px(view, depth_m, column, row, static_cast<double>(deviation_m_[round.box.item])));
    }
  }
  return reach;
}

// The width across the axis that appears least: at the farthest corner of the box, shrunk by the scale that shrinks
// most.
void RoundEdges::open_narrow(const View& view, const Round& round) {
  const glm::dmat4 view_from_mesh = RoundEdges::view_from_mesh(view, round.box);
  const glm::dmat3 linear(view_from_mesh);
  const double scale = 1 / stretch_of(glm::inverse(linear));
  double far_m = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 at(corner & 1 ? round.box.high.x : round.box.low.x,
                        corner & 2 ? round.box.high.y : round.box.low.y,
                        corner & 4 ? round.box.high.z : round.box.low.z);
    far_m = std::max(far_m, glm::length(glm::dvec3(view_from_mesh * glm::dvec4(at, 1))));
  }
  const double focal_px = std::min(view.pinhole.fx_px, view.pinhole.fy_px);
  double least_m = 2 * round.shape.radius_m;  // across the axis, or along that of a flat cylinder or cone
  if (round.shape.kind == SurfaceKind::cylinder || round.shape.kind == SurfaceKind::cone) {
    least_m = std::min(least_m, round.shape.length_m);
  }
  const double px_per_m = focal_px * scale / far_m;
  if (!(least_m * px_per_m >= kWide_px)) {  // by slices, whose boxes have less beside a shape that is aslant
    for (int slice = 0; slice < kSlices; ++slice) {
      Box part = round.box;
      const double low_m = round.box.low[round.shape.axis], size_m = round.box.high[round.shape.axis] - low_m;
      part.low[round.shape.axis] = low_m + slice * size_m / kSlices;
      part.high[round.shape.axis] = low_m + (slice + 1) * size_m / kSlices;
      open_box(view, part);
    }
    return;
  }
  if (round.shape.kind != SurfaceKind::cone) return;
  Box tip = round.box;
  const double share = kWide_px / (2 * round.shape.radius_m * px_per_m);  // of the cone's length, below 1
  const double half_m = share * round.shape.radius_m;
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == round.shape.axis) {
      tip.low[axis] = tip.high[axis] - share * round.shape.length_m;
    } else {
      const double middle_m = (tip.low[axis] + tip.high[axis]) / 2;
      tip.low[axis] = middle_m - half_m;
      tip.high[axis] = middle_m + half_m;
    }
  }
  open_box(view, tip);
}

void RoundEdges::add(const Pass& pass, const View& view, const PassResult& result, std::uint32_t width_px,
                     std::uint32_t first_row, bool whole) {
  if (!any_) return;
  const std::uint32_t width = view.width_px, height = view.height_px;
  const auto place = [&](std::uint32_t x, std::uint32_t y) {
    return std::size_t{view.y_px + y} * pass.width_px + view.x_px + x;
  };
  begins_.assign((std::size_t{width} + 1) * height, 0);
  for (const Box& cloud : clouds_) open_box(view, cloud);
  for (const Round& round : rounds_) {
    open_narrow(view, round);
    open_border(view, round);
  }
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::uint32_t item = result.item_of(place(x, y));
      if (item == kNoItem || deviation_m_[item] <= 0) continue;
      const bool inside = x > 0 && y > 0 && x + 1 < width && y + 1 < height &&
                          result.item_of(place(x - 1, y)) == item && result.item_of(place(x + 1, y)) == item &&
                          result.item_of(place(x, y - 1)) == item && result.item_of(place(x, y + 1)) == item;
      if (inside) {
        if (whole) open({x, x + 1}, {y, y + 1}, width);
        continue;
      }
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
