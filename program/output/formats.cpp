#include "program/output/formats.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <simvis/error.h>

namespace simvis {

namespace {

constexpr FormatSpec kFormats[] = {
    {"color", "png", "CAMERA/000000.png", "8-bit sRGB", true},
    {"color", "jpeg", "CAMERA/000000.jpg", "the same as JPEG of quality 95"},
    {"color", "apng", "CAMERA.apng",
     "the frames of the run as one animated PNG of 8-bit sRGB, which browsers play at the speed of simulated time; it "
     "appears at the end of the run"},
    {"color", "exr", "CAMERA/000000.exr", "32-bit floats R G B (linear)"},
    {"color", "rgb8", "CAMERA/000000.npy",
     "a NumPy array of uint8, height x width x 3: the pixels of the PNG without its compression, which is fast to "
     "write"},
    {"depth", "exr", "CAMERA/000000.exr",
     "of cameras whose `outputs` has depth: 32-bit floats Z (metres along the optical axis, `inf` where nothing is "
     "hit), with the colour R G B (linear) unless a format of colour is chosen",
     true},
    {"depth", "png", "CAMERA_depth/000000.png",
     "16-bit codes of `--depth-unit`, 0 where nothing is hit or the code would exceed 65535"},
    {"depth", "npy", "CAMERA_depth/000000.npy", "a NumPy array of float32, metres"},
    {"scan", "csv", "SCANNER.csv", "the table of all frames, one row for each beam", true},
    {"scan", "npy", "SCANNER/000000.npy",
     "the same columns for one frame, without `frame` and `time_s`: a structured NumPy array with float32 for what "
     "the CSV prints with nine digits, float64 for angles, and int64 for whole numbers"},
    {"scan", "npz", "SCANNER/000000.npz",
     "one NumPy array for each column, with `frame`, `time_s` and `world_from_sensor` (4 x 4)"},
    {"scan", "ply", "SCANNER/000000.ply",
     "the beams that hit something, as binary points x y z in the sensor's frame with the other columns, angles as "
     "doubles; the comments hold the pose of the sensor"},
    {"scan", "pcd", "SCANNER/000000.pcd", "the same; `VIEWPOINT` holds the pose of the sensor"},
    {"scan", "bin", "SCANNER/000000.bin",
     "KITTI's layout: four float32 for each point, x y z and `intensity` (0 without such a column)"},
    {"scan", "evt3", "EVENTS/000000.raw",
     "of event cameras of up to 2048 x 2048 pixels: the events as Prophesee's EVT 3.0 with its header"},
};

/// The chosen formats of each kind.
constexpr std::pair<std::string_view, std::set<std::string> OutputFormats::*> kKinds[] = {
    {"color", &OutputFormats::color}, {"depth", &OutputFormats::depth}, {"scan", &OutputFormats::scan}};

/// "color=png,jpeg depth=exr" of all formats, or of the default ones.
std::string list_formats(bool only_defaults) {
  std::string text;
  for (const auto& [kind, chosen] : kKinds) {
    std::string names;
    for (const FormatSpec& format : kFormats) {
      if (format.kind != kind || (only_defaults && !format.is_default)) continue;
      names += (names.empty() ? "" : ",") + std::string(format.name);
    }
    text += (text.empty() ? "" : " ") + std::string(kind) + "=" + names;
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

std::span<const FormatSpec> format_table() { return kFormats; }

std::set<std::string> default_formats(std::string_view kind) {
  std::set<std::string> names;
  for (const FormatSpec& format : kFormats) {
    if (format.kind == kind && format.is_default) names.emplace(format.name);
  }
  return names;
}

std::string describe_formats() { return list_formats(false) + "; default: " + list_formats(true); }

OutputFormats parse_formats(std::span<const std::string> values) {
  OutputFormats chosen{.color = {}, .depth = {}, .scan = {}};
  for (const std::string& value : values) {
    const std::size_t equals = value.find('=');
    const bool names_kind = equals != std::string::npos;
    for (const std::string& name : split_at_commas(value.substr(names_kind ? equals + 1 : 0))) {
      bool known = false;
      for (const FormatSpec& format : kFormats) {
        if (format.name != name || (names_kind && format.kind != value.substr(0, equals))) continue;
        (chosen.*std::ranges::find(kKinds, format.kind, [](const auto& kind) { return kind.first; })->second)
            .insert(name);
        known = true;
      }
      if (!known) throw InputError("\"" + value + "\" is no format, expected " + list_formats(false));
    }
  }
  chosen.color_beside_depth = chosen.color.empty();
  for (const auto& [kind, formats] : kKinds) {
    if ((chosen.*formats).empty()) chosen.*formats = default_formats(kind);
  }
  return chosen;
}

}  // namespace simvis
