// The equalities of an MJCF model that are no joints of its tree.
#pragma once

#include "import/mjcf/mjcf_tree.h"
#include "import/model/import_report.h"
#include "import/model/model_description.h"

namespace simvis {

/// <equality> joint with a straight line: one joint of `file` follows another of the same body. <equality> connect and
/// weld: constraints between links, which stand at the beginning as the file places them. Others are reported.
/// Throws InputError for wrong numbers.
void read_mjcf_equalities(const MjcfTree& tree, ModelDescription& file, ImportReport& report);

}  // namespace simvis
