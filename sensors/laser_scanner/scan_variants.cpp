// The variants of a laser scanner for price lists: the possible values of its accuracy attributes.
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "engine/base/assert.h"
#include "sensors/laser_scanner/laser_scanner.h"
#include "sensors/raster_depth/depth_range.h"

namespace simvis {

namespace {

constexpr double kBetweenMethods_rel = 1e-4;              // for hybrid: it renders and casts
constexpr double kTolerances_rel[] = {1e-3, 1e-4, 1e-5};  // for hybrid

/// Removes the values that the method does not use. A hybrid that accepts no pixel renders nothing.
ScanVariant normal(ScanVariant variant) {
  const std::optional<ScanMethod> method = find_scan_method(variant.method);
  SIMVIS_ASSERT(method.has_value());
  if (!takes_tolerance(*method)) {
    variant.max_error_m.reset();
    variant.max_error_rel.reset();
  }
  const bool trusts_no_pixel = variant.max_error_rel && *variant.max_error_rel < min_planar_bound();
  if (*method == ScanMethod::raycast || trusts_no_pixel) variant.resolution_px.reset();
  return variant;
}

template <std::size_t N>
std::vector<double> with(const double (&listed)[N], std::optional<double> own) {
  std::vector<double> all(listed, listed + N);
  if (own && !std::ranges::count(all, *own)) all.push_back(*own);
  return all;
}

/// The variant that the scene selects, with the default values for attributes that it omits.
ScanVariant variant_of(const LaserScannerDesc& desc) {
  ScanVariant variant{.method = std::string(to_string(desc.method)), .resolution_px = {}, .max_error_rel = {}};
  if (desc.resolution_px > 0) {
    variant.resolution_px = desc.resolution_px;
  } else if (desc.method != ScanMethod::automatic) {  // auto chooses the resolution itself
    variant.resolution_px = default_resolution_px(desc.pattern);
  }
  if (std::isfinite(desc.max_error_rel)) variant.max_error_rel = desc.max_error_rel;
  variant.max_error_m = desc.max_error_m;
  return normal(variant);
}

std::vector<ScanVariant> priced(const LaserScannerDesc& desc, const ScanVariant& own) {
  const std::optional<double> own_px = desc.resolution_px > 0 ? std::optional(desc.resolution_px) : std::nullopt;
  std::vector<double> resolutions_px =
      desc.pattern.rings == 1 ? with(kPlanarResolutions, own_px) : with(kRingsResolutions, own_px);
  std::ranges::sort(resolutions_px);
  std::vector<double> tolerances_rel = with(kTolerances_rel, own.max_error_rel);
  std::ranges::sort(tolerances_rel, std::greater<>());

  std::vector<ScanVariant> variants;
  const auto add = [&](const ScanVariant& variant) {
    if (!std::ranges::count(variants, normal(variant))) variants.push_back(normal(variant));
  };
  for (const char* method : {"nearest", "planar"}) {
    for (const double resolution : resolutions_px) add({method, resolution, {}});
  }
  for (const double tolerance : tolerances_rel) {
    for (const double resolution : resolutions_px) add({"hybrid", resolution, tolerance});
  }
  add({"raycast", {}, {}});
  add(own);
  return variants;
}

std::vector<ScanVariant> by_method(LaserScannerDesc desc) {
  desc.max_error_m.reset();
  desc.max_error_rel = kBetweenMethods_rel;
  std::vector<ScanVariant> variants;
  for (const ScanMethod method : {ScanMethod::nearest, ScanMethod::planar, ScanMethod::hybrid, ScanMethod::raycast}) {
    desc.method = method;
    variants.push_back(variant_of(desc));
  }
  return variants;
}

}  // namespace

ScanVariants laser_scanner_variants(const SensorContext& context) {
  const LaserScannerDesc desc = read_desc<LaserScannerDesc>(context);
  const ScanVariant own = variant_of(desc);
  if (beam_following_effect(desc) != nullptr || desc.table != nullptr) return {own, {own}, {own}};
  return {own, priced(desc, own), by_method(desc)};
}

}  // namespace simvis
