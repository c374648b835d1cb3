#include "import/model/shown_visuals.h"

#include <algorithm>

#include <simvis/location.h>
#include "engine/base/read_fence.h"

namespace simvis {
namespace {

// The deepest folder that all the files lie in; that of the first file if only a shared one has them all.
std::filesystem::path folder_of(const std::vector<std::filesystem::path>& files) {
  std::filesystem::path folder = files.front().parent_path();
  while (!std::ranges::all_of(files, [&](const std::filesystem::path& file) { return lies_in(file, {folder}); })) {
    folder = folder.parent_path();
  }
  return is_shared_folder(folder) ? files.front().parent_path() : folder;
}

}  // namespace

std::optional<std::string> outside_warning(const std::filesystem::path& file, std::string_view what,
                                           const std::vector<std::filesystem::path>& outside) {
  if (outside.empty()) return std::nullopt;
  const bool is_one = outside.size() == 1;
  return file.string() + ": " + std::to_string(outside.size()) + " " + std::string(what) + (is_one ? " is" : "s are") +
         " left out: " + (is_one ? "its file lies" : "their files lie") +
         " outside the folders of the part; --package NAME=" + folder_of(outside).string() + " adds the folder";
}

void ShownVisuals::leave_out(const std::string& why, std::size_t count) {
  if (left_out_ == 0) first_reason_ = why;
  left_out_ += count;
}

void ShownVisuals::leave_out_outside(const std::filesystem::path& visual_file) {
  outside_.push_back(without_links(visual_file));
  leave_out(outside_.back().string() + ": lies outside the folders of the part; --package NAME=" +
            folder_of({outside_.back()}).string() + " adds its folder");
}

void ShownVisuals::require(bool half) const {
  const bool is_enough = shown_ > 0 && (!half || shown_ >= left_out_);
  if (left_out_ == 0 || is_enough || may_lack_most_) return;
  const std::string all = std::to_string(shown_ + left_out_);
  fail_at({.file = file_.string()},
          (shown_ == 0 ? std::string("none of its visuals can be shown: ")
                       : "only " + std::to_string(shown_) + " of its " + all + " visuals can be shown: ") +
              first_reason_ + "; missing_visuals=\"any\" on the part shows what there is");
}

}  // namespace simvis
