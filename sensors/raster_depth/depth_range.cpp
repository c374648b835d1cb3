#include "sensors/raster_depth/depth_range.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace simvis {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kFloatUnit = 0x1p-24;

// The second difference of three pixels of one plane is at most this many times the error of each; pixels with a larger
// one do not lie on one plane.
constexpr double kPossible = 4;

// Three pixels with a second difference up to this many times the error are treated as one plane. The bound contains
// the possible deviation, so this value is a trade-off: a larger one interpolates where small bevels may hide, a
// smaller one makes more beams uncertain.
constexpr double kBelieved = 0.5;

// A surface around one corner of the beam's cell: w = w0 + gx (x - corner) + gy (y - corner).
struct Plane {
  double x = 0, y = 0;  // the corner, in pixels from the tap's pixel
  double w0 = 0, gx = 0, gy = 0;
  double noise = 0;           // bound on the error of each w from which the plane was computed
  double believed_noise = 0;  // the same bound if the whole cell shows one surface
  bool flat = false;

  double at(double px, double py) const { return w0 + gx * (px - x) + gy * (py - y); }
};

// The position of a beam between the pixels 0 and 1 of a line, and the sides of them on which it may appear to lie.
struct Place {
  double fraction = 0;
  bool below = false, above = false;  // so near to pixel 0 (1) that it may lie before (beyond) it
  bool lost = false;                  // edges may be off by one pixel or more

  // The largest distance to the nearest pixel of its own surface.
  double distance() const {
    if (below) return 1 + fraction;
    return above ? 2 - fraction : std::max(fraction, 1 - fraction);
  }
};

// States whether pixels 0 and 1 of a line agree with one surface, and how far the interpolated w may be off from any
// other surface that the line allows, from the second differences at pixels -1, 0, 1 and 2.
struct Line {
  bool straight = false;
  double doubt = 0;
};

Line judge(const std::array<double, 4>& differences, double noise, double believed_noise, const Place& place) {
  const auto& [before, first, second, after] = differences;
  const auto believed = [&](double difference) { return std::abs(difference) <= kBelieved * believed_noise; };
  const auto possible = [&](double difference) { return std::abs(difference) <= kPossible * noise; };
  Line line{believed(first) || believed(second)};
  // A surface that ends at pixel 0 is in line with the pixels before it, and one that begins at pixel 1 with the pixels
  // beyond it.
  if (possible(before) || place.below) {
    line.straight = line.straight && believed(first);
    line.doubt = place.fraction * std::abs(first);
  }
  if (possible(after) || place.above) {
    line.straight = line.straight && believed(second);
    line.doubt = std::max(line.doubt, (1 - place.fraction) * std::abs(second));
  }
  // A surface may even end before pixel 0, or begin beyond pixel 1.
  if (place.below) {
    line.straight = line.straight && believed(before);
    line.doubt += (1 + place.fraction) * std::abs(before);
  }
  if (place.above) {
    line.straight = line.straight && believed(after);
    line.doubt += (2 - place.fraction) * std::abs(after);
  }
  return line;
}

class Cell {
 public:
  Cell(const FacePixels& pixels, const BeamTap& tap, const VertexRounding& rounding)
      : pixels_(pixels), tap_(tap), rounding_(pixels.reach) {
    const float* row = pixels.depth + std::size_t{tap.y - kPixelsBefore} * pixels.stride_px + tap.x - kPixelsBefore;
    for (int y = 0; y < kSide; ++y, row += pixels.stride_px) {
      for (int x = 0; x < kSide; ++x) w_[y * kSide + x] = static_cast<double>(row[x]) / pixels.near_m;
    }
    for (const double w : {at(0, 0), at(1, 0), at(0, 1), at(1, 1)}) {
      if (!(w > 0)) continue;
      const double displacement_m = rounding.at(tap.ray_per_depth / w);
      max_displacement_m_ = std::max(max_displacement_m_, displacement_m);
      min_displacement_m_ = std::min(min_displacement_m_, displacement_m);
    }
    const double hx = pixels.middle_tangent_x, hy = pixels.middle_tangent_y;
    row_x_ = std::sqrt(1 + hx * hx);
    row_y_ = std::sqrt(1 + hy * hy);
    const double edge = displacement_of_edges(rounding);
    place_x_ = place(tap.fraction_x, pixels.focal_x_px, row_x_, pixels.reach.x_px, edge);
    place_y_ = place(tap.fraction_y, pixels.focal_y_px, row_y_, pixels.reach.y_px, edge);
  }

