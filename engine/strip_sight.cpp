#include "engine/strip_sight.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/assert.h"
#include "engine/clusters.h"
#include "engine/view_projection.h"

namespace simvis {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// What a corner may be displaced by at the most, so that the rest holds.
constexpr double kDisplaced_px = 0.125;
// A corner that lies so far from a side of the viewport is cut off, or it is not, whatever rounding makes of it.
constexpr double kSide_px = 1;
// A triangle that thin may be turned by rounding.
constexpr double kThin_px = 1;
// By how far it is taken to reach beyond its edges, or not to reach them.
constexpr double kOutwards_px = 1, kInwards_px = 1;
// What w is taken to be off by: of its gradient, of itself, and of its range over the triangle times the share of the
// box around it that it does not fill.
constexpr double kShift_px = 0.5, kRounding = 1e-4, kSlope = 50 * 0x1p-24;

constexpr std::size_t kMostVertices = 3 * kClusterTriangles;

template <typename Corner>
Corner in_pixels(const glm::dvec3& place) {
  const double w = 1 / place.z;
  return {place.x * w, place.y * w, w};
}

// Where the edge from a to b crosses the row v.
template <typename Corner>
Corner crossing(const Corner& a, const Corner& b, double v) {
  const double share = (v - a.v) / (b.v - a.v);
  return {a.u + share * (b.u - a.u), v, a.w + share * (b.w - a.w)};
}

template <typename Corner>
bool crosses(const Corner& a, const Corner& b, double v) {
  return (a.v < v) != (b.v < v);
}

}  // namespace

void StripSight::begin(const View& view, const StripColumns& columns) {
  candidates_.clear();
  seen_.clear();
  width_ = view.width_px;
  height_ = view.height_px;
  guard_ = guard_rows(view);
  near_m_ = view.near_m;
  fx_ = view.pinhole.fx_px;
  fy_ = view.pinhole.fy_px;
  cx_ = view.pinhole.cx_px;
  cy_ = view.pinhole.cy_px;
  columns_ = &columns;
  hidden_below_.assign(columns_->centres_px().size(), 0);
}

void StripSight::place(std::uint32_t owner, const glm::dmat4& view_from_mesh, double slack_m) {
  owner_ = owner;
  const glm::dmat4 rows = glm::transpose(view_from_mesh);
  row_x_ = fx_ * rows[0] + cx_ * rows[2];
  row_y_ = fy_ * rows[1] + cy_ * rows[2];
  row_z_ = rows[2];
  slack_m_ = slack_m;
  slack_x_ = slack_m * (std::abs(fx_) + std::abs(cx_) + width_);
  slack_y_ = slack_m * (std::abs(fy_) + std::abs(cy_) + height_);
  // In a view that is cut at 45 degrees or less, a step in z moves a point as far as one across.
  least_z_m_ = std::max(near_m_, 2 * std::max(std::abs(fx_), std::abs(fy_)) * slack_m / kDisplaced_px);
}

// Where no side of the viewport, however rounded, cuts it off.
bool StripSight::is_inside(const glm::dvec3& p) const {
  return p.z > least_z_m_ && p.x > kSide_px * p.z && p.x < (width_ - kSide_px) * p.z &&
         p.y > (kSide_px - guard_) * p.z && p.y < (height_ + guard_ - kSide_px) * p.z;
}

// So near to a side that rounding decides.
bool StripSight::is_on_side(const glm::dvec3& p) const {
  const double near = kSide_px * std::max(p.z, least_z_m_);
  return std::abs(p.x) < near || std::abs(p.x - width_ * p.z) < near || std::abs(p.y + guard_ * p.z) < near ||
         std::abs(p.y - (height_ + guard_) * p.z) < near;
}

