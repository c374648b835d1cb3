// Attributes of the statements of a scene file that are no commands: set, repeat and include. The reader checks the
// names, `simvis-run --describe` prints the rows.
#pragma once

#include <cstdint>

#include <simvis/attributes.h>

namespace simvis {

inline constexpr std::int64_t kMaxRounds = 100'000;  // of one repetition

inline constexpr AttributeSpec kSetRows[] = {
    {.name = "name", .kind = AttributeKind::text, .text = "name of the variable"},
    {.name = "value", .text = "its value, a number or ${EXPRESSION}"},
};
inline constexpr AttributeSpec kRepeatRows[] = {
    {.name = "count",
     .kind = AttributeKind::integer,
     .text = "number of rounds",
     .min = 0,
     .max = static_cast<double>(kMaxRounds)},
    {.name = "as", .kind = AttributeKind::text, .text = "name of the variable that counts the rounds from 0"},
};
inline constexpr AttributeSpec kIncludeRows[] = {
    {.name = "file", .kind = AttributeKind::file, .text = "scene file, relative to the file that includes it"},
    {.name = "prefix",
     .kind = AttributeKind::text,
     .text = "text in front of each name that the included file defines"},
    {.name = "insert_at", .kind = AttributeKind::part, .text = "insertion point that is ROOT of the included file"},
};

}  // namespace simvis
