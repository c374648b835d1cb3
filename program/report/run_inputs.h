// What a run depends on: files and their hashes, the attributes of sensors, the machine.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <simvis/command.h>

namespace simvis {

/// Names of files and the SHA-256 of their contents.
using FileHashes = std::map<std::string, std::string>;

/// Files below the working folder are named from there, so that the names also hold for a copy of that folder.
FileHashes hashes_of(std::span<const std::filesystem::path> files);

/// Environment variables with their values; none: not set.
using RecordedVariables = std::map<std::string, std::optional<std::string>>;

/// Sets and unsets those of recorded_variables() in this process: a report is a file of its author, and other variables
/// choose programs and drivers. Returns the names of the others. No other thread may use the environment at the same
/// time.
std::vector<std::string> set_environment(const RecordedVariables& environment);

using NamedTexts = std::vector<std::pair<std::string, std::string>>;

/// The attributes of a sensor's command.
NamedTexts given_attributes(const Command& sensor);

/// The attributes that the command does not give and that have a default, with it.
NamedTexts default_attributes(const Command& sensor);

/// The machine that a run was made on.
struct HostInfo {
  std::string name,      ///< in the network
      system,            ///< operating system, its version, kind of processor
      processor;         ///< model; empty if it is unknown
  unsigned threads = 0;  ///< of the processor
};
HostInfo host_info();

}  // namespace simvis
