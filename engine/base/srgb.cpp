#include "engine/base/srgb.h"

#include <algorithm>
#include <array>
#include <bit>

#include "engine/base/assert.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace simvis {
namespace {

// Floats below kDark have code 0, as the first code starts at 1 / 510 / 12.92 = 1.5e-4. kBright has code 255.
constexpr float kDark = 0x1p-13f, kBright = 0x1.fffffep-1f;
// Floats whose upper 16 bits are equal form a bucket, which spans 1/128 of its start.
constexpr int kLowBits = 16;
constexpr std::uint32_t kBucketFloats = 1u << kLowBits, kFirstBucket = std::bit_cast<std::uint32_t>(kDark) >> kLowBits,
                        kBuckets = (std::bit_cast<std::uint32_t>(kBright) >> kLowBits) + 1 - kFirstBucket;

/// The bits of the smallest float that has a code.
std::uint32_t first_bits(std::uint32_t code) {
  const double start = decode_srgb((code - 0.5) / 255);
  const auto near = static_cast<float>(start);
  return std::bit_cast<std::uint32_t>(near) + (near < start ? 1u : 0u);
}

/// One number for each bucket. The code changes at most once within a bucket, because it grows by less than 113 for
/// each factor of e. The number is such that adding the lower bits of a float carries into the upper 16 bits, which are
/// the code, exactly from the float at which the code changes.
struct SrgbTable {
  std::array<std::uint32_t, kBuckets> numbers{};

  SrgbTable() {
    std::uint32_t code = 0, next = first_bits(1);
    for (std::uint32_t i = 0; i < kBuckets; ++i) {
      const std::uint32_t start = (kFirstBucket + i) << kLowBits;
      while (next <= start) next = first_bits(++code + 1);
      numbers[i] = (code << kLowBits) + kBucketFloats - std::min(next - start, kBucketFloats);
    }
  }
};

const SrgbTable kSrgb;

#if defined(__x86_64__)
__attribute__((target("avx2"), always_inline)) inline __m256i codes_of_two(const float* rgba) {
  // The maximum of NaN and kDark is kDark.
  const __m256 inside =
      _mm256_min_ps(_mm256_max_ps(_mm256_loadu_ps(rgba), _mm256_set1_ps(kDark)), _mm256_set1_ps(kBright));
  const __m256i bits = _mm256_castps_si256(inside);
  const __m256i bucket = _mm256_sub_epi32(_mm256_srli_epi32(bits, kLowBits), _mm256_set1_epi32(kFirstBucket));
  const __m256i number = _mm256_i32gather_epi32(reinterpret_cast<const int*>(kSrgb.numbers.data()), bucket, 4);
  const __m256i low = _mm256_and_si256(bits, _mm256_set1_epi32(kBucketFloats - 1));
  return _mm256_srli_epi32(_mm256_add_epi32(number, low), kLowBits);
}

/// Writes the codes of the first pixels, eight at a time, and returns their number. Each step writes four bytes more
/// than its codes, which the next codes replace: at least two pixels are left. Tests cover it on machines with AVX2
/// alone, there with sanitizers too.
__attribute__((target("avx2"))) std::size_t vector_codes(const float* rgba, std::size_t pixels, std::uint8_t* rgb) {
  const __m256i in_order = _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7);
  const __m256i without_alpha = _mm256_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1,  //
                                                 0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1);
  std::size_t done = 0;
  for (; done + 10 <= pixels; done += 8, rgba += 32, rgb += 24) {
    const __m256i words = _mm256_packus_epi32(codes_of_two(rgba), codes_of_two(rgba + 8)),
                  more = _mm256_packus_epi32(codes_of_two(rgba + 16), codes_of_two(rgba + 24));
    const __m256i bytes = _mm256_permutevar8x32_epi32(_mm256_packus_epi16(words, more), in_order);
    const __m256i colors = _mm256_shuffle_epi8(bytes, without_alpha);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(rgb), _mm256_castsi256_si128(colors));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(rgb + 12), _mm256_extracti128_si256(colors, 1));
  }
  return done;
}
#endif

}  // namespace

std::uint8_t srgb_code(float linear) {
  const float inside = std::min(linear > kDark ? linear : kDark, kBright);  // NaN is not above kDark
  const auto bits = std::bit_cast<std::uint32_t>(inside);
  const std::uint32_t number = kSrgb.numbers[(bits >> kLowBits) - kFirstBucket];
  return static_cast<std::uint8_t>((number + (bits & (kBucketFloats - 1))) >> kLowBits);
}

void srgb_codes(std::span<const float> rgba, std::span<std::uint8_t> rgb) {
  SIMVIS_ASSERT(rgba.size() / 4 * 3 == rgb.size());
  std::size_t i = 0;
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) i = vector_codes(rgba.data(), rgba.size() / 4, rgb.data());
#endif
  for (; i < rgba.size() / 4; ++i) {
    for (std::size_t c = 0; c < 3; ++c) rgb[3 * i + c] = srgb_code(rgba[4 * i + c]);
  }
}

}  // namespace simvis
