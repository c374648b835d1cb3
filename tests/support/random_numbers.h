// Random whole numbers that are the same on every machine, for tests that break files.
#pragma once

#include <cstdint>

namespace simvis::test {

/// splitmix64.
class Random {
 public:
  explicit Random(std::uint64_t seed = 1) : state_(seed) {}

  /// 0 <= number < end; `end` above 0.
  std::uint64_t below(std::uint64_t end) {
    state_ += 0x9E3779B97F4A7C15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return (z ^ (z >> 31)) % end;
  }

 private:
  std::uint64_t state_;
};

}  // namespace simvis::test
