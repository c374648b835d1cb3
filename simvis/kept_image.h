// An image that stays as it is while the simulation goes on.
#pragma once

#include <functional>
#include <memory>

#include "engine/base/program_api.h"
#include "scenegraph/image_span.h"

namespace simvis {

struct BuiltSensor;

struct KeptImage {
  ImageSpan image;
  std::shared_ptr<const void> kept;  ///< while a copy of it lives, the image stays; any thread may let it go
};

/// Keeps an image that the sensor gives to a sink where it is: `keep` is Simulation::keep() of this sensor. A sensor of
/// a plug-in may have made the image for this call, so its images are copied, and `keep` is not called.
SIMVIS_PROGRAM_API KeptImage keep_image(const BuiltSensor& sensor, const Image& image,
                                        const std::function<std::shared_ptr<const void>()>& keep);

}  // namespace simvis
