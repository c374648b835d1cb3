#include "scenegraph/pictures/fast_zlib.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "scenegraph/pictures/deflate.h"

// RFC 1950 and 1951 describe the format.
namespace simvis {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 17;
constexpr std::size_t kMinRun = 8, kMinLength = 3, kMaxLength = 258;
constexpr std::size_t kEnd = 256, kSymbols = 286, kCodeLengths = 19;
constexpr std::size_t kMaxCodeBits = 12, kMaxLengthBits = 7;
// Enough for all that a block has beside the codes of its bytes.
constexpr std::size_t kBlockFront = 8 + (kCodeLengths * 3 + (kSymbols + 1) * kMaxLengthBits + kMaxCodeBits) / 8;

/// Appends numbers bit by bit, the lowest bit first. Between two calls of flush() there is space for 57 bits.
struct BitWriter {
  std::uint8_t* to;
  std::uint64_t word = 0;
  std::size_t bits = 0;

  void add(std::uint64_t number, std::size_t count) {
    word |= number << bits;
    bits += count;
  }
  // Writes eight bytes, of which those with bits count.
  void flush() {
    static_assert(std::endian::native == std::endian::little, "the lowest byte comes first");
    std::memcpy(to, &word, sizeof word);
    to += bits / 8;
    word >>= bits / 8 * 8;
    bits %= 8;
  }
};

struct Code {
  std::uint32_t bits = 0;  // the first one is the lowest
  std::uint32_t length = 0;

