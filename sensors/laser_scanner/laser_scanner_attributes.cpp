// The attributes of the sensor `laser_scanner`.
#include <algorithm>
#include <iterator>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/decimal.h"
#include "sensors/cloud_attributes.h"
#include "sensors/laser_scanner/laser_scanner.h"
#include "sensors/laser_scanner/laser_scanner_presets.h"
#include "sensors/laser_scanner/scan_beams.h"
#include "sensors/laser_scanner/scan_calibration.h"
#include "sensors/laser_scanner/scanner_pattern.h"

namespace simvis {

namespace {

const AttributeWords<ScanMethod> kScanMethods{{ScanMethod::nearest, "nearest"},
                                              {ScanMethod::planar, "planar"},
                                              {ScanMethod::hybrid, "hybrid"},
                                              {ScanMethod::raycast, "raycast"},
                                              {ScanMethod::automatic, "auto"}};

AttributeRows<ScanPattern> pattern_rows() {
  constexpr AttributeLimits kAzimuth{.min = -360, .max = 360}, kElevation{.min = -90, .max = 90};
  return {
      row(&ScanPattern::beams, "samples", "", {.min = 1, .max = 1e6}, "beams of a ring, from min_angle to max_angle"),
      row(&ScanPattern::min_azimuth_rad, "min_angle", kDegrees, kAzimuth,
          "azimuth of the first beam, counter-clockwise from +x"),
      row(&ScanPattern::max_azimuth_rad, "max_angle", kDegrees, kAzimuth,
          "azimuth of the last beam; at most a full turn after the first"),
      row(&ScanPattern::rings, "vertical_samples", "", {.min = 1, .max = 1e5},
          "number of rings, from vertical_min_angle to vertical_max_angle"),
      row(&ScanPattern::min_elevation_rad, "vertical_min_angle", kDegrees, kElevation, "elevation of the lowest ring"),
      row(&ScanPattern::max_elevation_rad, "vertical_max_angle", kDegrees, kElevation,
          "elevation of the highest ring")};
}

// These choose the beams in place of the even grid, see scanner_pattern().
constexpr AttributeSpec kPattern{
    .name = "pattern",
    .kind = AttributeKind::file,
    .text = "beam table: a file .csv, .mat3x4f, .json or .yaml, or device:NAME; default: an even grid",
    .choices = kDevicePrefix};
constexpr AttributeSpec kPatternBeams{
    .name = "pattern_beams",
    .kind = AttributeKind::integer,
    .text = "beams of a scan of a pattern that runs on from scan to scan; default: every scan has the whole pattern",
    .min = 1,
    .max = static_cast<double>(kMaxTableBeams)};
constexpr AttributeSpec kPatternRate{
    .name = "pattern_rate",
    .unit = "1/s",
    .text = "beams per second, in the order of the pattern; default: the times of the pattern",
    .min = 1,
    .max = 1e9};

constexpr std::string_view kToleranceAttributes[] = {"max_error_m", "max_error_rel"};

// The tolerance attribute in the scene, for messages; null if there is none.
const CommandAttribute* written_tolerance(const Command& command) {
  for (const std::string_view name : kToleranceAttributes) {
    if (const CommandAttribute* const written = command.find(name)) return written;
  }
  return nullptr;
}

// An ignored tolerance would be a promise that nothing checks.
void refuse_ignored_tolerance(const Command& command, ScanMethod method) {
  const CommandAttribute* const tolerance = written_tolerance(command);
  if (tolerance == nullptr || takes_tolerance(method)) return;
  fail_at(tolerance->where, "attribute " + in_quotes(tolerance->name) + ": method " + in_quotes(to_string(method)) +
                                " ignores a tolerance, expected method hybrid or auto, or none, which is hybrid here");
}

// An effect that follows beams requires that every beam is cast. Only `raycast` does so, and `raycast` accepts no
// tolerance.
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
  const std::string from = decimal(a.number(low), 6);
  fail_at(a.where(high), "attribute \"" + std::string(high) + "\": " + decimal(a.number(high), 6) +
                             " is not allowed with " + low + "=\"" + from + "\", expected from " + from + " to " +
                             decimal(a.number(low) + limit, 6));
}

const SensorRegistration kLaserScannerRegistration(
    {.name = "laser_scanner",
     .summary = "A laser scanner: ranges along beams, each with an error bound.",
     .notes =
         "Beam i of a ring has the azimuth min_angle + i (max_angle - min_angle) / (samples - 1). Azimuth is "
         "counter-clockwise from +x about +z, elevation is positive upwards.\nA range is measured along the beam. It "
         "is inf where nothing lies within range_max, and 0 where the beam meets something nearer than range_min. The "
         "true range lies within error_bound_m of range_m; an infinite bound says that the method cannot tell which "
         "surface the beam meets.\nmethod: raycast casts a ray for every beam; it is exact up to rounding and gives "
         "the same bytes on every device. planar takes ranges from rendered depth, exact on planes; hybrid renders "
         "like planar and casts the beams whose bound exceeds the tolerance; nearest takes the nearest depth pixel. "
         "auto takes the cheapest method that meets the tolerance. With a tolerance below 1.5e-6 of the range, hybrid "
         "and auto cast every beam. Without "
         "max_error_m and max_error_rel, hybrid and auto keep 1e-6 of the range; if both are given, both hold. A "
         "tolerance without a method means hybrid. A tolerance with nearest, planar or raycast is an error.\nThe "
         "columns "
         "of truth are for the beam's nominal direction, from the pose of the frame; range_min and range_max do not "
         "limit "
         "true_range_m. true_item counts the meshes that are drawn in the scene, true_primitive the triangles of the "
         "mesh. true_instance, true_semantic and true_shape are ids as those of cameras, see docs/truth.md; "
         "true_normal is that of "
         "the triangle, towards the sensor; true_velocity is that of the matter of the object, the mean since the "
         "scanner's measurement before.\nWith a pattern the beams are those of a table, which docs/beam-tables.md "
         "describes; beams need "
         "not start at one point, and each is cast. device:NAME names the table of a real device.\nEffects "
         "that follow beams cast every beam: method is then raycast, or not given.\nPresets cite the data sheets of "
         "devices. Steps, ring angles and firing cycles were checked; check the other values against your device.",
     .capabilities = kCastsBeams | kSeesSplats | kRaysHitSplats,
     .attributes = rows_of<LaserScannerDesc>().table(),
     .create = create_sensor<LaserScanner, LaserScannerDesc>,
     .presets = laser_scanner_presets(),
     .measure_costs = measure_scan_costs,
     .scan_variants = laser_scanner_variants,
     .outputs = laser_scanner_outputs});

// As many as a beam table may have, so that a scanner of any attributes fits into memory. `samples` alone is below
// that.
void require_possible_size(const AttributeValues& a, const ScanPattern& pattern) {
  if (std::uint64_t{pattern.rings} * pattern.beams <= kMaxTableBeams) return;
  fail_at(a.where("vertical_samples"), "attribute \"vertical_samples\": " + std::to_string(pattern.rings) +
                                           " rings of " + std::to_string(pattern.beams) +
                                           " samples are too many beams, expected at most " +
                                           std::to_string(kMaxTableBeams));
}

// What the fields of a driver's cloud can hold.
struct LayoutLimits {
  std::string_view layout;
  std::uint32_t rings;
  double sweep_s;
};
constexpr double kAnySweep_s = std::numeric_limits<double>::infinity();
constexpr double kWordSweep_s = 4;  // in nanoseconds in 32 bits, which end at 4.29 s
constexpr LayoutLimits kLayoutLimits[] = {
    {"velodyne", 65536, kAnySweep_s}, {"ouster", 65536, kWordSweep_s}, {"livox", 256, kWordSweep_s}};

// The time from the first beam of a scan to its last, or a little more.
double sweep_s(const AttributeValues& a, const LaserScannerDesc& desc) {
  if (desc.table == nullptr) return a.number("sweep");
  if (a.choice("firing") != "pattern") return 0;
  const std::int64_t ns = desc.table_beams == 0 ? *std::ranges::max_element(desc.table->time_ns)
                                                : RunningBeams(*desc.table, desc.table_beams).period_ns();
  return static_cast<double>(ns) / 1e9;
}

std::uint32_t rings_of(const LaserScannerDesc& desc) {
  if (desc.table == nullptr) return desc.pattern.rings;
  const std::vector<std::uint32_t>& channels = desc.table->channel;
  return channels.empty() ? desc.table->rings : *std::ranges::max_element(channels) + 1;
}

void require_layout(const AttributeValues& a, const LaserScannerDesc& desc) {
  const std::string& layout = a.choice(kLayoutAttribute.name);
  const auto* const limits = std::ranges::find(kLayoutLimits, layout, &LayoutLimits::layout);
  if (limits == std::end(kLayoutLimits)) return;
  const auto refuse = [&](const std::string& what) {
    fail_at(a.where(kLayoutAttribute.name), "attribute \"layout\": " + in_quotes(layout) + " " + what);
  };
  if (const std::uint32_t rings = rings_of(desc); rings > limits->rings) {
    refuse("cannot number the scanner's " + std::to_string(rings) + " rings, expected at most " +
           std::to_string(limits->rings));
  }
  if (const double scan_s = sweep_s(a, desc); scan_s > limits->sweep_s) {
    refuse("cannot hold the times of a scan of " + decimal(scan_s, 6) + " s, expected at most " +
           decimal(limits->sweep_s, 6) + " s");
  }
}

}  // namespace

