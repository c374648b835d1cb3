#include "scenegraph/gltf_textures.h"

#include <stb_image.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include "scenegraph/gltf_accessors.h"

namespace simvis {
namespace {

constexpr int kMaxSide_px = 16384;
constexpr int kChannels = 4;

bool starts_with(std::span<const std::uint8_t> bytes, std::span<const std::uint8_t> start) {
  return bytes.size() >= start.size() && std::equal(start.begin(), start.end(), bytes.begin());
}

bool is_png_or_jpeg(std::span<const std::uint8_t> bytes) {
  constexpr std::uint8_t kPng[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  constexpr std::uint8_t kJpeg[] = {0xFF, 0xD8, 0xFF};
  return starts_with(bytes, kPng) || starts_with(bytes, kJpeg);
}

// No PNG or JPEG is smaller than this: deflate shrinks to 1/1032 at best, and a pixel has at least one bit.
bool can_hold(std::size_t file_bytes, std::size_t pixels) {
  constexpr std::size_t kMaxPixelsPerByte = 1032 * 8, kHeaderBytes = 1024;
  return pixels / kMaxPixelsPerByte <= file_bytes + kHeaderBytes;
}

// stb_image reads many more formats than glTF has; nothing else reaches it.
Texture decode(std::span<const std::uint8_t> bytes, const std::string& place, const GltfDocument& document) {
  if (!is_png_or_jpeg(bytes)) document.fail(place + " is neither PNG nor JPEG");
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    document.fail(place + " has more than 2 GiB");
  }
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(bytes.data(), size, &width, &height, &channels) == 0 || width < 1 || height < 1) {
    document.fail(place + " has a broken header");
  }
  const std::string size_text = std::to_string(width) + " x " + std::to_string(height) + " pixels";
  if (width > kMaxSide_px || height > kMaxSide_px) {
    document.fail(place + " has " + size_text + "; expected at most " + std::to_string(kMaxSide_px) + " on a side");
  }
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (!can_hold(bytes.size(), pixels)) {
    document.fail(place + " claims " + size_text + " but has only " + std::to_string(size) + " bytes");
  }
  const std::unique_ptr<stbi_uc, void (*)(void*)> rgba(
      stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, kChannels), stbi_image_free);
  if (rgba == nullptr) document.fail(place + " cannot be decoded: " + stbi_failure_reason());
  if (static_cast<std::size_t>(width) * static_cast<std::size_t>(height) != pixels) {
    document.fail(place + " has pictures of two sizes");
  }
  Texture texture;
  texture.width = static_cast<std::uint32_t>(width);
  texture.height = static_cast<std::uint32_t>(height);
  texture.rgba.assign(rgba.get(), rgba.get() + pixels * kChannels);
  return texture;
}

Wrap wrap_of(int mode, const std::string& place, const GltfDocument& document) {
  switch (mode) {
    case TINYGLTF_TEXTURE_WRAP_REPEAT:
      return Wrap::repeat;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
      return Wrap::mirrored_repeat;
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
      return Wrap::clamp_to_edge;
    default:
      document.fail(place + " has the wrap mode " + std::to_string(mode) + "; expected 10497, 33071 or 33648");
  }
}

// What the file leaves open stays as Sampler has it: linear throughout.
void set_minification(int filter, const std::string& place, const GltfDocument& document, Sampler& sampler) {
  switch (filter) {
    case -1:
    case TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR:
      return;
    case TINYGLTF_TEXTURE_FILTER_NEAREST:
      sampler.minify = Filter::nearest;
      sampler.mipmapped = false;
      return;
    case TINYGLTF_TEXTURE_FILTER_LINEAR:
      sampler.mipmapped = false;
      return;
    case TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_NEAREST:
      sampler.minify = sampler.between_mips = Filter::nearest;
      return;
    case TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_NEAREST:
      sampler.between_mips = Filter::nearest;
      return;
    case TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_LINEAR:
      sampler.minify = Filter::nearest;
      return;
    default:
      document.fail(place + " has the minFilter " + std::to_string(filter) + "; expected 9728, 9729 or 9984 to 9987");
  }
}

Sampler sampler_of(int index, const GltfDocument& document) {
  Sampler sampler;
  if (index < 0) return sampler;
  const std::string place = "samplers/" + std::to_string(index);
  const tinygltf::Sampler& source = document.model.samplers[static_cast<std::size_t>(index)];
  sampler.wrap_u = wrap_of(source.wrapS, place, document);
  sampler.wrap_v = wrap_of(source.wrapT, place, document);
  if (source.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST) sampler.magnify = Filter::nearest;
  set_minification(source.minFilter, place, document, sampler);
  return sampler;
}

Texture decode_image(int index, const GltfDocument& document) {
  const GltfImage& image = document.images[static_cast<std::size_t>(index)];
  const std::string place = "images/" + std::to_string(index);
  if (image.buffer_view >= 0) return decode(view_bytes(document, image.buffer_view, place), place, document);
  return decode(read_gltf_uri(image.uri, document.file, place), place, document);
}

}  // namespace

std::shared_ptr<const Texture> GltfTextures::get(int index) {
  const auto [entry, is_new] = known_.try_emplace(index);
  if (!is_new) return entry->second;
  const tinygltf::Texture& source = document_.model.textures[static_cast<std::size_t>(index)];
  if (source.source < 0) {
    document_.warn("textures without a PNG or JPEG source are left out");
    return nullptr;
  }
  Texture texture = decode_image(source.source, document_);
  texture.name = source.name.empty() ? document_.images[static_cast<std::size_t>(source.source)].name : source.name;
  texture.sampler = sampler_of(source.sampler, document_);
  entry->second = pool_.intern(std::move(texture));
  return entry->second;
}

}  // namespace simvis
