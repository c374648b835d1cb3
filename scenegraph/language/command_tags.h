// The tags of commands in scene files.
#pragma once

#include <array>
#include <string_view>

namespace simvis {

/// Commands that change a scene, in the order of CommandKind.
inline constexpr std::array<std::string_view, 4> kCommandTags{"part", "element", "sensor", "remove"};

/// Statements of which the reader makes commands.
inline constexpr std::string_view kSet = "set", kRepeat = "repeat", kInclude = "include", kRandomize = "randomize";

inline constexpr std::array kTags{kCommandTags[0], kCommandTags[1], kCommandTags[2], kCommandTags[3], kInclude, kSet,
                                  kRepeat,         kRandomize};

}  // namespace simvis
