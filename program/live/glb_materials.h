// The materials, textures and pictures of a GLB.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include <simvis/mesh.h>
#include "program/live/glb_buffer.h"

namespace simvis::live {

class GlbMaterials {
 public:
  using Json = GlbBuffer::Json;
  explicit GlbMaterials(GlbBuffer& buffer) : buffer_(buffer) {}

  /// Returns the index in the file. Equal indices of the draw list are to be added once.
  std::size_t add(const Material& material, std::size_t index_in_list);
  /// Moves what is here into the file's JSON.
  void take(Json& gltf, std::set<std::string>& extensions);

 private:
  Json texture_info(const std::shared_ptr<const Texture>& texture, int uv_set, const glm::mat3x2& uv_transform);
  std::size_t texture(const std::shared_ptr<const Texture>& texture);
  void add_surface(Json& json, const Material& material);

  GlbBuffer& buffer_;
  Json materials_ = Json::array(), textures_ = Json::array(), images_ = Json::array(), samplers_ = Json::array();
  std::map<const Texture*, std::size_t> numbers_;
  std::set<std::string> extensions_;
};

/// The share of light that the colour of a surface stops: an opaque material has none of the colour's alpha.
float shown_alpha(const Material& material);

/// Whether the material has a texture with this set of coordinates.
bool reads_uv(const Material& material, int uv_set);

}  // namespace simvis::live
