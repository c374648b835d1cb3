#include "program/output/item_file.h"

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

std::string item_line(const SceneItem& item, std::size_t number) {
  return std::to_string(number) + "," + csv_field(item.part) + "," + csv_field(item.mesh) + "," +
         std::to_string(item.triangles);
}

std::string instance_line(const SceneItem& item, std::size_t /*number*/) {
  return std::to_string(item.instance) + "," + csv_field(item.part) + "," + csv_field(item.mesh) + "," +
         std::to_string(item.semantic) + "," + csv_field(item.label);
}

/// The rest of the lines of the last frame among the first `bytes` bytes of a table.
std::string last_frame_of(const ItemTable& table, const std::filesystem::path& file, std::uintmax_t bytes) {
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

const ItemTable kItemTable{"items", "frame,item,part,mesh,triangles\n", item_line};
const ItemTable kInstanceTable{"instances", "frame,instance,part,mesh,semantic,class\n", instance_line};

ItemFile::ItemFile(const ItemTable& table, const std::filesystem::path& file)
    : table_(table), file_(file, std::string_view(table.heading)) {}

ItemFile::ItemFile(const ItemTable& table, const std::filesystem::path& file, std::uint64_t frame)
    : table_(table),
      last_(last_frame_of(table, file, table_start(file, frame).bytes)),
      has_frame_(!last_.empty()),
      file_(file, table_start(file, frame).bytes) {}

void ItemFile::append(std::uint64_t frame, std::span<const SceneItem> items) {
  std::string lines, rest;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string line = "," + table_.line(items[i], i) + "\n";
    lines += std::to_string(frame) + line;
    rest += line;
  }
  if (has_frame_ && rest == last_) return;
  has_frame_ = true;
  last_ = std::move(rest);
  file_.append(lines);
}

}  // namespace simvis
