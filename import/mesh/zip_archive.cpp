#include "import/mesh/zip_archive.h"

#include <stb_image.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include <simvis/location.h>
#include "scenegraph/pictures/deflate.h"

namespace simvis {
namespace {

// The records of an archive begin with these, and have at least these lengths.
constexpr std::uint32_t kEndMark = 0x06054b50, kEntryMark = 0x02014b50, kFileMark = 0x04034b50;
constexpr std::size_t kEndBytes = 22, kEntryBytes = 46, kFileBytes = 30, kMaxComment = 65535;
constexpr std::uint32_t kStored = 0, kDeflated = 8, kEncrypted = 1;

}  // namespace

void ZipArchive::fail(const std::string& what) const { fail_at({.file = file_.string()}, what); }

// Little-endian; the caller has checked nothing.
std::uint32_t ZipArchive::number(std::size_t at, std::size_t bytes) const {
  if (at > bytes_.size() || bytes > bytes_.size() - at) fail("ends too early, expected a zip archive");
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < bytes; ++i) value |= std::uint32_t{bytes_[at + i]} << (8 * i);
  return value;
}

// The last record of the archive, behind which there may be a comment.
std::size_t ZipArchive::find_directory() const {
  for (std::size_t back = kEndBytes; back <= bytes_.size() && back <= kEndBytes + kMaxComment; ++back) {
    if (number(bytes_.size() - back, 4) == kEndMark) return bytes_.size() - back;
  }
  fail("has no directory, expected a zip archive");
}

ZipArchive::ZipArchive(const std::filesystem::path& file, Bytes bytes) : file_(file), bytes_(std::move(bytes)) {
  const std::size_t end = find_directory();
  const std::uint32_t count = number(end + 10, 2);
  if (number(end + 4, 2) != 0 || number(end + 8, 2) != count) fail("is one of several archives, expected a whole one");
  std::size_t at = number(end + 16, 4);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (number(at, 4) != kEntryMark) fail("has a broken directory, expected a zip archive without extensions");
    const Entry entry{.flags = number(at + 8, 2),
                      .method = number(at + 10, 2),
                      .checksum = number(at + 16, 4),
                      .packed = number(at + 20, 4),
                      .unpacked = number(at + 24, 4),
                      .header = number(at + 42, 4)};
    const std::size_t length = number(at + 28, 2), name_at = at + kEntryBytes;
    at = name_at + length + number(at + 30, 2) + number(at + 32, 2);
    if (at > bytes_.size()) fail("ends too early, expected a zip archive");
    const std::string name(reinterpret_cast<const char*>(bytes_.data()) + name_at, length);
    if (name.ends_with('/')) continue;
    if (entries_.emplace(name, entry).second) names_.push_back(name);
  }
}

Bytes ZipArchive::read(const std::string& name) const {
  const Entry& entry = entries_.at(name);
  const std::string subject = "holds " + in_quotes(name) + ", which ";
  if ((entry.flags & kEncrypted) != 0) fail(subject + "is encrypted");
  if (entry.unpacked > kMaxUnpackedBytes - unpacked_) {
    fail(subject + "unpacks to " + std::to_string(entry.unpacked) +
         " bytes, expected at most 1 GiB of all files together");
  }
  Bytes bytes = unpack(entry, subject);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (crc32_of(text) != entry.checksum) fail(subject + "is broken: its checksum differs");
  unpacked_ += bytes.size();
  return bytes;
}

Bytes ZipArchive::unpack(const Entry& entry, const std::string& subject) const {
  if (number(entry.header, 4) != kFileMark) fail(subject + "is not where the directory says");
  const std::size_t data = entry.header + kFileBytes + number(entry.header + 26, 2) + number(entry.header + 28, 2);
  if (data > bytes_.size() || entry.packed > bytes_.size() - data) fail(subject + "is cut off");
  const std::span<const std::uint8_t> packed(bytes_.data() + data, entry.packed);
  if (entry.method == kStored && entry.packed == entry.unpacked) return {packed.begin(), packed.end()};
  if (entry.method != kDeflated) {
    fail(subject + "is packed by method " + std::to_string(entry.method) + ", expected deflate or none");
  }
  // Deflate packs to 1/1032 at best, so that a small archive never asks for much memory.
  constexpr std::size_t kBestRatio = 1032, kSlack = 64;
  if (entry.unpacked / kBestRatio > entry.packed + kSlack) fail(subject + "claims more than it can unpack to");
  // The decoder looks ahead by two bytes, as if a checksum of zlib followed. The directory does.
  const std::size_t ahead = std::min<std::size_t>(2, bytes_.size() - data - packed.size());
  Bytes bytes(entry.unpacked);
  const int size = stbi_zlib_decode_noheader_buffer(
      reinterpret_cast<char*>(bytes.data()), static_cast<int>(bytes.size()),
      reinterpret_cast<const char*>(packed.data()), static_cast<int>(packed.size() + ahead));
  if (size < 0 || static_cast<std::size_t>(size) != bytes.size()) fail(subject + "is broken");
  return bytes;
}

}  // namespace simvis
