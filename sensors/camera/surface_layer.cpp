#include "sensors/camera/surface_layer.h"

#include <algorithm>
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

const DrawList& LayerList::follow(const DrawList& list) {
  if (!follow_log(list)) {
    copy_ = list;
    copy_materials(list);
    copy_.changes.mark_structure_dirty();
    ++copies_;
  }
  seen_ = list.changes.version();
  return copy_;
}

// Returns false if the log does not say what has changed since the last call.
bool LayerList::follow_log(const DrawList& list) {
  const auto items = list.changes.items_since(seen_);
  const auto moved = list.changes.moved_since(seen_);
  if (!items || !moved) return false;
  if (!items->empty()) copy_.meshes = list.meshes;
  for (const std::uint32_t item : *items) {
    copy_.items[item] = list.items[item];
    copy_.changes.mark_item_dirty(item);
  }
  for (const TransformRange& range : *moved) {
    std::copy(list.world_from_node.begin() + range.first, list.world_from_node.begin() + range.end,
              copy_.world_from_node.begin() + range.first);
    copy_.changes.mark_transforms_dirty(range);
  }
  if (copy_.revisions.materials != list.revisions.materials) copy_materials(list);
  if (copy_.revisions.lights != list.revisions.lights) copy_.lights = list.lights;
  copy_.environment = list.environment;
  copy_.sky = list.sky;
  copy_.medium = list.medium;
  copy_.revisions = list.revisions;
  return true;
}

void LayerList::copy_materials(const DrawList& list) {
  copy_.materials = list.materials;
  copy_.material_revision = list.material_revision;
  if (layer_ == SurfaceLayer::visible) return;
  const float least = layer_ == SurfaceLayer::first ? kAlphaHalfStep : 1 - kAlphaHalfStep;
  for (std::shared_ptr<const Material>& material : copy_.materials) {
    if (material->alpha_mode == AlphaMode::opaque && material->opacity == 1) continue;
    material = std::make_shared<const Material>(solid_from(*material, least));
  }
}

const DrawList& LayerWorld::begin(const DrawList& list) {
  if (layer_ == SurfaceLayer::visible) return list;
  const DrawList& of_layer = list_.follow(list);
  world_.set(of_layer);
  return of_layer;
}

RayCaster& LayerWorld::caster(RayCaster& of_list) {
  if (layer_ == SurfaceLayer::visible) return of_list;
  world_.place({}, of_list.threads());
  return world_.caster();
}

}  // namespace simvis
