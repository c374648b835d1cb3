#include "program/live/page_assets.h"

#include <algorithm>
#include <utility>

namespace simvis::live {

std::string_view page_asset(std::string_view name) {
  const std::span<const PageAsset> all = page_assets();
  const auto found = std::ranges::find(all, name, &PageAsset::name);
  return found == all.end() ? std::string_view() : found->bytes;
}

std::string_view media_type(std::string_view name) {
  constexpr std::pair<std::string_view, std::string_view> kTypes[] = {{".html", "text/html; charset=utf-8"},
                                                                      {".css", "text/css; charset=utf-8"},
                                                                      {".js", "text/javascript; charset=utf-8"},
                                                                      {".glb", "model/gltf-binary"},
                                                                      {".txt", "text/plain; charset=utf-8"}};
  for (const auto& [ending, type] : kTypes) {
    if (name.ends_with(ending)) return type;
  }
  return "application/octet-stream";
}

}  // namespace simvis::live
