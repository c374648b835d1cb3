// The outputs of a sensor type, as `--describe` and the reference print them.
#pragma once

#include <span>
#include <string>

#include <simvis/scan.h>

namespace simvis {

/// The outputs in aligned columns. Lines are at most 120 columns wide. Empty without outputs.
std::string output_text_table(std::span<const OutputSpec> outputs);

/// The outputs as a Markdown table. Empty without outputs.
std::string output_markdown_table(std::span<const OutputSpec> outputs);

}  // namespace simvis
