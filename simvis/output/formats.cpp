#include "simvis/output/formats.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include <simvis/error.h>

namespace simvis {

namespace {

struct FormatKind {
  std::string_view name;
  std::vector<std::string> formats;
  std::set<std::string> OutputFormats::*chosen;
};

const std::array<FormatKind, 3>& format_kinds() {
  static const std::array<FormatKind, 3> kinds = {
      FormatKind{"color", {"png", "jpeg", "exr"}, &OutputFormats::color},
      FormatKind{"depth", {"exr", "png", "npy"}, &OutputFormats::depth},
      FormatKind{"scan", {"csv", "npy", "npz", "ply", "pcd", "bin"}, &OutputFormats::scan}};
  return kinds;
}

std::string allowed() {
  std::string text;
  for (const FormatKind& kind : format_kinds()) {
    text += (text.empty() ? "" : "; ") + std::string(kind.name) + "=";
    for (std::size_t i = 0; i < kind.formats.size(); ++i) text += (i == 0 ? "" : ",") + kind.formats[i];
  }
  return text;
}

std::vector<std::string> split_at_commas(const std::string& text) {
  std::vector<std::string> names;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    names.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  return names;
}

}  // namespace

OutputFormats parse_formats(std::span<const std::string> values) {
  OutputFormats chosen{.color = {}, .depth = {}, .scan = {}};
  for (const std::string& value : values) {
    const std::size_t equals = value.find('=');
    const std::string wanted = equals == std::string::npos ? "" : value.substr(0, equals);
    for (const std::string& name : split_at_commas(value.substr(equals == std::string::npos ? 0 : equals + 1))) {
      bool known = false;
      for (const FormatKind& kind : format_kinds()) {
        if (equals != std::string::npos && wanted != kind.name) continue;
        for (const std::string& format : kind.formats) {
          if (format != name) continue;
          (chosen.*kind.chosen).insert(name);
          known = true;
        }
      }
      if (!known) throw InputError("\"" + value + "\" is no format, expected " + allowed());
    }
  }
  const OutputFormats standard;
  chosen.color_beside_depth = chosen.color.empty();
  for (const FormatKind& kind : format_kinds()) {
    if ((chosen.*kind.chosen).empty()) chosen.*kind.chosen = standard.*kind.chosen;
  }
  return chosen;
}

}  // namespace simvis
