// One process's share of a run that many make together.
#pragma once

#include <cstdint>
#include <string>

namespace simvis {

/// The frames k of a run with k mod `count` = `index`.
struct Shard {
  std::uint64_t index = 0, count = 1;  ///< index < count

  bool has(std::uint64_t frame) const { return frame % count == index; }
  /// How many of `frames`, which are counted from 0.
  std::uint64_t share_of(std::uint64_t frames) const { return frames / count + (frames % count > index ? 1 : 0); }
  /// What sets the files of this shard apart from those of the others: "-3-of-8".
  std::string suffix() const;
};

/// From "K/N", 0 <= K < N. Throws InputError that says what was seen.
Shard parse_shard(const std::string& text);

}  // namespace simvis
