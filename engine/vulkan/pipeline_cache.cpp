#include "engine/vulkan/pipeline_cache.h"

#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>

#include "engine/base/cache_file.h"
#include "engine/vulkan/vulkan_check.h"

namespace simvis {
namespace {

// The file's header, before the driver's data. The driver's own header has no checksum, and some drivers do not check
// the data that they are given.
struct FileHeader {
  char magic[8];
  std::uint32_t vendor, device, driver_version, unused;
  std::uint8_t uuid[VK_UUID_SIZE];
  std::uint64_t size, checksum;
};
static_assert(sizeof(FileHeader) == 56);

FileHeader header_for(const VkPhysicalDeviceProperties& properties, const std::vector<char>& data) {
  FileHeader header{.magic = {'S', 'I', 'M', 'V', 'I', 'S', 'P', '1'},
                    .vendor = properties.vendorID,
                    .device = properties.deviceID,
                    .driver_version = properties.driverVersion,
                    .unused = 0,
                    .uuid = {},
                    .size = data.size(),
                    .checksum = cache_checksum({data.data(), data.size()})};
  std::memcpy(header.uuid, properties.pipelineCacheUUID, VK_UUID_SIZE);
  return header;
}

std::string file_name(const VkPhysicalDeviceProperties& properties) {
  std::string name = "pipelines-";
  char hex[16];
  for (const std::uint8_t byte : properties.pipelineCacheUUID) {
    std::snprintf(hex, sizeof hex, "%02x", byte);
    name += hex;
  }
  std::snprintf(hex, sizeof hex, "-%08x", properties.driverVersion);
  return name + hex + ".bin";
}

// The driver's data in the file. Empty unless the file is unchanged since this device and driver wrote it.
std::vector<char> read(const std::filesystem::path& file, const VkPhysicalDeviceProperties& properties) {
  std::ifstream in(file, std::ios::binary);
  FileHeader header;
  if (!in.read(reinterpret_cast<char*>(&header), sizeof header)) return {};
  std::vector<char> data{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  const FileHeader expected = header_for(properties, data);
  if (std::memcmp(&header, &expected, sizeof header) != 0) return {};
  return data;
}

}  // namespace

PipelineCache::PipelineCache(VkDevice device, const VkPhysicalDeviceProperties& properties,
                             const std::filesystem::path& folder)
    : device_(device), properties_(properties) {
  if (!folder.empty()) {
    file_ = folder / file_name(properties);
    loaded_ = read(file_, properties);
  }
  // SwiftShader keeps no pipelines, and returns its header with all that it was given behind it. Given a header, the
  // file would grow by another one with each run.
  const bool has_pipelines = loaded_.size() > sizeof(VkPipelineCacheHeaderVersionOne);
  const VkPipelineCacheCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO,
                                       .pNext = nullptr,
                                       .flags = 0,
                                       .initialDataSize = has_pipelines ? loaded_.size() : 0,
                                       .pInitialData = loaded_.data()};
  vk_check(vkCreatePipelineCache(device_, &info, nullptr, &cache_), "vkCreatePipelineCache");
}

PipelineCache::~PipelineCache() { vkDestroyPipelineCache(device_, cache_, nullptr); }

void PipelineCache::save() const {
  if (file_.empty()) return;
  std::size_t size = 0;
  if (vkGetPipelineCacheData(device_, cache_, &size, nullptr) != VK_SUCCESS) return;
  std::vector<char> data(size);
  if (vkGetPipelineCacheData(device_, cache_, &size, data.data()) != VK_SUCCESS) return;
  data.resize(size);
  if (data == loaded_) return;

  const FileHeader header = header_for(properties_, data);
  std::string content(reinterpret_cast<const char*>(&header), sizeof header);
  content.append(data.data(), data.size());
  write_cache_file(file_, content);
}

}  // namespace simvis
