#include "simvis/kept_image.h"

#include "simvis/library_of.h"
#include "simvis/scene_builder.h"

namespace simvis {

KeptImage keep_image(const BuiltSensor& sensor, const Image& image,
                     const std::function<std::shared_ptr<const void>()>& keep) {
  if (is_of_the_library(*find_sensor_type(sensor.type))) return {image, keep()};
  const auto copy = std::make_shared<const Image>(image);
  return {*copy, copy};
}

}  // namespace simvis
