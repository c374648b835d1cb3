#include "import/programs/inventor/inventor_look.h"

#include <Inventor/SbImage.h>
#include <Inventor/SoFullPath.h>
#include <Inventor/VRMLnodes/SoVRMLAppearance.h>
#include <Inventor/VRMLnodes/SoVRMLGeometry.h>
#include <Inventor/VRMLnodes/SoVRMLImageTexture.h>
#include <Inventor/VRMLnodes/SoVRMLShape.h>
#include <Inventor/VRMLnodes/SoVRMLTexture.h>
#include <Inventor/elements/SoLazyElement.h>
#include <Inventor/fields/SoSFBool.h>
#include <Inventor/fields/SoSFNode.h>

#include <algorithm>
#include <utility>

#include "engine/base/srgb.h"

namespace simvis {
namespace {

glm::vec3 to_linear(const SbColor& color) { return linear_of_display_color({color[0], color[1], color[2]}); }

bool is_vrml97(const SoShape& shape) { return shape.isOfType(SoVRMLGeometry::getClassTypeId()) != 0; }

// VRML97 stores in a field of the shape the hint that Inventor stores in a ShapeHints node before the shape.
bool is_double_sided(SoCallbackAction& action, const SoShape& shape) {
  const SoField* const solid = shape.getField("solid");
  if (solid != nullptr && solid->isOfType(SoSFBool::getClassTypeId()))
    return static_cast<const SoSFBool*>(solid)->getValue() == 0;
  return action.getShapeType() != SoShapeHints::SOLID || action.getVertexOrdering() == SoShapeHints::UNKNOWN_ORDERING;
}

// Lines and points without normals cannot be shaded.
bool is_unlit(SoCallbackAction& action, const SoShape& shape, bool is_surface) {
  if (action.getLightModel() == SoLightModel::BASE_COLOR) return true;
  return !is_surface && !has_normals(action, shape);
}

AlphaMode alpha_mode_of(const std::vector<std::uint8_t>& rgba) {
  bool clear = false;
  for (std::size_t i = 3; i < rgba.size(); i += 4) {
    if (rgba[i] != 0 && rgba[i] != 255) return AlphaMode::blend;
    clear = clear || rgba[i] == 0;
  }
  return clear ? AlphaMode::mask : AlphaMode::opaque;
}

// Coin's rows begin at the bottom and have 1 (grey), 2 (grey, alpha), 3 or 4 bytes per pixel.
std::vector<std::uint8_t> rgba_of(const unsigned char* pixels, std::size_t width, std::size_t height, int components) {
  const bool grey = components <= 2, has_alpha = components % 2 == 0;
  const auto stride = static_cast<std::size_t>(components);
  std::vector<std::uint8_t> rgba;
  rgba.reserve(width * height * 4);
  for (std::size_t y = height; y-- > 0;) {
    for (std::size_t x = 0; x < width; ++x) {
      const unsigned char* const p = pixels + (y * width + x) * stride;
      for (std::size_t c = 0; c < 3; ++c) rgba.push_back(p[grey ? 0 : c]);
      rgba.push_back(has_alpha ? p[stride - 1] : std::uint8_t{255});
    }
  }
  return rgba;
}

// Coin: (s', t') = (s, t, 0, 1) * M with t up. Here v = 1 - t points down, before and after.
glm::mat3x2 uv_transform_of(const SbMatrix& m) {
  const double ss = m[0][0], st = m[0][1], ts = m[1][0], tt = m[1][1], s1 = m[3][0], t1 = m[3][1];
  return glm::mat3x2(glm::dmat3x2(ss, -st, -ts, tt, ts + s1, 1 - tt - t1));
}

Wrap wrap_of(bool repeats) { return repeats ? Wrap::repeat : Wrap::clamp_to_edge; }

// Returns the texture node of the VRML97 Shape that contains the current geometry, or null.
const SoVRMLTexture* vrml97_texture_of(SoCallbackAction& action) {
  const auto* const path = static_cast<const SoFullPath*>(action.getCurPath());
  const SoNode* const parent = path->getLength() > 1 ? path->getNodeFromTail(1) : nullptr;
  const auto* const shape = dynamic_cast<const SoVRMLShape*>(parent);
  const auto* const appearance = shape ? dynamic_cast<const SoVRMLAppearance*>(shape->appearance.getValue()) : nullptr;
  return appearance ? dynamic_cast<const SoVRMLTexture*>(appearance->texture.getValue()) : nullptr;
}

// Coin puts a white picture in the place of a missing one. It would replace the colour.
bool lacks_picture(const SoVRMLTexture* node) {
  const auto* const texture = dynamic_cast<const SoVRMLImageTexture*>(node);
  if (texture == nullptr) return false;
  SbVec2s size;
  int components = 0;
  return texture->getImage() == nullptr || texture->getImage()->getValue(size, components) == nullptr;
}

// Coin 4.0 exchanges VRML97's repeatS and repeatT in its state, so they are read from the node itself.
std::pair<Wrap, Wrap> wraps_of(SoCallbackAction& action) {
  if (const SoVRMLTexture* const texture = vrml97_texture_of(action)) {
    return {wrap_of(texture->repeatS.getValue() != 0), wrap_of(texture->repeatT.getValue() != 0)};
  }
  return {wrap_of(action.getTextureWrapS() == SoTexture2::REPEAT),
          wrap_of(action.getTextureWrapT() == SoTexture2::REPEAT)};
}

}  // namespace

bool has_normals(const SoCallbackAction& action, const SoShape& shape) {
  return !is_vrml97(shape) && action.getNumNormals() > 0;
}

glm::vec3 linear_of_display_color(const glm::vec3& srgb) {
  return {linear_from_srgb(srgb.x), linear_from_srgb(srgb.y), linear_from_srgb(srgb.z)};
}

InventorLook InventorLooks::look(SoCallbackAction& action, const SoShape& shape, bool is_surface) {
  InventorLook look;
  Material& material = look.material.material;
  SbColor ambient, diffuse, specular, emission;
  float shininess = 0, transparency = 0;
  action.getMaterial(ambient, diffuse, specular, emission, shininess, transparency, 0);
  material.unlit = is_unlit(action, shape, is_surface);
  material.double_sided = is_double_sided(action, shape);
  if (!material.unlit) material.emissive = to_linear(emission);
  const SoField* const color = shape.getField("color");
  look.emits_as_line = !is_surface && is_vrml97(shape) && action.getLightModel() != SoLightModel::BASE_COLOR &&
                       color != nullptr && color->isOfType(SoSFNode::getClassTypeId()) &&
                       static_cast<const SoSFNode*>(color)->getValue() == nullptr;
  add_texture(action, shape, look);
  return look;
}

glm::vec4 InventorLooks::color(SoCallbackAction& action, const InventorLook& look, int material_index) {
  SoState* const state = action.getState();
  const SoLazyElement& element = *SoLazyElement::getInstance(state);
  // Wrong indices in the file are clamped, as in Coin's own renderer.
  const int last = std::max(element.getNumDiffuse() - 1, 0);
  const int index = std::clamp(material_index, 0, last);
  const bool has_alpha = index < element.getNumTransparencies();
  const float alpha = 1 - SoLazyElement::getTransparency(state, has_alpha ? index : 0);
  if (look.replaces_color) return {1, 1, 1, alpha};
  if (look.emits_as_line) return {to_linear(SoLazyElement::getEmissive(state)), alpha};
  return {to_linear(SoLazyElement::getDiffuse(state, index)), alpha};
}

std::uint32_t InventorLooks::add(ImportedMaterial&& material) {
  const std::uint32_t texture = material.texture;
  kept_.push_back(pool_.intern(Material(material.material)));
  const auto [entry, is_new] =
      numbers_.try_emplace({kept_.back().get(), texture}, static_cast<std::uint32_t>(scene_.materials.size()));
  if (is_new) {
    scene_.materials.push_back(std::move(material));
  } else {
    kept_.pop_back();
  }
  return entry->second;
}

void InventorLooks::add_texture(SoCallbackAction& action, const SoShape& shape, InventorLook& look) {
  SbVec3s size(0, 0, 0);
  int components = 0;
  const unsigned char* const pixels = action.getTextureImage(size, components);
  if (pixels == nullptr || size[0] <= 0 || size[1] <= 0 || components < 1 || components > 4) return;
  if (lacks_picture(vrml97_texture_of(action))) return;
  if (size[2] > 1) return warn("textures with three dimensions are left out");
  const KnownTexture known = texture(action, pixels, size, components);
  ImportedMaterial& material = look.material;
  material.texture = known.number;
  material.material.alpha_mode = known.alpha;
  material.material.uv_transform = uv_transform_of(action.getTextureMatrix());
  look.textured = true;
  const SoTexture2::Model model = action.getTextureModel();
  if (model == SoTexture2::REPLACE || (model == SoTexture2::DECAL && components == 3)) {
    look.replaces_color = true;
    material.material.unlit = true;
    material.material.emissive = glm::vec3(0);
  } else if (model != SoTexture2::MODULATE) {
    warn("the texture models BLEND and DECAL (with transparency) are drawn as MODULATE");
  }
  // VRML97, table 4.5: a coloured texture replaces the diffuse colour, and a grey texture multiplies it.
  if (is_vrml97(shape) && components >= 3) look.replaces_color = true;
}

InventorLooks::KnownTexture InventorLooks::texture(SoCallbackAction& action, const unsigned char* pixels,
                                                   const SbVec3s& size, int components) {
  const auto [wrap_u, wrap_v] = wraps_of(action);
  const auto [entry, is_new] = textures_.try_emplace({pixels, size[0], size[1], components, wrap_u, wrap_v});
  if (!is_new) return entry->second;
  ImportedTexture imported;
  Texture& texture = imported.texture;
  texture.width = static_cast<std::uint32_t>(size[0]);
  texture.height = static_cast<std::uint32_t>(size[1]);
  texture.rgba = rgba_of(pixels, texture.width, texture.height, components);
  texture.sampler.wrap_u = wrap_u;
  texture.sampler.wrap_v = wrap_v;
  entry->second.number = static_cast<std::uint32_t>(scene_.textures.size());
  entry->second.alpha = alpha_mode_of(texture.rgba);
  scene_.textures.push_back(std::move(imported));
  return entry->second;
}

void InventorLooks::warn(const std::string& what) {
  if (std::find(scene_.warnings.begin(), scene_.warnings.end(), what) == scene_.warnings.end()) {
    scene_.warnings.push_back(what);
  }
}

}  // namespace simvis
