// A reader of EVT 3.0 that follows the document of the format.
#pragma once

#include <doctest/doctest.h>

#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

namespace simvis::test {

/// Time in microseconds, column, row, brighter.
using EventFields = std::tuple<std::int64_t, std::uint32_t, std::uint32_t, bool>;

/// Reads a stream piece by piece.
class Evt3Reader {
 public:
  std::vector<EventFields> read(std::span<const std::uint8_t> bytes) {
    std::vector<EventFields> events;
    for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
      const unsigned word = bytes[i] | bytes[i + 1] << 8, value = word & 0xfff;
      switch (word >> 12) {
        case 0x0:
          row_ = value & 0x7ff;
          break;
        case 0x2:
          events.emplace_back((turns_ << 24) + (high_ << 12) + low_, value & 0x7ff, row_, (value & 0x800) != 0);
          break;
        case 0x6:
          low_ = value;
          break;
        case 0x8:
          turns_ += value < high_;
          high_ = value;
          break;
        default:
          FAIL("a word of another kind");
      }
    }
    return events;
  }

 private:
  std::int64_t turns_ = 0, high_ = 0, low_ = 0;
  std::uint32_t row_ = 0;
};

}  // namespace simvis::test
