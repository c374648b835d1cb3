// The time profile of the frames of a run, in Chrome's trace format (chrome://tracing, ui.perfetto.dev).
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <simvis/frame_costs.h>
#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>
#include <simvis/simulation.h>
#include <simvis/step_costs.h>
#include "engine/base/result_lock.h"
#include "program/output/atomic_file.h"

namespace simvis {

/// The costs of one frame.
struct ProfiledFrame {
  std::uint64_t index = 0;
  /// The frame lasts from the start of the first stage to the end of the last.
  std::span<const StageTime> stages{};
  std::int64_t written_ns = 0;  ///< time at which the results were passed to the writer of files; 0 if they were not
  std::span<const SensorCost> sensors{};
  const FrameCounters& counters;
  std::uint64_t device_memory_bytes = 0;
};

/// The profile has two tracks. The host track contains the frame, its stages and their sensors. The device track
/// contains the uploads, the passes with their views, and the readbacks of each submission. The device has its own
/// clock, so its first command is placed at the time of the submission by the host. Counters have one sample per frame.
///
/// File     one event per line, so that the file can be read while it grows; complete and under its final name after
///          commit(). Times are microseconds from the start of the first frame.
/// Errors   see AtomicFile and ResultLock.
class Profile {
 public:
  Profile(std::filesystem::path path, const std::string& device);

  void add(const ProfiledFrame& frame);
  /// Adds the device events of the frame that was added last.
  void add(const FramePlan& plan, const FrameCosts& costs);

  void commit();

 private:
  struct Span {
    std::string name;
    const char* category;
    int track;
    std::int64_t start_ns, end_ns;
    std::vector<std::pair<const char*, std::uint64_t>> counts{};
    std::string reason{};
  };
  void write_span(const Span& span);
  void write_counters(const ProfiledFrame& frame, std::int64_t time_ns);
  void write_line(const std::string& event);

  ResultLock lock_;
  AtomicFile file_;
  std::uint64_t frame_ = 0;
  std::int64_t first_ns_ = -1;
  bool any_ = false;  // a line has been written
};

}  // namespace simvis
