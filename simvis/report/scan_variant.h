// The variants of a laser scanner: the possible values of its accuracy attributes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <simvis/command.h>

namespace simvis {

/// One row of a price list. A number is set only if the method uses it.
struct ScanVariant {
  std::string method;                   ///< as written in the scene
  std::optional<double> resolution_px;  ///< pixels across 90 degrees
  std::optional<double> max_error_rel;  ///< hybrid, auto
  std::optional<double> max_error_m{};  ///< hybrid, auto: set only if the scene gives it

  bool operator==(const ScanVariant&) const = default;
};

/// The variant that the command of a laser scanner selects, including defaults. Throws the InputErrors of the creation
/// of the scanner.
ScanVariant variant_of(const Command& scanner);

/// All variants that a price list contains: nearest, planar and hybrid at several resolutions, hybrid also with several
/// tolerances, and raycast. Methods that cast rays are included only if the build supports ray casting. The resolutions
/// and tolerances of the command, and the variant that it selects, are included. If an effect of the scanner follows
/// beams, only raycast can measure.
std::vector<ScanVariant> priced_variants(const Command& scanner);

/// One variant of each method except auto, at the resolution of the command. The tolerance of hybrid is one at which it
/// both renders and casts. If an effect of the scanner follows beams, only raycast.
std::vector<ScanVariant> variants_by_method(const Command& scanner);

/// The attributes as written in the scene: `method="planar" resolution="4096"`.
std::string attributes_of(const ScanVariant& variant);

/// The command with the attributes of the variant and the name `name`; the scanner measures in every frame.
Command with_variant(Command scanner, const ScanVariant& variant, const std::string& name);

}  // namespace simvis
