// The files in a zip archive: packed COLLADA (.zae), arrays of NumPy (.npz).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "engine/base/input_file.h"

namespace simvis {

/// An archive in memory, by its central directory (PKWARE, APPNOTE 6.3). It is not trusted: no file is written, and
/// what a file unpacks to is never larger than the archive says, nor all together larger than kMaxUnpackedBytes.
class ZipArchive {
 public:
  static constexpr std::size_t kMaxUnpackedBytes = std::size_t{1} << 30;

  /// Throws InputError naming `file`: it is no zip archive, or its directory is broken or of several disks.
  ZipArchive(const std::filesystem::path& file, Bytes bytes);

  /// The names of all files, in the order of the archive.
  const std::vector<std::string>& names() const { return names_; }
  bool contains(const std::string& name) const { return entries_.contains(name); }

  /// Unpacks a file, which is there. Throws InputError naming the archive and the file: it is encrypted, packed by
  /// another method than deflate, broken, of another checksum than the archive says, or too large.
  Bytes read(const std::string& name) const;

 private:
  struct Entry {
    std::uint32_t flags = 0, method = 0, checksum = 0;
    std::size_t packed = 0, unpacked = 0, header = 0;
  };
  [[noreturn]] void fail(const std::string& what) const;
  std::uint32_t number(std::size_t at, std::size_t bytes) const;
  std::size_t find_directory() const;
  Bytes unpack(const Entry& entry, const std::string& subject) const;

  std::filesystem::path file_;
  Bytes bytes_;
  std::map<std::string, Entry> entries_;
  std::vector<std::string> names_;
  mutable std::size_t unpacked_ = 0;  // bytes that read() has returned
};

}  // namespace simvis
