#include "scenegraph/pictures/png_bytes.h"

#include <algorithm>
#include <vector>

#include "engine/base/assert.h"
#include "scenegraph/pictures/deflate.h"

namespace simvis {
namespace {

void append_big_endian(std::string& bytes, std::uint32_t value) {
  for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(value >> shift & 0xff);
}

void append_chunk(std::string& png, const char* type, std::string_view data) {
  append_big_endian(png, static_cast<std::uint32_t>(data.size()));
  const std::size_t body = png.size();
  png.append(type, 4).append(data);
  append_big_endian(png, crc32_of(std::string_view(png).substr(body)));
}

// In 16 bits and without branches, so that the compiler makes vectors of it.
std::uint8_t paeth(std::int16_t left, std::int16_t above, std::int16_t above_left) {
  const auto size = [](std::int16_t value) { return static_cast<std::int16_t>(value < 0 ? -value : value); };
  const auto from_above = static_cast<std::int16_t>(above - above_left),
             from_left = static_cast<std::int16_t>(left - above_left);
  const std::int16_t to_left = size(from_above), to_above = size(from_left),
                     to_above_left = size(static_cast<std::int16_t>(from_above + from_left));
  const std::int16_t second = to_above <= to_above_left ? above : above_left;
  return static_cast<std::uint8_t>(to_left <= std::min(to_above, to_above_left) ? left : second);
}

std::vector<std::uint8_t> filtered(const PngLayout& layout, std::span<const std::uint8_t> rows) {
  const std::size_t row_bytes = layout.row_bytes(), pixel = layout.pixel_bytes();
  std::vector<std::uint8_t> all(layout.height * (row_bytes + 1));
  const std::vector<std::uint8_t> nothing(row_bytes, 0);
  const std::uint8_t* above = nothing.data();
  std::uint8_t* out = all.data();
  for (std::size_t y = 0; y < layout.height; ++y) {
    const std::uint8_t* const row = rows.data() + y * row_bytes;
    *out++ = static_cast<std::uint8_t>(layout.filter);
    const std::size_t plain = layout.filter == PngFilter::paeth ? pixel : row_bytes;  // Paeth has no left neighbour yet
    for (std::size_t x = 0; x < plain; ++x) *out++ = static_cast<std::uint8_t>(row[x] - above[x]);
    for (std::size_t x = plain; x < row_bytes; ++x) {
      out[x - plain] = static_cast<std::uint8_t>(row[x] - paeth(row[x - pixel], above[x], above[x - pixel]));
    }
    out += row_bytes - plain;
    above = row;
  }
  return all;
}

}  // namespace

std::string png_bytes(const PngLayout& layout, std::span<const std::uint8_t> rows) {
  SIMVIS_ASSERT(layout.width > 0 && layout.height > 0 && rows.size() == layout.height * layout.row_bytes());
  std::string header;
  append_big_endian(header, layout.width);
  append_big_endian(header, layout.height);
  header += static_cast<char>(layout.bits);
  header += static_cast<char>(layout.channels == 4 ? 6 : layout.channels == 3 ? 2 : 0);  // the type of colour
  header += {0, 0, 0};  // deflate, the standard filters, not interlaced
  std::string png = "\x89PNG\r\n\x1a\n";
  append_chunk(png, "IHDR", header);
  append_chunk(png, "IDAT", Deflater().zlib_of(filtered(layout, rows)));
  append_chunk(png, "IEND", "");
  return png;
}

}  // namespace simvis
