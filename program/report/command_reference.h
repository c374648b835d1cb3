// What `simvis-run --describe` prints of the commands of the scene language.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>

namespace simvis {

/// A command or statement of the scene language.
struct CommandForm {
  std::string_view name;                     ///< its tag
  std::string_view summary;                  ///< one sentence
  std::vector<AttributeSpec> attributes;     ///< all that it may carry beside those of its type
  std::vector<std::string_view> required{};  ///< names of attributes that it must carry
};

/// All commands and statements, in the order of docs/scene-language.md.
std::vector<CommandForm> command_forms();

}  // namespace simvis
