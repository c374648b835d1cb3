// CDR (XCDR version 1, little-endian): the bytes of a ROS 2 message as DDS and MCAP carry them.
//
// Bytes    four bytes of encapsulation (0, 1, 0, 0), then the fields in order. A number of n bytes lies at a
//          multiple of n, counted from behind the encapsulation. A string is its length with the final zero as uint32,
//          its bytes, and the zero; a sequence is its length as uint32 and its elements.
// Errors   decode() throws InputError with the type, the byte and what is wrong there. It never allocates more than a
//          small multiple of the input's size.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "exchange/messages/field.h"

namespace simvis::ros {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie in memory");

template <typename T>
concept Number = std::integral<T> || std::floating_point<T> || std::same_as<T, std::byte>;

inline constexpr std::string_view kEncapsulation{"\0\1\0\0", 4};

/// Appends to a string.
class CdrEncoder {
 public:
  explicit CdrEncoder(std::string& bytes) : bytes_(bytes) {
    bytes_ += kEncapsulation;
    start_ = bytes_.size();
  }

  template <Number T>
  void add(const T& value) {
    align(sizeof(T));
    append(&value, sizeof(T));
  }
  void add(const std::string& text) {
    add(static_cast<std::uint32_t>(text.size() + 1));
    append(text.c_str(), text.size() + 1);
  }
  template <typename T, std::size_t kCount>
  void add(const std::array<T, kCount>& values) {
    add_elements(values);
  }
  template <typename T>
  void add(const std::vector<T>& values) {
    add(static_cast<std::uint32_t>(values.size()));
    add_elements(values);
  }
  template <Message M>
  void add(const M& message) {
    for_each_field(message, [this](const auto& value) { this->add(value); });
  }

 private:
  void align(std::size_t size) { bytes_.append((start_ - bytes_.size()) & (size - 1), '\0'); }
  void append(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }

  template <typename Values>
  void add_elements(const Values& values) {
    using T = typename Values::value_type;
    if constexpr (Number<T> && !std::same_as<Values, std::vector<bool>>) {
      if (values.empty()) return;  // without elements there is nothing to align
      align(sizeof(T));
      append(values.data(), values.size() * sizeof(T));
    } else {
      for (const T& value : values) add(value);
    }
  }

  std::string& bytes_;
  std::size_t start_;
};

class CdrDecoder {
 public:
  /// `type` is for messages. Both must outlive the decoder.
  CdrDecoder(std::string_view bytes, std::string_view type);

  template <Number T>
  void read(T& value) {
    align(sizeof(T));
    if constexpr (std::same_as<T, bool>) {
      value = read_bool();
    } else {
      std::memcpy(&value, take(sizeof(T)), sizeof(T));
    }
  }
  void read(std::string& text);
  template <typename T, std::size_t kCount>
  void read(std::array<T, kCount>& values) {
    for (T& value : values) read(value);
  }
  template <typename T>
  void read(std::vector<T>& values) {
    std::uint32_t count = 0;
    read(count);
    values.clear();
    if constexpr (Number<T> && !std::same_as<T, bool>) {
      if (count == 0) return;
      align(sizeof(T));
      require(count, sizeof(T));
      values.resize(count);
      std::memcpy(values.data(), take(count * sizeof(T)), count * sizeof(T));
    } else {
      require(count, 1);
      for (; count > 0; --count) {
        T value{};
        read(value);
        values.push_back(std::move(value));
      }
    }
  }
  template <Message M>
  void read(M& message) {
    for_each_field(message, [this](auto& value) { this->read(value); });
  }
  /// Throws if more than the padding of a message is left.
  void finish() const;

 private:
  void align(std::size_t size);
  bool read_bool();
  const char* take(std::size_t size);
  void require(std::size_t count, std::size_t size) const;
  [[noreturn]] void fail(const std::string& what) const;

  std::string_view body_, type_;
  std::size_t at_ = 0;
};

template <Message M>
void encode(const M& message, std::string& bytes) {
  CdrEncoder(bytes).add(message);
}
template <Message M>
std::string encode(const M& message) {
  std::string bytes;
  encode(message, bytes);
  return bytes;
}

/// Throws InputError as above.
template <Message M>
M decode(std::string_view bytes) {
  CdrDecoder decoder(bytes, M::kName);
  M message;
  decoder.read(message);
  decoder.finish();
  return message;
}

}  // namespace simvis::ros
