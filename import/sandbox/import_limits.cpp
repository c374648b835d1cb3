#include "import/sandbox/import_limits.h"

#include <algorithm>
#include <cstdlib>
#include <string>

#include <simvis/error.h>
#include <simvis/location.h>
#include "engine/base/words.h"

namespace simvis {
namespace {

constexpr double kMebibyte = 0x1p20;
constexpr double kTime_ms = 250, kMemory_bytes = 8 * kMebibyte;  // for each MiB of the file

}  // namespace

double import_factor() {
  constexpr double kMaxFactor = 1000;
  const char* const text = std::getenv("SIMVIS_IMPORT_FACTOR");
  if (text == nullptr || *text == '\0') return 1;
  const double factor = as_number<double>(text).value_or(0);
  if (factor >= 1 && factor <= kMaxFactor) return factor;
  throw InputError("variable SIMVIS_IMPORT_FACTOR: " + in_quotes(text) +
                   " is not allowed, expected a number from 1 to 1000");
}

ImportLimits limits_for(const ImportLimits& least, std::uintmax_t file_bytes) {
  const double factor = import_factor();
  const double size = std::min(static_cast<double>(file_bytes), factor * kLargestPart_bytes) / kMebibyte;
  constexpr double kMaxBytes = 0x1p60, kMaxTime_ms = 0x1p40;
  const double time_ms = factor * (static_cast<double>(least.time.count()) + kTime_ms * size);
  const double memory_bytes = factor * (static_cast<double>(least.memory_bytes) + kMemory_bytes * size);
  return {.time = std::chrono::milliseconds(static_cast<std::int64_t>(std::min(time_ms, kMaxTime_ms))),
          .memory_bytes = static_cast<std::size_t>(std::min(memory_bytes, kMaxBytes))};
}

}  // namespace simvis
