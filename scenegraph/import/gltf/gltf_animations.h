// The animations of a glTF file.
#pragma once

#include <memory>
#include <vector>

#include "scenegraph/import/gltf/gltf_document.h"
#include "scenegraph/import/gltf/gltf_hierarchy.h"
#include "scenegraph/part_animation.h"

namespace simvis {

/// The clips of a file and what they move. The vectors have one value for each node of the file.
struct GltfMotion {
  std::vector<AnimationClip> clips;         ///< their channels name nodes of the file
  std::vector<bool> is_moved;               ///< a channel translates, turns or scales it
  std::vector<bool> is_carried;             ///< it or an ancestor is moved
  std::vector<std::size_t> moving_weights;  ///< how many morph weights channels change; 0: they change none
};

/// Channels without a node and those whose accessors hold no data are left out, with a warning.
/// Throws InputError with the place: an unknown path or interpolation, a sampler that does not exist, a node that has a
/// matrix or no morph targets, two channels for the same, accessors of the wrong type or of lengths that do not fit,
/// times that do not ascend from 0, rotations that are not unit quaternions.
GltfMotion read_motion(GltfDocument& document, const GltfHierarchy& hierarchy);

/// Whether a clip moves a joint of the skin.
bool moves_skin(const GltfDocument& document, const GltfMotion& motion, int skin);

/// The weights that a node's morph targets have at rest: its own, its mesh's, or none given.
const std::vector<double>& rest_weights(const GltfDocument& document, int node);

/// What a file's clips move, found while its graph was made.
struct GltfBindings {
  std::vector<std::shared_ptr<Transform>> transforms;  ///< of moved nodes, by node of the file; null: not shown
  std::vector<AnimatedShape> shapes;                   ///< `node` and `skin` are the file's
};

/// Null if the file has no animations. Throws InputError where they lead out of float32's range.
std::shared_ptr<const PartAnimations> bind_animations(const GltfDocument& document, const GltfHierarchy& hierarchy,
                                                      GltfMotion&& motion, GltfBindings&& bindings);

}  // namespace simvis
