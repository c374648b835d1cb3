// Reads the Gaussian splats of a glTF primitive: the extension KHR_gaussian_splatting with its kernel `ellipse`.
#pragma once

#include <cstddef>
#include <memory>

#include "engine/draw/splat_cloud.h"
#include "import/gltf/gltf_document.h"

namespace simvis {

/// Whether a primitive is read as splats. One with a kernel, colour space or projection that is not known is not, with
/// a warning: it is a cloud of points then.
bool has_known_splats(GltfDocument& document, const tinygltf::Primitive& source);

/// The splats of a primitive, whose positions are `centers`. Splats with an opacity beyond [0, 1], a negative scale, no
/// extent or a rotation that is no unit quaternion are left out, with a warning. Throws InputError naming the file and
/// the accessor, for attributes that are missing, do not fit or have no data, and for more than kMaxSplats.
std::shared_ptr<const SplatCloud> read_splats(GltfDocument& document, const tinygltf::Primitive& source,
                                              std::span<const glm::vec3> centers);

}  // namespace simvis
