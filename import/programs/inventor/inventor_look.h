// Reads the material and texture of a shape from the state of a Coin traversal.
#pragma once

#include <Inventor/actions/SoCallbackAction.h>
#include <Inventor/nodes/SoShape.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <simvis/content_pool.h>
#include "import/sandbox/imported_scene.h"

namespace simvis {

/// Inventor's colours are display colours, that is sRGB.
glm::vec3 linear_of_display_color(const glm::vec3& srgb);

/// Whether the file gives normals to the lines or points of the current shape, which VRML97 never does. Coin makes up
/// normals of others.
bool has_normals(const SoCallbackAction& action, const SoShape& shape);

/// The properties of a whole shape. The colours of its vertices are read one by one.
struct InventorLook {
  ImportedMaterial material;    ///< its base colour is white until the vertices' colours are known
  bool textured = false;        ///< texture coordinates are used
  bool replaces_color = false;  ///< the texture replaces the diffuse colour
  bool emits_as_line = false;   ///< a VRML97 line or point without a colour of its own, drawn in the emissive colour
};

/// Collects materials and textures. Equal ones are added once.
class InventorLooks {
 public:
  explicit InventorLooks(ImportedScene& scene) : scene_(scene) {}

  /// Must be called from a primitive's callback, because only then does the state hold the shape's own properties.
  InventorLook look(SoCallbackAction& action, const SoShape& shape, bool is_surface);
  /// Returns the linear RGBA colour of a vertex.
  static glm::vec4 color(SoCallbackAction& action, const InventorLook& look, int material_index);
  /// Adds a warning to the scene, once.
  void warn(const std::string& what);
  /// Returns the number of the material in the scene.
  std::uint32_t add(ImportedMaterial&& material);

 private:
  struct KnownTexture {
    std::uint32_t number = kNoTexture;
    AlphaMode alpha = AlphaMode::opaque;
  };
  using TextureKey = std::tuple<const unsigned char*, int, int, int, Wrap, Wrap>;

  void add_texture(SoCallbackAction& action, const SoShape& shape, InventorLook& look);
  KnownTexture texture(SoCallbackAction& action, const unsigned char* pixels, const SbVec3s& size, int components);

  ImportedScene& scene_;
  std::map<TextureKey, KnownTexture> textures_;
  ContentPool pool_;
  std::map<std::pair<const Material*, std::uint32_t>, std::uint32_t> numbers_;
  std::vector<std::shared_ptr<const Material>> kept_;
};

}  // namespace simvis
