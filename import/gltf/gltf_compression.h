// Decodes the compressed geometry of a glTF file.
#pragma once

#include "import/gltf/gltf_document.h"

namespace simvis {

/// Gives every buffer view and accessor whose bytes exist only in compressed form bytes of its own, so that they are
/// read like all others. What the file also holds uncompressed is left as it is.
///   EXT_meshopt_compression: buffer views. Its decoder is safe on any bytes and runs in this process; the bytes that
///   it
///     makes are at most 64 times those of the file.
///   KHR_draco_mesh_compression: primitives. They are decoded by the program simvis-decode.
/// Throws InputError naming the buffer view or primitive whose data is broken or does not fit.
void decode_compressed_geometry(GltfDocument& document);

}  // namespace simvis
