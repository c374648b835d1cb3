#include "sensors/laser_scanner/scanner_pattern.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/location.h>
#include "sensors/beam_tables/beam_table_file.h"
#include "sensors/beam_tables/device_tables.h"

namespace simvis {
namespace {

// What an even grid has, or a rendered one.
constexpr std::string_view kGridAttributes[] = {"vertical_samples",
                                                "vertical_min_angle",
                                                "vertical_max_angle",
                                                "resolution",
                                                "max_error_m",
                                                "max_error_rel",
                                                "sweep",
                                                "sweep_direction"};
constexpr std::string_view kColumnAttributes[] = {"samples", "min_angle", "max_angle"};

[[noreturn]] void fail_at_attribute(const SensorContext& context, std::string_view name, const std::string& what) {
  fail_at(context.attributes.where(name), "attribute " + in_quotes(name) + ": " + what);
}

void refuse_without_pattern(const SensorContext& context) {
  for (const std::string_view name : {"pattern_beams", "pattern_rate"}) {
    if (context.attributes.is_set(name))
      fail_at_attribute(context, name, "needs a pattern, expected one, or none of both");
  }
  if (context.attributes.choice("firing") == "pattern") {
    fail_at_attribute(context, "firing", "\"pattern\" needs a pattern with times, expected one, or \"together\"");
  }
}

void refuse_grid(const SensorContext& context, bool columns_needed) {
  const auto refuse = [&](std::string_view name) {
    if (context.command.find(name) == nullptr) return;
    fail_at_attribute(context, name, "is not for a scanner with a pattern, whose beams are those of the table");
  };
  for (const std::string_view name : kGridAttributes) refuse(name);
  for (const std::string_view name : kColumnAttributes) {
    if (!columns_needed) refuse(name);
  }
  const std::string& method = context.attributes.choice("method");
  if (context.command.find("method") != nullptr && method != "raycast") {
    fail_at_attribute(context, "method", in_quotes(method) + " renders an even grid, expected raycast with a pattern");
  }
}

BeamTable read_table(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  const std::string& name = a.text("pattern");
  if (name.starts_with(kDevicePrefix)) {
    refuse_grid(context, false);
    const std::string_view device = std::string_view(name).substr(kDevicePrefix.size());
    if (const DeviceTable* const known = find_device_table(device)) return known->make(known->index);
    std::vector<std::string_view> names;
    std::string all;
    for (const DeviceTable& each : device_tables()) {
      names.push_back(each.name);
      all += (all.empty() ? "" : ", ") + std::string(each.name);
    }
    fail_at_attribute(
        context, "pattern",
        in_quotes(device) + " is not a device with a table, expected one of: " + all + suggestion(device, names));
  }
  const std::filesystem::path file = context.command.folder / name;
  refuse_grid(context, needs_columns(file));
  const TableColumns columns{static_cast<std::uint32_t>(a.integer("samples")), a.number("min_angle"),
                             a.number("max_angle")};
  return read_beam_table(file, columns,
                         a.is_set("pattern_rate") ? std::optional(a.number("pattern_rate")) : std::nullopt);
}

void require_times(const SensorContext& context, std::string_view attribute, const BeamTable& table) {
  const bool timed = !table.time_ns.empty() && std::ranges::max(table.time_ns) > 0;
  if (!timed) {
    fail_at_attribute(context, attribute,
                      "the pattern " + in_quotes(context.attributes.text("pattern")) +
                          " does not say when its beams fire, expected pattern_rate as well");
  }
}

}  // namespace

std::optional<ScannerPattern> scanner_pattern(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  if (!a.is_set("pattern")) {
    refuse_without_pattern(context);
    return {};
  }
  ScannerPattern pattern{.table = std::make_shared<const BeamTable>(read_table(context))};
  const BeamTable& table = *pattern.table;
  pattern.shape = {table.rings, table.beams};
  if (a.choice("firing") == "pattern") require_times(context, "firing", table);
  if (!a.is_set("pattern_beams")) return pattern;
  require_times(context, "pattern_beams", table);
  pattern.beams_of_scan = static_cast<std::uint32_t>(a.integer("pattern_beams"));
  if (pattern.beams_of_scan > table.size()) {
    fail_at_attribute(context, "pattern_beams",
                      std::to_string(pattern.beams_of_scan) + " is not allowed, expected at most the " +
                          std::to_string(table.size()) + " beams of the pattern");
  }
  pattern.shape = {1, pattern.beams_of_scan};
  return pattern;
}

}  // namespace simvis
