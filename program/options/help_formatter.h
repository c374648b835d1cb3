// The layout of `simvis-run --help`.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace simvis {

/// Prints options in groups, each with its value and default, and wraps texts to lines of at most 100 columns. Which
/// options exclude or need each other is left to the message of a wrong command line: the lists would hide the texts.
struct HelpFormatter : CLI::Formatter {
  HelpFormatter();
  std::string make_group(std::string title, bool is_positional, std::vector<const CLI::Option*> options) const override;
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
};

}  // namespace simvis
