#include "program/report/scan_variant.h"

#include <algorithm>
#include <initializer_list>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/words.h"

namespace simvis {

namespace {

std::vector<std::pair<const char*, std::string>> written(const ScanVariant& variant) {
  std::vector<std::pair<const char*, std::string>> attributes;
  if (!variant.method.empty()) attributes.emplace_back("method", variant.method);
  if (variant.resolution_px) attributes.emplace_back("resolution", format_number(*variant.resolution_px));
  if (variant.max_error_m) attributes.emplace_back("max_error_m", format_number(*variant.max_error_m));
  if (variant.max_error_rel) attributes.emplace_back("max_error_rel", format_number(*variant.max_error_rel));
  return attributes;
}

std::optional<double> given(const AttributeValues& attributes, AttributeTable table, std::string_view name) {
  const auto row = std::ranges::find(table, name, &AttributeSpec::name);
  if (row == table.end() || row->kind != AttributeKind::number || !attributes.is_set(name)) return {};
  return attributes.number(name);
}

// For a type that lists no variants itself: what its table says.
ScanVariants declared_variants(AttributeTable table, const AttributeValues& attributes) {
  const ScanVariant unnamed{.method = {},
                            .resolution_px = given(attributes, table, "resolution"),
                            .max_error_rel = given(attributes, table, "max_error_rel"),
                            .max_error_m = given(attributes, table, "max_error_m")};
  const auto method = std::ranges::find(table, "method", &AttributeSpec::name);
  if (method == table.end() || method->kind != AttributeKind::choice) return {unnamed, {unnamed}, {unnamed}};
  ScanVariants variants{.own = unnamed, .priced = {}, .by_method = {}};
  if (attributes.is_set(method->name)) variants.own.method = attributes.choice(method->name);
  ScanVariant each = unnamed;
  for (const std::string_view choice : words_of(method->choices)) {
    each.method = choice;
    variants.by_method.push_back(each);
  }
  if (!std::ranges::count(variants.by_method, variants.own)) variants.by_method.push_back(variants.own);
  variants.priced = variants.by_method;
  return variants;
}

}  // namespace

ScanVariants scan_variants(const Command& scanner) {
  const SensorType* const type = find_sensor_type(scanner.require("type").value);
  SIMVIS_ASSERT(type != nullptr);
  const std::vector<AttributeSpec> table = all_attributes(*type);
  const AttributeValues attributes(scanner, table, kSensorCommonAttributes);
  if (type->scan_variants == nullptr) return declared_variants(table, attributes);
  return type->scan_variants({.command = scanner, .attributes = attributes, .name = {}, .seed = 0});
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
