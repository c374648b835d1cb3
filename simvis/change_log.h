// The log of the commands that made a scene (Parameters::changes()), read again.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <simvis/command.h>

namespace simvis {

/// A command of the log.
Command logged_command(const std::string& text);

/// The numbers in the log of the commands whose objects stand in the scene, ascending: without those that were removed
/// later, and without the removals.
std::vector<std::size_t> standing_commands(std::span<const std::string> log);

}  // namespace simvis
