#include "sensors/camera/surface_layer.h"

#include <memory>

namespace simvis {
namespace {

// A texel is solid for rays if its alpha is at least the cutoff, and the opacity at least kMinDepthVisibleAlpha.
Material solid_from(const Material& material, float least_covered) {
  Material changed = material;
  const bool any = material.opacity >= least_covered;
  changed.opacity = any ? 1.0f : 0.0f;
  if (!any || material.alpha_mode != AlphaMode::blend) return changed;
  changed.alpha_mode = AlphaMode::mask;
  changed.alpha_cutoff = least_covered / material.opacity;
  return changed;
}

}  // namespace

SurfaceLayer surface_layer(const AttributeValues& attributes, bool measures_surfaces) {
  const std::string& name = attributes.choice(kLayerAttribute.name);
  if (name == "visible") return SurfaceLayer::visible;
  if (!measures_surfaces) {
    fail_at(attributes.where(kLayerAttribute.name),
            "attribute \"layer\": colour shows all layers, expected outputs with depth or truth beside it");
  }
  return name == "first" ? SurfaceLayer::first : SurfaceLayer::first_opaque;
}

DrawList layer_list(const DrawList& list, SurfaceLayer layer) {
  DrawList changed = list;
  if (layer == SurfaceLayer::visible) return changed;
  const float least = layer == SurfaceLayer::first ? kAlphaHalfStep : 1 - kAlphaHalfStep;
  for (std::shared_ptr<const Material>& material : changed.materials) {
    if (material->alpha_mode == AlphaMode::opaque && material->opacity == 1) continue;
    material = std::make_shared<const Material>(solid_from(*material, least));
  }
  return changed;
}

const DrawList& LayerWorld::begin(const DrawList& list) {
  if (layer_ == SurfaceLayer::visible) return list;
  list_ = layer_list(list, layer_);
  world_.set(list_);
  return list_;
}

RayCaster& LayerWorld::caster(RayCaster& of_list) {
  if (layer_ == SurfaceLayer::visible) return of_list;
  world_.place({});
  return world_.caster();
}

}  // namespace simvis
