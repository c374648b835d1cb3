// Presets: devices that one can buy, as attributes of a sensor type.
#pragma once

#include <span>
#include <string_view>

#include <simvis/attributes.h>

namespace simvis {

/// One attribute of a preset.
struct PresetAttribute {
  std::string_view name,  ///< as in a command
      value;              ///< as in a command
};

/// A device, as attributes of a sensor type. The strings live as long as the type.
struct SensorPreset {
  std::string_view name;                        ///< the value of the attribute `preset`: "sick_lms200"
  std::string_view summary;                     ///< the device, and which of its settings
  std::string_view source;                      ///< data sheets: title, revision, place in it
  std::span<const PresetAttribute> attributes;  ///< its attributes
  /// On which conditions the limits hold, what kind each error is, and what the source does not say: sentences.
  std::string_view notes{};
};

/// The row `preset`, for the table of a sensor type that has presets.
inline constexpr AttributeSpec kPresetAttribute{
    .name = "preset",
    .kind = AttributeKind::text,
    .text = "a device (see below) that sets the defaults of other attributes; default: none"};

}  // namespace simvis