std::string_view to_string(ScanMethod method) { return word_of(kScanMethods, method); }

std::optional<ScanMethod> find_scan_method(std::string_view name) {
  for (const auto& [method, word] : kScanMethods) {
    if (word == name) return method;
  }
  return std::nullopt;
}

AttributeRows<LaserScannerDesc> LaserScannerDesc::rows() {
  using Desc = LaserScannerDesc;
  return {
      nested(&Desc::pattern, pattern_rows()),
      kPattern,
      kPatternBeams,
      kPatternRate,
      row(&Desc::range_min_m, "range_min", "m", kNotNegative,
          "a surface nearer than this along the beam blocks it and reads 0"),
      row(&Desc::range_max_m, "range_max", "m", kAboveZero, "a surface farther than this along the beam reads inf"),
      row(&Desc::method, "method", kScanMethods, "how ranges are measured; with a max_error and no method: hybrid"),
      row(&Desc::max_error_m, "max_error_m", "m", kAboveZero, "hybrid and auto: largest error bound"),
      row(&Desc::max_error_rel, "max_error_rel", "", kAboveZero,
          "hybrid and auto: largest error bound as a share of the range; default: 1e-6 without max_error_m")
          .without_default(),
      row(&Desc::resolution_px, "resolution", "px", {.min = 8, .max = 16000},
          "pixels of the virtual cameras across 90 degrees; default: 4096 for one ring, 1024 for more; auto chooses "
          "from 512 to 8000 for one ring and from 256 to 2048 for more")
          .without_default(),
      nested(&Desc::truth, ScanTruthDesc::rows()),
      kLayoutAttribute,
      kDenseAttribute,
      kRateAttribute,
      kPresetAttribute};
}

