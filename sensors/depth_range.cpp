#include "sensors/depth_range.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

namespace simvis {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kFloatUnit = 0x1p-24;

// Roundings between the clip coordinates of three vertices and the depth stored for a pixel: perspective division (2
// of each coordinate), viewport (2), the gradients (4, each a difference of products over the area), the value at the
// corner (4), the evaluation (4), storing it (1).
constexpr double kSetup = 17;

// How many noises of a pixel the w of a flat surface is off at the most: its own, and four of a kink that hides in the
// second difference.
constexpr double kFlatNoises = 5;

// Second differences up to this share of their worst rounding are taken for none. What it lets through is in the bound,
// but for pixels of different surfaces that lie in line by chance, which a larger share makes likelier; a smaller one
// takes rough planes for steps and calls more beams uncertain.
constexpr double kBelieved = 0.3;

// A surface around one corner of the beam's cell: w = w0 + gx (x - corner) + gy (y - corner).
struct Plane {
  double x = 0, y = 0;  // the corner, in pixels from the tap's
  double w0 = 0, gx = 0, gy = 0;
  double noise = 0;           // bound on the error of each w that it was taken from
  double believed_noise = 0;  // what that is if the whole cell shows one surface
  double doubt = 0;           // second differences found, which a kink may hide behind
  bool flat = false;

  double at(double px, double py) const { return w0 + gx * (px - x) + gy * (py - y); }
};

// Whether pixels 0 and 1 of a line lie on one surface, from the second differences at pixels -1, 0, 1 and 2.
struct Line {
  bool straight = false;
  double doubt = 0;
};

// Either all of -1, 0, 1, 2 lie in line. Or three do and the fourth is off, beyond an edge; then the pixel before the
// edge must not also lie in line with what is beyond it: it would be anybody's.
Line judge(double before, double first, double second, double after, double believed) {
  const auto in_line = [&](double difference) { return std::abs(difference) <= believed; };
  if (in_line(first) && in_line(second)) return {true, std::abs(first) + std::abs(second)};
  if (in_line(first)) return {!in_line(after), std::abs(first)};
  if (in_line(second)) return {!in_line(before), std::abs(second)};
  return {};
}

class Cell {
 public:
  Cell(const FacePixels& pixels, const BeamTap& tap, bool planar_layout, const VertexRounding& rounding)
      : pixels_(pixels),
        tap_(tap),
        planar_(planar_layout),
        origin_(pixels.depth + std::size_t{tap.y} * pixels.stride_px + tap.x) {
    for (const double w : {at(0, 0), at(1, 0), at(0, 1), at(1, 1)}) {
      if (!(w > 0)) continue;
      const double displacement_m = rounding.at(tap.ray_per_depth / w);
      most_displacement_m_ = std::max(most_displacement_m_, displacement_m);
      least_displacement_m_ = std::min(least_displacement_m_, displacement_m);
    }
  }

  double at(int x, int y) const {
    return static_cast<double>(origin_[static_cast<std::ptrdiff_t>(y) * pixels_.stride_px + x]) / pixels_.near_m;
  }

  // Bilinear: weights that are never negative and sum to 1 do not enlarge the pixels' errors.
  double interpolated() const {
    const double fx = tap_.fraction_x, fy = tap_.fraction_y;
    return (1 - fy) * ((1 - fx) * at(0, 0) + fx * at(1, 0)) + fy * ((1 - fx) * at(0, 1) + fx * at(1, 1));
  }

  // How far the pixels around differ from w at the most.
  double relief(double w) const {
    double relief = 0;
    for (int y = planar_ ? 0 : -kPixelsBefore; y <= (planar_ ? 0 : kPixelsAfter); ++y) {
      for (int x = -kPixelsBefore; x <= kPixelsAfter; ++x) relief = std::max(relief, std::abs(at(x, y) - w));
    }
    return relief;
  }

