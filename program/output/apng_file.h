// A film as an animated PNG, which browsers play: the pictures of all frames, each shown until the next one.
//
// Format   Portable Network Graphics, third edition (W3C, 2025), "Animation". Programs that know no animation show the
//          first picture.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "program/output/atomic_file.h"

namespace simvis {

inline constexpr std::int64_t kMaxShown_ms = 65535;  ///< the longest time that a picture can be shown

/// The film is repeated without end. The file appears with finish(). Errors as AtomicFile, and InputError for
/// devices, because the beginning is written last.
class ApngFile {
 public:
  explicit ApngFile(const std::filesystem::path& path);

  /// Adds the bytes of encode_png(), all of one size. Times ascend. They are rounded to milliseconds, so that none of
  /// them is off by more than half of one; a picture is shown for at most kMaxShown_ms.
  void add(std::int64_t time_ns, std::string_view png);

  /// Writes the last picture, which is shown as long as the one before it.
  void finish();

 private:
  void write_waiting(std::int64_t shown_ms);

  AtomicFile file_;
  std::string start_;    // signature and header of the pictures; empty before the first
  std::string waiting_;  // data of the last picture: how long it is shown depends on the next one
  std::int64_t waiting_ms_ = 0, shown_ms_ = 100;
  std::uint32_t written_ = 0;
};

}  // namespace simvis
