// The files of the page, which lie in the program.
#pragma once

#include <span>
#include <string_view>

namespace simvis::live {

struct PageAsset {
  std::string_view name;  ///< without a folder: "index.html"
  std::string_view bytes;
};

/// Valid for the rest of the program.
std::span<const PageAsset> page_assets();

/// The file of this name; empty if there is none.
std::string_view page_asset(std::string_view name);

/// The type of a file for HTTP, by the ending of its name.
std::string_view media_type(std::string_view name);

}  // namespace simvis::live
