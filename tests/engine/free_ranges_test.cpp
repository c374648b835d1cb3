#include "engine/base/free_ranges.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "tests/support/random_numbers.h"

TEST_SUITE_BEGIN("engine");

using namespace simvis;

namespace {

/// The same block, byte by byte.
class Bytes {
 public:
  explicit Bytes(std::size_t size) : taken_(size, 0) {}

  bool has_room(std::uint64_t size, std::uint64_t alignment) const {
    std::uint64_t run = 0;  // free bytes from an aligned place on
    for (std::size_t i = 0; i < taken_.size(); ++i) {
      if (taken_[i]) {
        run = 0;
      } else if (run > 0 || i % alignment == 0) {
        if (++run == size) return true;
      }
    }
    return false;
  }
  /// False when one of these bytes is not as expected.
  bool set(std::uint64_t first, std::uint64_t size, bool taken) {
    if (first + size > taken_.size()) return false;
    const auto begin = taken_.begin() + static_cast<std::ptrdiff_t>(first),
               end = begin + static_cast<std::ptrdiff_t>(size);
    if (std::find(begin, end, taken ? 1 : 0) != end) return false;
    std::fill(begin, end, taken ? 1 : 0);
    return true;
  }
  std::uint64_t free_bytes() const { return static_cast<std::uint64_t>(std::ranges::count(taken_, 0)); }
  std::size_t free_runs() const {
    std::size_t runs = 0;
    for (std::size_t i = 0; i < taken_.size(); ++i) runs += !taken_[i] && (i == 0 || taken_[i - 1]);
    return runs;
  }

 private:
  std::vector<std::uint8_t> taken_;
};

struct Taken {
  std::uint64_t first, size;
};

}  // namespace

TEST_CASE("ranges come from the smallest free range that fits, the first among equal ones") {
  FreeRanges free(100);
  CHECK(free.take(40, 1) == 0u);
  CHECK(free.take(20, 1) == 40u);
  CHECK(free.take(30, 1) == 60u);
  free.give_back(0, 40);  // free now: 0 to 40, and 90 to 100
  CHECK(free.take(10, 1) == 90u);
  CHECK(free.take(41, 1) == std::nullopt);
  CHECK(free.take(40, 1) == 0u);
  CHECK(free.free_bytes() == 0);
  CHECK(free.take(1, 1) == std::nullopt);
}

TEST_CASE("bytes skipped for alignment stay free") {
  FreeRanges free(128);
  CHECK(free.take(3, 1) == 0u);
  CHECK(free.take(64, 64) == 64u);
  CHECK(free.free_bytes() == 61);
  CHECK(free.take(62, 1) == std::nullopt);
  CHECK(free.take(61, 1) == 3u);
}

TEST_CASE("a hundred thousand random calls never return a byte twice, and find room whenever there is any") {
  constexpr std::uint64_t kSize = 4096;
  constexpr int kCalls = 100'000;
  test::Random random(17);
  const auto below = [&](std::uint64_t end) { return random.below(end); };
  FreeRanges free(kSize);
  Bytes bytes(kSize);
  std::vector<Taken> taken;
  int refused = 0, given_back = 0;
  for (int call = 0; call < kCalls; ++call) {
    // Phases in which the block fills, and phases in which it runs empty.
    const bool filling = (call / 500) % 2 == 0;
    if (below(10) < (filling ? 6u : 4u)) {
      const std::uint64_t size = 1 + below(below(4) == 0 ? 400 : 40), alignment = std::uint64_t{1} << below(8);
      const std::optional<std::uint64_t> first = free.take(size, alignment);
      if (!first) {
        ++refused;
        REQUIRE(!bytes.has_room(size, alignment));
        continue;
      }
      REQUIRE(*first % alignment == 0);
      REQUIRE(bytes.set(*first, size, true));
      taken.push_back({*first, size});
    } else if (!taken.empty()) {
      std::swap(taken[below(taken.size())], taken.back());
      free.give_back(taken.back().first, taken.back().size);
      REQUIRE(bytes.set(taken.back().first, taken.back().size, false));
      taken.pop_back();
      ++given_back;
    }
    if (call % 50 != 0) continue;
    REQUIRE(free.free_bytes() == bytes.free_bytes());
    REQUIRE(free.count() == bytes.free_runs());
    REQUIRE(free.all_free() == taken.empty());
  }
  CHECK(refused > kCalls / 100);
  CHECK(given_back > kCalls / 4);
  for (const Taken& each : taken) free.give_back(each.first, each.size);
  CHECK(free.all_free());
  CHECK(free.count() == 1);
  CHECK(free.take(kSize, kSize) == 0u);
}

TEST_SUITE_END();
