// A file that appears complete or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace simvis {

/// The file is written under a temporary name in the same folder and renamed by commit(). If the object is destroyed
/// without commit(), as after an exception, the temporary file is removed and an existing file at `path` is unchanged.
///
/// output_target() decides what may be replaced; a character device, such as /dev/null, is written to at once.
///
/// Errors   MachineError with the path and the reason from the operating system, such as a folder that is not writable
///          or a full disk; InputError of output_target().
/// Special  safe against the end of the program, but not against a power failure: commit() does not wait for the disk.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::string_view bytes);
  /// Writes over bytes that have been written. The file is none of the devices.
  void rewrite(std::uint64_t offset, std::string_view bytes);
  /// Closes the file and gives it its final name. Do not call write() afterwards.
  void commit();

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_, target_, temporary_;  // no temporary file: the target is a device
  int descriptor_ = -1;
};

/// Writes all bytes to the descriptor. Throws MachineError about `path` as AtomicFile does.
void write_all(int descriptor, const std::filesystem::path& path, std::string_view bytes);

/// Throws MachineError: "PATH: error: WHAT: the reason for the number `error`".
[[noreturn]] void throw_file_error(const std::filesystem::path& path, const char* what, int error);

/// Creates a folder and its parent folders if they do not exist. Throws MachineError as AtomicFile does.
void make_folder(const std::filesystem::path& folder);

/// Writes a small file in one call, through AtomicFile.
void write_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace simvis
