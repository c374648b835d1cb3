// Attribute tables as texts and as Markdown, for the generated reference.
#pragma once

#include <string>
#include <string_view>

#include <simvis/attributes.h>
#include "engine/base/program_api.h"

namespace simvis {

/// The name of a kind in tables, such as "number" or "3 numbers".
SIMVIS_PROGRAM_API std::string_view kind_text(AttributeKind kind);

/// Returns the facts that describe() prints about the attributes, as a Markdown table. Empty for an empty table.
SIMVIS_PROGRAM_API std::string markdown_table(AttributeTable table);

/// Returns `text` with the characters escaped that Markdown would read as markup.
SIMVIS_PROGRAM_API std::string markdown_text(std::string_view text);

}  // namespace simvis