  // Rounding of a w on a plane with these gradients per pixel, into the plane. A surface that all pixels show counts at
  // the range of each, so its displacement is the least found there; where they show several, each has its own, and
  // that of a far one must not make a step beside it look like a plane.
  void judge_noise(Plane& plane) const {
    plane.noise = noise(plane.w0, plane.gx, plane.gy, most_displacement_m_);
    plane.believed_noise = noise(plane.w0, plane.gx, plane.gy, least_displacement_m_);
  }
  double noise(double w, double gx, double gy, double displacement_m) const {
    const double mx = gx * pixels_.focal_px, my = gy * pixels_.focal_px;
    const double mz = w - mx * tap_.tangent_x - my * tap_.tangent_y;
    const double vertices = w * displacement_m * std::sqrt(mx * mx + my * my + mz * mz);
    const double setup =
        kSetup * kFloatUnit * (std::abs(gx) * pixels_.reach_x_px + std::abs(gy) * pixels_.reach_y_px + w);
    return vertices + setup;
  }

  double second_difference_x(int x, int y) const { return at(x - 1, y) - 2 * at(x, y) + at(x + 1, y); }
  double second_difference_y(int x, int y) const { return at(x, y - 1) - 2 * at(x, y) + at(x, y + 1); }

  // The surface at corner (x, y) in {0, 1}^2, seen from the three pixels outward from it in each direction.
  Plane outward_plane(int x, int y) const {
    const int sx = x == 0 ? -1 : 1, sy = y == 0 ? -1 : 1;
    Plane plane{static_cast<double>(x), static_cast<double>(y), at(x, y)};
    plane.gx = sx * (at(x + sx, y) - at(x, y));
    const double bend_x = std::abs(second_difference_x(x + sx, y));
    double bend_y = 0, twist = 0;
    if (planar_) {
      // Row 1 only tells the slant; it is believed where the neighbour outward tells the same.
      plane.gy = at(x, 1) - at(x, 0);
      twist = std::abs(at(x + sx, 1) - at(x + sx, 0) - plane.gy);
    } else {
      plane.gy = sy * (at(x, y + sy) - at(x, y));
      bend_y = std::abs(second_difference_y(x, y + sy));
      twist = std::abs(at(x + sx, y + sy) - at(x + sx, y) - at(x, y + sy) + at(x, y));
    }
    judge_noise(plane);
    plane.flat = at(x + sx, y) > 0 && std::max({bend_x, bend_y, twist}) <= kBelieved * plane.believed_noise;
    return plane;
  }

  // One surface under the whole cell, or none (`flat` false).
  Plane single_plane() const {
    Plane plane{0, 0, at(0, 0), at(1, 0) - at(0, 0), at(0, 1) - at(0, 0)};
    judge_noise(plane);
    const double twist = std::abs(at(1, 1) - at(1, 0) - at(0, 1) + at(0, 0));
    plane.doubt = twist;
    plane.flat = twist <= kBelieved * plane.believed_noise;
    const auto along = [&](double before, double first, double second, double after) {
      const Line line = judge(before, first, second, after, kBelieved * plane.believed_noise);
      plane.flat = plane.flat && line.straight;
      plane.doubt += line.doubt;
    };
    for (int y = 0; y <= (planar_ ? 0 : 1); ++y) {
      along(second_difference_x(-1, y), second_difference_x(0, y), second_difference_x(1, y),
            second_difference_x(2, y));
    }
    for (int x = 0; x <= 1 && !planar_; ++x) {
      along(second_difference_y(x, -1), second_difference_y(x, 0), second_difference_y(x, 1),
            second_difference_y(x, 2));
    }
    return plane;
  }

