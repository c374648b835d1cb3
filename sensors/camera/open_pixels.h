// The pixels of a drawn image that drawing leaves open, and that are cast after all: those near the outlines of round
// shapes, or all of these shapes where an output needs the point of the shape itself; those whose depth has no finite
// bound, if bounds are asked for; and, for flow, those on meshes that change their shape.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
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
  PixelFlow* flow = nullptr;                                           ///< null: not asked for
  std::function<void(std::uint32_t pixel, double depth_m)> set_depth;  ///< along Z
};

class OpenPixels {
 public:
  /// `layout` and `views` must live as long as this object.
  OpenPixels(const CameraLayout& layout, const CameraViews& views, double near_m)
      : layout_(layout), views_(views), near_m_(near_m) {}

  /// Starts an image of this list. Returns whether it has round shapes: its passes need items. `clouds`: whether pixels
  /// of solid clouds are cast, too; their squares are drawn otherwise, within the bound of depth.
  bool begin(const DrawList& list, bool clouds);
  /// Adds the rays that the image may take. `name` is that of the sensor.
  void plan(const std::string& name, FramePlan& plan) const;
  /// Reads drawn rows, as RoundEdges::add(). `depth_bounds_m` are those of these pixels, if any are asked for; the pass
  /// then has items.
  void read(const Pass& pass, const View& view, const PassResult& result, std::uint32_t first_row, bool whole,
            std::span<const double> depth_bounds_m);
  /// Casts the pixels and sets them in the images. `rows` are all of the image, in the order of CameraMoment::rows;
  /// `caster`'s world is the list of `world`.
  void cast(RayCaster& caster, std::span<const PixelRows> rows, const IdentifiedList& world, const TruthImages& images);

  /// The pixels of the last cast(), ascending, and the largest bound of their depths' errors.
  const std::shared_ptr<const std::vector<std::uint32_t>>& pixels() const { return pixels_; }
  double bound_m() const { return bound_m_; }

  /// Number of rays since it was made.
  std::uint64_t rays() const { return rays_ ? rays_->rays() : 0; }

 private:
  const CameraLayout& layout_;
  const CameraViews& views_;
  double near_m_;
  RoundEdges edges_;
  std::optional<PixelRays> rays_;  // made when first needed
  std::vector<SeenSurface> seen_;  // by pixel; of those that were cast
  bool round_ = false;             // the list has round shapes
  std::vector<std::uint32_t> unbounded_;
  std::shared_ptr<const std::vector<std::uint32_t>> pixels_ = std::make_shared<std::vector<std::uint32_t>>();
  double bound_m_ = 0;
};

}  // namespace simvis
