// The assets that Foxglove's clients fetch to draw robots: the mesh files that the URDF of /robot_description
// names and that were read for it, and no other file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace simvis::live {

/// Files, without symbolic links, by the names that the URDF has for them, such as package://arm/base.dae.
using AssetFiles = std::map<std::string, std::filesystem::path>;

struct AssetRequest {
  std::string uri;
  std::uint32_t id = 0;  ///< of the client
};

/// The binary message that answers a request: the bytes of the file, or why there are none.
std::string asset_answer(const AssetFiles& files, const AssetRequest& request);

}  // namespace simvis::live
