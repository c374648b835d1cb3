// A recording as one HTML file, which a browser opens without a server: the page, and the messages of each frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/result_lock.h"
#include "program/live/series_log.h"
#include "program/live/view_snapshot.h"
#include "program/output/atomic_file.h"

namespace simvis::live {

/// Frames are compressed one by one, so that the page reads those that it shows. Each is a difference from the first
/// frame of its scene, so that a page can go to any of them. What graphs show is a block of its own, so that they cover
/// the whole run.
///
/// Errors   MachineError of the file and of ResultLock. It appears whole, with finish(), or not at all.
class PageFile {
 public:
  explicit PageFile(std::filesystem::path file);

  void add(const ViewFrame& frame);
  void finish();

  const std::filesystem::path& path() const { return file_.path(); }

 private:
  struct Entry {
    std::uint64_t key;  ///< number of the frame that this one is a difference from
    std::int64_t time_ns;
    std::vector<std::uint32_t> sensors;  ///< that have measured
    std::size_t warnings;                ///< that had come until then
  };
  void add_block(const std::string& id, std::string_view bytes);

  ResultLock lock_;
  AtomicFile file_;
  std::vector<Entry> entries_;
  SeriesLog series_;
  ViewFrame key_;  // its numbers alone
  std::uint64_t key_number_ = 0;
};

}  // namespace simvis::live
