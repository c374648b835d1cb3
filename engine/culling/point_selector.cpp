#include "engine/culling/point_selector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "engine/geometry/simd.h"

namespace simvis {
namespace {

constexpr float kNothing_m = std::numeric_limits<float>::infinity();

// Relative rounding of a place in the picture here: the reciprocal, two products with a rounded factor and a sum, some
// 6 * 2^-24.
constexpr float kPlaceRounding = 0x1p-21f;
// Relative rounding of the size of a point on the device: the length of a row that is a difference of rounded rows, and
// a quotient. The rows' rounding counts more by the ratio of their lengths, which is below 8 at angles below 160
// degrees.
constexpr float kSizeRounding = 0x1p-18f;
// Relative rounding of near / z on the device and of z here: six operations.
constexpr float kDepthRounding = 0x1p-20f;
// Points whose places are less certain than this, in samples, are rare and are selected.
constexpr float kMaxUncertain = 4;

using Float4 = float __attribute__((vector_size(16)));
using Int4 = int __attribute__((vector_size(16)));
constexpr int kBlock = 4;           // samples of a row that are read together
constexpr std::size_t kPoints = 8;  // that are placed together
using PointInts = int __attribute__((vector_size(32)));

SIMVIS_INLINE Float8 clamp8(Float8 a, float low, float high) {
  return min(splat8(high), max(splat8(low), a));  // `low` for what is not a number
}
SIMVIS_INLINE Float8 abs8(Float8 a) { return max(a, -a); }

// One cloud in one view, rounded to float32.
struct CloudView {
  float row_x[4], row_y[4], row_z[4];  // view_from_mesh
  float fx, fy, cx, cy, focal;         // in samples; `focal` is the larger one
  float width, height, near_m;
  float slack_m;    // bound on how far the device's point and the one here are apart, along each axis
  float uncertain;  // rounding of a place, in samples, apart from that of the point
  float size;       // of a point at a depth of 1 m
  float max_size, size_step;
  int to_positive;  // added to a coordinate before it is truncated
};

// Samples of a rectangle: from the first to before the last one.
struct Samples {
  PointInts left, right, top, bottom;
};

// Eight points. Bits and lanes belong to the points.
struct PlacedPoints {
  Samples outer, inner;  // all samples that a point may cover, and samples that it covers if it is drawn
  Float8 nearest_m, farthest_m;
  unsigned invisible = 0;  // the device draws nothing of it
  unsigned unknown = 0;    // it must be selected, and the rest is not known; excludes `invisible`
  unsigned drawn = 0;      // the device draws it for certain
};

SIMVIS_INLINE Float8 times(const float (&row)[4], Float8 x, Float8 y, Float8 z) {
  return splat8(row[0]) * x + splat8(row[1]) * y + splat8(row[2]) * z + splat8(row[3]);
}

// The samples whose middles lie between two coordinates, within `count` samples.
SIMVIS_INLINE void between(Float8 low, Float8 high, float count, int to_positive, PointInts& first, PointInts& last) {
  const Float8 shift = splat8(static_cast<float>(to_positive));
  const PointInts shifted = __builtin_convertvector(shift, PointInts);
  const Float8 from = clamp8(low - 0.5f, -1, count), to = clamp8(high - 0.5f, -1, count - 1);
  first = shifted - __builtin_convertvector(shift - from, PointInts);
  last = __builtin_convertvector(shift + to, PointInts) - shifted + 1;
  first = first < 0 ? PointInts{} : first;
}

SIMVIS_INLINE PlacedPoints place(const CloudView& view, Float8 px, Float8 py, Float8 pz) {
  PlacedPoints placed;
  const Float8 x = times(view.row_x, px, py, pz), y = times(view.row_y, px, py, pz), z = times(view.row_z, px, py, pz);
  const Float8 least_z = z - view.slack_m, most_z = z + view.slack_m;
  const Float8 per_z = 1.0f / z, slack_per_z = view.slack_m / least_z;
  const Float8 aside_u = view.fx * x * per_z, aside_v = view.fy * y * per_z;
  const Float8 u = aside_u + view.cx, v = aside_v + view.cy;
  // A movement of d along each axis moves the place by at most (f + |u - c|) d / (z - d).
  const Float8 uncertain =
      max(abs8(aside_u), abs8(aside_v)) * (slack_per_z + kPlaceRounding) + view.focal * slack_per_z + view.uncertain;
  const Float8 size = clamp8(view.size * per_z, 1, view.max_size);
  const Float8 size_uncertain = 0.5f * (size * (slack_per_z + kSizeRounding) + view.size_step);
  const Float8 most = 0.5f * size + size_uncertain + uncertain, least = 0.5f * size - size_uncertain - uncertain;
  const Mask8 before = most_z<view.near_m, in_front = least_z> view.near_m;
  const Mask8 aside = (u + most < 0.0f) | (u - most > view.width) | (v + most < 0.0f) | (v - most > view.height);
  // Comparisons with what is not a number are false.
  const Mask8 known = in_front & (uncertain < kMaxUncertain) & (u == u) & (v == v);
  const Mask8 within =
      (u - uncertain > 0.0f) & (u + uncertain < view.width) & (v - uncertain > 0.0f) & (v + uncertain < view.height);
  placed.invisible = bits_of(before | (in_front & aside));
  placed.unknown = ~bits_of(known) & ~placed.invisible & 0xffu;
  placed.drawn = bits_of(known & within);
  placed.nearest_m = least_z * (1 - kDepthRounding);
  placed.farthest_m = most_z * (1 + kDepthRounding);
  between(u - most, u + most, view.width, view.to_positive, placed.outer.left, placed.outer.right);
  between(v - most, v + most, view.height, view.to_positive, placed.outer.top, placed.outer.bottom);
  between(u - least, u + least, view.width, view.to_positive, placed.inner.left, placed.inner.right);
  between(v - least, v + least, view.height, view.to_positive, placed.inner.top, placed.inner.bottom);
  return placed;
}

SIMVIS_INLINE PlacedPoints place(const CloudView& view, std::span<const glm::vec3> positions,
                                 std::span<const std::uint32_t> points, std::size_t first) {
  Float8 x{}, y{}, z{};
  for (std::size_t lane = 0; lane < kPoints; ++lane) {
    const glm::vec3& p = positions[points[std::min(first + lane, points.size() - 1)]];
    x[lane] = p.x;
    y[lane] = p.y;
    z[lane] = p.z;
  }
  return place(view, x, y, z);
}

// The lanes of a block whose samples lie before the last one.
SIMVIS_INLINE Int4 before(int first, int last) {
  const Int4 lanes{0, 1, 2, 3};
  return lanes + first < last;
}

SIMVIS_INLINE Float4 read(const float* from) {
  Float4 block;
  std::memcpy(&block, from, sizeof block);
  return block;
}

SIMVIS_INLINE void cover(float* samples, std::size_t stride, const Samples& of, std::size_t lane, float depth_m) {
  for (int column = of.left[lane]; column < of.right[lane]; column += kBlock) {
    const Float4 depth = before(column, of.right[lane]) ? Float4{depth_m, depth_m, depth_m, depth_m}
                                                        : Float4{kNothing_m, kNothing_m, kNothing_m, kNothing_m};
    float* at = samples + static_cast<std::size_t>(of.top[lane]) * stride + column;
    for (int row = of.top[lane]; row < of.bottom[lane]; ++row, at += stride) {
      const Float4 known = read(at), nearer = depth < known ? depth : known;
      std::memcpy(at, &nearer, sizeof nearer);
    }
  }
}

// Whether something nearer covers all samples.
SIMVIS_INLINE bool is_covered(const float* samples, std::size_t stride, const Samples& of, std::size_t lane,
                              float depth_m) {
  for (int column = of.left[lane]; column < of.right[lane]; column += kBlock) {
    const Int4 counted = before(column, of.right[lane]);
    const float* at = samples + static_cast<std::size_t>(of.top[lane]) * stride + column;
    for (int row = of.top[lane]; row < of.bottom[lane]; ++row, at += stride) {
      const Int4 open = counted & ~(read(at) < depth_m);
      if ((open[0] | open[1] | open[2] | open[3]) != 0) return false;
    }
  }
  return true;
}

SIMVIS_FOR_EACH_MACHINE void cover_samples(const CloudView& view, std::span<const glm::vec3> positions,
                                           std::span<const std::uint32_t> points, float* samples, std::size_t stride) {
  for (std::size_t first = 0; first < points.size(); first += kPoints) {
    const PlacedPoints placed = place(view, positions, points, first);
    if (placed.drawn == 0) continue;
    for (std::size_t lane = 0; lane < kPoints; ++lane) {
      if ((placed.drawn >> lane & 1u) != 0) cover(samples, stride, placed.inner, lane, placed.farthest_m[lane]);
    }
  }
}

SIMVIS_FOR_EACH_MACHINE std::size_t select_visible(const CloudView& view, std::span<const glm::vec3> positions,
                                                   std::span<const std::uint32_t> points, const float* samples,
                                                   std::size_t stride, std::uint32_t* selected) {
  std::size_t count = 0;
  for (std::size_t first = 0; first < points.size(); first += kPoints) {
    const PlacedPoints placed = place(view, positions, points, first);
    if (placed.invisible == 0xffu) continue;
    const std::size_t end = std::min(kPoints, points.size() - first);
    for (std::size_t lane = 0; lane < end; ++lane) {
      if ((placed.invisible >> lane & 1u) != 0) continue;
      const bool hidden =
          (placed.unknown >> lane & 1u) == 0 && is_covered(samples, stride, placed.outer, lane, placed.nearest_m[lane]);
      selected[count] = points[first + lane];
      count += hidden ? 0 : 1;
    }
  }
  return count;
}

void set_row(float (&row)[4], const glm::dvec4& from) {
  for (int i = 0; i < 4; ++i) row[i] = static_cast<float>(from[i]);
}

}  // namespace

void PointSelector::begin(const View& view, std::uint32_t supersampling, double snap_px, const PointSizes& sizes) {
  const Pinhole& k = view.pinhole;
  const double samples = supersampling;
  width_ = samples * view.width_px;
  height_ = samples * view.height_px;
  near_m_ = view.near_m;
  fx_ = samples * k.fx_px;
  fy_ = samples * k.fy_px;
  cx_ = samples * k.cx_px;
  cy_ = samples * k.cy_px;
  snap_ = snap_px;
  sizes_ = sizes;
  stride_ = static_cast<std::size_t>(width_) + kBlock;
}

void PointSelector::select(const glm::dmat4& view_from_mesh, double slack_m, double size_m,
                           std::span<const glm::vec3> positions, std::span<const std::uint32_t> points,
                           std::vector<std::uint32_t>& selected) {
  const glm::dmat4 rows = glm::transpose(view_from_mesh);
  const double largest = std::max({width_, height_, std::abs(cx_), std::abs(cy_)}) + kBlock;
  CloudView view{.row_x = {},
                 .row_y = {},
                 .row_z = {},
                 .fx = static_cast<float>(fx_),
                 .fy = static_cast<float>(fy_),
                 .cx = static_cast<float>(cx_),
                 .cy = static_cast<float>(cy_),
                 .focal = static_cast<float>(std::max(std::abs(fx_), std::abs(fy_))),
                 .width = static_cast<float>(width_),
                 .height = static_cast<float>(height_),
                 .near_m = static_cast<float>(near_m_),
                 // The same rounding on the device and here, and that of the near plane.
                 .slack_m = static_cast<float>(2 * slack_m + 1e-6 * near_m_),
                 // A place is snapped to the grid, and its coordinates are rounded as numbers of their size are.
                 .uncertain = static_cast<float>(2 * snap_ + 8 * kPlaceRounding * largest),
                 .size = static_cast<float>(size_m * std::abs(fx_) * glm::length(glm::dvec3(rows[0]))),
                 .max_size = static_cast<float>(sizes_.max_px),
                 .size_step = static_cast<float>(sizes_.step_px),
                 .to_positive = static_cast<int>(largest) + kBlock};
  set_row(view.row_x, rows[0]);
  set_row(view.row_y, rows[1]);
  set_row(view.row_z, rows[2]);
  nearest_m_.assign(stride_ * static_cast<std::size_t>(height_), kNothing_m);
  cover_samples(view, positions, points, nearest_m_.data(), stride_);
  const std::size_t known = selected.size();
  selected.resize(known + points.size());
  selected.resize(known + select_visible(view, positions, points, nearest_m_.data(), stride_, selected.data() + known));
}

}  // namespace simvis
