#include "import/gltf/gltf_textures.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include "import/gltf/gltf_accessors.h"
#include "import/mesh/picture_file.h"

namespace simvis {
namespace {

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

// Without a filter in the file the default of Sampler applies: linear, also between mipmap levels.
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

// Reads a picture: it returns nothing and adds a warning if the picture cannot be had. It holds the bytes of a picture
// that lies in the glTF file or one of its buffers, because these are closed when the part has been read.
std::function<std::optional<Texture>(std::vector<std::string>&)> reader_of(int index, const GltfDocument& document) {
  const GltfImage& image = document.images[static_cast<std::size_t>(index)];
  const std::string place = "images/" + std::to_string(index);
  const std::filesystem::path file = document.file;
  std::vector<std::uint8_t> bytes;
  std::string broken;
  try {
    if (image.buffer_view < 0 && !image.uri.starts_with("data:")) {
      const std::string name = relative_gltf_path(image.uri, file, place).string();
      return [name, file](std::vector<std::string>& warnings) { return find_and_read_picture(name, file, warnings); };
    }
    if (image.buffer_view >= 0) {
      bytes = view_bytes(document, image.buffer_view, place);
    } else {
      const GltfBuffer buffer = open_gltf_uri(image.uri, file, place);
      bytes = buffer.read(0, buffer.size());
    }
  } catch (const InputError& error) {
    broken = error.what();
  }
  return [bytes, broken, file, place](std::vector<std::string>& warnings) -> std::optional<Texture> {
    try {
      if (!broken.empty()) throw InputError(broken);
      return decode_picture(bytes, file.string() + ": error: " + place);
    } catch (const InputError& error) {
      warnings.push_back(without_word_error(error.what()) + "; the material's colour replaces it");
      return std::nullopt;
    }
  };
}

// Returns the picture of a texture, or -1. KHR_texture_basisu and MSFT_texture_dds come last, because no decoder is
// there for them.
int image_of(const tinygltf::Texture& texture) {
  const auto source_of = [&](const char* extension) {
    const auto found = texture.extensions.find(extension);
    const bool has_source = found != texture.extensions.end() && found->second.Has("source");
    return has_source ? found->second.Get("source").GetNumberAsInt() : -1;
  };
  for (const int image : {source_of("EXT_texture_webp"), texture.source, source_of("KHR_texture_basisu"),
                          source_of("MSFT_texture_dds")}) {
    if (image >= 0) return image;
  }
  return -1;
}

}  // namespace

std::shared_ptr<const Texture> GltfTextures::get(int index, PictureUse use) {
  const auto [entry, is_new] = known_.try_emplace({index, use});
  if (!is_new) return entry->second;
  const tinygltf::Texture& source = document_.model.textures[static_cast<std::size_t>(index)];
  const Sampler sampler = sampler_of(source.sampler, document_);
  const int image = image_of(source);
  if (image < 0) {
    document_.warn("textures/" + std::to_string(index) + " has no picture; the material's colour replaces it");
    return nullptr;
  }
  const std::string name = source.name.empty() ? document_.images[static_cast<std::size_t>(image)].name : source.name;
  const auto read = [decode = reader_of(image, document_), name, sampler](std::vector<std::string>& warnings) {
    std::optional<Texture> texture = decode(warnings);
    if (!texture) return texture;
    texture->name = name;
    texture->sampler = sampler;
    return texture;
  };
  std::vector<std::string> warnings;
  entry->second = pool_.picture({.read = read, .use = use}, warnings);
  for (std::string& warning : warnings) document_.add_warning(std::move(warning));
  return entry->second;
}

}  // namespace simvis
