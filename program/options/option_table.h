// The options of simvis-run as one table. Parsing, `--help` and the tables of docs/command-line.md follow from its
// rows.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "program/options/options.h"

namespace simvis {

/// The groups of --help, in its order.
enum class OptionGroup : std::uint8_t { run, sensors, results, reports, processes, instead_of_run };

/// What a value must be, besides a value of the target's type.
enum class OptionCheck : std::uint8_t {
  none,
  above_zero,  ///< a number above 0
  whole,       ///< a whole number from 0 to 2^64 - 1
  not_empty,   ///< a text
  one_of       ///< one of the words that OptionSpec::value separates by "|"
};

/// Where the value of an option goes. A list takes one value each time that the option is given.
using OptionTarget = std::variant<bool*, double*, unsigned*, std::uint64_t*, std::string*,
                                  std::optional<std::uint16_t>*, std::vector<std::string>*>;

/// One option. Texts are Markdown in which only `code` is marked; --help prints them without the marks.
struct OptionSpec {
  OptionGroup group;
  std::string_view names;                      ///< "-o,--out"
  OptionTarget (*target)(Options&) = nullptr;  ///< without one: that of `setting`, or --help and --version
  std::string_view value{};                    ///< what stands for the value, such as "DIR"; empty: a flag
  std::string_view text{};                     ///< what it does; empty: the text of `setting`
  std::string_view setting{};        ///< the setting of a simulation that it sets (program/options/settings.h)
  std::string_view absent_word{};    ///< the value that stands for no value of `setting`
  std::string (*facts)() = nullptr;  ///< behind the text in brackets, from constants of the program
  /// Values that shells complete, separated by spaces, beside the lower-case words of `value`.
  std::string (*choices)() = nullptr;
  std::string_view more{};   ///< Markdown behind the text, in the document alone
  std::string_view needs{};  ///< names of options, one of which must be given with it
  OptionCheck check = OptionCheck::none;
  bool is_value_optional = false;  ///< the option may stand without a value
  bool splits_at_commas = false;   ///< of a list: one value gives several
  bool hides_default = false;      ///< the default stands for "no value"
  bool changes_no_result = false;  ///< it may stand beside --again and a --resume without a scene
};

/// All options, group by group.
std::span<const OptionSpec> option_table();

/// Pairs of options that exclude each other.
struct OptionExclusion {
  std::string_view option;
  std::string_view others;  ///< separated by spaces
};
std::span<const OptionExclusion> option_exclusions();

/// Where the value of this option goes, or nothing for --help and --version.
std::optional<OptionTarget> target_of(const OptionSpec& option, Options& options);

/// A command or a status, and what it does or means.
struct UsageNote {
  std::string_view head, text;
};

/// What simvis-run is, in one sentence.
inline constexpr std::string_view kProgramSummary = "simulates what the sensors of a robot measure";

/// Command lines for a start.
std::span<const UsageNote> usage_examples();

/// All exit statuses.
std::span<const UsageNote> exit_statuses();

/// The title of a group in --help and in the document.
std::string_view title_of(OptionGroup group);

/// The default as it is written, or an empty text.
std::string default_text(const OptionSpec& option);

/// The text of --help.
std::string help_text(const OptionSpec& option);

/// The tables of docs/command-line.md, one for each group.
std::string option_document();

}  // namespace simvis
