// Fast compression of pictures by libdeflate, the only place that includes it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "engine/base/program_api.h"

struct libdeflate_compressor;

namespace simvis {

/// Compresses one span after the other. One thread at a time.
class SIMVIS_PROGRAM_API Deflater {
 public:
  Deflater();  ///< throws MachineError if memory runs out

  /// A stream of zlib's format, as PNG and EXR hold it.
  std::string zlib_of(std::span<const std::uint8_t> bytes);

 private:
  std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor_;
};

/// The CRC-32 of PNG and MCAP. `before` is that of the bytes in front of these.
std::uint32_t crc32_of(std::string_view bytes, std::uint32_t before = 0);

}  // namespace simvis
