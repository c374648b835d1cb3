// Whether this machine may have a GPU, without a look at Vulkan's drivers.
#pragma once

#include <filesystem>

namespace simvis {

/// Whether `dev` has a file of a driver of GPUs: dri/renderD* (DRM), nvidia* and nvhost* (NVIDIA's), dxg (WSL).
bool has_gpu_node(const std::filesystem::path& dev = "/dev");

}  // namespace simvis
