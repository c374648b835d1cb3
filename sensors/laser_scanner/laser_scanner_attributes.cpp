// What a laser_scanner of a scene can be given.
#include <limits>
#include <sstream>

#include "engine/base/assert.h"
#include "sensors/laser_scanner/laser_scanner.h"
#include "sensors/laser_scanner/laser_scanner_presets.h"

namespace simvis {

namespace {

constexpr AttributeSpec kAttributes[] = {
    {.name = "samples",
     .kind = AttributeKind::integer,
     .default_value = "361",
     .text = "beams of a ring, the first at min_angle, the last at max_angle",
     .min = 1,
     .max = 1e6},
    {.name = "min_angle",
     .default_value = "-90",
     .unit = "deg",
     .text = "azimuth of the first beam, counter-clockwise from x",
     .min = -360,
     .max = 360},
    {.name = "max_angle",
     .default_value = "90",
     .unit = "deg",
     .text = "azimuth of the last beam; at most a full turn from the first",
     .min = -360,
     .max = 360},
    {.name = "vertical_samples",
     .kind = AttributeKind::integer,
     .default_value = "1",
     .text = "rings, the lowest at vertical_min_angle",
     .min = 1,
     .max = 1e5},
    {.name = "vertical_min_angle",
     .default_value = "0",
     .unit = "deg",
     .text = "elevation of the lowest ring",
     .min = -90,
     .max = 90},
    {.name = "vertical_max_angle",
     .default_value = "0",
     .unit = "deg",
     .text = "elevation of the highest ring",
     .min = -90,
     .max = 90},
    {.name = "range_min",
     .default_value = "0.05",
     .unit = "m",
     .text = "what is nearer along the ray blocks the beam and reads 0",
     .min = 0},
    {.name = "range_max",
     .default_value = "80",
     .unit = "m",
     .text = "what is farther along the ray reads inf",
     .min = 0,
     .open_min = true},
    {.name = "method",
     .kind = AttributeKind::choice,
     .default_value = "raycast",
     .text = "how ranges are measured; with a max_error and no method: hybrid",
     .choices = "nearest planar hybrid raycast auto"},
    {.name = "max_error_m",
     .unit = "m",
     .text = "hybrid and auto: no error bound is above this",
     .min = 0,
     .open_min = true},
    {.name = "max_error_rel",
     .text = "hybrid and auto: no error bound is above this share of its range; 1e-6 if no max_error_m is given",
     .min = 0,
     .open_min = true},
    {.name = "resolution",
     .unit = "px",
     .text = "pixels of the virtual cameras across 90 degrees; 4096 for one ring, 1024 for more, if not given",
     .min = 8,
     .max = 16000},
    kRateAttribute,
    kPresetAttribute,
};

constexpr std::string_view kToleranceAttributes[] = {"max_error_m", "max_error_rel"};

// The tolerance that the scene writes, for messages: null if it writes none.
const CommandAttribute* written_tolerance(const Command& command) {
  for (const std::string_view name : kToleranceAttributes) {
    if (const CommandAttribute* const written = command.find(name)) return written;
  }
  return nullptr;
}

// A tolerance without a method means the method that keeps it and casts only where it has to.
ScanMethod scan_method(const Command& command, const AttributeValues& attributes) {
  if (command.find("method") == nullptr && written_tolerance(command) != nullptr) return ScanMethod::hybrid;
  const std::optional<ScanMethod> method = find_scan_method(attributes.choice("method"));
  SIMVIS_ASSERT(method.has_value());
  return *method;
}

// A tolerance that the method ignores would promise what nobody checks.
void refuse_ignored_tolerance(const Command& command, ScanMethod method) {
  const CommandAttribute* const tolerance = written_tolerance(command);
  if (tolerance == nullptr || takes_tolerance(method)) return;
  fail_at(tolerance->where, "attribute " + in_quotes(tolerance->name) + ": method " + in_quotes(to_string(method)) +
                                " does not look at it, expected method hybrid or auto, or none, which is hybrid here");
}

// An effect that follows beams needs every beam cast, which only `raycast` does, and `raycast` keeps no tolerance.
void refuse_other_than_raycast(const Command& command, const EffectType& effect) {
  const std::string needed =
      " cannot show " + in_quotes(effect.name) + " (" + std::string(effect.source) + "), expected ";
  if (const CommandAttribute* const method = command.find("method")) {
    if (method->value == to_string(ScanMethod::raycast)) return;
    fail_at(method->where,
            "attribute \"method\": " + in_quotes(method->value) + needed + "raycast, or none, which is raycast here");
  }
  if (const CommandAttribute* const tolerance = written_tolerance(command)) {
    fail_at(tolerance->where,
            "attribute " + in_quotes(tolerance->name) + ": a scanner that keeps a tolerance" + needed + "no tolerance");
  }
}

void check_order(const AttributeValues& a, const char* low, const char* high, double limit) {
  const double span = a.number(high) - a.number(low);
  if (span >= 0 && span <= limit) return;
  std::ostringstream message;
  message << "attribute \"" << high << "\": " << a.number(high) << " is not allowed with " << low << "=\""
          << a.number(low) << "\", expected from " << a.number(low) << " to " << a.number(low) + limit;
  fail_at(a.where(high), message.str());
}

std::unique_ptr<Sensor> create(const SensorContext& context) {
  return std::make_unique<LaserScanner>(context.name, laser_scanner_desc(context));
}

const SensorRegistration kRegistration({"laser_scanner",
                                        "A laser scanner: ranges along beams, each with an error bound.", kAttributes,
                                        create, laser_scanner_presets()});

}  // namespace

LaserScannerDesc laser_scanner_desc(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  LaserScannerDesc desc;
  desc.pattern = {.samples = static_cast<std::uint32_t>(a.integer("samples")),
                  .rings = static_cast<std::uint32_t>(a.integer("vertical_samples")),
                  .min_azimuth_rad = glm::radians(a.number("min_angle")),
                  .max_azimuth_rad = glm::radians(a.number("max_angle")),
                  .min_elevation_rad = glm::radians(a.number("vertical_min_angle")),
                  .max_elevation_rad = glm::radians(a.number("vertical_max_angle"))};
  desc.range_min_m = a.number("range_min");
  desc.range_max_m = a.number("range_max");
  desc.method = scan_method(context.command, a);
  if (a.is_set("max_error_m")) {
    desc.max_error_m = a.number("max_error_m");
    desc.max_error_rel = std::numeric_limits<double>::infinity();
  }
  if (a.is_set("max_error_rel")) desc.max_error_rel = a.number("max_error_rel");
  desc.where_max_error_m = a.where("max_error_m");
  desc.where_max_error_rel = a.where("max_error_rel");
  if (a.is_set("resolution")) desc.resolution_px = a.number("resolution");
  desc.effects = scan_effects({a, desc.pattern.rings, desc.pattern.samples, context.seed, context.name});

  if (const EffectType* const effect = beam_following_effect(desc)) {
    refuse_other_than_raycast(context.command, *effect);
  }
  refuse_ignored_tolerance(context.command, desc.method);
  check_order(a, "min_angle", "max_angle", 360);
  check_order(a, "vertical_min_angle", "vertical_max_angle", 180);
  check_order(a, "range_min", "range_max", std::numeric_limits<double>::infinity());
  return desc;
}

}  // namespace simvis
