#include "engine/vulkan/gpu_node.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <system_error>

namespace simvis {
namespace {

// A folder that does not exist or cannot be read has none.
bool has_name_with(const std::filesystem::path& folder, std::string_view prefix) {
  std::error_code none;
  const std::filesystem::directory_iterator entries(folder, none);
  return std::any_of(begin(entries), end(entries), [prefix](const std::filesystem::directory_entry& entry) {
    return entry.path().filename().string().starts_with(prefix);
  });
}

}  // namespace

bool has_gpu_node(const std::filesystem::path& dev) {
  return has_name_with(dev / "dri", "renderD") || has_name_with(dev, "nvidia") || has_name_with(dev, "nvhost") ||
         has_name_with(dev, "dxg");
}

}  // namespace simvis
