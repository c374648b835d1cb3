#include "engine/culling/occlusion_culler.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace simvis {
namespace {

// Tiles along the seam of two walls hide nothing. Larger ones make seams wider, smaller ones cost more to fill.
constexpr double kTile_px = 2;
// Smallest share of the image for an occluder's box; a smaller occluder hides next to nothing.
constexpr double kMinShare = 1.0 / 256;
// The rounding of the viewport transform, of images of at most 16,384 pixels.
constexpr double kViewportRounding_px = 0x1p-9;

// Returns whether h D of each triangle of the cluster is larger than `least`, in the mesh's unit: see FacingTolerance.
bool shows_all(const EyeInMesh& eye, double least, const MeshRange& mesh, const Cluster& cluster) {
  const ClusterVertices vertices = mesh.clustering->vertices_of(cluster);
  const std::span<const std::uint8_t> corners = mesh.clustering->corners_of(cluster);
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    const glm::vec3 &p = mesh.positions[vertices[corners[i]]], &q = mesh.positions[vertices[corners[i + 1]]],
                    &r = mesh.positions[vertices[corners[i + 2]]];
    // A triangle with two corners at one position is never drawn.
    if (!(squared_thickness(eye, p, q, r) > least * least) && p != q && q != r && r != p) return false;
  }
  return true;
}

// w changes by at most this times a displacement along z.
double square_of_nearest(const PixelPolygon& polygon) {
  const double nearest = std::ranges::max(polygon.all(), {}, &PixelCorner::w).w;
  return nearest * nearest;
}

}  // namespace

ViewBox view_box(const ViewProjection& projection, const WorldBox& box) {
  ViewBox seen{.center = glm::dvec3(projection.view_from_world * glm::dvec4(box.center, 1)), .half_size = {}};
  const glm::dmat3 axes(projection.view_from_world);
  for (const glm::dvec3& axis : box.axis) seen.half_size += glm::abs(axes * axis);
  seen.slack_m = rounding_of(seen.center, box);
  return seen;
}

ViewBox view_box(const glm::dmat4& view_from_mesh, const Cluster& cluster, double slack_m) {
  const glm::dmat3 axes(view_from_mesh);
  const glm::dvec3 half(cluster.half_size);
  return {.center = glm::dvec3(view_from_mesh * glm::dvec4(cluster.center, 1)),
          .half_size = glm::abs(axes[0]) * half.x + glm::abs(axes[1]) * half.y + glm::abs(axes[2]) * half.z,
          .slack_m = slack_m};
}

// min_z_m() bounds slack * focal / z by kDisplaced_px / 2. A displacement along z moves the image of a point by up to
// the tangent times that.
void OcclusionCuller::begin(const View& view, double snap_px) {
  limit_ = FacingTolerance(view, snap_px);
  sides_ = PixelSides(view);
  pinhole_ = view.pinhole;
  width_ = view.width_px;
  height_ = view.height_px;
  const double guard = guard_rows(view);
  const double tangent = std::max(std::max(pinhole_.cx_px, width_ - pinhole_.cx_px) / pinhole_.fx_px,
                                  (std::max(pinhole_.cy_px, height_ - pinhole_.cy_px) + guard) / pinhole_.fy_px);
  snapped_px_ = snap_px + kViewportRounding_px;
  inwards_px_ = snapped_px_ + kDisplaced_px / 2 * (1 + tangent);
  any_ = false;
  columns_ = static_cast<std::size_t>(std::ceil(width_ / kTile_px));
  rows_ = static_cast<std::size_t>(std::ceil(height_ / kTile_px));
}

bool OcclusionCuller::may_hold_occluders(const ViewBox& box) const {
  const double nearest = box.center.z - box.half_size.z;
  if (nearest <= 0) return true;
  const double size = 2 * glm::length(box.half_size);
  return size * size * pinhole_.fx_px * pinhole_.fy_px >= kMinShare * width_ * height_ * nearest * nearest;
}

