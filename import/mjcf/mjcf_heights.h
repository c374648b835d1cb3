// Fields of heights of an MJCF model.
#pragma once

#include "import/mjcf/mjcf_element.h"
#include "scenegraph/height_map.h"

namespace simvis {

/// The surface of an <hfield>: a picture in `file`, or `nrow` by `ncol` numbers in `elevation`, the first row at +y.
/// The lowest value is at z = 0, the highest at the third number of `size`; the base below is not part of it. Throws
/// InputError for edges that are not from 10^-6 to 10^6 m, a height that is not above 0 or is more than that, values
/// beyond 10^6, other counts, and pictures that cannot be read.
HeightMap mjcf_height_map(const MjcfElement& asset);

}  // namespace simvis
