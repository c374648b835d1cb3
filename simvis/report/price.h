// The price list of accuracy: what each way to measure costs on this machine, in this scene, and what it is worth.
//
// How prices are taken. A price is the median time of a frame in which only that scanner measures, as
// Simulation::step() makes it: elements, flattening, planning, rendering or casting, ranges in memory. All variants are
// sensors of one loaded scene that stand where the scanner stands, so the scene is read once. They take turns in every
// frame, in an order that rotates, so that whatever else the machine does hits all of them alike: ratios are firmer
// than times. Each turn is two frames of the same variant, the one before and the frame itself, and the second is
// timed: so each pays for what moved between them, and finds its own buffers as in a run in which nothing else
// measures. A scene that moves along no trajectory stands still, and then flattening costs nothing.
//
// What they are worth is what the scans of those frames say of themselves, and how they differ from the ray cast of the
// same frame.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "simvis/report/scan_variant.h"

namespace simvis {

struct PriceDesc {
  std::uint64_t frames = 15;                  ///< that each variant is timed in: 1 to `frames` of a run; at least 1
  std::uint64_t warm_up = 1;                  ///< turns at frame 1 before that
  double rate_hz = SimulationDesc{}.rate_hz;  ///< of frames along the trajectory
  const Trajectory* trajectory = nullptr;
  /// What to price of a scanner, given its command.
  std::vector<ScanVariant> (*variants)(const Command& scanner) = priced_variants;
  /// Called after every frame; what it throws ends the pricing.
  std::function<void(std::uint64_t done, std::uint64_t all)> on_frame{};
};

/// One row. Relative numbers are shares of the range. Numbers of which there is none, as a bound where nothing was
/// hit, are NaN.
struct VariantPrice {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  ScanVariant variant;
  bool in_scene = false;  ///< what the scene asks for
  double median_ms = 0;   ///< of a frame
  double ratio = 0;       ///< of that to the cheapest of the scanner's variants
  double cast_share = 0;  ///< of beams, in all frames
  /// Of readings with a finite bound: the median (of the frames' medians) over those that are ranges, the largest over
  /// all. A reading of 0 that may be a range has an infinite relative bound.
  double bound_median_m = kNone, bound_median_rel = kNone;
  double bound_largest_m = kNone, bound_largest_rel = kNone;
  double unbounded_share = 0;  ///< of beams: an infinite bound
  /// To `raycast`, where both read a range: the largest of beams with a finite bound, and of those without.
  double difference_largest_m = kNone, difference_largest_rel = kNone;
  double unbounded_difference_m = kNone;
  double wrong_kind_share = kNone;  ///< of beams: a hit, a miss or something too near where `raycast` says another

  /// Whether in all frames all beams had a bound within this share of their range, and `raycast` agreed.
  bool meets(double tolerance_rel) const;
};

struct ScannerPrice {
  std::string scanner;
  std::uint32_t rings = 0, beams = 0;  ///< `beams` of all rings
  std::uint64_t frames = 0;
  std::vector<VariantPrice> variants;  ///< as priced_variants() has them
};

/// The tolerances, as shares of a range, that a price list gives advice for.
inline constexpr double kPriceTolerances_rel[] = {1e-3, 1e-4, 1e-6};

/// The variant to take for a tolerance, or none if nothing meets it: the cheapest; but of those that cost within 5 % of
/// it, which is no difference, the one with the smallest largest bound.
std::optional<std::size_t> cheapest_for(const ScannerPrice& price, double tolerance_rel);

/// The names of the enabled laser scanners. Throws InputError where there is none.
std::vector<std::string> scanners_to_price(const Simulation& simulation);

/// Prices those of a simulation, which is used up by it. Throws InputError also where one stands in a part that is
/// switched off.
std::vector<ScannerPrice> price_scanners(Simulation simulation, const PriceDesc& desc = {});

}  // namespace simvis