// By the sides of the viewport, each so far outwards. False if there is nothing left, or it is too near to be sure of.
bool StripSight::cut(const glm::dvec3 (&triangle)[3], double outwards_px, Polygon& polygon) const {
  glm::dvec3 corners[8] = {triangle[0], triangle[1], triangle[2]}, left[8];
  int count = 3;
  const auto cut_by = [&](const auto& inwards) {
    int kept = 0;
    for (int i = 0; i < count; ++i) {
      const glm::dvec3 &p = corners[i], &q = corners[(i + 1) % count];
      const double at_p = inwards(p), at_q = inwards(q);
      if (at_p >= 0) left[kept++] = p;
      if ((at_p >= 0) != (at_q >= 0)) left[kept++] = p + (at_p / (at_p - at_q)) * (q - p);
    }
    std::copy(left, left + kept, corners);
    count = kept;
  };
  cut_by([&](const glm::dvec3& p) { return p.z - near_m_; });
  cut_by([&](const glm::dvec3& p) { return p.x + outwards_px * p.z; });
  cut_by([&](const glm::dvec3& p) { return (width_ + outwards_px) * p.z - p.x; });
  cut_by([&](const glm::dvec3& p) { return p.y + (guard_ + outwards_px) * p.z; });
  cut_by([&](const glm::dvec3& p) { return (height_ + guard_ + outwards_px) * p.z - p.y; });
  polygon.count = count;
  for (int i = 0; i < count; ++i) {
    if (!(corners[i].z > least_z_m_)) return false;
    polygon.corners[i] = in_pixels<Corner>(corners[i]);
  }
  return count >= 3;
}

// How many columns that are read have their centres before u.
std::uint32_t StripSight::first_read(double u) const {
  const double column = std::clamp(u - 0.5, 0.0, width_);
  const auto whole = static_cast<std::uint32_t>(column);  // std::ceil is a call on plain x86-64
  return columns_->before(whole + (column > whole));
}

