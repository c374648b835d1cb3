// A draw list as a binary glTF file.
#pragma once

#include <span>
#include <string>

#include <simvis/draw_list.h>
#include <simvis/scan.h>

namespace simvis::live {

/// The bytes of a GLB. Each pair of a mesh and a material is one glTF mesh, and each item is one node of it. A root
/// node turns the world, whose z is up, to glTF's y up. Item nodes have `extras`: item, transform, material, mesh and
/// part, so that a page can move and deform them. `items` is as long as `list.items`, or empty.
///
/// What glTF cannot say is left out: what only lasers see, the medium, the surroundings, and items without primitives
/// or of no size. An opaque or masked material of opacity below 1 becomes a blended one.
/// Throws MachineError if memory runs out, or the file would be longer than 4 GiB, which the format cannot hold.
std::string glb_bytes(const DrawList& list, std::span<const SceneItem> items);

/// The normal of a vertex in a GLB, of unit length.
glm::vec3 glb_normal(const VertexAttributes& vertex);

}  // namespace simvis::live
