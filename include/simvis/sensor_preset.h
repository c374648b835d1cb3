// Presets: commercially available devices as attributes of a sensor type.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include <simvis/attributes.h>
#include <simvis/command.h>

namespace simvis {

struct SensorType;

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
};

/// The row `preset`, for the table of a sensor type that has presets.
inline constexpr AttributeSpec kPresetAttribute{
    .name = "preset",
    .kind = AttributeKind::text,
    .text = "a device, see below, whose values hold for attributes that are not given; default: none"};

/// Expands the attribute `preset`: the result has the preset's attributes where the command does not write them itself,
/// with the place of `preset`, and has no attribute `preset`.
///
/// Errors   InputError at the attribute if the type has no preset of that name.
Command with_preset(Command command, const SensorType& type);

/// The presets of a type as `--describe` prints them; empty if it has none.
std::string describe_presets(const SensorType& type);

}  // namespace simvis
