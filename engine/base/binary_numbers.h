// Numbers as bytes of files and messages: little-endian, one after the other without gaps.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstring>
#include <iterator>
#include <span>
#include <string>
#include <type_traits>

#include "engine/base/assert.h"

namespace simvis {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie in memory");

/// Appends a number or a struct of numbers.
template <typename Number>
requires std::is_trivially_copyable_v<Number>
void append_binary(std::string& bytes, const Number& value) {
  char raw[sizeof(Number)];
  std::memcpy(raw, &value, sizeof(Number));
  bytes.append(raw, sizeof(Number));
}

/// Appends the lowest `count` bytes of a whole number.
template <std::unsigned_integral Number>
void append_lowest(std::string& bytes, Number value, std::size_t count) {
  SIMVIS_ASSERT(count <= sizeof(Number));
  append_binary(bytes, value);
  bytes.resize(bytes.size() - sizeof(Number) + count);
}

/// Appends several numbers or structs of numbers.
template <typename Number>
void append_binary_all(std::string& bytes, std::span<const Number> values) {
  static_assert(std::is_trivially_copyable_v<Number>);
  if (!values.empty()) bytes.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}

/// The number at an offset of a contiguous range of bytes, which must hold all of it.
template <typename Number, typename Bytes>
Number binary_at(const Bytes& bytes, std::size_t offset) {
  static_assert(std::is_trivially_copyable_v<Number> && sizeof(*std::data(bytes)) == 1);
  SIMVIS_ASSERT(offset <= std::size(bytes) && sizeof(Number) <= std::size(bytes) - offset);
  Number value;
  std::memcpy(&value, std::data(bytes) + offset, sizeof(Number));
  return value;
}

}  // namespace simvis
