// Reads Draco data with libdraco.
#pragma once

#include <cstdint>
#include <span>

#include "import/sandbox/draco_mesh.h"

namespace simvis {

/// May crash on broken data. Throws InputError with the reason if the data is no mesh, or lacks an attribute.
DracoMesh read_draco(std::span<const std::uint8_t> bytes, std::span<const DracoAttribute> attributes);

}  // namespace simvis
