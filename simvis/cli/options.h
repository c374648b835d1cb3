// The command line of simvis-run.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/simulation_desc.h>
#include "simvis/cli/list_options.h"

namespace simvis {

struct Options {
  std::string scene, out = "out", trajectory, method, max_error_m, device, profile, describe, shard, again, serve,
                     follow, record, record_policy = "wait", record_pcap, udp, export_file, page;
  std::vector<std::string> set, sensors, plugins, packages, formats, poses, record_topics;
  std::vector<std::string> allow, lockstep, dds_topics;
  std::string dds_domain, dds_qos = "sensor-data";
  bool dds = false;                   ///< --dds is given
  bool serve_group = false;           ///< members of the group may connect too
  std::optional<std::uint16_t> live;  ///< port of the live view; 0: any free one
  std::string live_address;           ///< empty: this machine alone
  double lockstep_timeout_s = ServeDesc{}.lockstep_timeout_s;
  double real_time = 0;  ///< simulated seconds for each second of the wall clock; 0: as fast as possible
  std::uint64_t frames = 1, seed = 0;
  unsigned threads = 0;
  std::string rate = format_number(SimulationDesc{}.rate_hz);
  double rate_hz = SimulationDesc{}.rate_hz, depth_unit_m = 0.001;
  bool list_devices = false, explain = false, quiet = false;
  bool price = false, summary = false, markdown = false;
  ListOptions list;
  bool frames_when_due = false, strict = false;
  bool resume = false, no_replace = false;
  bool names_out = false, names_frames = false;  ///< --out, --frames are given
  bool endless = false;                          ///< the run has no last frame: it ends when it is interrupted
  bool writes = true;                            ///< results go to files
  std::vector<std::string> command;              ///< the arguments that these options are from
};

/// Options, or the exit status of a program that has already printed what was asked for: its help, its version.
struct ParsedOptions {
  Options options;
  std::optional<int> exit_status;
};

/// `arguments` without the program's name. Throws InputError.
ParsedOptions parse_options(std::vector<std::string> arguments);

/// The options of the run that --again names, or that --resume without a scene goes on with, with those of `given` that
/// concern only this execution: --out, --quiet, --threads, --device, --no-replace, and --frames for --resume. Other
/// options as given. Throws InputError: the report cannot be read, or an option is given that the run has fixed.
Options recorded_options(const Options& given);

}  // namespace simvis
