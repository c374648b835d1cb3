// Attributes that the caller writes over those of the scene.
#pragma once

#include <optional>
#include <string>

namespace simvis {

/// An attribute written over those of all sensors of one type, before the scene is built.
struct AttributeOverride {
  std::string sensor_type, attribute;
  std::optional<std::string> value;  ///< nothing: what the scene says is dropped, so that the default counts
  std::string origin;                ///< who asks for it, for messages: "--method"; empty: "SENSOR_TYPE.ATTRIBUTE"
};

}  // namespace simvis
