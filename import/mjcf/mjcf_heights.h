// Fields of heights of an MJCF model.
#pragma once

#include <simvis/mesh.h>
#include "import/mjcf/mjcf_element.h"

namespace simvis {

/// The surface of an <hfield>: a picture in `file`, or `nrow` by `ncol` numbers in `elevation`, the first row at +y.
/// The lowest value is at z = 0, the highest at the third number of `size`; the base below is not part of it. Throws
/// InputError for sizes that are not above 0, other counts, and pictures that cannot be read.
Mesh mjcf_height_mesh(const MjcfElement& asset);

}  // namespace simvis
