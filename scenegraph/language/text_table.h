// Tables of text for people: the last column holds sentences, which wrap.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/program_api.h"

namespace simvis {

/// The cells of one row. All rows of a table have the same number of cells.
using TextRow = std::vector<std::string>;

/// Adds `line` and then `text`, wrapped between words so that lines are at most 100 columns wide. Continuation lines
/// are indented by `indent`.
void add_wrapped(std::string& page, std::string line, std::size_t indent, std::string_view text);

/// The rows with aligned columns. The last column wraps within itself.
SIMVIS_PROGRAM_API std::string text_table(std::span<const TextRow> rows);

/// The rows as a Markdown table; the cells are Markdown already.
SIMVIS_PROGRAM_API std::string markdown_rows(const TextRow& heads, std::span<const TextRow> rows);

}  // namespace simvis
