// The outputs of a sensor, as `--describe`, `--list` and the reference print them.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include <simvis/scan.h>

namespace simvis {

/// The outputs with their facts, for a terminal. Empty without outputs.
std::string output_text_table(std::span<const OutputSpec> outputs);

/// The outputs as a Markdown table. Empty without outputs.
std::string output_markdown_table(std::span<const OutputSpec> outputs);

/// The same facts of one output, each under a name of its own.
nlohmann::ordered_json output_json(const OutputSpec& output);

}  // namespace simvis
