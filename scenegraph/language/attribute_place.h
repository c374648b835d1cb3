// Where a command says something.
#pragma once

#include <string_view>

#include <simvis/command.h>

namespace simvis {

/// The place of the attribute, or of the command if the attribute was not written.
inline const Location& place_of(const Command& command, std::string_view attribute) {
  const CommandAttribute* const found = command.find(attribute);
  return found == nullptr ? command.where : found->where;
}

}  // namespace simvis
