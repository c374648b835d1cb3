// The report of a run: its parameters and its speed, for run.json and the final lines on the terminal.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <simvis/device_info.h>
#include <simvis/simulation.h>
#include "engine/base/thinned_list.h"
#include "program/output/output_writer.h"
#include "program/report/run_inputs.h"
#include "program/report/shard.h"

namespace simvis {

/// What a run depends on, besides the scene, the device and the seed.
struct RunRecord {
  std::vector<std::string> command;              ///< the command line, without the program
  std::vector<std::string> set;                  ///< the values of --set
  std::string trajectory;                        ///< the file; empty: none
  FileHashes inputs;                             ///< all files that were read: scene, parts, trajectory, plug-ins
  RecordedVariables environment;                 ///< the variables that led to these files
  HostInfo host;                                 ///< the machine
  OutputFormats formats;                         ///< of the files
  std::vector<std::string> poses;                ///< parts whose poses were asked for
  std::map<std::string, NamedTexts> attributes,  ///< of each sensor, as executed
      defaults;                                  ///< of the attributes that are not given
};

/// How well a run has kept to the wall clock.
struct Punctuality {
  std::uint64_t late_frames = 0;  ///< frames that began more than a frame's time late
  double largest_lag_s = 0;       ///< by the wall clock
};

/// A run that was to keep to the wall clock.
struct RealTimeRecord {
  double factor = 1;  ///< simulated seconds for each second
  Punctuality punctuality{};
};

/// The contents of run.json.
struct RunReport {
  std::string scene;  ///< as given
  RunRecord record{};
  std::string status =
      "running";  ///< then "complete", "stopped" by a signal, or "failed"; a killed run stays "running"
  std::uint64_t frames_wanted = 0;            ///< the run has the frames 0 to frames_wanted - 1, or its shard of them
  bool endless = false;                       ///< `frames_wanted` does not apply
  std::optional<ServeDesc> served{};          ///< set by --serve
  std::string followed{};                     ///< the name of --follow
  std::optional<RealTimeRecord> real_time{};  ///< set by --real-time
  std::uint64_t next_frame = 0;               ///< the first frame that was not written
  RunFiles files{};
  std::optional<DeviceInfo> device{};  ///< empty: the run needs none
  std::uint64_t seed = 0;
  std::optional<Shard> shard{};  ///< set if the run is a shard
  double rate_hz = 0;
  bool frames_when_due = false;  ///< `rate_hz` does not apply
  double simulated_s = 0;        ///< simulated time of the frames made, up to the next frame
  double wall_s = 0;             ///< time from the start of the program to its last file
  double later_frames_s = 0;     ///< from the end of the first frame of this process until the last file is written
  /// Of each step() of this process, of long runs evenly spaced ones; files are written in parallel and not included.
  ThinnedList<double> frame_ms;
  std::vector<SensorInfo> sensors;
  std::vector<std::string> warnings{};                 ///< of the scene and of the frames
  std::optional<RecordReport> recording{};             ///< of --record, when it has ended
  std::vector<std::optional<PacketReport>> packets{};  ///< of each --record-pcap, when it has ended
  std::optional<PacketReport> sent_packets{};          ///< of --udp, when it has ended
  std::optional<DdsReport> dds{};                      ///< of --dds, when it has ended
};

/// The sensors of the simulation with the error bounds of their depth images. Bounds that are not known yet are
/// computed here.
std::vector<SensorInfo> with_bounds(const Simulation& simulation);

/// The p-th percentile, 0 < p <= 100: the smallest value that at least p percent of the values do not exceed. 0 if
/// `values` is empty.
double percentile(std::span<const double> values, double p);

/// The report as JSON. A bound that is not finite is null.
std::string to_json(const RunReport& report);

/// "30 frames, 2.43 ms a frame: 411.5 Hz, 27.43 x real time at 15 Hz; 1.60 s with loading and files: 1.25 x real time;
/// 2 warnings": from the median time of a frame, and from the whole time of the program.
std::string speed_line(const RunReport& report);

}  // namespace simvis
