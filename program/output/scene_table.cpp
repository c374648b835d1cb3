#include "program/output/scene_table.h"

#include <fstream>
#include <string_view>

#include "program/output/pose_files.h"

namespace simvis {

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + "\"";
}

namespace {

/// The rest of the lines of the last frame among the first `bytes` bytes of a table.
std::string last_frame_of(const SceneTable& table, const std::filesystem::path& file, std::uintmax_t bytes) {
  std::ifstream stream(file, std::ios::binary);
  std::string text(bytes, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(bytes));
  std::string last, frame;
  const std::string_view heading = table.heading;
  std::string_view rest = text;
  rest.remove_prefix(std::min(heading.size(), rest.size()));
  while (!rest.empty()) {
    const std::size_t comma = std::min(rest.find(','), rest.size()), end = std::min(rest.find('\n'), rest.size() - 1);
    if (rest.substr(0, comma) != frame) last.clear();
    frame = rest.substr(0, comma);
    last += rest.substr(comma, end + 1 - comma);
    rest.remove_prefix(end + 1);
  }
  return last;
}

}  // namespace

std::vector<std::string> item_lines(std::span<const SceneItem> items) {
  std::vector<std::string> lines;
  for (const SceneItem& item : items) {
    lines.push_back(std::to_string(lines.size()) + "," + csv_field(item.part) + "," + csv_field(item.mesh) + "," +
                    std::to_string(item.triangles));
  }
  return lines;
}

std::vector<std::string> shape_lines(std::span<const SceneItem> items) {
  std::vector<std::string> lines;
  for (const SceneItem& item : items) {
    lines.push_back(std::to_string(item.shape) + "," + std::to_string(item.instance) + "," + csv_field(item.part) +
                    "," + csv_field(item.mesh) + "," + std::to_string(item.semantic) + "," + csv_field(item.label));
  }
  return lines;
}

std::vector<std::string> object_lines(std::span<const SceneObject> objects) {
  std::vector<std::string> lines;
  for (const SceneObject& object : objects) {
    if (object.kind == ObjectKind::frame && object.surfaces.empty()) continue;
    lines.push_back(std::to_string(object.instance) + "," + csv_field(object.path) + "," +
                    std::to_string(object.parent) + "," + std::string(to_string(object.kind)) + "," +
                    std::to_string(object.semantic) + "," + csv_field(object.label));
  }
  return lines;
}

SceneTableFile::SceneTableFile(const SceneTable& table, const std::filesystem::path& file)
    : file_(file, std::string_view(table.heading)) {}

SceneTableFile::SceneTableFile(const SceneTable& table, const std::filesystem::path& file, std::uint64_t frame)
    : last_(last_frame_of(table, file, table_start(file, frame).bytes)),
      has_frame_(!last_.empty()),
      file_(file, table_start(file, frame).bytes) {}

void SceneTableFile::append(std::uint64_t frame, std::span<const std::string> lines) {
  std::string numbered, rest;
  for (const std::string& each : lines) {
    const std::string line = "," + each + "\n";
    numbered += std::to_string(frame) + line;
    rest += line;
  }
  if (has_frame_ && rest == last_) return;
  has_frame_ = true;
  last_ = std::move(rest);
  file_.append(numbered);
}

}  // namespace simvis