  double at(int x, int y) const {
    return w_[static_cast<std::size_t>((y + kPixelsBefore) * kSide + x + kPixelsBefore)];
  }

  bool lost() const { return place_x_.lost || place_y_.lost; }
  bool beside_a_centre() const { return place_x_.below || place_x_.above || place_y_.below || place_y_.above; }

  // True if nothing is hit at the beam, nor just beyond a pixel's centre on either side of which the beam may lie.
  bool empty() const {
    for (int y = place_y_.below ? -1 : 0; y <= (place_y_.above ? 2 : 1); ++y) {
      for (int x = place_x_.below ? -1 : 0; x <= (place_x_.above ? 2 : 1); ++x) {
        if (at(x, y) > 0) return false;
      }
    }
    return true;
  }

  // Bilinear interpolation: the weights are not negative and sum to 1, so they do not enlarge the pixels' errors.
  double interpolated() const {
    const double fx = tap_.fraction_x, fy = tap_.fraction_y;
    return (1 - fy) * ((1 - fx) * at(0, 0) + fx * at(1, 0)) + fy * ((1 - fx) * at(0, 1) + fx * at(1, 1));
  }

  // The largest difference of the surrounding pixels from w.
  double relief(double w) const {
    double relief = 0;
    for (int y = -kPixelsBefore; y <= kPixelsAfter; ++y) {
      for (int x = -kPixelsBefore; x <= kPixelsAfter; ++x) relief = std::max(relief, std::abs(at(x, y) - w));
    }
    return relief;
  }

  // If all pixels of the cell show one surface, it has one displacement at the range of each pixel, so the smallest of
  // them bounds it. If they show several surfaces, each has its own displacement, and that of a far surface must not
  // make a step look like a plane.
  double noise(double w, double gx, double gy) const { return noise(w, gx, gy, max_displacement_m_); }
  double believed_noise(double w, double gx, double gy) const { return noise(w, gx, gy, min_displacement_m_); }

  // The error of each pixel on a plane with these gradients and with this w in the cell.
  double noise(double w, double gx, double gy, double displacement_m) const {
    const double ax = std::abs(gx), ay = std::abs(gy), fx = pixels_.focal_x_px, fy = pixels_.focal_y_px;
    const double farthest = w + 3 * (ax + ay);  // of the surrounding pixels
    const double to_middle_x = pixels_.middle_tangent_x - tap_.tangent_x;
    const double to_middle_y = pixels_.middle_tangent_y - tap_.tangent_y;
    const double middle = std::abs(w + fx * gx * to_middle_x + fy * gy * to_middle_y);
    const double vertices = farthest * displacement_m * (fx * ax * row_x_ + fy * ay * row_y_ + middle);
    const double set_up = rounding_.per_gx * ax + rounding_.per_gy * ay + rounding_.per_w * farthest;
    // The gradients are off by 2 n each, which changes the noise by this many times n.
    const double feedback = 2 * (farthest * displacement_m *
                                     (fx * (row_x_ + std::abs(to_middle_x)) + fy * (row_y_ + std::abs(to_middle_y))) +
                                 rounding_.per_gx + rounding_.per_gy);
    return feedback < 1 ? (vertices + set_up) / (1 - feedback) : kInfinity;
  }

  double second_difference_x(int x, int y) const { return at(x - 1, y) - 2 * at(x, y) + at(x + 1, y); }
  double second_difference_y(int x, int y) const { return at(x, y - 1) - 2 * at(x, y) + at(x, y + 1); }

  // The surface at corner (x, y) in {0, 1}^2, from the three pixels outward from it in each direction.
  Plane outward_plane(int x, int y) const {
    const int sx = x == 0 ? -1 : 1, sy = y == 0 ? -1 : 1;
    Plane plane{static_cast<double>(x), static_cast<double>(y), at(x, y)};
    plane.gx = sx * (at(x + sx, y) - at(x, y));
    const double bend_x = std::abs(second_difference_x(x + sx, y));
    plane.gy = sy * (at(x, y + sy) - at(x, y));
    const double bend_y = std::abs(second_difference_y(x, y + sy));
    const double twist = std::abs(at(x + sx, y + sy) - at(x + sx, y) - at(x, y + sy) + at(x, y));
    plane.noise = noise(plane.w0, plane.gx, plane.gy);
    plane.believed_noise = believed_noise(plane.w0, plane.gx, plane.gy);
    plane.flat = at(x + sx, y) > 0 && std::max({bend_x, bend_y, twist}) <= kBelieved * plane.believed_noise;
    return plane;
  }

