// The tables of a scene: items.csv, which scans with `truth="hit"` count, and objects.csv and shapes.csv, with the ids
// that cameras and scanners give.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/object_tree.h>
#include <simvis/scan.h>
#include "program/output/growing_file.h"

namespace simvis {

/// A text as a field of a table: in quotation marks if it has a comma, a quotation mark or a line end.
std::string csv_field(const std::string& text);

/// The name of a table's file without its ending, and the table's columns.
struct SceneTable {
  const char *stem, *heading;
};
inline constexpr SceneTable kItemTable{"items", "frame,item,part,mesh,triangles\n"},
    kObjectTable{"objects", "frame,instance,object,parent,kind,semantic,class\n"},
    kShapeTable{"shapes", "frame,shape,instance,part,mesh,semantic,class\n"},
    kTimingTable{"timing", "frame,sensor,stamp_s,capture_time_s,arrival_time_s\n"};

/// The lines of a table without the numbers of frames. Names with a comma, a quotation mark or a line end stand in
/// quotation marks, and marks in them are doubled.
std::vector<std::string> item_lines(std::span<const SceneItem> items);
std::vector<std::string> shape_lines(std::span<const SceneItem> items);
/// Named places without surfaces have no line.
std::vector<std::string> object_lines(std::span<const SceneObject> objects);

/// Appends all lines in the first frame and in each frame in which they differ from those before.
class SceneTableFile {
 public:
  /// Creates the file with its heading.
  SceneTableFile(const SceneTable& table, const std::filesystem::path& file);
  /// Continues the file; frames from `frame` on are cut off.
  SceneTableFile(const SceneTable& table, const std::filesystem::path& file, std::uint64_t frame);

  void append(std::uint64_t frame, std::span<const std::string> lines);
  void finish() { file_.finish(); }  ///< as that of GrowingFile

 private:
  std::string last_;  // the lines of the last frame, without its number
  bool has_frame_ = false;
  GrowingFile file_;
};

}  // namespace simvis
