#include "program/output/zip_file.h"

#include <zlib.h>

#include <cstdint>
#include <initializer_list>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "engine/base/binary_numbers.h"

namespace simvis {

namespace {

void append_u16(std::string& bytes, std::initializer_list<std::uint32_t> values) {
  for (const std::uint32_t value : values) append_lowest(bytes, value, sizeof(std::uint16_t));
}

void append_u32(std::string& bytes, std::initializer_list<std::uint64_t> values) {
  for (const std::uint64_t value : values) {
    SIMVIS_ASSERT(value <= 0xffffffff);
    append_binary(bytes, static_cast<std::uint32_t>(value));
  }
}

/// A raw deflate stream, as ZIP stores it.
std::string deflated(const std::string& content) {
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, -MAX_WBITS, MAX_MEM_LEVEL, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw MachineError("out of memory while an archive was compressed");
  }
  std::string bytes(deflateBound(&stream, static_cast<uLong>(content.size())), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
  stream.avail_in = static_cast<uInt>(content.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  const int result = deflate(&stream, Z_FINISH);
  bytes.resize(stream.total_out);
  deflateEnd(&stream);
  SIMVIS_ASSERT(result == Z_STREAM_END);
  return bytes;
}

}  // namespace

std::string encode_zip(std::span<const ZipEntry> entries) {
  constexpr std::uint32_t kVersion = 20, kDeflate = 8, kMidnight = 0, kFirstOfJanuary1980 = 33;
  std::string archive, directory;
  for (const ZipEntry& entry : entries) {
    const std::size_t offset = archive.size();
    const std::string data = deflated(entry.content);
    std::string common;
    append_u16(common, {kVersion, 0, kDeflate, kMidnight, kFirstOfJanuary1980});
    append_u32(common, {crc32_z(0, reinterpret_cast<const Bytef*>(entry.content.data()), entry.content.size()),
                        data.size(), entry.content.size()});
    append_u16(common, {static_cast<std::uint32_t>(entry.name.size()), 0});
    archive += "PK\x03\x04" + common + entry.name + data;
    directory += "PK\x01\x02";
    append_u16(directory, {kVersion});
    directory += common;
    append_u16(directory, {0, 0, 0});
    append_u32(directory, {0, offset});
    directory += entry.name;
  }
  const std::size_t offset = archive.size();
  archive += directory + "PK\x05\x06";
  const auto count = static_cast<std::uint32_t>(entries.size());
  append_u16(archive, {0, 0, count, count});
  append_u32(archive, {directory.size(), offset});
  append_u16(archive, {0});
  return archive;
}

}  // namespace simvis
