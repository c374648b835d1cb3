// Which of the surfaces along a ray depth and labels mean, where some are transparent.
#pragma once

#include <cstdint>

#include <simvis/attributes.h>
#include <simvis/draw_list.h>
#include "sensors/camera/moved_world.h"

namespace simvis {

enum class SurfaceLayer : std::uint8_t {
  visible,      ///< the first one that is depth-visible, see Material
  first,        ///< the first one that lets less than all of the light pass
  first_opaque  ///< the first one that lets no light pass
};

/// Covered shares are those of 8-bit textures at best: what is nearer to 0 or to 1 than half of their step is 0 or 1.
inline constexpr float kAlphaHalfStep = 0.5f / 255;

inline constexpr AttributeSpec kLayerAttribute{
    .name = "layer",
    .kind = AttributeKind::choice,
    .default_value = "visible",
    .text =
        "which surface depth, labels, boxes and all other truth mean where some are transparent: the first that "
        "covers half of what lies behind it, the first of any, or the first that nothing shines through",
    .choices = "visible first first_opaque"};

/// Reads the attribute. Throws InputError if nothing is measured that it decides.
SurfaceLayer surface_layer(const AttributeValues& attributes, bool measures_surfaces);

/// A copy of a draw list as rays see it that look for a layer. It follows the list from frame to frame: where the list
/// has a log, only what changes is copied.
class LayerList {
 public:
  explicit LayerList(SurfaceLayer layer) : layer_(layer) {}
  LayerList(const LayerList&) = delete;
  LayerList& operator=(const LayerList&) = delete;

  /// The copy, brought up to `list`: its materials are those of the layer, and all else is the same. It has a log of
  /// its own.
  const DrawList& follow(const DrawList& list);
  const DrawList& list() const { return copy_; }

  /// Lists copied as a whole since it was made.
  std::uint64_t copies() const { return copies_; }

 private:
  bool follow_log(const DrawList& list);
  void copy_materials(const DrawList& list);

  SurfaceLayer layer_;
  DrawList copy_;
  ListVersion seen_;
  std::uint64_t copies_ = 0;
};

/// The world of one layer, frame after frame.
class LayerWorld {
 public:
  explicit LayerWorld(SurfaceLayer layer) : layer_(layer), list_(layer) {}

  /// The list of the layer. It is valid until the next call, as long as `list`.
  const DrawList& begin(const DrawList& list);
  /// A caster into it, with the threads of `of_list`: that one, if the layer is that of the list itself.
  RayCaster& caster(RayCaster& of_list);

 private:
  SurfaceLayer layer_;
  LayerList list_;  // unless the layer is `visible`
  MovedWorld world_;
};

}  // namespace simvis