 private:
  const FacePixels& pixels_;
  const BeamTap& tap_;
  bool planar_;
  const float* origin_;
  double most_displacement_m_ = 0, least_displacement_m_ = kInfinity;
};

RangeEstimate to_range(double w, double w_bound, const BeamTap& tap) {
  if (!(w > 0)) return {kInfinity, kInfinity};
  const double range = tap.ray_per_depth / w;
  return {range, w_bound < w ? range * w_bound / (w - w_bound) : kInfinity};
}

// The envelope of the corners' planes if they form one continuous surface, upper or lower.
RangeEstimate crease_or_step(const Cell& cell, const BeamTap& tap, std::span<const Plane> corners) {
  const double fx = tap.fraction_x, fy = tap.fraction_y;
  bool flat = true, upper = true, lower = true;
  double highest = -kInfinity, lowest = kInfinity, noise = 0;
  for (const Plane& own : corners) {
    flat = flat && own.flat;
    noise = std::max(noise, own.noise);
    highest = std::max(highest, own.at(fx, fy));
    lowest = std::min(lowest, own.at(fx, fy));
    for (const Plane& other : corners) {
      const double gap = own.w0 - other.at(own.x, own.y), slack = 8 * (own.believed_noise + other.believed_noise);
      upper = upper && gap >= -slack;
      lower = lower && gap <= slack;
    }
  }
  if (flat && (upper || lower)) {
    // A plane extended over up to a pixel in each direction errs by five times the noise of the pixels that it rests
    // on. What may hide between the pixels is taken to be no rougher than what they show all around.
    const double w = upper ? highest : lowest;
    return to_range(w, std::max(highest - lowest, cell.relief(w)) + 5 * noise, tap);
  }
  const Plane& side = *std::ranges::min_element(
      corners, {}, [&](const Plane& c) { return (c.x - fx) * (c.x - fx) + (c.y - fy) * (c.y - fy); });
  const double extended = side.at(fx, fy);
  return {to_range(side.flat && extended > 0 ? extended : side.w0, 0, tap).range_m, kInfinity};
}

}  // namespace

double least_planar_bound() { return kFlatNoises * kSetup * kFloatUnit; }

RangeEstimate planar_range(const FacePixels& pixels, const BeamTap& tap, bool planar_layout,
                           const VertexRounding& rounding) {
  const Cell cell(pixels, tap, planar_layout, rounding);
  const std::array<double, 4> corners{cell.at(0, 0), cell.at(1, 0), cell.at(0, 1), cell.at(1, 1)};
  const std::span<const double> seen(corners.data(), planar_layout ? 2 : 4);
  if (std::ranges::all_of(seen, [](double w) { return w == 0; })) return {kInfinity, 0};

  const bool all_hit = std::ranges::all_of(seen, [](double w) { return w > 0; });
  if (all_hit) {
    const Plane plane = cell.single_plane();
    if (plane.flat) {
      // Interpolation keeps the noise; a kink of at most the doubt and its own noise may hide in the second difference.
      return to_range(cell.interpolated(), kFlatNoises * plane.noise + plane.doubt, tap);
    }
  }
  const std::array<Plane, 4> planes = planar_layout
                                          ? std::array<Plane, 4>{cell.outward_plane(0, 0), cell.outward_plane(1, 0)}
                                          : std::array<Plane, 4>{cell.outward_plane(0, 0), cell.outward_plane(1, 0),
                                                                 cell.outward_plane(0, 1), cell.outward_plane(1, 1)};
  return crease_or_step(cell, tap, {planes.data(), seen.size()});
}

RangeEstimate nearest_range(const FacePixels& pixels, const BeamTap& tap, const ScanFace& face,
                            const RangeEstimate& planar) {
  const std::uint32_t x = tap.x + (tap.fraction_x >= 0.5), y = tap.y + (tap.fraction_y >= 0.5);
  const double w = static_cast<double>(pixels.depth[std::size_t{y} * pixels.stride_px + x]) / pixels.near_m;
  if (w == 0) return {kInfinity, planar.range_m == kInfinity ? planar.error_bound_m : kInfinity};
  const double qx = (x + 0.5 - face.pinhole.cx_px) / face.pinhole.fx_px;
  const double qy = (y + 0.5 - face.pinhole.cy_px) / face.pinhole.fy_px;
  const double range = std::sqrt(1 + qx * qx + qy * qy) / w;
  return {range, std::abs(range - planar.range_m) + planar.error_bound_m};
}

}  // namespace simvis
