// What `simvis-run --describe` prints: the elements, sensors and effects that are registered, plug-ins' included, from
// the tables that also check the scene.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace simvis {

enum class ReferenceFormat : std::uint8_t { text, markdown };

/// All that is registered under this name; a name can be an element's and an effect's. "all": everything, as one page.
/// Throws InputError when there is nothing of this name; the message names the nearest one and lists all.
std::string type_reference(std::string_view name, ReferenceFormat format);

}  // namespace simvis
