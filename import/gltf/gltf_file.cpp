#include "import/gltf/gltf_file.h"

#include <array>
#include <cstdint>
#include <optional>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "engine/base/binary_numbers.h"
#include "engine/base/read_fence.h"
#include "import/mesh/percent_encoding.h"

namespace simvis {
namespace {

constexpr std::size_t kGlbHeaderBytes = 12, kChunkHeaderBytes = 8;
constexpr std::uint32_t kGlbMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

// Smaller buffers are read at once, because a part may have more small buffers than a process may have open files.
constexpr std::size_t kWorthHoldingOpen = std::size_t{1} << 20;

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
  throw InputError(file.string() + ": error: " + what);
}

GltfChunks split_glb(const InputFile& input, const std::filesystem::path& file) {
  if (input.size() < kGlbHeaderBytes) fail(file, "the .glb header is cut off; expected 12 bytes");
  const Bytes header = input.read(0, kGlbHeaderBytes);
  const std::uint32_t version = binary_at<std::uint32_t>(header, 4), length = binary_at<std::uint32_t>(header, 8);
  if (version != 2) fail(file, "is binary glTF of version " + std::to_string(version) + "; expected version 2");
  if (length > input.size()) {
    fail(file, "the .glb header gives " + std::to_string(length) + " bytes, but the file has " +
                   std::to_string(input.size()));
  }
  GltfChunks chunks;
  chunks.extra_bytes = input.size() - length;
  std::size_t at = kGlbHeaderBytes;
  for (int index = 0; at < length; ++index) {
    const std::string chunk = "chunk " + std::to_string(index) + " of the .glb";
    if (length - at < kChunkHeaderBytes) fail(file, "the header of " + chunk + " is cut off");
    const Bytes head = input.read(at, kChunkHeaderBytes);
    const std::uint32_t size = binary_at<std::uint32_t>(head, 0), type = binary_at<std::uint32_t>(head, 4);
    at += kChunkHeaderBytes;
    if (size > length - at) {
      fail(file,
           chunk + " claims " + std::to_string(size) + " bytes, but only " + std::to_string(length - at) + " are left");
    }
    if ((index == 0) != (type == kJsonChunk))
      fail(file, chunk + " is of the wrong type; expected first one JSON chunk");
    if (index == 0) chunks.json = input.read(at, size);
    if (index == 1 && type == kBinaryChunk) {
      chunks.binary_first = at;
      chunks.binary_size = size;
      chunks.has_binary = true;
    }
    at += size;
  }
  if (chunks.json.empty()) fail(file, "the .glb has no JSON chunk");
  return chunks;
}

std::array<int, 256> base64_digits() {
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<int, 256> digits{};
  digits.fill(-1);
  for (std::size_t i = 0; i < kAlphabet.size(); ++i) {
    digits[static_cast<unsigned char>(kAlphabet[i])] = static_cast<int>(i);
  }
  return digits;
}

std::optional<Bytes> decode_base64(std::string_view text) {
  static const std::array<int, 256> digits = base64_digits();
  for (int padding = 0; padding < 2 && text.ends_with('=') && (text.size() + padding) % 4 == 0; ++padding) {
    text.remove_suffix(1);
  }
  if (text.size() % 4 == 1) return std::nullopt;
  Bytes bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int bit_count = 0;
  for (const char c : text) {
    const int digit = digits[static_cast<unsigned char>(c)];
    if (digit < 0) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    bit_count += 6;
    if (bit_count < 8) continue;
    bit_count -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> bit_count));
  }
  return bytes;
}

bool has_scheme(std::string_view uri) {
  const std::size_t colon = uri.find(':');
  return colon != std::string_view::npos && colon < uri.find_first_of("/?#");
}

// Returns the URI for a message. It is shortened, because a data URI may have megabytes.
std::string shown(std::string_view uri) {
  constexpr std::size_t kShownCharacters = 60;
  return "\"" + std::string(uri.substr(0, kShownCharacters)) + (uri.size() > kShownCharacters ? "...\"" : "\"");
}

}  // namespace

std::filesystem::path relative_gltf_path(std::string_view uri, const std::filesystem::path& file,
                                         const std::string& place) {
  const std::string expected = "; expected a relative path in the folders of the part, or a data URI";
  const std::optional<std::string> decoded = decode_percent(uri);
  if (!decoded) fail(file, place + " has malformed percent-encoding in its URI " + shown(uri));
  if (decoded->find('\0') != std::string::npos) fail(file, place + " has a zero byte in its URI " + shown(uri));
  const std::filesystem::path path = std::filesystem::path(*decoded).lexically_normal();
  if (decoded->empty() || has_scheme(uri) || path.is_absolute() || !is_readable(file.parent_path() / path)) {
    fail(file, place + " has the URI " + shown(uri) + expected);
  }
  return path;
}

void GltfBuffer::cut(std::size_t size) {
  size_ = size;
  if (!file_) bytes_.resize(size);
}

Bytes GltfBuffer::read(std::size_t first, std::size_t count) const {
  SIMVIS_ASSERT(first <= size_ && count <= size_ - first);
  if (file_) return file_->read(first_ + first, count);
  const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(first);
  return {begin, begin + static_cast<std::ptrdiff_t>(count)};
}

GltfChunks split_gltf(const InputFile& input, const std::filesystem::path& file) {
  if (input.size() == 0) fail(file, "is empty; expected glTF 2.0");
  if (input.size() >= 4 && binary_at<std::uint32_t>(input.read(0, 4), 0) == kGlbMagic) return split_glb(input, file);
  if (file.extension() == ".glb") fail(file, "does not begin with \"glTF\"; expected binary glTF 2.0");
  GltfChunks chunks;
  chunks.json = input.read(0, input.size());
  return chunks;
}

GltfBuffer open_gltf_uri(std::string_view uri, const std::filesystem::path& file, const std::string& place) {
  if (!uri.starts_with("data:")) {
    const std::filesystem::path path = file.parent_path() / relative_gltf_path(uri, file, place);
    try {
      auto input = std::make_shared<const InputFile>(path);
      const std::size_t size = input->size();
      if (size < kWorthHoldingOpen) return GltfBuffer(input->read(0, size));
      return {std::move(input), 0, size};
    } catch (const InputError& e) {
      fail(file, place + ": " + e.what());
    }
  }
  constexpr std::string_view kMarker = ";base64,";
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos || !uri.substr(0, comma + 1).ends_with(kMarker)) {
    fail(file, place + " has a malformed data URI " + shown(uri) + "; expected \"data:TYPE;base64,DATA\"");
  }
  std::optional<Bytes> bytes = decode_base64(uri.substr(comma + 1));
  if (!bytes) fail(file, place + " has a data URI that is not base64: " + shown(uri));
  return GltfBuffer(std::move(*bytes));
}

}  // namespace simvis