void OcclusionCuller::add(std::span<const Occluder> occluders, const glm::dmat4& view_from_mesh, double slack_m,
                          bool from_front, bool mirrored) {
  if (inwards_px_ > kShift_px) return;  // the bounds of pixel_polygon.h do not hold
  const double min_z_m = sides_.min_z_m(slack_m);
  for (const Occluder& occluder : occluders) {
    glm::dvec3 corners[4], seen[4];
    const auto count = static_cast<std::size_t>(occluder.count);
    for (std::size_t i = 0; i < count; ++i) {
      const glm::dvec3 p(view_from_mesh * glm::dvec4(occluder.corners[i], 1));
      corners[i] = p;
      seen[i] = {pinhole_.fx_px * p.x + pinhole_.cx_px * p.z, pinhole_.fy_px * p.y + pinhole_.cy_px * p.z, p.z};
    }
    // The device culls and clips each triangle separately, and each must be certain.
    const glm::dvec3 halves[2][3] = {{seen[0], seen[1], seen[2]}, {seen[0], seen[2], seen[3]}};
    PixelSlant slants[2];
    bool shows_front[2] = {};
    for (std::size_t i = 0; i + 2 < count; ++i) {
      const glm::dvec3 &a = corners[0], &b = corners[i + 1], &c = corners[i + 2];
      shows_front[i] = (glm::dot(glm::cross(b - a, c - a), a) > 0) == mirrored;
      if (from_front && !shows_front[i]) continue;
      PixelPolygon drawn;
      if (sides_.keep(halves[i], min_z_m, drawn) || sides_.cut(halves[i], 0, min_z_m, drawn)) {
        slants[i] = slant_of(drawn);
        slants[i].uncertain_w += slack_m * square_of_nearest(drawn);
      }
    }
    if (slants[0].certain && slants[1].certain && shows_front[0] == shows_front[1]) {
      add_occluder(std::span(seen, count), min_z_m, slants[0], slants[1].uncertain_w);
      continue;
    }
    for (std::size_t i = 0; i < 2; ++i) {
      if (slants[i].certain) add_occluder(halves[i], min_z_m, slants[i], 0);
    }
  }
}

// Raises the limit of w in the tiles that the shape fills. The error of its w is at least `min_uncertain_w`.
void OcclusionCuller::add_occluder(std::span<const glm::dvec3> corners, double min_z_m, const PixelSlant& slant,
                                   double min_uncertain_w) {
  if (!any_) hidden_below_.assign(columns_ * rows_, 0);
  any_ = true;
  PixelPolygon reach;
  if (!sides_.keep(corners, min_z_m, reach) && !sides_.cut(corners, 2 * inwards_px_, min_z_m, reach)) return;
  double bent = 0;
  for (const PixelCorner& corner : reach.all()) bent = std::max(bent, std::abs(corner.w - slant.at(corner)));
  const double uncertain_w = std::max(slant.uncertain_w, min_uncertain_w) + bent, half = kTile_px / 2;
  const auto [top, bottom] = std::ranges::minmax(reach.all(), {}, &PixelCorner::v);
  const auto first_row = static_cast<std::size_t>(std::max(0.0, top.v) / kTile_px);
  const auto end_row = std::min(rows_, static_cast<std::size_t>(std::max(0.0, bottom.v) / kTile_px) + 1);
  for (std::size_t row = first_row; row < end_row; ++row) {
    const double v = static_cast<double>(row) * kTile_px;
    const PixelSpan above = reach.at_row(v - inwards_px_),
                    below = reach.at_row(std::min(v + kTile_px, height_) + inwards_px_);
    const double first = std::max(0.0, std::max(above.first, below.first) + inwards_px_),
                 end = std::min(above.end, below.end) - inwards_px_;
    if (!(first < end)) continue;
    const auto first_tile = static_cast<std::size_t>(std::ceil(first / kTile_px)),
               end_tile = end >= width_ ? columns_ : static_cast<std::size_t>(end / kTile_px);
    const double at_0 = slant.at({half, v + half, 0}) - half * slant.gradient - uncertain_w;
    for (std::size_t tile = first_tile; tile < end_tile; ++tile) {
      float& hidden = hidden_below_[row * columns_ + tile];
      hidden = std::max(hidden, static_cast<float>(at_0 + slant.du * kTile_px * static_cast<double>(tile)));
    }
  }
}

ViewExtent OcclusionCuller::extent(const ViewBox& box) const {
  const glm::dvec3 low = box.center - box.half_size - box.slack_m, high = box.center + box.half_size + box.slack_m;
  const double nearest = 1 / low.z, farthest = 1 / high.z;
  return {.left = pinhole_.fx_px * low.x * (low.x < 0 ? nearest : farthest) + pinhole_.cx_px,
          .right = pinhole_.fx_px * high.x * (high.x < 0 ? farthest : nearest) + pinhole_.cx_px,
          .top = pinhole_.fy_px * low.y * (low.y < 0 ? nearest : farthest) + pinhole_.cy_px,
          .bottom = pinhole_.fy_px * high.y * (high.y < 0 ? farthest : nearest) + pinhole_.cy_px,
          .nearest_m = low.z,
          .farthest_m = high.z};
}

