#include "scenegraph/import/gltf/gltf_textures.h"

#include <string>
#include <utility>

#include "scenegraph/import/gltf/gltf_accessors.h"
#include "scenegraph/import/mesh/picture_file.h"

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

Texture decode_image(int index, const GltfDocument& document) {
  const GltfImage& image = document.images[static_cast<std::size_t>(index)];
  const std::string place = "images/" + std::to_string(index);
  const std::string subject = document.file.string() + ": error: " + place;
  if (image.buffer_view >= 0) return decode_picture(view_bytes(document, image.buffer_view, place), subject);
  const GltfBuffer buffer = open_gltf_uri(image.uri, document.file, place);
  return decode_picture(buffer.read(0, buffer.size()), subject);
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
