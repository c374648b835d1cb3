// The text of a command that an SDF file brings.
#pragma once

#include <numbers>

#include "import/model/file_command.h"
#include "import/sdf/sdf_commands.h"

namespace simvis {

/// Degrees of commands per radian of SDF.
inline constexpr double kSdfDegrees = 180 / std::numbers::pi;

class SdfCommand : public FileCommand {
 public:
  SdfCommand(CommandKind kind, const char* type, const SdfPlace& place)
      : FileCommand(kind, type, place.name, place.insert_at) {}
};

}  // namespace simvis
