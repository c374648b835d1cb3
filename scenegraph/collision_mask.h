// Which surfaces collide with which, by 32 bits each.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace simvis {

/// The bits that one surface has, and those with which it collides: MuJoCo's contype and conaffinity, SDF's
/// <category_bitmask> and <collide_bitmask>. All are set where nothing is said.
struct CollisionMask {
  static constexpr std::uint32_t kAll = 0xFFFFFFFF;
  std::uint32_t category = kAll, collides = kAll;

  bool operator==(const CollisionMask&) const = default;
  /// MuJoCo's rule: the category of one surface has a bit with which the other one collides.
  constexpr bool meets(const CollisionMask& other) const {
    return (category & other.collides) != 0 || (other.category & collides) != 0;
  }
};

/// What parse_bitmask() reads, for messages.
inline constexpr std::string_view kBitmaskExpected =
    "a whole number from -2147483648 to 4294967295, or 0x and hexadecimal digits";

/// Reads 32 bits: a decimal number, where -1 is all bits, or a hexadecimal one after 0x; only white space may surround
/// it. Empty: any other text.
std::optional<std::uint32_t> parse_bitmask(std::string_view text);

}  // namespace simvis
