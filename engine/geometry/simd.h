// SIMD vectors for loops that the compiler turns into one vector instruction for each operation, as far as the machine
// has it. Every lane rounds like a scalar: products and sums stay separate in files that are compiled with
// -ffp-contract=off.
#pragma once

#include <cmath>

#define SIMVIS_INLINE inline __attribute__((always_inline))

// Marks a function that is compiled once for machines with AVX2 and once for all others; the version is selected when
// the program starts. clang needs the mark at the first declaration and in every file that calls the function, so the
// function is called in its own file only. It passes no SIMD vectors itself, since clang refuses calls between a
// function with AVX and one without; what it calls may do so once it is inlined.
// With the address sanitizer there is only the version for all others, so that tests cover it on every machine.
// With the thread sanitizer too: the choice at the start of the program would run before the sanitizer is ready.
// engine/base/srgb.cpp has intrinsics for AVX2 in place of two versions of one function, and selects them at each call,
// with sanitizers too.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SIMVIS_FOR_EACH_MACHINE __attribute__((target_clones("avx2", "default")))
#else
#define SIMVIS_FOR_EACH_MACHINE
#endif

// SIMD vectors are passed only to functions that are inlined. Other functions could expect them in other registers,
// depending on the version that the machine selects.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace simvis {

using Double4 = double __attribute__((vector_size(32)));
using Mask4 = long long __attribute__((vector_size(32)));  ///< each lane has all bits set, or none
using Mask8 = int __attribute__((vector_size(32)));
using Float8 = float __attribute__((vector_size(32)));

/// Bit i of the result is set if lane i is set.
SIMVIS_INLINE unsigned bits_of(Mask4 mask) {
#if defined(__SSE2__)
  using Float4 = float __attribute__((vector_size(16)));
  using Int8 = int __attribute__((vector_size(32)));
  const Int8 words = reinterpret_cast<Int8>(mask);
  return static_cast<unsigned>(
      __builtin_ia32_movmskps(reinterpret_cast<Float4>(__builtin_shufflevector(words, words, 0, 2, 4, 6))));
#else
  return (mask[0] != 0) | (mask[1] != 0) << 1 | (mask[2] != 0) << 2 | (mask[3] != 0) << 3;
#endif
}

SIMVIS_INLINE unsigned bits_of(Mask8 mask) {
  using Mask4x32 = int __attribute__((vector_size(16)));
#if defined(__SSE2__)
  using Float4 = float __attribute__((vector_size(16)));
  const Mask4x32 low = __builtin_shufflevector(mask, mask, 0, 1, 2, 3),
                 high = __builtin_shufflevector(mask, mask, 4, 5, 6, 7);
  return static_cast<unsigned>(__builtin_ia32_movmskps(reinterpret_cast<Float4>(low)) |
                               __builtin_ia32_movmskps(reinterpret_cast<Float4>(high)) << 4);
#else
  unsigned bits = 0;
  for (unsigned lane = 0; lane < 8; ++lane) bits |= (mask[lane] != 0u) << lane;
  return bits;
#endif
}

SIMVIS_INLINE bool any(Mask4 mask) {
  using Mask2 = long long __attribute__((vector_size(16)));
  const Mask2 halves = __builtin_shufflevector(mask, mask, 0, 1) | __builtin_shufflevector(mask, mask, 2, 3);
#if defined(__SSE2__)
  using Float4 = float __attribute__((vector_size(16)));
  return __builtin_ia32_movmskps(reinterpret_cast<Float4>(halves)) != 0;
#else
  return (halves[0] | halves[1]) != 0;
#endif
}

// Copies of one lane are one instruction with AVX2. A vector that is set lane by lane is a chain of inserts by GCC 12.
SIMVIS_INLINE Double4 splat4(double value) {
  using Double2 = double __attribute__((vector_size(16)));
  const Double2 first{value};
  return __builtin_shufflevector(first, first, 0, 0, 0, 0);
}
SIMVIS_INLINE Float8 splat8(float value) {
  using Float4 = float __attribute__((vector_size(16)));
  const Float4 first{value};
  return __builtin_shufflevector(first, first, 0, 0, 0, 0, 0, 0, 0, 0);
}

SIMVIS_INLINE Double4 min(Double4 a, Double4 b) { return b < a ? b : a; }
SIMVIS_INLINE Double4 max(Double4 a, Double4 b) { return a < b ? b : a; }
SIMVIS_INLINE Float8 min(Float8 a, Float8 b) { return b < a ? b : a; }
SIMVIS_INLINE Float8 max(Float8 a, Float8 b) { return a < b ? b : a; }
SIMVIS_INLINE Double4 abs4(Double4 a) { return a < splat4(0) ? -a : a; }
SIMVIS_INLINE Double4 sqrt4(Double4 a) {
  return Double4{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
}

/// Rounds eight values, the lower four first.
SIMVIS_INLINE Float8 to_floats(Double4 low, Double4 high) {
  using Float4 = float __attribute__((vector_size(16)));
  const Float4 first = __builtin_convertvector(low, Float4), second = __builtin_convertvector(high, Float4);
  return __builtin_shufflevector(first, second, 0, 1, 2, 3, 4, 5, 6, 7);
}

SIMVIS_INLINE double hmax(Double4 a) {
  const double first = a[0] < a[1] ? a[1] : a[0], second = a[2] < a[3] ? a[3] : a[2];
  return first < second ? second : first;
}

}  // namespace simvis
