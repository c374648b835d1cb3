#include "sensors/camera/resampled_image.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sensors/raster_depth/depth_range.h"

namespace simvis {

namespace {

/// All numbers of the image, to be written.
float* all_of(Image& image, const CameraLayout& layout, std::uint32_t channels) {
  image.width = layout.width_px;
  image.height = layout.height_px;
  image.channels = channels;
  std::vector<float>& pixels = image.pixels.overwrite();
  pixels.resize(std::size_t{layout.width_px} * layout.height_px * channels);
  return pixels.data();
}

// Bilinear interpolation; `pixel` is the top left of the four pixels.
glm::vec4 between(const glm::vec4* pixel, std::size_t stride, const BeamTap& tap) {
  const auto along = [&](const glm::vec4* p) {
    return (1 - tap.fraction_x) * glm::dvec4(p[0]) + tap.fraction_x * glm::dvec4(p[1]);
  };
  return glm::vec4((1 - tap.fraction_y) * along(pixel) + tap.fraction_y * along(pixel + stride));
}

// By how much a round shape may be nearer than its mesh, which is seen at a range.
double nearer_by(const FacePixels& pixels, const BeamTap& tap, double range_m, const ShapeDeviation& deviation) {
  const double deviation_m = deviation.at(range_m);
  if (deviation_m == 0) return 0;
  const double w = tap.ray_per_depth / range_m;
  const double dw = change_of_inverse_depth(w, deviation_m, steepness_at(pixels, tap));
  return dw < w ? range_m * dw / (w - dw) : std::numeric_limits<double>::infinity();
}

}  // namespace

void resample_color(const CameraLayout& layout, const CameraViews& views, std::span<const Pass> passes,
                    std::span<const PassResult> results, Image& image) {
  float* const pixels = all_of(image, layout, 4);
  for (std::size_t i = 0; i < views.taps.size(); ++i) {
    glm::vec4 seen(0, 0, 0, 1);
    if (views.taps[i].view != PixelTap::kNone) {
      const CameraView& view = views.views[views.taps[i].view];
      const BeamTap tap = beam_tap(views.taps[i], view.pinhole);
      const std::size_t stride = passes[view.pass].width_px;
      seen = between(results[view.pass].color.data() + (view.y_px + tap.y) * stride + view.x_px + tap.x, stride, tap);
    }
    for (int c = 0; c < 4; ++c) pixels[4 * i + static_cast<std::size_t>(c)] = seen[c];
  }
}

double resample_depth(const CameraLayout& layout, const CameraViews& views, std::span<const Pass> passes,
                      std::span<const PassResult> results, std::span<const DepthView> depth_views, Image& image) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  float* const depths_m = all_of(image, layout, 1);
  std::vector<FacePixels> pixels;
  std::vector<std::size_t> taken(passes.size(), 0);  // number of views already taken from each pass
  for (const CameraView& view : views.views) {
    const Pass& pass = passes[view.pass];
    pixels.push_back(face_pixels(results[view.pass], pass, pass.views[taken[view.pass]++]));
  }
  double bound_m = 0;
  for (std::size_t i = 0; i < views.taps.size(); ++i) {
    double depth_m = kInfinity;
    if (const std::uint32_t v = views.taps[i].view; v != PixelTap::kNone) {
      const CameraView& view = views.views[v];
      const BeamTap tap = beam_tap(views.taps[i], view.pinhole);
      const RangeEstimate range = planar_range(pixels[v], tap, depth_views[v].rounding);
      const glm::dvec3 ray = glm::dvec3(tap.tangent_x, tap.tangent_y, 1) * view.face_from_view;  // by the transpose
      const double depth_per_range = ray.z / tap.ray_per_depth;
      if (range.range_m < kInfinity) {
        depth_m = range.range_m * depth_per_range;
        // The stored depth is rounded to float32.
        const double shape_m = nearer_by(pixels[v], tap, range.range_m, depth_views[v].deviation);
        const double own_m = (range.error_bound_m + shape_m) * std::abs(depth_per_range) + 0x1p-24 * std::abs(depth_m);
        bound_m = std::max(bound_m, own_m);
      }
    }
    depths_m[i] = static_cast<float>(depth_m);
  }
  return bound_m;
}

}  // namespace simvis
