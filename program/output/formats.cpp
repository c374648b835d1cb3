#include "program/output/formats.h"

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include <simvis/location.h>
#include "engine/base/assert.h"
#include "engine/base/words.h"
#include "scenegraph/pictures/png_file.h"

namespace simvis {

namespace {

/// In the order of format_table(). It exists before the first registration of any file, and does not change once main()
/// runs.
std::vector<FormatSpec>& registered_formats() {
  static std::vector<FormatSpec> all;
  return all;
}

/// The chosen formats of each kind.
constexpr std::pair<std::string_view, std::set<std::string> OutputFormats::*> kKinds[] = {
    {"color", &OutputFormats::color}, {"depth", &OutputFormats::depth}, {"scan", &OutputFormats::scan}};

// Those whose encoders stand beside their readers.
const FormatRegistration kPngFormat({.kind = "color",
                                     .name = "png",
                                     .file = "CAMERA/000000.png",
                                     .text = "8-bit sRGB",
                                     .order = 0,
                                     .is_default = true,
                                     .encode_color = encode_png}),
    kJpegFormat({.kind = "color",
                 .name = "jpeg",
                 .file = "CAMERA/000000.jpg",
                 .text = "8-bit sRGB as JPEG of quality 95",
                 .order = 20,
                 .encode_color = encode_jpeg});

/// "color=png,jpeg depth=exr" of all formats, or of the default ones.
std::string list_formats(bool only_defaults) {
  std::string text;
  for (const auto& [kind, chosen] : kKinds) {
    std::string names;
    for (const FormatSpec& format : format_table()) {
      if (format.kind != kind || (only_defaults && !format.is_default)) continue;
      names += (names.empty() ? "" : ",") + std::string(format.name);
    }
    text += (text.empty() ? "" : " ") + std::string(kind) + "=" + names;
  }
  return text;
}

}  // namespace

FormatRegistration::FormatRegistration(const FormatSpec& format) {
  const auto place = [](const FormatSpec& each) { return std::tuple(each.kind, each.order, each.name); };
  std::vector<FormatSpec>& all = registered_formats();
  const auto known = [&](const FormatSpec& each) { return each.kind == format.kind && each.name == format.name; };
  SIMVIS_ASSERT(std::ranges::count(kKinds, format.kind, [](const auto& kind) { return kind.first; }) == 1 &&
                std::ranges::none_of(all, known));
  all.insert(std::ranges::upper_bound(all, place(format), {}, place), format);
}

std::span<const FormatSpec> format_table() { return registered_formats(); }

std::set<std::string> default_formats(std::string_view kind) {
  std::set<std::string> names;
  for (const FormatSpec& format : format_table()) {
    if (format.kind == kind && format.is_default) names.emplace(format.name);
  }
  return names;
}

std::string describe_formats() { return list_formats(false) + "; default: " + list_formats(true); }

OutputFormats parse_formats(std::span<const std::string> values) {
  OutputFormats chosen{.color = {}, .depth = {}, .scan = {}};
  for (const std::string& value : values) {
    std::optional<std::string_view> kind;  // of the names from here on; none: each kind that has the name
    for (const std::string_view cell : cells_of(value)) {
      const std::size_t equals = cell.find('=');
      if (equals != cell.npos) kind = cell.substr(0, equals);
      const std::string_view name = cell.substr(equals == cell.npos ? 0 : equals + 1);
      bool known = false;
      for (const FormatSpec& format : format_table()) {
        if (format.name != name || (kind && format.kind != *kind)) continue;
        (chosen.*std::ranges::find(kKinds, format.kind, [](const auto& each) { return each.first; })->second)
            .emplace(name);
        known = true;
      }
      if (!known) throw InputError(in_quotes(cell) + " is no format, expected " + list_formats(false));
    }
  }
  chosen.color_beside_depth = chosen.color.empty();
  for (const auto& [kind, formats] : kKinds) {
    if ((chosen.*formats).empty()) chosen.*formats = default_formats(kind);
  }
  return chosen;
}

}  // namespace simvis
