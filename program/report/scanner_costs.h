// The list of costs: the cost and the accuracy of each measuring method, on this machine and in this scene.
//
// Costs. A cost is the median time of a frame in which only that scanner measures, as Simulation::step() executes it:
// elements, flattening, planning, rendering or casting, ranges in memory. All variants are sensors of one loaded scene
// at the pose of the scanner, so the scene is read once. The variants take turns in every frame, in a rotating order,
// so that other load on the machine affects all of them equally: ratios are more reliable than times. Each turn
// consists of two frames of the same variant, the previous frame and the frame itself, and only the second is timed. So
// each variant pays for the motion between the two frames, and finds its own buffers as in a run in which no other
// sensor measures. A scene without a trajectory does not move, and flattening then costs nothing.
//
// Accuracy. It is taken from the error bounds of the scans in those frames, and from their differences to the ray cast
// of the same frame.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "program/report/cost_desc.h"
#include "program/report/scan_variant.h"

namespace simvis {

/// One row of the list. Relative numbers are shares of the range. Values that do not exist are NaN, for example
/// the bound if no beam hit anything.
struct VariantCosts {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  ScanVariant variant;
  bool in_scene = false;                                ///< the variant that the scene selects
  double median_ms = 0;                                 ///< median time of a frame
  double first_quartile_ms = 0, third_quartile_ms = 0;  ///< a quarter of the frames took less, or more
  double processor_ms = 0;                              ///< median processor time of a frame, of all threads
  double ratio = 0;                                     ///< median_ms divided by that of the scanner's cheapest variant
  double cast_share = 0;                                ///< share of beams that were cast as rays, in all frames
  /// Bounds of readings with a finite bound: the median (of the medians of the frames) over readings that are ranges,
  /// and the largest over all readings. A reading of 0 that may be a range has an infinite relative bound.
  double bound_median_m = kNone, bound_median_rel = kNone;
  double bound_largest_m = kNone, bound_largest_rel = kNone;
  double unbounded_share = 0;  ///< share of beams with an infinite bound
  /// Largest difference to `raycast` over beams for which both give a range: of beams with a finite bound, and of beams
  /// without.
  double difference_largest_m = kNone, difference_largest_rel = kNone;
  double unbounded_difference_m = kNone;
  double wrong_kind_share = kNone;  ///< share of beams whose kind (hit, miss or too near) differs from `raycast`

  /// Whether in all frames all beams had a bound within this share of their range, and `raycast` gave the same kind of
  /// reading and, within this share, the same range.
  bool meets(double tolerance_rel) const;
};

struct ScannerCosts {
  std::string scanner;
  std::uint32_t rings = 0, beams = 0;  ///< `beams` is the total over all rings
  std::uint64_t frames = 0;
  double load = 0;                     ///< see CostRun::load()
  std::vector<VariantCosts> variants;  ///< in the order of CostDesc::variants
};

/// The tolerances, as shares of the range, for which the list gives advice.
inline constexpr double kCostTolerances_rel[] = {1e-3, 1e-4, 1e-6};

/// The index of the recommended variant for a tolerance, or none if no variant meets it. Among the variants that cost
/// within 5 % of the cheapest one, which is no significant difference, it is the one with the smallest largest bound.
std::optional<std::size_t> cheapest_for(const ScannerCosts& costs, double tolerance_rel);

/// Of a list of variants, the one that errors are taken from: of method `raycast`; none if there is no such variant.
std::optional<std::size_t> reference_of(std::span<const VariantCosts> variants);

/// The names of the enabled sensors that cast beams. Throws InputError if there is none.
std::vector<std::string> costed_scanners(const Simulation& simulation);

/// Measures the costs of the enabled scanners of a simulation and consumes the simulation. Throws InputError if there
/// is none, if one is mounted in a part that is switched off, or if one gives a scan that is not one of whole rings.
std::vector<ScannerCosts> scanner_costs(Simulation simulation, const CostDesc& desc = {});

}  // namespace simvis
