// What each frame of a run spent its time on, for people: Chrome's trace format (chrome://tracing, ui.perfetto.dev).
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
#include <simvis/sensor_cost.h>
#include <simvis/simulation.h>
#include "simvis/output/atomic_file.h"

namespace simvis {

/// What one frame cost.
struct ProfiledFrame {
  std::uint64_t index = 0;
  /// The frame is the time from the first of them to the last.
  std::span<const StageTime> stages{};
  std::int64_t written_ns = 0;  ///< when the results were handed over for files; 0: they were not
  std::span<const SensorCost> sensors{};
  const FrameCounters& counters;
  std::uint64_t device_memory_bytes = 0;
};

/// Two tracks: what the host did, and what the device did. Host: the frame, of it the stages, of these the sensors.
/// Device: of each submission the uploads, the passes, of these the views, and the readbacks. A device has a clock of
/// its own: its first command stands where the host handed the frame over. Counters: one sample for each frame.
///
/// File     one event in each line, so that it can be read as it grows; whole and under its name after commit(). Times
///          are microseconds from the first frame's start.
/// Errors   see AtomicFile.
class Profile {
 public:
  Profile(std::filesystem::path path, const std::string& device);

  void add(const ProfiledFrame& frame);
  /// What the device did in the frame that was added last.
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

  AtomicFile file_;
  std::uint64_t frame_ = 0;
  std::int64_t first_ns_ = -1;
  bool any_ = false;  // line has been written
};

}  // namespace simvis
