#include "scenegraph/collision_mask.h"

#include <limits>

#include "engine/base/words.h"

namespace simvis {

std::optional<std::uint32_t> parse_bitmask(std::string_view text) {
  text = trimmed(text);
  const bool is_hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  if (is_hexadecimal) text.remove_prefix(2);
  if (is_hexadecimal && text.starts_with('-')) return std::nullopt;
  const std::optional<std::int64_t> value = as_number<std::int64_t>(text, is_hexadecimal ? 16 : 10);
  if (!value || *value < std::numeric_limits<std::int32_t>::min() || *value > CollisionMask::kAll) return std::nullopt;
  return static_cast<std::uint32_t>(*value);
}

}  // namespace simvis
