// How a joint of SDF follows another.
#pragma once

#include <optional>
#include <string>

#include "import/model/import_report.h"
#include "import/sdf/sdf_tree.h"

namespace simvis {

/// value = multiplier * value of the leader + offset, in radians and metres.
struct SdfMimic {
  std::string leader;  ///< the name of its element
  bool leader_turns = false;
  double multiplier = 1, offset = 0;
};

/// SDF's default of <lower> and <upper>: from here on, a limit is none.
inline constexpr double kSdfNoLimit = 1e16;

/// Whether the element <joint> turns or slides about its first axis, as the element `joint` does.
bool sdf_joint_turns(const SdfElement& joint);
bool sdf_joint_slides(const SdfElement& joint);

/// What the link's joint follows by its <mimic>: the last joint of a chain of them. Empty: it has none, or one of a
/// joint that is not there, is fixed or of an unknown type, or follows itself in the end, which gives a warning. Throws
/// InputError for wrong numbers.
std::optional<SdfMimic> find_sdf_mimic(const SdfLink& link, const SdfTree& tree, ImportReport& report);

}  // namespace simvis
