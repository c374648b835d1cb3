// Small glTF files, written by tests from the values that they then expect to find.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "tests/support/parts/loaded_part.h"
#include "tests/support/temporary_folder.h"

namespace simvis::test {

using nlohmann::json;
using ByteString = std::vector<std::uint8_t>;

void write_bytes(const std::filesystem::path& file, const ByteString& bytes);

std::string base64(const ByteString& bytes);

void put_u32(ByteString& bytes, std::uint32_t value, bool big_endian);

/// A PNG of `rows` that already hold packed samples, stored without compression.
ByteString png(std::uint32_t width, std::uint32_t height, int bit_depth, int color_type,
               const std::vector<ByteString>& rows);

/// glTF's names for component types.
enum Component { kByte = 5120, kUByte = 5121, kShort = 5122, kUShort = 5123, kUInt = 5125, kFloat = 5126 };

template <class T>
constexpr int component_of() {
  if constexpr (std::is_same_v<T, std::int8_t>) return kByte;
  if constexpr (std::is_same_v<T, std::uint8_t>) return kUByte;
  if constexpr (std::is_same_v<T, std::int16_t>) return kShort;
  if constexpr (std::is_same_v<T, std::uint16_t>) return kUShort;
  if constexpr (std::is_same_v<T, std::uint32_t>) return kUInt;
  if constexpr (std::is_same_v<T, float>) return kFloat;
}

/// A glTF document under construction: `root` is open to every change.
class GltfBuilder {
 public:
  json root;
  ByteString bytes;

  GltfBuilder();

  int view(const void* data, std::size_t size);

  template <class T>
  int accessor(const char* type, const std::vector<T>& values, bool normalized = false) {
    return accessor_of(component_of<T>(), type, values.data(), values.size(), sizeof(T), normalized);
  }

  int append(const char* array, json value);

  /// A mesh of one primitive, and a node that shows it.
  json& primitive(json attributes);

  /// A triangle of three points, shown by a node.
  json& triangle();

  std::string text() const;

  ByteString glb() const;

 private:
  int accessor_of(int component, const char* type, const void* values, std::size_t count, std::size_t size,
                  bool normalized);
};

}  // namespace simvis::test
