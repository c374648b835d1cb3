// Fast compression: what another library reads back, and its size against that of Huffman's codes.
#include "scenegraph/pictures/fast_zlib.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "tests/support/picture_files.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis {
namespace {

using PackedBytes = std::vector<std::uint8_t>;

constexpr std::size_t kBlockBytes = std::size_t{1} << 17;

std::uint32_t adler_by_definition(const PackedBytes& bytes) {
  constexpr std::uint32_t kPrime = 65521;
  std::uint32_t sum = 1, sums = 0;
  for (const std::uint8_t byte : bytes) {
    sum = (sum + byte) % kPrime;
    sums = (sums + sum) % kPrime;
  }
  return sums << 16 | sum;
}

bool comes_back(const PackedBytes& bytes) {
  const std::string stream = fast_zlib_of(bytes);
  std::uint32_t sum = 0;
  for (std::size_t i = stream.size() - 4; i < stream.size(); ++i) sum = sum << 8 | static_cast<std::uint8_t>(stream[i]);
  int size = 0;
  char* const read = stbi_zlib_decode_malloc(stream.data(), static_cast<int>(stream.size()), &size);
  const bool same = read != nullptr && static_cast<std::size_t>(size) == bytes.size() &&
                    std::equal(bytes.begin(), bytes.end(), reinterpret_cast<const std::uint8_t*>(read));
  stbi_image_free(read);
  return same && sum == adler_by_definition(bytes);
}

PackedBytes noise(std::size_t size) {
  std::mt19937 random(1);
  PackedBytes bytes(size);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

// Byte k with probability 2^-(k + 1), the last one as often as the one before it.
PackedBytes halves(std::size_t size, std::uint32_t last) {
  std::mt19937 random(2);
  PackedBytes bytes(size);
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(std::min<std::uint32_t>(std::countr_zero(random() | 1u << 31), last));
  }
  return bytes;
}

// The sizes are around those of a block and of the longest length. The counts of the third kind need more bits than a
// code may have. Runs begin at each place, and go on in the next block.
TEST_CASE("all bytes come back") {
  std::vector<std::size_t> sizes = {kBlockBytes - 1, kBlockBytes, kBlockBytes + 1, kBlockBytes + 9,
                                    3 * kBlockBytes + 77};
  for (std::size_t size = 1; size < 800; ++size) sizes.push_back(size);
  for (const std::size_t size : sizes) {
    CAPTURE(size);
    CHECK(comes_back(PackedBytes(size, 0)));
    CHECK(comes_back(noise(size)));
    CHECK(comes_back(halves(size, 31)));
    PackedBytes run = noise(size);
    std::fill(run.begin() + static_cast<std::ptrdiff_t>(size / 7), run.end() - static_cast<std::ptrdiff_t>(size / 5),
              9);
    CHECK(comes_back(run));
  }
}

TEST_CASE("sizes are those of Huffman's codes, and runs take almost nothing") {
  constexpr std::size_t kTableBytes = 300;  // of a block, at most
  constexpr std::size_t kStreamBytes = 6;   // before and after the blocks
  const PackedBytes bytes = halves(kBlockBytes, 7);
  double bits = 0;  // byte k has a code of k + 1 bits
  for (const std::uint8_t byte : bytes) bits += std::min(byte + 1, 7);
  CHECK(static_cast<double>(fast_zlib_of(bytes).size()) <= bits / 8 + kTableBytes + kStreamBytes);
  CHECK(fast_zlib_of(noise(kBlockBytes)).size() <= kBlockBytes + kTableBytes + kStreamBytes);
  constexpr std::size_t kRepetitionBits = 2;  // a length of one bit and the distance, of 258 bytes
  CHECK(fast_zlib_of(PackedBytes(kBlockBytes, 5)).size() <=
        kBlockBytes / 258 * kRepetitionBits / 8 + kTableBytes + kStreamBytes);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
