// The share of one process in a run that several processes execute together.
#pragma once

#include <cstdint>
#include <string>

namespace simvis {

/// The frames k of a run for which k mod `count` = `index`.
struct Shard {
  std::uint64_t index = 0, count = 1;  ///< index < count

  bool has(std::uint64_t frame) const { return frame % count == index; }
  /// The number of frames of the shard among the frames 0 to `frames` - 1.
  std::uint64_t share_of(std::uint64_t frames) const { return frames / count + (frames % count > index ? 1 : 0); }
  /// A suffix that distinguishes the files of this shard from those of other shards: "-3-of-8".
  std::string suffix() const;
};

/// Parses "K/N" with 0 <= K < N. Throws InputError with the given text if it is invalid.
Shard parse_shard(const std::string& text);

}  // namespace simvis
