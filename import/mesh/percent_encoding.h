// The percent-encoding of URIs.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace simvis {

/// "a%20b" -> "a b". Empty if a percent sign is not followed by two hexadecimal digits.
std::optional<std::string> decode_percent(std::string_view uri);

}  // namespace simvis
