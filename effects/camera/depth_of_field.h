// The effect `depth_of_field`: a lens with an opening, which is sharp at one distance.
//
//   <sensor type="camera" ... aperture="0.004" focus_distance="1.5" lens_samples="64"/>
//
// Model    A thin lens of the diameter `aperture` A, focused at the depth F. A point at the depth Z is spread evenly
//          over a circle of the diameter fx A |1 / Z - 1 / F| pixels: the sum of the pictures that all points of the
//          lens see, each sheared so that the plane at F stays where it is. The picture is the mean, in linear light,
//          of `lens_samples` of them, from points that fill the lens evenly. Depth and truth are those of the centre.
// Error    With n points the picture of an edge errs by less than 1 / (2 sqrt(n)), the standard deviation of random
//          points.
// Limits   No diffraction, no aberrations. A camera refuses it with a fisheye that takes several views (see
//          sensors/camera/camera_views.h).
#pragma once

#include <cstdint>

#include <simvis/camera_effect.h>
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

struct ThinLens {
  double aperture_m = 0;       ///< diameter
  double focus_m = 1;          ///< depth, above 0
  std::uint32_t samples = 64;  ///< points of the lens
  Location at{},               ///< where the aperture was written, for messages
      samples_at{};            ///< where the number of samples was written

  static AttributeRows<ThinLens> rows();
};

class DepthOfField : public CameraEffect {
 public:
  explicit DepthOfField(const ThinLens& lens) : lens_(lens) {}

  void configure_rays(CameraLayout& layout) const override;

 private:
  ThinLens lens_;
};

}  // namespace simvis
