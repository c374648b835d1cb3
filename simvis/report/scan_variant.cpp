#include "simvis/report/scan_variant.h"

#include <algorithm>
#include <initializer_list>
#include <utility>

#include "engine/base/assert.h"
#include "sensors/laser_scanner/laser_scanner.h"
#include "sensors/raster_depth/depth_range.h"

namespace simvis {

namespace {

constexpr double kStripResolutions_px[] = {512, 1024, 2048, 4096, 8192};  // of one ring: two rows of pixels
constexpr double kAreaResolutions_px[] = {256, 512, 1024, 2048};          // of several rings: whole faces
constexpr double kTolerances_rel[] = {1e-3, 1e-4, 1e-5};                  // of hybrid

AttributeValues read_scanner(const Command& scanner) {
  const SensorType* const type = find_sensor_type("laser_scanner");
  SIMVIS_ASSERT(type != nullptr);
  return AttributeValues(scanner, all_attributes(*type), kSensorCommonAttributes);
}

/// Without what the method does not look at: a hybrid that trusts no pixel renders nothing.
ScanVariant normal(ScanVariant variant) {
  if (variant.method != "hybrid") variant.max_error_rel.reset();
  if (variant.method == "raycast" || (variant.max_error_rel && *variant.max_error_rel < min_planar_bound())) {
    variant.resolution_px.reset();
  }
  return variant;
}

template <std::size_t N>
std::vector<double> with(const double (&listed)[N], std::optional<double> own) {
  std::vector<double> all(listed, listed + N);
  if (own && !std::ranges::count(all, *own)) all.push_back(*own);
  return all;
}

double own_tolerance(const AttributeValues& scanner) {
  return scanner.is_set("max_error_rel") ? scanner.number("max_error_rel") : LaserScannerDesc{}.max_error_rel;
}

std::vector<std::pair<const char*, std::string>> written(const ScanVariant& variant) {
  std::vector<std::pair<const char*, std::string>> attributes = {{"method", variant.method}};
  if (variant.resolution_px) attributes.emplace_back("resolution", format_number(*variant.resolution_px));
  if (variant.max_error_rel) attributes.emplace_back("max_error_rel", format_number(*variant.max_error_rel));
  return attributes;
}

}  // namespace

ScanVariant variant_of(const Command& scanner) {
  const AttributeValues a = read_scanner(scanner);
  const bool one_ring = a.integer("vertical_samples") == 1;
  return normal({.method = a.choice("method"),
                 .resolution_px = a.is_set("resolution") ? a.number("resolution")
                                  : one_ring             ? kPlanarResolution
                                                         : kRingsResolution,
                 .max_error_rel = own_tolerance(a)});
}

std::vector<ScanVariant> priced_variants(const Command& scanner) {
  const ScanVariant own = variant_of(scanner);
  const AttributeValues a = read_scanner(scanner);
  const bool one_ring = a.integer("vertical_samples") == 1;
  std::vector<double> resolutions_px =
      one_ring ? with(kStripResolutions_px, own.resolution_px) : with(kAreaResolutions_px, own.resolution_px);
  std::ranges::sort(resolutions_px);
  const bool says_one = scanner.find("max_error_rel") != nullptr;
  std::vector<double> tolerances_rel =
      with(kTolerances_rel, says_one ? std::optional(a.number("max_error_rel")) : own.max_error_rel);
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

std::string attributes_of(const ScanVariant& variant) {
  std::string text;
  for (const auto& [name, value] : written(variant)) text += (text.empty() ? "" : " ") + (name + ("=\"" + value)) + '"';
  return text;
}

Command with_variant(Command scanner, const ScanVariant& variant, const std::string& name) {
  const auto set_here = {"name", "rate", "method", "resolution", "max_error_m", "max_error_rel"};
  std::erase_if(scanner.attributes, [&](const CommandAttribute& attribute) {
    return std::ranges::find(set_here, attribute.name) != set_here.end();
  });
  scanner.attributes.push_back({"name", name, scanner.where});
  for (const auto& [attribute, value] : written(variant)) {
    scanner.attributes.push_back({attribute, value, scanner.where});
  }
  return scanner;
}

}  // namespace simvis
