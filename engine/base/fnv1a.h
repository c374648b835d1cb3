// The 64-bit hash FNV-1a (Fowler, Noll, Vo). It is fast for short keys and the same on every machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace simvis {

inline constexpr std::uint64_t kFnv1aStart = 0xcbf29ce484222325u;

/// The hash after one more word. FNV-1a proper has words of one byte; larger words are faster and give a different
/// hash.
constexpr std::uint64_t fnv1a_step(std::uint64_t hash, std::uint64_t word) { return (hash ^ word) * 0x100000001b3u; }

inline std::uint64_t fnv1a(const void* data, std::size_t size, std::uint64_t hash = kFnv1aStart) {
  const auto* const bytes = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < size; ++i) hash = fnv1a_step(hash, bytes[i]);
  return hash;
}

inline std::uint64_t fnv1a(std::string_view text) { return fnv1a(text.data(), text.size()); }

}  // namespace simvis
