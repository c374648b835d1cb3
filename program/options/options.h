// The values of the command line of simvis-run. program/options/option_table.h has the options.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/simulation_desc.h>

namespace simvis {

/// Where Foxglove looks for a server.
inline constexpr std::uint16_t kDefaultLivePort = 8765;

/// How many scans of a recording --compare takes, unless --frames says otherwise.
inline constexpr std::uint64_t kComparedScans = 20;

/// What to print of a scene in place of a run.
struct ListOptions {
  bool scene = false, types = false, json = false, check = false;
};

struct Options {
  SimulationDesc simulation;          ///< the settings that have an option of their own
  std::vector<std::string> datasets;  ///< their formats; empty: the files of a run
  std::string scene, out = "out", trajectory, method, max_error_m, profile, describe, shard, again, serve, follow,
                     record, record_policy = "wait", udp, export_file, export_heights, export_area, export_start, page,
                     compare, compare_topic, completion, save_state, restore_state;
  std::vector<std::string> set, sensors, plugins, packages, formats, poses, record_topics, record_pcap, export_ignore;
  std::vector<std::string> allow, lockstep, dds_topics;
  std::string dds_domain, dds_qos = "sensor-data", dds_node = DdsDesc{}.node;
  bool dds = false;                   ///< --dds is given
  bool dds_requests = false;          ///< change requests by DDS are executed
  bool serve_group = false;           ///< members of the group may connect too
  std::optional<std::uint16_t> live;  ///< port of the live view; 0: any free one
  std::string live_address;           ///< empty: this machine alone
  double lockstep_timeout_s = ServeDesc{}.lockstep_timeout_s;
  double real_time = 0;  ///< simulated seconds for each second of the wall clock; 0: as fast as possible
  std::uint64_t frames = 1;
  std::string rate = format_number(SimulationDesc{}.rate_hz);
  double depth_unit_m = 0.001, export_resolution_m = 0.05;
  bool list_devices = false, explain = false, quiet = false;
  bool price = false, summary = false, markdown = false, xsd = false, man = false, fit_pose = false;
  ListOptions list;
  bool resume = false, no_replace = false;
  bool names_out = false, names_frames = false;  ///< --out, --frames are given
  bool names_export_resolution = false;          ///< --export-resolution is given
  bool endless = false;                          ///< the run has no last frame: it ends when it is interrupted
  bool writes = true;                            ///< results go to files
  std::vector<std::string> command;              ///< the arguments that these options are from
};

}  // namespace simvis