  // If the whole cell agrees with one surface: w at the beam and its largest error. Otherwise 0 and infinity.
  std::pair<double, double> single_plane() const {
    const double gx = at(1, 0) - at(0, 0), gy = at(0, 1) - at(0, 0);
    const double n = noise(at(0, 0), gx, gy), believed = believed_noise(at(0, 0), gx, gy);
    const double twist = std::abs(at(1, 1) - at(1, 0) - at(0, 1) + at(0, 0));
    bool flat = twist <= kBelieved * believed;
    double doubt_x = 0, doubt_y = 0;
    for (int y = 0; y <= 1 && flat; ++y) {
      const Line line = judge(
          {second_difference_x(-1, y), second_difference_x(0, y), second_difference_x(1, y), second_difference_x(2, y)},
          n, believed, place_x_);
      flat = line.straight;
      doubt_x = std::max(doubt_x, line.doubt);
    }
    for (int x = 0; x <= 1 && flat; ++x) {
      const Line line = judge(
          {second_difference_y(x, -1), second_difference_y(x, 0), second_difference_y(x, 1), second_difference_y(x, 2)},
          n, believed, place_y_);
      flat = line.straight;
      doubt_y = std::max(doubt_y, line.doubt);
    }
    if (!flat) return {0, kInfinity};
    if (lost()) return {interpolated(), kInfinity};  // the best guess
    const double far_x = place_x_.distance();
    const double far_y = place_y_.distance();
    // The plane is extended in both directions; inside the cell its fourth corner follows from the other three and the
    // twist.
    const double extended =
        std::max(far_x, far_y) <= 1 ? 1 + 2 * (far_x + far_y + far_x * far_y) : (1 + 2 * far_x) * (1 + 2 * far_y);
    return {interpolated(), extended * n + doubt_x + doubt_y + far_x * far_y * twist};
  }

 private:
  // The largest displacement of the surfaces in the surrounding pixels, in tangents. Most cells lie in one bin of
  // ranges.
  double displacement_of_edges(const VertexRounding& rounding) const {
    double largest = 0, least_w = kInfinity, most_w = 0;
    for (const double w : w_) {
      least_w = w > 0 ? std::min(least_w, w) : least_w;
      most_w = std::max(most_w, w);
    }
    if (!(most_w > 0)) return 0;
    const double near_m = tap_.ray_per_depth / most_w, far_m = tap_.ray_per_depth / least_w;
    if (VertexRounding::bin(near_m) == VertexRounding::bin(far_m)) return rounding.at(near_m) * most_w;
    for (const double w : w_) {
      if (w > 0) largest = std::max(largest, rounding.at(tap_.ray_per_depth / w) * w);
    }
    return largest;
  }

  // In the rasteriser, edges are off by the snapping and the displacement of their vertices: in clip x over w, with w
  // displaced as well, at a distance of at most 1 from the middle.
  Place place(double fraction, double focal_px, double row, double reach_px, double displacement) const {
    const double off_px = pixels_.snap_px + focal_px * displacement * (row + 1) + 2 * kFloatUnit * reach_px;
    return {fraction, fraction < off_px, 1 - fraction < off_px, off_px >= 1};
  }

  const FacePixels& pixels_;
  const BeamTap& tap_;
  PlaneRounding rounding_;  // rounding of the set-up
  static constexpr int kSide = kPixelsBefore + 1 + kPixelsAfter;
  double w_[kSide * kSide];  // of the surrounding pixels
  double max_displacement_m_ = 0, min_displacement_m_ = kInfinity;
  double row_x_ = 1, row_y_ = 1;  // lengths of the rows of clip x and y, in tangents
  Place place_x_, place_y_;
};

