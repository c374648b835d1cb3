// Counter-based random numbers: a number depends on its purpose only, never on the order of calls.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include <simvis/export.h>

namespace simvis {

/// Philox 4x32 with ten rounds: Salmon, Moraes, Dror, Shaw, "Parallel Random Numbers: As Easy as 1, 2, 3", SC 2011.
/// A bijection of the counter for each key. Any two counters or keys give unrelated numbers, however similar they are.
SIMVIS_API std::array<std::uint32_t, 4> philox4x32_10(std::array<std::uint32_t, 4> counter,
                                                      std::array<std::uint32_t, 2> key);

/// The random numbers of one sensor in one run.
///
/// A number is identified by the frame (see random_key() in <simvis/frame_time.h>), the element (a beam, a pixel; 0 if
/// there is one only) and the draw (which of several numbers for the same element). Other sensors of the scene, skipped
/// frames and the order of calls therefore change nothing.
///
/// Threads  any number at a time.
class SIMVIS_API SensorRandom {
 public:
  /// The key is the seed, mixed with the 64-bit FNV-1a hash of the sensor's name.
  SensorRandom(std::uint64_t seed, std::string_view sensor);

  /// Uniformly distributed in [0, 1), a multiple of 2^-53.
  double uniform(std::uint64_t frame, std::uint32_t element, std::uint32_t draw) const;

  /// Four numbers at the cost of one, each uniformly distributed in [0, 1), a multiple of 2^-32. They share their bits
  /// with uniform() and gaussian() of the same draw.
  std::array<double, 4> uniforms(std::uint64_t frame, std::uint32_t element, std::uint32_t draw) const;

  /// Normally distributed with mean 0 and standard deviation 1; the absolute value is at most 8.6.
  double gaussian(std::uint64_t frame, std::uint32_t element, std::uint32_t draw) const;

 private:
  std::array<std::uint32_t, 4> bits(std::uint64_t frame, std::uint32_t element, std::uint32_t draw) const;

  std::array<std::uint32_t, 2> key_;
};

}  // namespace simvis
