// Measures the beams of a scanner by rendering: virtual cameras of one resolution, and ranges from their depth.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <simvis/cost_model.h>
#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>
#include "sensors/laser_scanner/scan_layout.h"
#include "sensors/raster_depth/depth_atlas.h"
#include "sensors/raster_depth/depth_range.h"
#include "sensors/raster_depth/shape_ranges.h"
#include "sensors/raster_depth/vertex_rounding.h"

namespace simvis {

class RenderedScan {
 public:
  RenderedScan(const ScanPattern& pattern, double resolution_px);

  /// Adds the views to the depth atlas of this name. `purpose` follows "N beams of laser scanner NAME" in their
  /// reasons.
  void plan(const std::string& scanner, const std::string& purpose, const glm::dmat4& sensor_from_world,
            FramePlan& plan, const std::string& atlas);

  /// Reads the results of the views of plan(). The scan is valid as long as `results` are, and `shapes`, whose beams
  /// are numbered as below; null: the scene has none.
  void collect(const FramePlan& plan, std::span<const PassResult> results, const VertexRounding& rounding,
               const ShapeRanges* shapes = nullptr);

  /// The range of beam [ring * beams + beam].
  RangeEstimate planar(std::size_t beam) const;
  RangeEstimate nearest(std::size_t beam) const;

  /// The work of the collected frame, in a pass of its own.
  CostModel work(std::size_t list_items) const;

  const ScanLayout& layout() const { return layout_; }
  double resolution_px() const { return resolution_px_; }

 private:
  double resolution_px_;
  ScanLayout layout_;
  std::vector<AtlasPlace> places_;  // of each face, in this frame
  std::vector<FacePixels> pixels_;
  VertexRounding rounding_;
  const ShapeRanges* shapes_ = nullptr;
  ViewCounts counts_;  // of all faces
};

}  // namespace simvis
