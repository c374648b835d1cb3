// What a laser_scanner of a scene can be given.
#include <algorithm>
#include <limits>
#include <sstream>

#include "sensors/laser_scanner/laser_scanner.h"
#include "sensors/laser_scanner/laser_scanner_presets.h"

namespace simvis {

namespace {

constexpr AttributeSpec kLaserScannerAttributes[] = {
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
     .default_value = "planar",
     .text = "how depth becomes ranges",
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

ScanMethod method_named(std::string_view name) {
  constexpr ScanMethod kMethods[] = {ScanMethod::nearest, ScanMethod::planar, ScanMethod::hybrid, ScanMethod::raycast,
                                     ScanMethod::automatic};
  return *std::ranges::find(kMethods, name, [](ScanMethod method) { return to_string(method); });
}

// An effect that follows beams needs them cast: so they are, unless the scene says that they shall be rendered.
void cast_what_effects_trace(const Command& command, LaserScannerDesc& desc) {
  const auto tracing = std::ranges::find_if(
      desc.effects, [](const auto& each) { return each.called_for == nullptr && each.effect->traces(); });
  if (tracing == desc.effects.end() || desc.method == ScanMethod::raycast) return;
  if (const CommandAttribute* const method = command.find("method")) {
    fail_at(method->where, "attribute \"method\": " + in_quotes(method->value) + " cannot show " +
                               in_quotes(tracing->type->name) + " (" + std::string(tracing->type->source) +
                               "), expected raycast, or none, which is raycast here");
  }
  desc.method = ScanMethod::raycast;
}

std::unique_ptr<Sensor> create_laser_scanner(const SensorContext& context) {
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
  desc.method = method_named(a.choice("method"));
  if (a.is_set("max_error_m")) {
    desc.max_error_m = a.number("max_error_m");
    desc.max_error_rel = std::numeric_limits<double>::infinity();
  }
  if (a.is_set("max_error_rel")) desc.max_error_rel = a.number("max_error_rel");
  desc.where_max_error_m = a.where("max_error_m");
  desc.where_max_error_rel = a.where("max_error_rel");
  if (a.is_set("resolution")) desc.resolution_px = a.number("resolution");

  desc.effects = scan_effects({a, desc.pattern.rings, desc.pattern.samples, context.seed, context.name});
  cast_what_effects_trace(context.command, desc);

  const auto ordered = [&](const char* low, const char* high, double limit) {
    const double span = a.number(high) - a.number(low);
    if (span >= 0 && span <= limit) return;
    std::ostringstream message;
    message << "attribute \"" << high << "\": " << a.number(high) << " is not allowed with " << low << "=\""
            << a.number(low) << "\", expected from " << a.number(low) << " to " << a.number(low) + limit;
    fail_at(a.where(high), message.str());
  };
  ordered("min_angle", "max_angle", 360);
  ordered("vertical_min_angle", "vertical_max_angle", 180);
  ordered("range_min", "range_max", std::numeric_limits<double>::infinity());
  return std::make_unique<LaserScanner>(context.name, desc);
}

const SensorRegistration kLaserScannerRegistration({"laser_scanner",
                                                    "A laser scanner: ranges along beams, each with an error bound.",
                                                    kLaserScannerAttributes, create_laser_scanner,
                                                    laser_scanner_presets()});

}  // namespace
}  // namespace simvis