RangeEstimate to_range(double w, double w_bound, const BeamTap& tap) {
  if (!(w > 0)) return {kInfinity, kInfinity};
  const double range = tap.ray_per_depth / w;
  return {range, w_bound < w ? range * w_bound / (w - w_bound) : kInfinity};
}

// The envelope of the corners' planes if they form one continuous upper or lower surface; otherwise a step.
RangeEstimate crease_or_step(const Cell& cell, const BeamTap& tap, const std::array<Plane, 4>& corners) {
  const double fx = tap.fraction_x, fy = tap.fraction_y;
  bool flat = !cell.lost(), upper = true, lower = true;
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
    // A plane that is extended by up to a pixel in each direction errs by five times the noise of its pixels. If its
    // first pixel only appears to belong to the surface, that pixel errs by 3 + kBelieved in each direction. Geometry
    // between the pixels is assumed to be no rougher than the surrounding pixels.
    constexpr double kOffPixel = 3 + kBelieved;
    const double extended = cell.beside_a_centre() ? kOffPixel * kOffPixel : 5;
    const double w = upper ? highest : lowest;
    return to_range(w, std::max(highest - lowest, cell.relief(w)) + extended * noise, tap);
  }
  const Plane& side = *std::ranges::min_element(
      corners, {}, [&](const Plane& c) { return (c.x - fx) * (c.x - fx) + (c.y - fy) * (c.y - fy); });
  const double extended = side.at(fx, fy);
  return {to_range(side.flat && extended > 0 ? extended : side.w0, 0, tap).range_m, kInfinity};
}

}  // namespace

FacePixels face_pixels(const PassResult& result, const Pass& pass, const View& view) {
  const double width = view.width_px, height = view.height_px;
  return {.depth = result.depth.data() + std::size_t{view.y_px} * pass.width_px + view.x_px,
          .stride_px = pass.width_px,
          .near_m = view.near_m,
          .focal_x_px = view.pinhole.fx_px,
          .focal_y_px = view.pinhole.fy_px,
          .reach = raster_reach(view, result.depth_snap_px),
          .middle_tangent_x = (width / 2 - view.pinhole.cx_px) / view.pinhole.fx_px,
          .middle_tangent_y = (height / 2 - view.pinhole.cy_px) / view.pinhole.fy_px,
          .snap_px = result.snap_px};
}

// A surface seen at range r is displaced by at least (5 + 3 + 1) u r (see VertexRounding), and |mx| + |my| + w' is at
// least w. Half a pixel from the last pixel of the surface the error is twice the noise.
double min_planar_bound() { return 2 * (9 + PlaneRounding::kValue) * kFloatUnit; }

RangeEstimate planar_range(const FacePixels& pixels, const BeamTap& tap, const VertexRounding& rounding) {
  const Cell cell(pixels, tap, rounding);
  const std::array<double, 4> corners{cell.at(0, 0), cell.at(1, 0), cell.at(0, 1), cell.at(1, 1)};
  if (cell.empty()) return {kInfinity, 0};

  if (std::ranges::all_of(corners, [](double w) { return w > 0; })) {
    const auto [w, bound] = cell.single_plane();
    if (w > 0) return to_range(w, bound, tap);
  }
  return crease_or_step(cell, tap,
                        std::array{cell.outward_plane(0, 0), cell.outward_plane(1, 0), cell.outward_plane(0, 1),
                                   cell.outward_plane(1, 1)});
}

double steepness_at(const FacePixels& pixels, const BeamTap& tap) {
  const auto w = [&](std::uint32_t x, std::uint32_t y) {
    return static_cast<double>(pixels.depth[std::size_t{y} * pixels.stride_px + x]) / pixels.near_m;
  };
  const double corners[4] = {w(tap.x, tap.y), w(tap.x + 1, tap.y), w(tap.x, tap.y + 1), w(tap.x + 1, tap.y + 1)};
  if (*std::ranges::min_element(corners) == 0) return kInfinity;
  const double gx = std::max(std::abs(corners[1] - corners[0]), std::abs(corners[3] - corners[2]));
  const double gy = std::max(std::abs(corners[2] - corners[0]), std::abs(corners[3] - corners[1]));
  return *std::ranges::max_element(corners) + pixels.focal_x_px * gx * (1 + std::abs(tap.tangent_x)) +
         pixels.focal_y_px * gy * (1 + std::abs(tap.tangent_y));
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
