// The ways in which one laser scanner of a scene could measure: what its attributes of accuracy could be.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <simvis/command.h>

namespace simvis {

/// One row of a price list. A number is there where the method looks at it.
struct ScanVariant {
  std::string method;                   ///< as in the scene
  std::optional<double> resolution_px;  ///< across 90 degrees
  std::optional<double> max_error_rel;  ///< hybrid, auto
  std::optional<double> max_error_m{};  ///< hybrid, auto: only where the scene itself asks for it

  bool operator==(const ScanVariant&) const = default;
};

/// What the command of a laser scanner asks for, defaults filled in. Throws InputError as making the scanner does.
ScanVariant variant_of(const Command& scanner);

/// All that are worth a price: nearest, planar and hybrid at several resolutions, the last with several tolerances, and
/// raycast; methods that cast only in a build that can. Resolutions and tolerances that the command itself gives are
/// among them, and so is what it asks for. Where an effect of the scanner follows beams, raycast alone can measure.
std::vector<ScanVariant> priced_variants(const Command& scanner);

/// One of each method but auto, at the resolution that the command asks for; hybrid with a tolerance at which it
/// renders and casts. Where an effect of the scanner follows beams, raycast alone.
std::vector<ScanVariant> variants_by_method(const Command& scanner);

/// As one writes it in the scene: `method="planar" resolution="4096"`.
std::string attributes_of(const ScanVariant& variant);

/// The command with this variant's attributes and another name, measuring in every frame.
Command with_variant(Command scanner, const ScanVariant& variant, const std::string& name);

}  // namespace simvis
