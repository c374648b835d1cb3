// The names of the rows of an attribute table, at compile time.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include <simvis/attributes.h>

namespace simvis {

template <std::size_t count>
constexpr std::array<std::string_view, count> names_of(const AttributeSpec (&rows)[count]) {
  std::array<std::string_view, count> names;
  for (std::size_t i = 0; i < count; ++i) names[i] = rows[i].name;
  return names;
}

}  // namespace simvis
