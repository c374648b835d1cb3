// A file of MCAP records that can be read at any moment, also after a kill.
//
// Layout   what was appended, then one record of a private opcode over the space that is reserved for what comes next,
//          then an end without a summary: data end, footer, magic. Readers skip the private record. New records are
//          written into it, and become visible at once when the head of the private record is replaced by that of the
//          first of them. Every write that a reader can see lies within one page of the file, so that a kill does not
//          interrupt it.
// Special  safe against the end of the program, but not against a power failure. Reserved space is a hole in the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace simvis::ros {

/// Errors   MachineError with the path and the reason from the operating system, also if the name of the file leads to
///          another one, or to none. The file then is as before the call.
class RecordFile {
 public:
  /// Creates or replaces the file with a start of magic and whole records. InputError if it is no regular file.
  RecordFile(const std::filesystem::path& path, std::string_view start);
  ~RecordFile();
  RecordFile(const RecordFile&) = delete;
  RecordFile& operator=(const RecordFile&) = delete;

  /// Appends whole records.
  void append(std::string records);
  /// Hides again what was appended behind `size`, a former size(), when crc() was `crc`.
  void cut(std::uint64_t size, std::uint32_t crc);
  /// Appends the last records, which end with the magic; the file ends with them. Do not append afterwards.
  void finish(std::string_view records);

  bool is_open() const { return file_ >= 0; }   ///< until finish(), which closes it also where it throws
  std::uint64_t size() const { return size_; }  ///< of what is visible, without the end
  std::uint32_t crc() const { return crc_; }    ///< of these bytes

 private:
  void write_at(std::uint64_t offset, std::string_view bytes) const;
  void reserve(std::uint64_t bytes);
  std::string reserved_head(std::uint64_t offset) const;
  void show(std::string_view records);

  std::filesystem::path path_, target_;
  int file_ = -1;
  std::uint64_t size_ = 0, file_size_ = 0;  // what is visible; the whole file
  std::uint32_t crc_ = 0;
};

/// CRC-32 as MCAP has it, of bytes that follow those of `before`.
std::uint32_t mcap_crc(std::string_view bytes, std::uint32_t before = 0);

}  // namespace simvis::ros
