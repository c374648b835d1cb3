// The tables of the items of a scene: items.csv, which scans with `truth="hit"` count, and instances.csv, with the ids
// that cameras and scanners give.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include <simvis/scan.h>
#include "program/output/growing_file.h"

namespace simvis {

/// A text as a field of a table: in quotation marks if it has a comma, a quotation mark or a line end.
std::string csv_field(const std::string& text);

/// A table of items: its columns, and the line of one item without the number of the frame.
struct ItemTable {
  const char *stem,  ///< of the file's name
      *heading;
  std::string (*line)(const SceneItem& item, std::size_t number);
};

/// frame,item,part,mesh,triangles
extern const ItemTable kItemTable;
/// frame,instance,part,mesh,semantic,class
extern const ItemTable kInstanceTable;

/// Appends all items, one line each, in the first frame and in each frame in which they differ from those before. Names
/// with a comma, a quotation mark or a line end stand in quotation marks, and marks in them are doubled.
class ItemFile {
 public:
  /// Creates the file with its heading.
  ItemFile(const ItemTable& table, const std::filesystem::path& file);
  /// Continues the file; frames from `frame` on are cut off.
  ItemFile(const ItemTable& table, const std::filesystem::path& file, std::uint64_t frame);

  void append(std::uint64_t frame, std::span<const SceneItem> items);
  void finish() { file_.finish(); }  ///< as that of GrowingFile

 private:
  const ItemTable& table_;
  std::string last_;  // the lines of the last frame, without its number
  bool has_frame_ = false;
  GrowingFile file_;
};

}  // namespace simvis
