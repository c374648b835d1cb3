// How much time and memory a helper program may use for a file: the more, the larger the file is.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace simvis {

/// Time of the processor, and memory beyond that of the program itself.
struct ImportLimits {
  std::chrono::milliseconds time{10'000};
  std::size_t memory_bytes = std::size_t{4} << 30;
};

/// What users multiply all limits of large files with: the environment variable SIMVIS_IMPORT_FACTOR, from 1 to 1000; 1
/// if it is not set. Throws InputError for other values.
double import_factor();

/// The largest file whose size counts, times import_factor(): a file without content may claim any size.
inline constexpr double kLargestPart_bytes = 0x1p30;

/// The limits for a file of this many bytes: `least`, and for each MiB of the file, up to the largest one, a quarter of
/// a second and 8 MiB; all times import_factor(). The slowest reader takes a tenth of this time, the largest scene for
/// its file half of this memory (docs/performance.md). Throws as import_factor().
ImportLimits limits_for(const ImportLimits& least, std::uintmax_t file_bytes);

/// What the message about a file that reaches a limit ends with.
inline constexpr const char* kRaiseLimits =
    "; a file may be large: SIMVIS_IMPORT_FACTOR=2 in the environment doubles the limits";

}  // namespace simvis