  void add_to(BitWriter& writer) const { writer.add(bits, length); }
};

/// The depths of the leaves of Huffman's tree. `weights` ascends and has at least two numbers.
std::vector<std::uint32_t> leaf_depths(std::span<const std::uint64_t> weights) {
  const std::size_t leaves = weights.size(), nodes = 2 * leaves - 1;
  std::vector<std::uint64_t> weight(weights.begin(), weights.end());
  std::vector<std::size_t> parent(nodes);
  std::size_t leaf = 0, inner = leaves;
  while (weight.size() < nodes) {  // inner nodes ascend too
    std::uint64_t sum = 0;
    for (int child = 0; child < 2; ++child) {
      const bool take_leaf = leaf < leaves && (inner == weight.size() || weight[leaf] <= weight[inner]);
      const std::size_t taken = take_leaf ? leaf++ : inner++;
      parent[taken] = weight.size();
      sum += weight[taken];
    }
    weight.push_back(sum);
  }
  std::vector<std::uint32_t> depth(nodes);
  for (std::size_t node = nodes - 1; node-- > 0;) depth[node] = depth[parent[node]] + 1;
  depth.resize(leaves);
  return depth;
}

/// Huffman codes of at most `limit` bits. Two counts at least are not 0; those that are 0 get no code. Where the tree
/// is too deep, counts are halved until it fits: that costs little, as such symbols are rare.
std::vector<Code> huffman_codes(std::span<const std::uint32_t> counts, std::size_t limit) {
  std::vector<std::pair<std::uint64_t, std::size_t>> used;
  for (std::size_t symbol = 0; symbol < counts.size(); ++symbol) {
    if (counts[symbol] > 0) used.emplace_back(counts[symbol], symbol);
  }
  SIMVIS_ASSERT(used.size() >= 2 && used.size() <= std::size_t{1} << limit);
  std::vector<Code> codes(counts.size());
  std::uint32_t deepest = 0;
  do {
    std::sort(used.begin(), used.end());
    std::vector<std::uint64_t> weights;
    for (auto& [weight, symbol] : used) {
      weights.push_back(weight);
      weight = (weight + 1) / 2;
    }
    const std::vector<std::uint32_t> depths = leaf_depths(weights);
    for (std::size_t i = 0; i < used.size(); ++i) codes[used[i].second].length = depths[i];
    deepest = *std::max_element(depths.begin(), depths.end());
  } while (deepest > limit);
  std::uint32_t next = 0;
  for (std::uint32_t length = 1; length <= deepest; ++length, next <<= 1) {
    for (Code& code : codes) {
      if (code.length != length) continue;
      for (std::uint32_t bit = 0; bit < length; ++bit) code.bits |= (next >> bit & 1) << (length - 1 - bit);
      ++next;
    }
  }
  return codes;
}

/// The symbol of a length, and the bits that follow it.
struct Length {
  std::size_t symbol;
  std::uint32_t extra = 0, extra_bits = 0;
};

Length length_of(std::size_t length) {
  if (length == kMaxLength) return {kSymbols - 1};
  const auto above = static_cast<std::uint32_t>(length - kMinLength);
  const auto width = static_cast<std::uint32_t>(std::bit_width(above));
  const std::uint32_t extra_bits = width > 3 ? width - 3 : 0;
  return {kEnd + 1 + 4 * extra_bits + (above >> extra_bits), above & ((1u << extra_bits) - 1), extra_bits};
}

/// A repetition of the byte before it.
struct Repetition {
  std::size_t begin, length;
};

/// One block of the bytes, as the compressor stores it.
struct Block {
  std::size_t begin, end;
  std::vector<Repetition> repetitions;
  std::array<std::uint32_t, kSymbols> counts{};
};

// Cuts a run into lengths that the format has.
void add_run(std::size_t begin, std::size_t end, Block& block) {
  while (begin < end) {
    const std::size_t left = end - begin;
    const std::size_t length = left <= kMaxLength ? left : std::min(kMaxLength, left - kMinLength);
    block.repetitions.push_back({begin, length});
    ++block.counts[length_of(length).symbol];
    begin += length;
  }
}

Block block_of(std::span<const std::uint8_t> bytes, std::size_t begin) {
  Block block{begin, std::min(bytes.size(), begin + kBlock), {}};
  // Several tables, so that the count of a byte does not wait for that of an equal one before it.
  std::array<std::array<std::uint32_t, 256>, 4> counts{};
  std::size_t i = begin;
  while (i + kMinRun <= block.end) {
    std::uint64_t word = 0;
    std::memcpy(&word, &bytes[i], sizeof word);
    if (i > 0 && word == 0x0101010101010101u * bytes[i - 1]) {
      std::size_t end = i + kMinRun;
      while (end < block.end && bytes[end] == bytes[i]) ++end;
      add_run(i, end, block);
      i = end;
    } else {
      for (std::size_t k = 0; k < kMinRun; ++k) ++counts[k % 4][bytes[i + k]];
      i += kMinRun;
    }
  }
  for (; i < block.end; ++i) ++counts[0][bytes[i]];
  for (std::size_t byte = 0; byte < 256; ++byte) {
    for (const auto& each : counts) block.counts[byte] += each[byte];
  }
  block.counts[kEnd] = 1;
  return block;
}

// The table of codes: their lengths, in codes of their own.
void add_table(const std::vector<Code>& codes, BitWriter& writer) {
  constexpr std::size_t kDistanceBits = 1;  // of the only distance
  constexpr std::size_t kOrder[kCodeLengths] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
  std::array<std::uint32_t, kCodeLengths> counts{};
  for (const Code& code : codes) ++counts[code.length];
  ++counts[kDistanceBits];
  const std::vector<Code> lengths = huffman_codes(counts, kMaxLengthBits);
  writer.add(kSymbols - 257, 5);
  writer.add(0, 5);  // one distance
  writer.add(kCodeLengths - 4, 4);
  for (const std::size_t length : kOrder) {
    writer.add(lengths[length].length, 3);
    writer.flush();
  }
  for (const Code& code : codes) {
    lengths[code.length].add_to(writer);
    writer.flush();
  }
  lengths[kDistanceBits].add_to(writer);
  writer.flush();
}

void add_literals(std::span<const std::uint8_t> bytes, const std::vector<Code>& codes, BitWriter& to) {
  BitWriter writer = to;  // a copy stays in registers
  constexpr std::size_t kAtOnce = 4;
  static_assert(kAtOnce * kMaxCodeBits <= 57 - 8);
  std::size_t i = 0;
  for (; i + kAtOnce <= bytes.size(); i += kAtOnce) {
    for (std::size_t k = 0; k < kAtOnce; ++k) codes[bytes[i + k]].add_to(writer);
    writer.flush();
  }
  for (; i < bytes.size(); ++i) {
    codes[bytes[i]].add_to(writer);
    writer.flush();
  }
  to = writer;
}

void add_block(const Block& block, std::span<const std::uint8_t> bytes, BitWriter& writer) {
  const std::vector<Code> codes = huffman_codes(block.counts, kMaxCodeBits);
  writer.add(block.end == bytes.size() ? 1 : 0, 1);  // the last block
  writer.add(2, 2);                                  // codes of its own
  add_table(codes, writer);
  std::size_t done = block.begin;
  for (const auto& [begin, size] : block.repetitions) {
    add_literals(bytes.subspan(done, begin - done), codes, writer);
    const Length length = length_of(size);
    codes[length.symbol].add_to(writer);
    writer.add(length.extra, length.extra_bits);
    writer.add(0, 1);  // the distance, 1
    writer.flush();
    done = begin + size;
  }
  add_literals(bytes.subspan(done, block.end - done), codes, writer);
  codes[kEnd].add_to(writer);
  writer.flush();
}

}  // namespace

std::string fast_zlib_of(std::span<const std::uint8_t> bytes) {
  SIMVIS_ASSERT(!bytes.empty());
  const std::size_t blocks = (bytes.size() + kBlock - 1) / kBlock;
  std::string stream(bytes.size() * kMaxCodeBits / 8 + blocks * kBlockFront + 2 * sizeof(std::uint64_t), '\0');
  auto* const first = reinterpret_cast<std::uint8_t*>(stream.data());
  BitWriter writer{first};
  writer.add(0x0178, 16);  // deflate with a window of 32 KiB, the fastest level
  for (std::size_t begin = 0; begin < bytes.size(); begin += kBlock) {
    add_block(block_of(bytes, begin), bytes, writer);
  }
  writer.bits = (writer.bits + 7) / 8 * 8;
  writer.flush();
  const std::uint32_t sum = adler32_of(bytes);
  for (const int shift : {24, 16, 8, 0}) writer.add(sum >> shift & 0xff, 8);
  writer.flush();
  stream.resize(static_cast<std::size_t>(writer.to - first));
  return stream;
}

}  // namespace simvis
