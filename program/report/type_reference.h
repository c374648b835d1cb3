// The output of `simvis-run --describe` and `--list-types`: the registered elements, sensors and effects, including
// those of plug-ins. It comes from the same tables that validate the scene.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace simvis {

enum class ReferenceFormat : std::uint8_t { text, markdown, json };

/// The reference of all types registered under this name, or of the command of the scene language; an element and an
/// effect can have the same name. "all": every type, as one page, and in JSON every command too. Throws InputError if
/// no type has this name; the message gives the nearest name and lists all.
std::string type_reference(std::string_view name, ReferenceFormat format);

/// One line for each registered type: element, sensor or effect, its name, its summary.
std::string type_list();

}  // namespace simvis
