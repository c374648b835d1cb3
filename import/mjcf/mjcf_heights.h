// Fields of heights of an MJCF model.
#pragma once

#include "import/mjcf/mjcf_element.h"
#include "scenegraph/height_map.h"

namespace simvis {

/// The surface of an <hfield>: a picture in `file`, or `nrow` by `ncol` numbers in `elevation`, the first row at +y.
/// The lowest value is at z = 0, the highest at the third number of `size`; the base below is not part of it. Throws
/// InputError for sizes that are not above 0, other counts, and pictures that cannot be read.
HeightMap mjcf_height_map(const MjcfElement& asset);

}  // namespace simvis
