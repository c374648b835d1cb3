#include "engine/culling/column_occlusion_buffer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/assert.h"
#include "engine/geometry/clusters.h"

namespace simvis {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A triangle is assumed to reach this far beyond its edges.
constexpr double kStripOutwards_px = 1;
// It certainly fills what lies this far within its edges, along a row.
constexpr double kInwards_px = 1;

constexpr std::size_t kMaxVertices = 3 * kClusterTriangles;

}  // namespace

void ColumnOcclusionBuffer::begin(const View& view, const StripColumns& columns) {
  candidates_.clear();
  seen_.clear();
  sides_ = PixelSides(view);
  width_ = view.width_px;
  height_ = view.height_px;
  near_m_ = view.near_m;
  fx_ = view.pinhole.fx_px;
  fy_ = view.pinhole.fy_px;
  cx_ = view.pinhole.cx_px;
  cy_ = view.pinhole.cy_px;
  columns_ = &columns;
  hidden_below_.assign(columns_->centres_px().size(), 0);
}

void ColumnOcclusionBuffer::place(std::uint32_t owner, const glm::dmat4& view_from_mesh, double slack_m) {
  owner_ = owner;
  const glm::dmat4 rows = glm::transpose(view_from_mesh);
  row_x_ = fx_ * rows[0] + cx_ * rows[2];
  row_y_ = fy_ * rows[1] + cy_ * rows[2];
  row_z_ = rows[2];
  slack_m_ = slack_m;
  slack_x_ = slack_m * (std::abs(fx_) + std::abs(cx_) + width_);
  slack_y_ = slack_m * (std::abs(fy_) + std::abs(cy_) + height_);
  min_z_m_ = sides_.min_z_m(slack_m);
}

// Returns the number of read columns whose centres lie to the left of u.
std::uint32_t ColumnOcclusionBuffer::first_read(double u) const {
  const double column = std::clamp(u - 0.5, 0.0, width_);
  const auto whole = static_cast<std::uint32_t>(column);  // std::ceil is a call on plain x86-64
  return columns_->before(whole + (column > whole));
}

void ColumnOcclusionBuffer::add(const ClusterVertices& vertices, std::span<const std::uint8_t> corners,
                                std::span<const glm::vec3> positions) {
  const auto times = [](const glm::dvec4& row, const glm::vec3& p) {
    return row.x * p.x + row.y * p.y + row.z * p.z + row.w;
  };
  // Each vertex is transformed once: it belongs to several triangles, and most of these miss the rows.
  double y[kMaxVertices], z[kMaxVertices];
  SIMVIS_ASSERT(vertices.size() <= kMaxVertices);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    y[i] = times(row_y_, positions[vertices[i]]);
    z[i] = times(row_z_, positions[vertices[i]]);
  }
  for (std::size_t first = 0; first < corners.size(); first += 3) {
    const std::uint8_t a = corners[first], b = corners[first + 1], c = corners[first + 2];
    if (std::max({y[a], y[b], y[c]}) < -slack_y_) continue;
    const auto below = [&](std::uint8_t i) { return height_ * z[i] - y[i] < -slack_y_; };
    if (below(a) && below(b) && below(c)) continue;
    const StripTriangle named{owner_, {vertices[a], vertices[b], vertices[c]}};
    const auto seen = [&](std::uint8_t i) { return glm::dvec3(times(row_x_, positions[vertices[i]]), y[i], z[i]); };
    const glm::dvec3 triangle[3] = {seen(a), seen(b), seen(c)};
    if (!misses(triangle)) add(named, triangle);
  }
}

// Returns whether the triangle lies beyond a side of the view, or between two adjacent read columns.
bool ColumnOcclusionBuffer::misses(const glm::dvec3 (&triangle)[3]) const {
  const auto all = [&](const auto& test) { return test(triangle[0]) && test(triangle[1]) && test(triangle[2]); };
  if (all([&](const glm::dvec3& p) { return p.z < near_m_ - slack_m_; })) return true;
  if (all([&](const glm::dvec3& p) { return p.x < -slack_x_; })) return true;
  if (all([&](const glm::dvec3& p) { return width_ * p.z - p.x < -slack_x_; })) return true;
  if (!all([&](const glm::dvec3& p) { return p.z > min_z_m_; })) return false;
  const double a = triangle[0].x / triangle[0].z, b = triangle[1].x / triangle[1].z, c = triangle[2].x / triangle[2].z;
  return first_read(std::min({a, b, c}) - kStripOutwards_px) == first_read(std::max({a, b, c}) + kStripOutwards_px);
}

