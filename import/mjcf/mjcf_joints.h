// What a joint of an MJCF model is.
#pragma once

#include "import/mjcf/mjcf_tree.h"
#include "import/model/import_report.h"

namespace simvis {

/// The kind, axis and limits of a joint, without names. Limits count from the pose in which the file places the body,
/// so that `ref` is subtracted. Throws InputError for an unknown type, an axis without length and wrong numbers; lower
/// limits above upper ones are left out with a warning.
MjcfJoint read_mjcf_joint(const MjcfElement& element, const glm::dmat4& body_from_frame, ImportReport& report);

}  // namespace simvis
