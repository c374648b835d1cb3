// The compression LZF, in which PCD files hold points.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace simvis {

/// The data that `compressed` stands for, or nothing if they are not `size` bytes. It consists of runs: a byte n below
/// 32 is followed by n + 1 bytes that stand for themselves; any other byte has a length in its upper three bits, 7 for
/// 7 plus the next byte, and begins a distance of 13 bits with its lower five: so many bytes and two more repeat those
/// that lie the distance and one before.
std::optional<std::vector<std::uint8_t>> lzf_data(std::span<const std::uint8_t> compressed, std::size_t size);

}  // namespace simvis
