// Images of a sensor that stands alone, without a simulation.
#pragma once

#include <doctest/doctest.h>

#include <optional>
#include <string_view>

#include <simvis/sensor.h>

namespace simvis {

/// The image of this output, which the sensor must give.
inline Image image_of(const Sensor& sensor, std::string_view output) {
  const Measurement measurement = sensor.measurement();
  const MeasuredArray* const array = measurement.find(output);
  REQUIRE(array != nullptr);
  const std::optional<Image> image = to_image(*array);
  REQUIRE(image.has_value());
  return *image;
}
/// The number that the sensor computes when it is read.
inline double requested(const Sensor& sensor, std::string_view name) {
  const std::optional<double> value = Measurement{.on_request = sensor.on_request()}.value(name);
  REQUIRE(value.has_value());
  return *value;
}
inline Image color_of(const Sensor& camera) { return image_of(camera, "color"); }
inline Image depth_of(const Sensor& camera) { return image_of(camera, "depth"); }

}  // namespace simvis
