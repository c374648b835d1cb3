// The pixels of a drawn image that drawing leaves open, and that are cast after all: those near the outlines of round
// shapes, and, for flow, those on meshes that change their shape.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sensors/camera/pixel_flow.h"
#include "sensors/camera/pixel_rays.h"
#include "sensors/camera/pixel_truth.h"
#include "sensors/camera/round_edges.h"

namespace simvis {

/// What is measured of an image.
struct TruthImages {
  PixelTruth& truth;
  PixelFlow* flow = nullptr;                                             ///< null: not asked for
  std::function<void(std::uint32_t pixel, double depth_m)> set_depth{};  ///< null: the same
};

class OpenPixels {
 public:
  /// `layout` and `views` must live as long as this object.
  OpenPixels(const CameraLayout& layout, const CameraViews& views, double near_m)
      : layout_(layout), views_(views), near_m_(near_m) {}

  /// Starts an image of this list, and adds the rays that it may take. `name` is that of the sensor.
  void begin(const DrawList& list, const std::string& name, FramePlan& plan);
  /// Reads drawn rows, as RoundEdges::add().
  void read(const Pass& pass, const View& view, const PassResult& result, std::uint32_t first_row) {
    edges_.add(pass, view, result, layout_.width_px, first_row);
  }
  /// Casts the pixels and sets them in the images. `rows` are all of the image, in the order of CameraMoment::rows;
  /// `caster`'s world is the list of `world`.
  void cast(RayCaster& caster, std::span<const PixelRows> rows, const IdentifiedList& world, const TruthImages& images);

  /// Number of rays since it was made.
  std::uint64_t rays() const { return rays_ ? rays_->rays() : 0; }

 private:
  const CameraLayout& layout_;
  const CameraViews& views_;
  double near_m_;
  RoundEdges edges_;
  std::optional<PixelRays> rays_;  // made when first needed
  std::vector<SeenSurface> seen_;  // by pixel; of those that were cast
};

}  // namespace simvis
