#include "scenegraph/gltf_file.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <system_error>

#include "engine/error.h"

namespace simvis {
namespace {

constexpr std::size_t kGlbHeaderBytes = 12, kChunkHeaderBytes = 8;
constexpr std::uint32_t kGlbMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
  throw InputError(file.string() + ": error: " + what);
}

std::uint32_t little_endian_u32(const std::uint8_t* p) {
  return std::uint32_t{p[0]} | std::uint32_t{p[1]} << 8 | std::uint32_t{p[2]} << 16 | std::uint32_t{p[3]} << 24;
}

GltfChunks split_glb(std::span<const std::uint8_t> bytes, const std::filesystem::path& file) {
  if (bytes.size() < kGlbHeaderBytes) fail(file, "the .glb header is cut off; expected 12 bytes");
  const std::uint32_t version = little_endian_u32(bytes.data() + 4), length = little_endian_u32(bytes.data() + 8);
  if (version != 2) fail(file, "is binary glTF of version " + std::to_string(version) + "; expected version 2");
  if (length > bytes.size()) {
    fail(file, "the .glb header gives " + std::to_string(length) + " bytes, but the file has " +
                   std::to_string(bytes.size()));
  }
  GltfChunks chunks;
  chunks.extra_bytes = bytes.size() - length;
  bytes = bytes.first(length);
  std::size_t at = kGlbHeaderBytes;
  for (int index = 0; at < bytes.size(); ++index) {
    const std::string chunk = "chunk " + std::to_string(index) + " of the .glb";
    if (bytes.size() - at < kChunkHeaderBytes) fail(file, "the header of " + chunk + " is cut off");
    const std::uint32_t size = little_endian_u32(bytes.data() + at), type = little_endian_u32(bytes.data() + at + 4);
    at += kChunkHeaderBytes;
    if (size > bytes.size() - at) {
      fail(file, chunk + " claims " + std::to_string(size) + " bytes, but only " + std::to_string(bytes.size() - at) +
                     " are left");
    }
    if ((index == 0) != (type == kJsonChunk))
      fail(file, chunk + " is of the wrong type; expected first one JSON chunk");
    if (index == 0) chunks.json = {reinterpret_cast<const char*>(bytes.data() + at), size};
    if (index == 1 && type == kBinaryChunk) {
      chunks.binary = bytes.subspan(at, size);
      chunks.has_binary = true;
    }
    at += size;
  }
  if (chunks.json.empty()) fail(file, "the .glb has no JSON chunk");
  return chunks;
}

std::array<std::int8_t, 256> base64_digits() {
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<std::int8_t, 256> digits;
  digits.fill(-1);
  for (std::size_t i = 0; i < kAlphabet.size(); ++i) {
    digits[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::int8_t>(i);
  }
  return digits;
}

std::optional<Bytes> decode_base64(std::string_view text) {
  static const std::array<std::int8_t, 256> digits = base64_digits();
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

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::optional<std::string> decode_percent(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      decoded.push_back(text[i]);
      continue;
    }
    if (i + 2 >= text.size()) return std::nullopt;
    const int high = hex_digit(text[i + 1]), low = hex_digit(text[i + 2]);
    if (high < 0 || low < 0) return std::nullopt;
    decoded.push_back(static_cast<char>(high * 16 + low));
    i += 2;
  }
  return decoded;
}

bool has_scheme(std::string_view uri) {
  const std::size_t colon = uri.find(':');
  return colon != std::string_view::npos && colon < uri.find_first_of("/?#");
}

// Data is shown cut short: a data URI may be megabytes long.
std::string shown(std::string_view uri) {
  constexpr std::size_t kShownCharacters = 60;
  return "\"" + std::string(uri.substr(0, kShownCharacters)) + (uri.size() > kShownCharacters ? "...\"" : "\"");
}

std::filesystem::path relative_path(std::string_view uri, const std::filesystem::path& file, const std::string& place) {
  const std::string expected = "; expected a relative path at or below the file's folder, or a data URI";
  const std::optional<std::string> decoded = decode_percent(uri);
  if (!decoded) fail(file, place + " has malformed percent-encoding in its URI " + shown(uri));
  if (decoded->find('\0') != std::string::npos) fail(file, place + " has a zero byte in its URI " + shown(uri));
  const std::filesystem::path path = std::filesystem::path(*decoded).lexically_normal();
  if (decoded->empty() || has_scheme(uri) || path.is_absolute() || *path.begin() == "..") {
    fail(file, place + " has the URI " + shown(uri) + expected);
  }
  return path;
}

}  // namespace

Bytes read_whole_file(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found) fail(file, "there is no such file");
  if (error) fail(file, "cannot be read: " + error.message());
  // A pipe or a device has no end that one could wait for.
  if (status.type() != std::filesystem::file_type::regular) fail(file, "is not a regular file");
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) fail(file, "cannot be read: " + error.message());
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail(file, std::string("cannot be opened: ") + std::strerror(errno));
  Bytes bytes(size);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(stream.gcount()) != size) fail(file, "could not be read to its end");
  return bytes;
}

GltfChunks split_gltf(std::span<const std::uint8_t> bytes, const std::filesystem::path& file) {
  if (bytes.empty()) fail(file, "is empty; expected glTF 2.0");
  const bool has_magic = bytes.size() >= 4 && little_endian_u32(bytes.data()) == kGlbMagic;
  if (has_magic) return split_glb(bytes, file);
  if (file.extension() == ".glb") fail(file, "does not begin with \"glTF\"; expected binary glTF 2.0");
  return {{reinterpret_cast<const char*>(bytes.data()), bytes.size()}, {}, false, 0};
}

Bytes read_gltf_uri(std::string_view uri, const std::filesystem::path& file, const std::string& place) {
  if (!uri.starts_with("data:")) {
    const std::filesystem::path path = file.parent_path() / relative_path(uri, file, place);
    try {
      return read_whole_file(path);
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
  return std::move(*bytes);
}

}  // namespace simvis
