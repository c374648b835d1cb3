// The file formats that a run writes, as `--format` chooses them. To add one with a file for each frame, add a file
// with its encoder and one static FormatRegistration; no other file changes: --help and the tables of
// docs/command-line.md have it.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <string_view>

namespace simvis {

struct Image;
struct ImageSpan;
struct TableFrame;

/// A format of one kind of data.
struct FormatSpec {
  std::string_view kind;       ///< "color", "depth" or "scan"
  std::string_view name;       ///< as `--format` takes it
  std::string_view file;       ///< the file in the folder of the run, for users
  std::string_view text;       ///< what the file holds, as Markdown
  std::uint32_t order = 1000;  ///< among the formats of its kind: ascending, then by name
  bool is_default = false;     ///< written if no format of the kind is chosen
  /// The bytes of a frame's file, whose ending is that of `file`; by the kind one of three. Without it, OutputWriter
  /// writes the format. It is called in any thread; `unit_m` is OutputFormats::depth_unit_m.
  std::string (*encode_color)(const ImageSpan& color) = nullptr;
  std::string (*encode_depth)(const Image& depth, double unit_m) = nullptr;
  std::string (*encode_table)(const TableFrame& table) = nullptr;
  bool (*fits)(const TableFrame& table) = nullptr;  ///< whether it can hold this table; null: any
};

/// A static object of this type adds a format. Strings must live as long as the program, and the name must be new among
/// the formats of its kind (asserted).
struct FormatRegistration {
  explicit FormatRegistration(const FormatSpec& format);
};

/// All formats, kind by kind, in their order.
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
