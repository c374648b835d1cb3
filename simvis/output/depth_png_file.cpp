#include "simvis/output/depth_png_file.h"

#include <zlib.h>

#include <cmath>
#include <cstdint>

#include <simvis/error.h>
#include "engine/base/assert.h"

namespace simvis {

namespace {

void append_big_endian(std::string& bytes, std::uint32_t value) {
  for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(value >> shift & 0xff);
}

std::string png_chunk(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  std::string chunk;
  append_big_endian(chunk, static_cast<std::uint32_t>(data.size()));
  chunk += body;
  append_big_endian(chunk,
                    static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(body.data()), body.size())));
  return chunk;
}

/// The rows with filter "up": the difference of each byte to the byte above.
std::string filtered_rows(const Image& depth, double unit_m) {
  constexpr char kUp = 2;
  const std::size_t row_bytes = std::size_t{2} * depth.width;
  std::string above(row_bytes, '\0'), row(row_bytes, '\0'), rows;
  rows.reserve((row_bytes + 1) * depth.height);
  for (std::size_t y = 0; y < depth.height; ++y) {
    rows += kUp;
    for (std::size_t x = 0; x < depth.width; ++x) {
      const std::uint16_t code = depth_code(depth.pixels[y * depth.width + x], unit_m);
      row[2 * x] = static_cast<char>(code >> 8);
      row[2 * x + 1] = static_cast<char>(code & 0xff);
    }
    for (std::size_t i = 0; i < row_bytes; ++i) rows += static_cast<char>(row[i] - above[i]);
    std::swap(above, row);
  }
  return rows;
}

}  // namespace

std::uint16_t depth_code(float depth_m, double unit_m) {
  const double code = std::round(static_cast<double>(depth_m) / unit_m);
  return code >= 0 && code <= 0xffff ? static_cast<std::uint16_t>(code) : 0;
}

std::string encode_depth_png(const Image& depth, double unit_m) {
  SIMVIS_ASSERT(depth.channels == 1 && unit_m > 0);
  SIMVIS_ASSERT(depth.pixels.size() == std::size_t{depth.width} * depth.height);
  const std::string rows = filtered_rows(depth, unit_m);
  uLongf size = compressBound(static_cast<uLong>(rows.size()));
  std::string data(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(data.data()), &size, reinterpret_cast<const Bytef*>(rows.data()),
                static_cast<uLong>(rows.size()), Z_BEST_SPEED) != Z_OK) {
    throw MachineError("out of memory while a PNG was compressed");
  }
  data.resize(size);
  std::string header;
  append_big_endian(header, depth.width);
  append_big_endian(header, depth.height);
  header += {16, 0, 0, 0, 0};  // bits, grey, deflate, the standard filters, not interlaced
  return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header) + png_chunk("IDAT", data) + png_chunk("IEND", "");
}

}  // namespace simvis