void StripSight::add(std::span<const std::uint32_t> vertices, std::span<const std::uint8_t> corners,
                     std::span<const glm::vec3> positions) {
  const auto times = [](const glm::dvec4& row, const glm::vec3& p) {
    return row.x * p.x + row.y * p.y + row.z * p.z + row.w;
  };
  // A vertex belongs to several triangles, and most of these miss the rows.
  double y[kMostVertices], z[kMostVertices];
  SIMVIS_ASSERT(vertices.size() <= kMostVertices);
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

// Whether it lies beyond a side of the view, or between columns that are read.
bool StripSight::misses(const glm::dvec3 (&triangle)[3]) const {
  const auto all = [&](const auto& test) { return test(triangle[0]) && test(triangle[1]) && test(triangle[2]); };
  if (all([&](const glm::dvec3& p) { return p.z < near_m_ - slack_m_; })) return true;
  if (all([&](const glm::dvec3& p) { return p.x < -slack_x_; })) return true;
  if (all([&](const glm::dvec3& p) { return width_ * p.z - p.x < -slack_x_; })) return true;
  if (!all([&](const glm::dvec3& p) { return p.z > least_z_m_; })) return false;
  const double a = triangle[0].x / triangle[0].z, b = triangle[1].x / triangle[1].z, c = triangle[2].x / triangle[2].z;
  return first_read(std::min({a, b, c}) - kOutwards_px) == first_read(std::max({a, b, c}) + kOutwards_px);
}

void StripSight::add(const StripTriangle& named, const glm::dvec3 (&triangle)[3]) {
  Candidate candidate{.triangle = named,
                      .first = 0,
                      .end = static_cast<std::uint32_t>(hidden_below_.size()),
                      .most = kInfinity,
                      .slope = 0};
  Polygon drawn, reach;
  if (is_inside(triangle[0]) && is_inside(triangle[1]) && is_inside(triangle[2])) {
    drawn.count = 3;
    std::ranges::transform(triangle, drawn.corners, in_pixels<Corner>);
    look(candidate, drawn, drawn);
  } else if (std::ranges::none_of(triangle, [this](const glm::dvec3& p) { return is_on_side(p); }) &&
             cut(triangle, 0, drawn) && cut(triangle, kSide_px, reach)) {
    look(candidate, drawn, reach);
  }
  if (candidate.first < candidate.end) candidates_.push_back(candidate);
}

// Of all triangles between its corners that have one of its sides.
StripSight::Slant StripSight::slant_of(const Polygon& drawn) const {
  Slant slant{.certain = true};
  double largest = 0;
  const int count = drawn.count;
  for (int i = 0; i < count; ++i) {
    const Corner &a = drawn.corners[i], &b = drawn.corners[(i + 1) % count];
    for (int k = 2; k < count; ++k) {
      const Corner& c = drawn.corners[(i + k) % count];
      const double du1 = b.u - a.u, dv1 = b.v - a.v, du2 = c.u - a.u, dv2 = c.v - a.v;
      const double area = std::abs(du1 * dv2 - du2 * dv1);
      const double box_u = std::max({a.u, b.u, c.u}) - std::min({a.u, b.u, c.u});
      const double box_v = std::max({a.v, b.v, c.v}) - std::min({a.v, b.v, c.v});
      // No side is longer than the box's sides together.
      if (!(area > kThin_px * (box_u + box_v))) return {};
      slant.unfilled = std::max(slant.unfilled, box_u * box_v / area);
      if (area <= largest) continue;
      largest = area;
      const double dw1 = b.w - a.w, dw2 = c.w - a.w;
      slant.gradient = (std::abs(dw1 * dv2 - dw2 * dv1) + std::abs(dw2 * du1 - dw1 * du2)) / area;
    }
    if (count == 3) break;
  }
  return slant;
}

void StripSight::look(Candidate& candidate, const Polygon& drawn, const Polygon& reach) {
  const double top = -kOutwards_px, bottom = height_ + kOutwards_px;
  // What of it lies in the rows is the hull of these.
  Corner hull[12];
  int count = 0;
  for (int i = 0; i < reach.count; ++i) {
    const Corner &p = reach.corners[i], &q = reach.corners[(i + 1) % reach.count];
    if (p.v >= top && p.v <= bottom) hull[count++] = p;
    if (crosses(p, q, top)) hull[count++] = crossing(p, q, top);
    if (crosses(p, q, bottom)) hull[count++] = crossing(p, q, bottom);
  }
  if (count == 0) {
    candidate.end = candidate.first;
    return;
  }
  const Corner *left = hull, *right = hull;
  for (const Corner* p = hull; p != hull + count; ++p) {
    if (p->u < left->u) left = p;
    if (p->u > right->u) right = p;
  }
  candidate.first = first_read(left->u - kOutwards_px);
  candidate.end = first_read(right->u + kOutwards_px);
  if (candidate.first >= candidate.end) return;

  const Slant slant = slant_of(drawn);
  if (!slant.certain) return;
  const auto [lowest, highest] = std::ranges::minmax(drawn.all(), {}, &Corner::w);
  // Along the columns w is taken to lie on or beside a line, which must not fall off where the hull ends.
  const double slope = right->u - left->u > 1 ? (right->w - left->w) / (right->u - left->u) : 0;
  const double off = kShift_px * (slant.gradient + std::abs(slope)) + kRounding * highest.w +
                     kSlope * slant.unfilled * (highest.w - lowest.w);
  double most = -std::numeric_limits<double>::infinity(), least = -most;
  for (const Corner* p = hull; p != hull + count; ++p) {
    most = std::max(most, p->w - slope * p->u);
    least = std::min(least, p->w - slope * p->u);
  }
  candidate.most = static_cast<float>(most + off);
  candidate.slope = static_cast<float>(slope);
  hide_behind(drawn, least - off, slope);
}

// Where the triangle fills all rows.
void StripSight::hide_behind(const Polygon& drawn, double least, double slope) {
  double first = -std::numeric_limits<double>::infinity(), end = -first;
  for (const double v : {0.0, height_}) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (int i = 0; i < drawn.count; ++i) {
      const Corner &p = drawn.corners[i], &q = drawn.corners[(i + 1) % drawn.count];
      if (!crosses(p, q, v)) continue;
      const double u = crossing(p, q, v).u;
      low = std::min(low, u);
      high = std::max(high, u);
    }
    first = std::max(first, low);
    end = std::min(end, high);
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

std::span<const StripTriangle> StripSight::seen() {
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
