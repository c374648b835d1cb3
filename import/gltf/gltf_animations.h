// Reads the animations of a glTF file.
#pragma once

#include <memory>
#include <vector>

#include "import/gltf/gltf_document.h"
#include "import/gltf/gltf_hierarchy.h"
#include "scenegraph/part_animation.h"

namespace simvis {

/// The clips of a file, and the nodes that they move. The vectors of flags and counts have one value for each node of
/// the file.
struct GltfMotion {
  std::vector<AnimationClip> clips;         ///< the channels refer to nodes of the file
  std::vector<bool> is_moved;               ///< a channel translates, turns or scales the node
  std::vector<bool> is_carried;             ///< the node or an ancestor of it is moved
  std::vector<std::size_t> moving_weights;  ///< number of morph weights that channels change; 0: none
};

/// Channels without a node and channels whose accessors hold no data are left out, with a warning.
/// Throws InputError with the place for an unknown path or interpolation, a sampler that does not exist, a node that
/// has a matrix or no morph targets, two channels for the same property of a node, accessors of the wrong type or of
/// lengths that do not fit, times that do not ascend from 0, and rotations that are not unit quaternions.
GltfMotion read_motion(GltfDocument& document, const GltfHierarchy& hierarchy);

/// Returns whether a clip moves a joint of the skin.
bool moves_skin(const GltfDocument& document, const GltfMotion& motion, int skin);

/// Returns the weights of a node's morph targets at rest: the node's own weights or else the weights of its mesh. Empty
/// if the file gives none.
const std::vector<double>& rest_weights(const GltfDocument& document, int node);

/// The nodes and shapes that a file's clips move, found while the graph is built.
struct GltfBindings {
  std::vector<std::shared_ptr<Transform>> transforms;  ///< for moved nodes, by node of the file; null: not shown
  std::vector<AnimatedShape> shapes;                   ///< `node` and `skin` are numbers of the file
};

/// Returns null if the file has no animations. Throws InputError if they can leave the range of float32.
std::shared_ptr<const PartAnimations> bind_animations(const GltfDocument& document, const GltfHierarchy& hierarchy,
                                                      GltfMotion&& motion, GltfBindings&& bindings);

}  // namespace simvis
