// A file that grows by whole records.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string_view>

namespace simvis {

/// The file gets its name when it has its beginning. What was appended is whole, also after the end of the program; a
/// kill during append() leaves whole records and a part of the next one.
///
/// Errors   InputError if the name is that of something that cannot be replaced, see output_target(); MachineError with
///          the path and the reason from the operating system. The file then ends with the last whole append().
///          MachineError too if its name leads to another file, or to none.
class CaptureFile {
 public:
  /// `before_name` is called when the beginning is written, just before the file gets its name; a device has its name
  /// already, and it is not called. What it throws goes through, and leaves no file.
  CaptureFile(std::filesystem::path path, std::string_view beginning, const std::function<void()>& before_name = {});
  ~CaptureFile();
  CaptureFile(const CaptureFile&) = delete;
  CaptureFile& operator=(const CaptureFile&) = delete;

  void append(std::string_view records);
  /// Do not append afterwards.
  void close();

  std::uint64_t size() const { return size_; }  ///< bytes

 private:
  void begin(std::string_view beginning);
  bool is_stream() const { return target_.empty(); }

  std::filesystem::path path_, target_;  // no target: a device
  int file_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace simvis
