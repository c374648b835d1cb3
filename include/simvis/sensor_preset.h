// Devices that one can buy, as attributes of a sensor type.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include <simvis/attributes.h>
#include <simvis/command.h>

namespace simvis {

struct SensorType;

struct PresetAttribute {
  std::string_view name, value;  ///< as one writes them in a command
};

struct SensorPreset {
  std::string_view name;     ///< what the attribute `preset` says: "sick_lms200"
  std::string_view summary;  ///< the device, and which of its settings
  std::string_view source;   ///< data sheets: title, revision, where in it
  std::span<const PresetAttribute> attributes;
};

/// The row `preset`, for the table of a sensor type that has some.
inline constexpr AttributeSpec kPresetAttribute{
    .name = "preset",
    .kind = AttributeKind::text,
    .text = "a device, see below, whose values hold for attributes that are not given; default: none"};

/// The command without its attribute `preset`, and with what this says of attributes that the command does not write
/// itself; their place is that of `preset`. Throws InputError there: the type has no preset of that name.
Command with_preset(Command command, const SensorType& type);

/// The presets of a type as `--describe` prints them; empty where it has none.
std::string describe_presets(const SensorType& type);

}  // namespace simvis
