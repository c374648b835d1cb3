// All surfaces that the ray through each pixel's centre passes, from the first on: their ranges, their items, and the
// share of their light that arrives through those before them.
//
// A surface counts if it covers more than half a step of 8-bit alpha of what lies behind it. The last layer of a pixel
// is one that nothing shines through, or the last of as many as are asked for. Two surfaces at the same range, but
// for its rounding, count once. A pane with two faces is two layers.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/measurement.h>
#include "sensors/camera/moved_world.h"
#include "sensors/camera/pixel_rays.h"
#include "sensors/camera/surface_layer.h"
#include "sensors/camera/surface_rays.h"

namespace simvis {

inline constexpr AttributeSpec kMaxLayersAttribute{.name = "max_layers",
                                                   .kind = AttributeKind::integer,
                                                   .default_value = "4",
                                                   .text = "layers of each pixel, with layers among outputs",
                                                   .min = 1,
                                                   .max = 64};

/// The number of layers that are asked for; 0: none.
std::uint32_t wanted_layers(const AttributeValues& attributes);

/// The outputs of one view; `prefix` stands in front of their names.
std::vector<OutputSpec> layer_outputs(const std::string& prefix, const AttributeValues& attributes);

/// The layers of one view.
class PixelLayers {
 public:
  PixelLayers(std::uint32_t layers, std::uint32_t width_px, std::uint32_t height_px);

  /// Starts an image of this list, which must live until its last cast(). `instance` as in ItemIds.
  void begin(const DrawList& list, std::span<const std::uint32_t> instance);
  /// Casts the pixels of these rows on so many threads.
  void cast(const PixelRows& rows, const PixelRays& rays, unsigned threads);

  /// The images, in the order of layer_outputs(), without numbers before the first begin().
  void add_to(Measurement& measurement, const std::string& prefix, const std::string& view) const;

 private:
  // A ray on its way.
  struct Passing {
    std::uint32_t pixel = 0;
    double behind_m = 0;
    float transmission = 1;  // of all layers so far
  };
  void cast_layer(std::uint32_t layer, const DrawList& first, const glm::dmat4& world_from_view, const PixelRays& rays);
  double covered(const DrawList& first, const SeenSurface& surface, const glm::dmat4& world_from_view,
                 const glm::dvec3& direction) const;

  std::uint32_t layers_, width_px_, height_px_;
  const DrawList* list_ = nullptr;
  std::span<const std::uint32_t> instance_;
  LayerList first_{SurfaceLayer::first};
  MovedWorld world_;
  SurfaceRays surface_rays_;
  std::vector<Passing> passing_;
  std::vector<glm::dvec3> directions_;  // by ray on its way, as the next two
  std::vector<double> behind_m_;
  std::vector<SeenSurface> met_;
  SharedArray<float> range_, transmission_;
  SharedArray<std::uint32_t> instances_;
};

}  // namespace simvis
