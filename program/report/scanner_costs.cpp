#include "program/report/scanner_costs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/assert.h"
#include "program/report/cost_run.h"
#include "program/report/run_report.h"

namespace simvis {

namespace {

constexpr double kSameCost = 1.05;

bool is_range(float reading_m) { return reading_m > 0 && std::isfinite(reading_m); }

/// Updates a running maximum, which is NaN before the first value.
void raise(double& largest, double value) {
  if (!(largest >= value)) largest = value;
}

/// The values collected from the frames of one variant.
struct Tally {
  std::vector<FrameTimes> times;
  std::vector<double> medians_m, medians_rel;
  double beams = 0, cast = 0, unbounded = 0, wrong_kind = 0;
};

void take_bounds(const Scan& scan, Tally& tally, VariantCosts& costs) {
  std::vector<double> bounds_m, bounds_rel;
  for (std::size_t i = 0; i < scan.range_m.size(); ++i) {
    const double range_m = scan.range_m[i], bound_m = scan.error_bound_m[i];
    if (!std::isfinite(bound_m)) {
      ++tally.unbounded;
      continue;
    }
    raise(costs.bound_largest_m, bound_m);
    raise(costs.bound_largest_rel, bound_m == 0 ? 0 : bound_m / range_m);
    if (!is_range(scan.range_m[i])) continue;
    bounds_m.push_back(bound_m);
    bounds_rel.push_back(bound_m / range_m);
  }
  tally.beams += static_cast<double>(scan.range_m.size());
  if (bounds_m.empty()) return;
  tally.medians_m.push_back(percentile(bounds_m, 50));
  tally.medians_rel.push_back(percentile(bounds_rel, 50));
}

void take_differences(const Scan& scan, const Scan& reference, Tally& tally, VariantCosts& costs) {
  for (std::size_t i = 0; i < scan.range_m.size(); ++i) {
    const float seen_m = scan.range_m[i], true_m = reference.range_m[i];
    if (seen_m == true_m && !is_range(seen_m)) continue;
    if (!is_range(seen_m) || !is_range(true_m)) {
      ++tally.wrong_kind;
      continue;
    }
    const double difference_m = std::abs(static_cast<double>(seen_m) - static_cast<double>(true_m));
    if (!std::isfinite(scan.error_bound_m[i])) {
      raise(costs.unbounded_difference_m, difference_m);
    } else {
      raise(costs.difference_largest_m, difference_m);
      raise(costs.difference_largest_rel, difference_m / static_cast<double>(true_m));
    }
  }
}

/// The variants of one scanner, as sensors of the simulation.
struct CostedScanner {
  std::string name;
  std::vector<std::string> sensors;  // by variant
  std::optional<std::size_t> reference;
  std::vector<VariantCosts> all_costs;
  std::vector<Tally> tallies;
};

class ScannerCostRun {
 public:
  ScannerCostRun(Simulation simulation, const CostDesc& desc)
      : names_(costed_scanners(simulation)), desc_(desc), run_(std::move(simulation), desc_) {
    for (const std::string& name : names_) add(name);
  }

  std::vector<ScannerCosts> run() {
    std::vector<ScannerCosts> all_costs;
    for (CostedScanner& scanner : scanners_) all_costs.push_back(costs(scanner));
    return all_costs;
  }

 private:
  void add(const std::string& name) {
    CostedScanner scanner{.name = name, .sensors = {}, .reference = {}, .all_costs = {}, .tallies = {}};
    const Command command = run_.simulation().diagnostics().command(name);
    const ScanVariants variants = scan_variants(command);
    for (const ScanVariant& variant : variants.*desc_.variants) {
      scanner.sensors.push_back(CostRun::variant_name(name, scanner.sensors.size()));
      run_.add(name, with_variant(command, variant, scanner.sensors.back()), scanner.sensors.back(),
               run_.frames_of_turns());
      scanner.all_costs.push_back({.variant = variant, .in_scene = variant == variants.own});
    }
    scanner.reference = reference_of(scanner.all_costs);
    scanner.tallies.resize(scanner.all_costs.size());
    scanners_.push_back(std::move(scanner));
  }