void LaserScannerDesc::complete(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  pattern.degrees = {.min_azimuth_deg = a.number("min_angle"),
                     .max_azimuth_deg = a.number("max_angle"),
                     .min_elevation_deg = a.number("vertical_min_angle"),
                     .max_elevation_deg = a.number("vertical_max_angle")};
  if (const std::optional<ScannerPattern> read = scanner_pattern(context)) {
    table = read->table;
    table_beams = read->beams_of_scan;
    pattern = {.beams = read->shape.columns, .rings = read->shape.rows};
  }
  require_possible_size(a, pattern);
  require_layout(a, *this);
  // A tolerance without a method selects `hybrid`, which meets the tolerance and casts only where necessary.
  if (context.command.find("method") == nullptr && written_tolerance(context.command) != nullptr) {
    method = ScanMethod::hybrid;
  }
  if (max_error_m && !a.is_set("max_error_rel")) max_error_rel = std::numeric_limits<double>::infinity();
  where_max_error_m = a.where("max_error_m");
  where_max_error_rel = a.where("max_error_rel");
  effects = scan_effects({.attributes = a,
                          .rings = pattern.rings,
                          .beams = pattern.beams,
                          .range_max_m = range_max_m,
                          .seed = context.seed,
                          .sensor = context.name});

  if (const EffectType* const effect = beam_following_effect(*this)) {
    refuse_other_than_raycast(context.command, *effect);
  }
  refuse_ignored_tolerance(context.command, method);
  check_order(a, "min_angle", "max_angle", 360);
  check_order(a, "vertical_min_angle", "vertical_max_angle", 180);
  check_order(a, "range_min", "range_max", std::numeric_limits<double>::infinity());
}

}  // namespace simvis
