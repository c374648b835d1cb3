// Which visuals of a model are shown, and what the user gets to know of the others.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/part_importer.h>

namespace simvis {

/// "FILE: 3 visuals are left out: their files lie outside ...", with the folder that has the files, which are absolute;
/// none: there are no files. `what` is what each of them is, such as "visual".
std::optional<std::string> outside_warning(const std::filesystem::path& file, std::string_view what,
                                           const std::vector<std::filesystem::path>& outside);

class ShownVisuals {
 public:
  explicit ShownVisuals(const ImportRequest& request)
      : file_(request.file), may_lack_most_(request.allow_missing_visuals) {}

  void show(std::size_t count = 1) { shown_ += count; }
  /// Counts visuals of which the caller warns with this reason.
  void leave_out(const std::string& why, std::size_t count = 1);
  /// Counts a visual whose file lies outside the folders of the part: outside_warning() has all of them.
  void leave_out_outside(const std::filesystem::path& visual_file);

  std::optional<std::string> outside_warning() const { return simvis::outside_warning(file_, "visual", outside_); }

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