  ScannerCosts costs(CostedScanner& scanner) {
    for (std::uint64_t turn = 0; turn < desc_.warm_up; ++turn) measure(scanner, 1, turn);
    for (Tally& tally : scanner.tallies) tally = {};
    for (std::uint64_t frame = 1; frame <= desc_.frames; ++frame) {
      measure(scanner, frame, frame);
      for (std::size_t i = 0; i < scanner.sensors.size(); ++i) judge(scanner, i);
    }
    double min_ms = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < scanner.all_costs.size(); ++i) {
      sum_up(scanner.tallies[i], scanner.reference.has_value(), scanner.all_costs[i]);
      min_ms = std::min(min_ms, scanner.all_costs[i].median_ms);
    }
    for (VariantCosts& each : scanner.all_costs) each.ratio = each.median_ms / min_ms;
    const Scan& scan = run_.simulation().scan(scanner.sensors.front());
    return {.scanner = scanner.name,
            .rings = scan.rings,
            .beams = scan.rings * scan.beams,
            .frames = desc_.frames,
            .load = run_.load(),
            .variants = scanner.all_costs};
  }

  /// All variants measure `frame`; each variant first measures the previous frame.
  void measure(CostedScanner& scanner, std::uint64_t frame, std::uint64_t turn) {
    const std::size_t count = scanner.sensors.size();
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t variant = (i + turn) % count;  // rotates the order
      const std::string& sensor = scanner.sensors[variant];
      scanner.tallies[variant].times.push_back(run_.time(sensor, "laser scanner \"" + scanner.name + '"', frame));
      const Scan& scan = run_.simulation().scan(sensor);
      if (scan.range_m.empty() || scan.range_m.size() != std::size_t{scan.rings} * scan.beams) {
        throw InputError("laser scanner \"" + scanner.name + "\" has no price: its scan is not one of whole rings");
      }
    }
  }

  void judge(CostedScanner& scanner, std::size_t variant) {
    Tally& tally = scanner.tallies[variant];
    const Scan& scan = run_.simulation().scan(scanner.sensors[variant]);
    take_bounds(scan, tally, scanner.all_costs[variant]);
    if (scanner.reference) {
      take_differences(scan, run_.simulation().scan(scanner.sensors[*scanner.reference]), tally,
                       scanner.all_costs[variant]);
    }
    tally.cast += cast_share(scanner.sensors[variant]) * static_cast<double>(scan.range_m.size());
  }

  double cast_share(const std::string& name) {
    const std::vector<SensorInfo> sensors = run_.simulation().sensors();
    const auto sensor = std::ranges::find(sensors, name, &SensorInfo::name);
    SIMVIS_ASSERT(sensor != sensors.end());
    return sensor->number("cast_share").value_or(0);
  }

  static void sum_up(const Tally& tally, bool compared, VariantCosts& costs) {
    set_times(tally.times, costs);
    costs.cast_share = tally.cast / tally.beams;
    costs.unbounded_share = tally.unbounded / tally.beams;
    if (compared) costs.wrong_kind_share = tally.wrong_kind / tally.beams;
    if (tally.medians_m.empty()) return;
    costs.bound_median_m = percentile(tally.medians_m, 50);
    costs.bound_median_rel = percentile(tally.medians_rel, 50);
  }

  std::vector<std::string> names_;
  const CostDesc& desc_;
  CostRun run_;
  std::vector<CostedScanner> scanners_;
};

}  // namespace

bool VariantCosts::meets(double tolerance_rel) const {
  return unbounded_share == 0 && bound_largest_rel <= tolerance_rel && !(difference_largest_rel > tolerance_rel) &&
         !(wrong_kind_share > 0);
}

std::optional<std::size_t> cheapest_for(const ScannerCosts& costs, double tolerance_rel) {
  double min_ms = std::numeric_limits<double>::infinity();
  for (const VariantCosts& each : costs.variants) {
    if (each.meets(tolerance_rel)) min_ms = std::min(min_ms, each.median_ms);
  }
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < costs.variants.size(); ++i) {
    const VariantCosts& each = costs.variants[i];
    if (!each.meets(tolerance_rel) || each.median_ms > kSameCost * min_ms) continue;
    if (!found || each.bound_largest_rel < costs.variants[*found].bound_largest_rel) found = i;
  }
  return found;
}

std::optional<std::size_t> reference_of(std::span<const VariantCosts> variants) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < variants.size(); ++i) {
    if (variants[i].variant.method == "raycast") found = i;
  }
  return found;
}

std::vector<std::string> costed_scanners(const Simulation& simulation) {
  std::vector<std::string> names;
  for (const SensorInfo& sensor : simulation.sensors()) {
    if (sensor.enabled && (sensor.capabilities & kCastsBeams) != 0) names.push_back(sensor.name);
  }
  if (names.empty()) throw InputError("there is no enabled laser scanner, expected at least one");
  return names;
}

std::vector<ScannerCosts> scanner_costs(Simulation simulation, const CostDesc& desc) {
  SIMVIS_ASSERT(desc.frames > 0);
  return ScannerCostRun(std::move(simulation), desc).run();
}

}  // namespace simvis
