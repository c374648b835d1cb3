// A file that appears whole or not at all.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace simvis {

/// Written under a temporary name in the same folder and renamed by commit(); when it is destroyed without one, as on
/// any exception, the temporary is removed and a file that stood there before is untouched.
///
/// Errors   MachineError with the path and the operating system's reason: the folder is not writable, the disk is full.
/// Special  safe against the program's end, not against a power cut: nothing waits for the disk.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::string_view bytes);
  /// Closes the file and gives it its name. Nothing can be written afterwards.
  void commit();

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_, temporary_;
  int descriptor_ = -1;
};

/// Makes a folder, and those above it, where they are missing. Throws MachineError as AtomicFile does.
void make_folder(const std::filesystem::path& folder);

/// The whole of a small file at once.
void write_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace simvis
