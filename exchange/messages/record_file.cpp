#include "exchange/messages/record_file.h"

#include <unistd.h>

#include <cerrno>
#include <utility>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "engine/base/file_writing.h"
#include "engine/base/output_target.h"
#include "engine/base/temporary_file.h"
#include "exchange/messages/mcap_records.h"
#include "scenegraph/pictures/deflate.h"

namespace simvis::ros {

namespace {

// The smallest page of the machines that SimVis runs on.
constexpr std::uint64_t kPageBytes = 4096;
constexpr std::uint64_t kReservedBytes = std::uint64_t{8} << 20;
constexpr std::uint64_t kHeadBytes = 1 + sizeof(std::uint64_t);

/// The end of a file without a summary. A checksum of 0 means "not computed".
const std::string& open_end() {
  static const std::string end = McapRecord(McapOpcode::data_end).number(std::uint32_t{0}).bytes() +
                                 McapRecord(McapOpcode::footer)
                                     .number(std::uint64_t{0})
                                     .number(std::uint64_t{0})
                                     .number(std::uint32_t{0})
                                     .bytes() +
                                 std::string(kMcapMagic);
  return end;
}

bool head_crosses_page(std::uint64_t offset) { return offset % kPageBytes > kPageBytes - kHeadBytes; }

}  // namespace

std::uint32_t mcap_crc(std::string_view bytes, std::uint32_t before) { return crc32_of(bytes, before); }

// The file gets its name when it is whole.
RecordFile::RecordFile(const std::filesystem::path& path, std::string_view start)
    : path_(path), target_(regular_target(path)) {
  TemporaryFile file(target_, path_);
  file_ = file.descriptor();
  write_at(0, start);
  size_ = start.size();
  crc_ = mcap_crc(start);
  SIMVIS_ASSERT(!head_crosses_page(size_));
  reserve(0);
  file.put_in_place();
  file.release();
}

RecordFile::~RecordFile() {
  if (file_ >= 0) ::close(file_);
}

void RecordFile::write_at(std::uint64_t offset, std::string_view bytes) const {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw_file_error(path_, "cannot be written", errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
}

/// The head of the private record at `offset`, which reaches to the end.
std::string RecordFile::reserved_head(std::uint64_t offset) const {
  return mcap_record_head(McapOpcode::reserved, file_size_ - open_end().size() - kHeadBytes - offset);
}

/// Makes room for so many bytes, another head and the end. The new end lies behind the old one, which readers see until
/// the private record covers it; both lead to the same records.
void RecordFile::reserve(std::uint64_t bytes) {
  const std::uint64_t needed = size_ + bytes + kHeadBytes + open_end().size();
  if (needed <= file_size_) return;
  const auto round_up = [](std::uint64_t size) { return (size + kPageBytes - 1) / kPageBytes * kPageBytes; };
  std::uint64_t size = round_up(needed + kReservedBytes);
  try {
    write_at(size - open_end().size(), open_end());
  } catch (const MachineError&) {  // there may be room for less
    size = round_up(needed);
    write_at(size - open_end().size(), open_end());
  }
  file_size_ = size;
  write_at(size_, reserved_head(size_));
}

/// Writes records behind what is visible, and the first head at last.
void RecordFile::show(std::string_view records) {
  write_at(size_ + kHeadBytes, records.substr(kHeadBytes));
  write_at(size_, records.substr(0, kHeadBytes));
}

void RecordFile::append(std::string records) {
  require_own_name(target_, file_);
  if (head_crosses_page(size_ + records.size())) records += mcap_record_head(McapOpcode::reserved, 0);
  reserve(records.size());
  const std::uint64_t next = size_ + records.size();
  write_at(next, reserved_head(next));
  show(records);
  crc_ = mcap_crc(records, crc_);
  size_ = next;
}

void RecordFile::cut(std::uint64_t size, std::uint32_t crc) {
  SIMVIS_ASSERT(size <= size_);
  write_at(size, reserved_head(size));
  size_ = size;
  crc_ = crc;
}

void RecordFile::finish(std::string_view records) {
  require_own_name(target_, file_);
  reserve(records.size());
  show(records);
  size_ += records.size();
  if (::ftruncate(file_, static_cast<off_t>(size_)) != 0) throw_file_error(path_, "cannot be cut", errno);
  if (::close(std::exchange(file_, -1)) != 0) throw_file_error(path_, "cannot be closed", errno);
}

}  // namespace simvis::ros
