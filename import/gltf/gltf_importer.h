// The scene of a glTF document.
#pragma once

#include <memory>

#include <simvis/content_pool.h>
#include <simvis/part_importer.h>
#include "import/gltf/gltf_document.h"

namespace simvis {

/// Decodes and checks what the document holds, and builds its graph, commands and animations. `y_up`: its frame is that
/// of glTF; otherwise it is that of SimVis. Throws InputError naming the file.
PartContent build_gltf(GltfDocument& document, ContentPool& pool, bool y_up);

/// The triangles of one of its meshes, after build_gltf(), with the bounds. Throws InputError as that.
std::shared_ptr<const Mesh> gltf_mesh(GltfDocument& document, std::size_t mesh, ContentPool& pool);

}  // namespace simvis
