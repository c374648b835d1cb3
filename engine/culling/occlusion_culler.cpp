#include "engine/culling/occlusion_culler.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace simvis {
namespace {

constexpr double kTile_px = 4;
// Smallest share of the image for an occluder's box; a smaller occluder hides next to nothing.
constexpr double kMinShare = 1.0 / 256;
// How far beyond its box an object may be drawn, in addition to the displacement of its corners.
constexpr double kOutwards_px = 1;
// Occluders are clipped at this distance beyond the image.
constexpr double kBeyond_px = 2 * kInwards_px;

// Returns whether h D of each triangle of the cluster is larger than `least`, in the mesh's unit: see FacingTolerance.
bool shows_all(const EyeInMesh& eye, double least, const MeshRange& mesh, const Cluster& cluster) {
  const ClusterVertices vertices = mesh.clustering->vertices_of(cluster);
  const std::span<const std::uint8_t> corners = mesh.clustering->corners_of(cluster);
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    const glm::vec3 &p = mesh.positions[vertices[corners[i]]], &q = mesh.positions[vertices[corners[i + 1]]],
                    &r = mesh.positions[vertices[corners[i + 2]]];
    const glm::dvec3 a(p), ab = glm::dvec3(q) - a, ac = glm::dvec3(r) - a, bc = ac - ab;
    const double volume = glm::dot(glm::cross(ab, ac), eye.place - a);  // h D times the longest side
    const double square = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
    // A triangle with two corners at one position is never drawn.
    if (!(volume * volume > least * least * square) && p != q && q != r && r != p) return false;
  }
  return true;
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

void OcclusionCuller::begin(const View& view, const FacingTolerance& limit) {
  limit_ = limit;
  sides_ = PixelSides(view);
  pinhole_ = view.pinhole;
  width_ = view.width_px;
  height_ = view.height_px;
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
  const double min_z_m = sides_.min_z_m(slack_m);
  for (const Occluder& occluder : occluders) {
    glm::dvec3 corners[4], seen[4];
    const auto count = static_cast<std::size_t>(occluder.count);
    for (std::size_t i = 0; i < count; ++i) {
      const glm::dvec3 p(view_from_mesh * glm::dvec4(occluder.corners[i], 1));
      corners[i] = p;
      seen[i] = {pinhole_.fx_px * p.x + pinhole_.cx_px * p.z, pinhole_.fy_px * p.y + pinhole_.cy_px * p.z, p.z};
    }
    const double volume = glm::dot(glm::cross(corners[1] - corners[0], corners[2] - corners[0]), corners[0]);
    if (from_front && (volume > 0) != mirrored) continue;
    // The device clips each triangle separately, and each must be certain.
    const glm::dvec3 halves[2][3] = {{seen[0], seen[1], seen[2]}, {seen[0], seen[2], seen[3]}};
    PixelSlant slants[2];
    for (std::size_t i = 0; i + 2 < count; ++i) {
      PixelPolygon drawn;
      if (sides_.keep(halves[i], min_z_m, drawn) || sides_.cut(halves[i], 0, min_z_m, drawn)) {
        slants[i] = slant_of(drawn);
      }
    }
    if (slants[0].certain && slants[1].certain) {
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
  if (!sides_.keep(corners, min_z_m, reach) && !sides_.cut(corners, kBeyond_px, min_z_m, reach)) return;
  double bent = 0;
  for (const PixelCorner& corner : reach.all()) bent = std::max(bent, std::abs(corner.w - slant.at(corner)));
  const double uncertain_w = std::max(slant.uncertain_w, min_uncertain_w) + bent, half = kTile_px / 2;
  const auto [top, bottom] = std::ranges::minmax(reach.all(), {}, &PixelCorner::v);
  const auto first_row = static_cast<std::size_t>(std::max(0.0, top.v) / kTile_px);
  const auto end_row = std::min(rows_, static_cast<std::size_t>(std::max(0.0, bottom.v) / kTile_px) + 1);
  for (std::size_t row = first_row; row < end_row; ++row) {
    const double v = static_cast<double>(row) * kTile_px;
    const PixelSpan above = reach.at_row(v - kInwards_px),
                    below = reach.at_row(std::min(v + kTile_px, height_) + kInwards_px);
    const double first = std::max(0.0, std::max(above.first, below.first) + kInwards_px),
                 end = std::min(above.end, below.end) - kInwards_px;
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

// Returns how much nearer, in w, the occluders in front of the box are than the box: a multiple of the difference
// between the w of its nearest and of its farthest point. 0 if no occluders hide the whole box, or if the box is not
// entirely within the image.
double OcclusionCuller::clearance(const ViewBox& box) const {
  if (!any_) return 0;
  const double slack = box.slack_m;
  const glm::dvec3 low = box.center - box.half_size - slack, high = box.center + box.half_size + slack;
  if (!(low.z > sides_.min_z_m(slack))) return 0;
  const double nearest = 1 / low.z, farthest = 1 / high.z;
  const double left = pinhole_.fx_px * low.x * (low.x < 0 ? nearest : farthest) + pinhole_.cx_px - kOutwards_px,
               right = pinhole_.fx_px * high.x * (high.x < 0 ? farthest : nearest) + pinhole_.cx_px + kOutwards_px,
               top = pinhole_.fy_px * low.y * (low.y < 0 ? nearest : farthest) + pinhole_.cy_px - kOutwards_px,
               bottom = pinhole_.fy_px * high.y * (high.y < 0 ? farthest : nearest) + pinhole_.cy_px + kOutwards_px;
  if (!(left >= 0 && right <= width_ && top >= 0 && bottom <= height_)) return 0;
  const double behind = nearest * (1 + kRounding);
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

// Returns the threshold of h D, see FacingTolerance, that each triangle in the box must exceed to be occluded. Infinite
// if the box is not occluded.
double OcclusionCuller::min_seen_m2(const ViewBox& box) const {
  const double clear = clearance(box);
  if (!(clear > 0 && limit_.is_usable())) return std::numeric_limits<double>::infinity();
  const double nearest = box.center.z - box.half_size.z, farthest = box.center.z + box.half_size.z;
  return limit_.min_m2(nearest, farthest, box.slack_m) * std::max(1.0, 2 / clear);
}

bool OcclusionCuller::is_occluded(const ViewBox& box, const glm::dmat4& view_from_mesh, const MeshRange& mesh) const {
  const double min_m2 = min_seen_m2(box);
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
  const double min_m2 = min_seen_m2(box);
  if (!std::isfinite(min_m2)) return false;
  const std::optional<EyeInMesh> eye = eye_in(view_from_mesh);
  return eye && shows_all(*eye, min_m2 / (eye->unit_m * eye->unit_m), mesh, cluster);
}

}  // namespace simvis
