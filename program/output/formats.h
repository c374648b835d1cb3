// The file formats that a run writes, as `--format` chooses them: one row for each format of each kind of data.
#pragma once

#include <set>
#include <span>
#include <string>
#include <string_view>

namespace simvis {

/// A format of one kind of data.
struct FormatSpec {
  std::string_view kind;    ///< "color", "depth" or "scan"
  std::string_view name;    ///< as `--format` takes it
  std::string_view file;    ///< the file in the folder of the run, for users
  std::string_view text;    ///< what the file holds, as Markdown
  bool is_default = false;  ///< written if no format of the kind is chosen
};

/// All formats, kind by kind.
std::span<const FormatSpec> format_table();

/// The default formats of a kind.
std::set<std::string> default_formats(std::string_view kind);

/// All kinds with their formats and defaults, in one line.
std::string describe_formats();

/// The formats of each kind of data. Each kind has at least one.
struct OutputFormats {
  std::set<std::string> color = default_formats("color");
  std::set<std::string> depth = default_formats("depth");
  std::set<std::string> scan = default_formats("scan");
  /// Whether the EXR of a camera with depth also holds its colour: if no format of colour was chosen.
  bool color_beside_depth = true;
  double depth_unit_m = 0.001;  ///< the length of one code of a depth PNG

  bool operator==(const OutputFormats&) const = default;
};

/// Reads the values of `--format`: "[KIND=]NAME[,NAME...]". A name without a kind counts for every kind that has it.
/// Kinds that no value names keep their defaults. Throws InputError naming the value and what is allowed.
OutputFormats parse_formats(std::span<const std::string> values);

}  // namespace simvis
