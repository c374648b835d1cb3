// Tables of attributes as Markdown, for the generated reference.
#pragma once

#include <string>
#include <string_view>

#include <simvis/attributes.h>

namespace simvis {

/// The facts that describe() prints of the attributes, as a Markdown table. Empty for an empty table.
std::string markdown_table(AttributeTable table);

/// `text` with those characters escaped that Markdown would take for markup.
std::string markdown_text(std::string_view text);

}  // namespace simvis
