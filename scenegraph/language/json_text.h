// Names of files as texts of JSON: JSON holds UTF-8 alone, and a name may have any bytes.
#pragma once

#include <string>
#include <string_view>

#include "engine/base/program_api.h"

namespace simvis {

/// Returns the text with each byte that belongs to no character as U+FFFD and two hexadecimal digits, and so the bytes
/// of each U+FFFD, so that the bytes can be read back. Other texts stay as they are.
SIMVIS_PROGRAM_API std::string to_json_text(std::string_view bytes);

/// The bytes that to_json_text() has made the text from.
SIMVIS_PROGRAM_API std::string from_json_text(std::string_view text);

}  // namespace simvis
