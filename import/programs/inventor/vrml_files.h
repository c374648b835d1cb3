// The VRML97 files that Coin reads, with what they include.
#pragma once

#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace simvis {

class VrmlFiles {
 public:
  explicit VrmlFiles(std::filesystem::path main) : main_(std::move(main)) {}

  /// The text that Coin reads in place of that of a file; empty: the text itself. A fault is kept for rethrow_fault().
  std::optional<std::string> text_of(const std::filesystem::path& file, std::string_view text);
  /// Keeps that `file` is opened within itself.
  void refuse_circle(const std::vector<std::filesystem::path>& chain);

  bool has_fault() const { return fault_ != nullptr; }
  void rethrow_fault() const;
  std::vector<std::string> release_warnings() { return std::move(warnings_); }

 private:
  std::string shown(const std::filesystem::path& file) const;

  std::filesystem::path main_;
  std::vector<std::string> warnings_;
  std::exception_ptr fault_;
};

}  // namespace simvis
