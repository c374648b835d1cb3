#include "engine/culling/triangle_selector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/base/assert.h"

namespace simvis {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

// Corners that are less certain than this are rare, and their triangles are selected.
constexpr double kMaxUncertain_px = 0.5;

double times(const glm::dvec4& row, const glm::vec3& p) { return row.x * p.x + row.y * p.y + row.z * p.z + row.w; }

}  // namespace

void TriangleSelector::begin(const View& view, std::uint32_t samples, double snap_px,
                             const OcclusionCuller& occlusion) {
  const Pinhole& k = view.pinhole;
  width_px_ = view.width_px;
  height_px_ = view.height_px;
  near_m_ = view.near_m;
  fx_px_ = k.fx_px;
  fy_px_ = k.fy_px;
  cx_px_ = k.cx_px;
  cy_px_ = k.cy_px;
  snap_px_ = snap_px;
  samples_ = samples;
  occlusion_ = &occlusion;
  const double tangents =
      std::max(cx_px_, width_px_ - cx_px_) / fx_px_ + std::max(cy_px_, height_px_ - cy_px_) / fy_px_;
  px_per_tangent_ = std::max(fx_px_, fy_px_) * std::sqrt(2 + tangents * tangents);
}

void TriangleSelector::place(const glm::dmat4& view_from_mesh, double slack_m, bool culls_backs, bool mirrored,
                             bool partly_hidden) {
  const glm::dmat4 rows = glm::transpose(view_from_mesh);
  row_u_ = fx_px_ * rows[0] + cx_px_ * rows[2];
  row_v_ = fy_px_ * rows[1] + cy_px_ * rows[2];
  row_z_ = rows[2];
  slack_m_ = slack_m;
  back_ = !culls_backs ? 0 : mirrored ? -1 : 1;
  eye_ = partly_hidden ? eye_in(view_from_mesh) : std::nullopt;
}

// A distance of d in space appears at the depth z, within the view, as at most px_per_tangent_ d / z pixels: see
// facing_tolerance.cpp. Snapping moves a vertex by half a step; the other half is for the rounding of the viewport
// transform.
TriangleSelector::Corner TriangleSelector::corner(const glm::vec3& position) const {
  const double z = times(row_z_, position), per_z = 1 / z;
  const Corner at{times(row_u_, position) * per_z, times(row_v_, position) * per_z, z,
                  snap_px_ + px_per_tangent_ * slack_m_ * per_z};
  const bool inside = z > near_m_ + slack_m_ && at.u >= 0 && at.u <= width_px_ && at.v >= 0 && at.v <= height_px_ &&
                      at.uncertain_px < kMaxUncertain_px;
  return inside ? at : Corner{at.u, at.v, at.z_m, kUnknown};
}

// Returns whether no sample lies between the two coordinates. The n-th sample is at (n + 1/2) / samples_.
bool TriangleSelector::misses_samples(double low_px, double high_px, double uncertain_px) const {
  constexpr double kPositive = 64;  // more than kMaxUncertain_px in samples: truncation rounds down
  const double shift = kPositive - 0.5;
  return static_cast<std::int64_t>((low_px - uncertain_px) * samples_ + shift) ==
         static_cast<std::int64_t>((high_px + uncertain_px) * samples_ + shift);
}

// Let s be the distance by which each corner may move along each axis. Twice the area of the triangle with the sides p
// and q, p x q, then changes by at most 2 s (|p|1 + |q|1) + 8 s^2.
bool TriangleSelector::can_change_a_pixel(const Corner& a, const Corner& b, const Corner& c) const {
  const double s = std::max({a.uncertain_px, b.uncertain_px, c.uncertain_px});
  if (s == kUnknown) return true;
  const double pu = b.u - a.u, pv = b.v - a.v, qu = c.u - a.u, qv = c.v - a.v;
  const double uncertain = 2 * s * (std::abs(pu) + std::abs(pv) + std::abs(qu) + std::abs(qv)) + 8 * s * s;
  if (back_ * (pu * qv - qu * pv) > uncertain) return false;
  return !misses_samples(std::min({a.u, b.u, c.u}), std::max({a.u, b.u, c.u}), s) &&
         !misses_samples(std::min({a.v, b.v, c.v}), std::max({a.v, b.v, c.v}), s);
}

// Returns whether occluders hide the triangle, whose corners are p, q and r in the mesh.
bool TriangleSelector::is_hidden(const Corner& a, const Corner& b, const Corner& c, const glm::vec3& p,
                                 const glm::vec3& q, const glm::vec3& r) const {
  const double s = std::max({a.uncertain_px, b.uncertain_px, c.uncertain_px});
  if (s == kUnknown) return false;
  const ViewExtent extent{.left = std::min({a.u, b.u, c.u}) - s,
                          .right = std::max({a.u, b.u, c.u}) + s,
                          .top = std::min({a.v, b.v, c.v}) - s,
                          .bottom = std::max({a.v, b.v, c.v}) + s,
                          .nearest_m = std::min({a.z_m, b.z_m, c.z_m}) - slack_m_,
                          .farthest_m = std::max({a.z_m, b.z_m, c.z_m}) + slack_m_};
  const double least = occlusion_->min_seen_m2(extent, slack_m_) / (eye_->unit_m * eye_->unit_m);
  return std::isfinite(least) && squared_thickness(*eye_, p, q, r) > least * least;
}

void TriangleSelector::select(const ClusterVertices& vertices, std::span<const std::uint8_t> corners,
                              std::span<const glm::vec3> positions, std::vector<std::uint32_t>& selected) const {
  std::array<Corner, 3 * kClusterTriangles> places;
  SIMVIS_ASSERT(vertices.size() <= places.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) places[i] = corner(positions[vertices[i]]);
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    const std::uint8_t a = corners[i], b = corners[i + 1], c = corners[i + 2];
    if (!can_change_a_pixel(places[a], places[b], places[c])) continue;
    const std::uint32_t p = vertices[a], q = vertices[b], r = vertices[c];
    if (eye_ && is_hidden(places[a], places[b], places[c], positions[p], positions[q], positions[r])) continue;
    selected.insert(selected.end(), {p, q, r});
  }
}

}  // namespace simvis
