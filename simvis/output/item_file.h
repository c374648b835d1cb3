// The items of a scene, which scans with `truth="hit"` count: items.csv.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include <simvis/scan.h>
#include "simvis/output/growing_file.h"

namespace simvis {

inline constexpr const char* kItemHeading = "frame,item,part,mesh,triangles\n";

/// Appends all items, one line each, in the first frame and in each frame in which they differ from those before. Names
/// with a comma, a quotation mark or a line end stand in quotation marks, and marks in them are doubled.
class ItemFile {
 public:
  /// Creates the file with its heading.
  explicit ItemFile(const std::filesystem::path& file);
  /// Continues the file; frames from `frame` on are cut off.
  ItemFile(const std::filesystem::path& file, std::uint64_t frame);

  void append(std::uint64_t frame, std::span<const SceneItem> items);
  void finish() { file_.finish(); }  ///< as that of GrowingFile

 private:
  std::string last_;  // the lines of the last frame, without its number
  bool has_frame_ = false;
  GrowingFile file_;
};

}  // namespace simvis
