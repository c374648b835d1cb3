// The messages of a running simulation, for callers that do not write them to a file, and messages to it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/program_api.h"
#include "exchange/messages/message_outlet.h"
#include "simvis/ros/command_inputs.h"

namespace simvis {

class Simulation;

/// From now on, the messages of each step also go to `outlet`, which must outlive the simulation, in the order of
/// docs/messages.md; null ends this. Throws InputError as check_messages(). A later command after which
/// check_messages() would throw is an error.
SIMVIS_PROGRAM_API void send_messages(Simulation& simulation, ros::MessageOutlet* outlet);

/// The topics on which elements of the simulation take commands of robots, and their types. Throws InputError while a
/// frame is under way.
SIMVIS_PROGRAM_API std::vector<CommandInput> command_inputs(const Simulation& simulation);

/// The mesh files that the descriptions of robots name and that were read, by these names: what a client needs to draw
/// the robots.
/// Throws InputError while a frame is under way.
SIMVIS_PROGRAM_API std::map<std::string, std::filesystem::path> files_of_robots(const Simulation& simulation);

/// The bytes of one of these files; empty: it has more than `max_bytes`. If a symbolic link has taken its name, or that
/// of a folder above it, nothing is read. Throws InputError and MachineError: it cannot be read.
SIMVIS_PROGRAM_API std::optional<std::string> read_robot_file(const std::filesystem::path& file, std::size_t max_bytes);

/// Applies a stranger's message to the next frame; `now_ns` is the time of the last one. Throws InputError, and nothing
/// is set: see apply_command(); a frame is under way.
SIMVIS_PROGRAM_API void send_command(Simulation& simulation, const CommandInput& input, std::string_view bytes,
                                     std::int64_t now_ns);

}  // namespace simvis
