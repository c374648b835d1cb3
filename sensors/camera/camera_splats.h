// Gaussian splats in the images of a camera, in front of and between what is drawn.
//
// Pixels   A pixel shows the splats on the ray through its centre, see engine/splats/splat_rays.h, whatever lens the
//          camera has and whatever samples its colour takes. What is drawn at the pixel's centre hides those behind it.
// Colour   What the splats add, and what shines through them of the drawn colour, before all effects on images.
// Surface  Where less than half of the light shines through the splats in front of the drawn surface, depth, range and
//          ids are those of the splat at that half; its item is that of the part. It has no normal, no coordinates and
//          no bound, and the surface behind it is not seen in boxes.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/splats/splat_rays.h"
#include "sensors/camera/pixel_rays.h"
#include "sensors/camera/pixel_truth.h"

namespace simvis {

/// Lists rays through the splats of a list in the plan, and their effect once for each sensor. `rays` names them for
/// people: "the centre of each pixel of camera CAM".
void plan_splat_rays(const DrawList& list, const std::string& rays, std::uint64_t max_rays, const std::string& sensor,
                     FramePlan& plan);

class CameraSplats {
 public:
  /// `views` are those of the layout.
  CameraSplats(const CameraLayout& layout, const CameraViews& views, double near_m);

  /// Lists the rays in the plan. `title` names the image for people: "camera CAM".
  void plan(const DrawList& list, const std::string& title, const std::string& sensor, FramePlan& plan) const;

  /// Looks at the splats of the list, on so many threads. `rows` are all of the image. `depth` is that of what is
  /// drawn.
  void look(const DrawList& list, std::span<const PixelRows> rows, const Image& depth, unsigned threads);

  /// Change images of the surfaces that look() got, or these surfaces by pixel.
  void add_to_color(Image& color) const;
  void add_to_depth(Image& depth) const;
  void add_to_disparity(Image& disparity, double disparity_times_depth) const;
  void add_to_truth(PixelTruth& truth, const IdentifiedList& world) const;
  void add_to_surfaces(std::span<SeenSurface> seen) const;

  /// Whether a pixel of the last look() has a splat's colour.
  bool in_color() const;
  /// Whether depths of the last look() are those of splats.
  bool in_depth() const;

 private:
  PixelRays rays_;
  std::uint32_t width_px_;
  std::vector<double> end_m_;  // by pixel, as sights_
  std::vector<SplatSight> sights_;
};

}  // namespace simvis
