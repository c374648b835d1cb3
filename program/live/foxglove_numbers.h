// Numbers in binary messages of Foxglove's protocol, which are little-endian as those of the machine.
#pragma once

#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>

namespace simvis::live {

template <typename T>
void append_number(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

/// The number at an offset; all of it lies within the bytes.
template <typename T>
T number_at(std::string_view bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

}  // namespace simvis::live
