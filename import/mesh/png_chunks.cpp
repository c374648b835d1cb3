#include "import/mesh/png_chunks.h"

#include <string_view>

#include <simvis/error.h>
#include "scenegraph/pictures/deflate.h"

namespace simvis {
namespace {

constexpr std::string_view kPngStart = "\x89PNG\r\n\x1a\n";
constexpr std::size_t kNumberBytes = 4, kChunkBytes = 3 * kNumberBytes;  // length, type, checksum

std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (const char byte : bytes.substr(0, kNumberBytes)) value = value << 8 | static_cast<std::uint8_t>(byte);
  return value;
}

// The first letter of a chunk's type says whether decoders may leave it out.
bool is_needed(std::string_view type) { return type[0] >= 'A' && type[0] <= 'Z'; }

}  // namespace

void check_png_chunks(std::span<const std::uint8_t> bytes, const std::string& subject) {
  std::string_view left(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!left.starts_with(kPngStart)) return;
  left.remove_prefix(kPngStart.size());
  while (left.size() >= kChunkBytes) {
    const std::size_t length = big_endian(left);
    if (length > left.size() - kChunkBytes) return;
    const std::string_view type = left.substr(kNumberBytes, kNumberBytes);
    const std::string_view summed = left.substr(kNumberBytes, kNumberBytes + length);
    if (is_needed(type) && crc32_of(summed) != big_endian(left.substr(2 * kNumberBytes + length))) {
      throw InputError(subject + " is broken: the checksum of a chunk of PNG differs");
    }
    if (type == "IEND") return;
    left.remove_prefix(kChunkBytes + length);
  }
}

}  // namespace simvis