void ColumnOcclusionBuffer::add(const StripTriangle& named, const glm::dvec3 (&triangle)[3]) {
  Candidate candidate{.triangle = named,
                      .first = 0,
                      .end = static_cast<std::uint32_t>(hidden_below_.size()),
                      .most = kInfinity,
                      .slope = 0};
  PixelPolygon drawn, reach;
  if (sides_.keep(triangle, min_z_m_, drawn)) {
    test_and_insert(candidate, drawn, drawn);
  } else if (sides_.cut(triangle, 0, min_z_m_, drawn) && sides_.cut(triangle, kSide_px, min_z_m_, reach)) {
    test_and_insert(candidate, drawn, reach);
  }
  if (candidate.first < candidate.end) candidates_.push_back(candidate);
}

void ColumnOcclusionBuffer::test_and_insert(Candidate& candidate, const PixelPolygon& drawn,
                                            const PixelPolygon& reach) {
  const double top = -kStripOutwards_px, bottom = height_ + kStripOutwards_px;
  // The part of the polygon in the rows is the hull of these points.
  PixelCorner hull[12];
  int count = 0;
  for (int i = 0; i < reach.count; ++i) {
    const PixelCorner &p = reach.corners[i], &q = reach.corners[(i + 1) % reach.count];
    if (p.v >= top && p.v <= bottom) hull[count++] = p;
    if (crosses(p, q, top)) hull[count++] = crossing(p, q, top);
    if (crosses(p, q, bottom)) hull[count++] = crossing(p, q, bottom);
  }
  if (count == 0) {
    candidate.end = candidate.first;
    return;
  }
  const PixelCorner *left = hull, *right = hull;
  for (const PixelCorner* p = hull; p != hull + count; ++p) {
    if (p->u < left->u) left = p;
    if (p->u > right->u) right = p;
  }
  candidate.first = first_read(left->u - kStripOutwards_px);
  candidate.end = first_read(right->u + kStripOutwards_px);
  if (candidate.first >= candidate.end) return;

  const PixelSlant slant = slant_of(drawn);
  if (!slant.certain) return;
  // w is bounded by two parallel lines over u. Their slope must not let the bounds fall off beyond the ends of the
  // hull, so a hull at most one pixel wide has slope 0.
  const double slope = right->u - left->u > 1 ? (right->w - left->w) / (right->u - left->u) : 0;
  const double off = slant.uncertain_w + kShift_px * std::abs(slope);
  double most = -std::numeric_limits<double>::infinity(), least = -most;
  for (const PixelCorner* p = hull; p != hull + count; ++p) {
    most = std::max(most, p->w - slope * p->u);
    least = std::min(least, p->w - slope * p->u);
  }
  candidate.most = static_cast<float>(most + off);
  candidate.slope = static_cast<float>(slope);
  add_occluder(drawn, least - off, slope);
}

// Raises the limit of w in the columns where the triangle fills all rows.
void ColumnOcclusionBuffer::add_occluder(const PixelPolygon& drawn, double least, double slope) {
  double first = -std::numeric_limits<double>::infinity(), end = -first;
  for (const double v : {0.0, height_}) {
    const PixelSpan span = drawn.at_row(v);
    first = std::max(first, span.first);
    end = std::min(end, span.end);
  }
  if (!(first + 2 * kInwards_px < end)) return;
  const std::uint32_t first_column = first_read(first + kInwards_px), end_column = first_read(end - kInwards_px);
  const auto at_0 = static_cast<float>(least), per_px = static_cast<float>(slope);
  const float* const u = columns_->centres_px().data();
  float* const hidden = hidden_below_.data();
  for (std::uint32_t i = first_column; i < end_column; ++i) {
    const float w = at_0 + per_px * u[i];
    hidden[i] = hidden[i] < w ? w : hidden[i];
  }
}

std::span<const StripTriangle> ColumnOcclusionBuffer::visible() {
  const float* const u = columns_->centres_px().data();
  for (const Candidate& each : candidates_) {
    for (std::uint32_t i = each.first; i < each.end; ++i) {
      if (each.most + each.slope * u[i] < hidden_below_[i]) continue;
      seen_.push_back(each.triangle);
      break;
    }
  }
  return seen_;
}

}  // namespace simvis
