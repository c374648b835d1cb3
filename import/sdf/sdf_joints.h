// What the joints of SDF links are.
#pragma once

#include "import/model/import_report.h"
#include "import/model/model_description.h"
#include "import/sdf/sdf_tree.h"

namespace simvis {

/// SDF's default of <lower> and <upper>: from here on, a limit is none.
inline constexpr double kSdfNoLimit = 1e16;

/// Sets the `motion` of each link that has a joint: the kind, the axis in a frame that has the joint's orientation and
/// the place of its insertion point, limits, and what it follows by <mimic>, without links and dynamics. A joint of a
/// type that elements do not have is fixed, and reported as left out. Limits of 1e16 and none are no limits; lower
/// limits above upper ones are left out with a warning, and so is a <mimic> of a joint that is not there or cannot be
/// followed. Throws InputError at the joint for wrong numbers and an axis without length.
void read_sdf_joints(SdfTree& tree, SdfPoses& poses, ImportReport& report);

}  // namespace simvis