// Returns how much nearer, in w, the occluders in front of the extent are than the extent: a multiple of the difference
// between the w of its nearest and of its farthest point. 0 if no occluders hide it whole, or if it is not entirely
// within the image. Its nearest depth is above sides_.min_z_m().
double OcclusionCuller::clearance(const ViewExtent& extent) const {
  const double left = extent.left - snapped_px_, right = extent.right + snapped_px_, top = extent.top - snapped_px_,
               bottom = extent.bottom + snapped_px_;
  if (!(left >= 0 && right <= width_ && top >= 0 && bottom <= height_)) return 0;
  const double nearest = 1 / extent.nearest_m, farthest = 1 / extent.farthest_m, behind = nearest * (1 + kRounding);
  const auto tile = [](double px) { return static_cast<std::size_t>(px / kTile_px); };
  const std::size_t end_column = std::min(columns_, tile(right) + 1), end_row = std::min(rows_, tile(bottom) + 1);
  float farthest_occluder = std::numeric_limits<float>::infinity();
  for (std::size_t row = tile(top); row < end_row; ++row) {
    for (std::size_t column = tile(left); column < end_column; ++column) {
      farthest_occluder = std::min(farthest_occluder, hidden_below_[row * columns_ + column]);
      if (!(farthest_occluder > behind)) return 0;
    }
  }
  return (farthest_occluder - behind) / (nearest - farthest);
}

double OcclusionCuller::min_seen_m2(const ViewExtent& extent, double slack_m) const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  if (!any_ || !limit_.is_usable() || !(extent.nearest_m > sides_.min_z_m(slack_m))) return kNever;
  const double clear = clearance(extent);
  if (!(clear > 0)) return kNever;
  const double nearest = extent.nearest_m + slack_m, farthest = extent.farthest_m - slack_m;
  return limit_.min_m2(nearest, farthest, slack_m) * std::max(1.0, 2 / clear);
}

bool OcclusionCuller::hides_middle(const ViewBox& box) const {
  if (!any_ || !(box.center.z > 0)) return false;
  const double w = 1 / box.center.z;
  const auto tile = [&](double focal_px, double place_m, double center_px, std::size_t count) {
    const double at = (focal_px * place_m * w + center_px) / kTile_px, last = static_cast<double>(count - 1);
    return static_cast<std::size_t>(std::max(0.0, std::min(last, at)));  // also if `at` is not a number
  };
  return hidden_below_[tile(pinhole_.fy_px, box.center.y, pinhole_.cy_px, rows_) * columns_ +
                       tile(pinhole_.fx_px, box.center.x, pinhole_.cx_px, columns_)] > w;
}

bool OcclusionCuller::is_occluded(const ViewBox& box, const glm::dmat4& view_from_mesh, const MeshRange& mesh) const {
  const double min_m2 = min_seen_m2(extent(box), box.slack_m);
  if (!std::isfinite(min_m2)) return false;
  const std::optional<EyeInMesh> eye = eye_in(view_from_mesh);
  if (!eye) return false;
  const double least = min_m2 / (eye->unit_m * eye->unit_m);
  if (mesh.flat->sides.empty()) {
    return std::ranges::all_of(mesh.clusters,
                               [&](const Cluster& cluster) { return shows_all(*eye, least, mesh, cluster); });
  }
  const double off = mesh.flat->off * glm::length(eye->place) + mesh.flat->off_m;
  return std::ranges::all_of(mesh.flat->sides, [&](const FacePlane& side) {
    const double distance = std::abs(glm::dot(side.normal, eye->place) - side.offset) - off;
    return side.min_height * distance > least;
  });
}

bool OcclusionCuller::is_occluded(const ViewBox& box, const glm::dmat4& view_from_mesh, const MeshRange& mesh,
                                  const Cluster& cluster) const {
  const double min_m2 = min_seen_m2(extent(box), box.slack_m);
  if (!std::isfinite(min_m2)) return false;
  const std::optional<EyeInMesh> eye = eye_in(view_from_mesh);
  return eye && shows_all(*eye, min_m2 / (eye->unit_m * eye->unit_m), mesh, cluster);
}

}  // namespace simvis
