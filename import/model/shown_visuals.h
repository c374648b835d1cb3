// Which visuals of a model are shown, and what the user gets to know of the others.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <simvis/part_importer.h>

namespace simvis {

class ShownVisuals {
 public:
  explicit ShownVisuals(const ImportRequest& request)
      : file_(request.file), may_lack_most_(request.allow_missing_visuals) {}

  void show() { ++shown_; }
  /// Counts a visual of which the caller warns with this reason.
  void leave_out(const std::string& why);
  /// Counts a visual whose file lies outside the folders of the part: outside_warning() has all of them.
  void leave_out_outside(const std::filesystem::path& visual_file);

  /// "FILE: 3 visuals are left out ...", with the folder that has their files; none: no file lies outside.
  std::optional<std::string> outside_warning() const;

  /// Throws InputError "FILE: error: ..." with the first reason if no visual is shown although there are some, so that
  /// no model is invisible. With `half`, at least half of them must be shown, so that no robot is a torso. Nothing is
  /// demanded where the request allows it.
  void require(bool half) const;

 private:
  std::filesystem::path file_;
  bool may_lack_most_ = false;
  std::size_t shown_ = 0, left_out_ = 0;
  std::string first_reason_;
  std::vector<std::filesystem::path> outside_;  // absolute
};

}  // namespace simvis
