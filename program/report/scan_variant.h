// The variants of a scanner, as commands.
#pragma once

#include <string>

#include <simvis/command.h>
#include <simvis/sensor.h>

namespace simvis {

/// The variants of the scanner that a command describes: those that its type lists, or, if it lists none, those that
/// SensorType::scan_variants names as its default. Throws the InputErrors of the creation of the scanner.
ScanVariants scan_variants(const Command& scanner);

/// What reports print as the method of a variant that names none.
inline const std::string kNoMethod = "-";

/// The attributes as written in the scene: `method="planar" resolution="4096"`.
std::string attributes_of(const ScanVariant& variant);

/// The command with the attributes of the variant and the name `name`; the scanner measures in every frame.
Command with_variant(Command scanner, const ScanVariant& variant, const std::string& name);

}  // namespace simvis
