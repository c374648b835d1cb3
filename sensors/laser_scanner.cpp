#include "sensors/laser_scanner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

#include "engine/assert.h"
#include "scenegraph/pose.h"
#include "sensors/depth_range.h"

namespace simvis {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A tenth of a millimetre: what touches the scanner is still seen, and reversed depth loses nothing by it.
constexpr double kNear_m = 1e-4;

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
     .default_value = "planar",
     .text = "how depth becomes ranges",
     .choices = "nearest planar hybrid raycast"},
    {.name = "max_error_rel",
     .default_value = "1e-6",
     .text = "hybrid: beams whose error bound is above this share of their range are cast",
     .min = 0,
     .open_min = true},
    {.name = "resolution",
     .unit = "px",
     .text = "pixels of the virtual cameras across 90 degrees; 4096 for one ring, 1024 for more, if not given",
     .min = 8,
     .max = 16000},
    kRateAttribute,
};

constexpr std::string_view kMethods[] = {"nearest", "planar", "hybrid", "raycast"};  // as ScanMethod

ScanMethod method_named(std::string_view name) {
  return static_cast<ScanMethod>(std::ranges::find(kMethods, name) - std::begin(kMethods));
}

bool renders(const LaserScannerDesc& desc) {
  return desc.method != ScanMethod::raycast &&
         !(desc.method == ScanMethod::hybrid && desc.max_error_rel < least_planar_bound());
}

bool casts(ScanMethod method) { return method == ScanMethod::hybrid || method == ScanMethod::raycast; }

std::unique_ptr<Sensor> create(const SensorContext& context) {
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
  desc.max_error_rel = a.number("max_error_rel");
  if (a.is_set("resolution")) desc.resolution_px = a.number("resolution");

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

const SensorRegistration kRegistration({"laser_scanner",
                                        "A laser scanner: ranges along beams, each with an error bound.", kAttributes,
                                        create});

// Whether a rendered range will do for `hybrid`: its bound is small enough, and does not reach across a limit along the
// ray, where it would leave open of which kind the reading is.
bool is_certain(const RangeEstimate& estimate, const LaserScannerDesc& desc) {
  if (std::isinf(estimate.error_bound_m)) return false;
  const double low = estimate.range_m - estimate.error_bound_m, high = estimate.range_m + estimate.error_bound_m;
  return estimate.error_bound_m <= desc.max_error_rel * estimate.range_m &&
         !(low < desc.range_min_m && high >= desc.range_min_m) && !(low <= desc.range_max_m && high > desc.range_max_m);
}

double resolution_of(const LaserScannerDesc& desc) {
  if (desc.resolution_px > 0) return desc.resolution_px;
  return desc.pattern.rings == 1 ? kPlanarResolution : kRingsResolution;
}

}  // namespace

LaserScanner::LaserScanner(std::string name, const LaserScannerDesc& desc) : name_(std::move(name)), desc_(desc) {
  if (renders(desc)) layout_ = lay_out(desc.pattern, resolution_of(desc));
  scan_.rings = desc.pattern.rings;
  scan_.columns = desc.pattern.samples;
  scan_.azimuth_rad = azimuths(desc.pattern);
  scan_.elevation_rad = elevations(desc.pattern);
  if (!casts(desc.method)) return;
  for (const double e : scan_.elevation_rad) {
    for (const double a : scan_.azimuth_rad) {
      directions_.emplace_back(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
    }
  }
}

void LaserScanner::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  world_from_sensor_ = world_from_sensor;
  if (renders(desc_)) plan_views(rigid_inverse(world_from_sensor), list, plan);
  if (!casts(desc_.method)) return;
  std::ostringstream reason;
  reason << (renders(desc_) ? "beams" : "every beam") << " of laser scanner " << name_;
  if (desc_.method == ScanMethod::hybrid) {
    reason << (renders(desc_) ? " whose bound is above " : ": no rendered range has a bound below ")
           << (renders(desc_) ? desc_.max_error_rel : least_planar_bound()) << " of "
           << (renders(desc_) ? "their range" : "itself");
  }
  plan.casts.push_back({.name = name_, .reason = reason.str(), .most_rays = directions_.size()});
}

void LaserScanner::plan_views(const glm::dmat4& sensor_from_world, const DrawList& list, FramePlan& plan) {
  rounding_ = VertexRounding(list, sensor_from_world);
  places_.clear();
  for (std::size_t f = 0; f < layout_.faces.size(); ++f) {
    const ScanFace& face = layout_.faces[f];
    View view;
    view.name = name_ + "/face " + std::to_string(f);
    view.reason = std::to_string(face.beams) + " beams of laser scanner " + name_;
    view.pinhole = face.pinhole;
    view.near_m = kNear_m;
    view.view_from_world = glm::dmat4(face.face_from_sensor) * sensor_from_world;
    view.width_px = face.width_px;
    view.height_px = face.height_px;
    view.sees_back_faces = true;
    view.sees_lines_and_points = false;
    places_.push_back(place_in_depth_atlas(plan, name_, std::move(view)));
  }
}

void LaserScanner::collect(const FrameTime&, const FramePlan& plan, std::span<const PassResult> results) {
  const std::size_t beams = std::size_t{scan_.rings} * scan_.columns;
  scan_.range_m.resize(beams);
  scan_.error_bound_m.resize(beams);
  beams_.clear();
  if (!renders(desc_)) return;
  std::vector<FacePixels> pixels;
  for (std::size_t f = 0; f < layout_.faces.size(); ++f) {
    const Pass& pass = plan.passes[places_[f].pass];
    const std::size_t first = std::size_t{places_[f].y_px} * pass.width_px + places_[f].x_px;
    pixels.push_back({.depth = results[places_[f].pass].depth.data() + first,
                      .stride_px = pass.width_px,
                      .near_m = kNear_m,
                      .focal_px = layout_.faces[f].pinhole.fx_px,
                      .reach_x_px = static_cast<double>(pass.width_px),
                      .reach_y_px = static_cast<double>(std::max(pass.height_px, layout_.faces[f].width_px))});
  }
  for (std::size_t beam = 0; beam < layout_.taps.size(); ++beam) {
    const BeamTap& tap = layout_.taps[beam];
    RangeEstimate estimate = planar_range(pixels[tap.face], tap, layout_.planar, rounding_);
    if (desc_.method == ScanMethod::nearest) {
      estimate = nearest_range(pixels[tap.face], tap, layout_.faces[tap.face], estimate);
    }
    if (desc_.method == ScanMethod::hybrid && !is_certain(estimate, desc_)) {
      beams_.push_back(static_cast<std::uint32_t>(beam));
    } else {
      take(beam, estimate.range_m, estimate.error_bound_m);
    }
  }
}

void LaserScanner::cast(RayCaster& rays) {
  if (!casts(desc_.method)) return;
  const bool every = !renders(desc_);
  if (!every) {
    cast_directions_.clear();
    for (const std::uint32_t beam : beams_) cast_directions_.push_back(directions_[beam]);
  }
  const std::span<const glm::dvec3> directions = every ? directions_ : cast_directions_;
  hits_.resize(directions.size());
  rays.cast(world_from_sensor_, directions, hits_);
  for (std::size_t i = 0; i < hits_.size(); ++i) take(every ? i : beams_[i], hits_[i].range_m, hits_[i].error_bound_m);
}

// Applies the limits along the ray. Where the bound reaches across a limit, the reading may be of the other kind, and
// the bound says how far that would be.
void LaserScanner::take(std::size_t beam, double range_m, double error_bound_m) {
  const double low = range_m - error_bound_m, high = range_m + error_bound_m;
  float reading = range_m < desc_.range_min_m ? 0 : static_cast<float>(range_m);
  double bound = error_bound_m + std::abs(static_cast<double>(reading) - range_m);
  if (range_m > desc_.range_max_m) {
    reading = kInfinity;
    bound = low > desc_.range_max_m || error_bound_m == 0 ? 0 : kInfinity;
  } else if (high > desc_.range_max_m) {
    bound = kInfinity;
  } else if (range_m < desc_.range_min_m) {
    bound = high < desc_.range_min_m ? 0 : high;
  } else if (low < desc_.range_min_m) {
    bound = std::max(bound, static_cast<double>(reading));
  }
  scan_.range_m[beam] = reading;
  scan_.error_bound_m[beam] = bound == 0 ? 0.0f : std::nextafter(static_cast<float>(bound), kInfinity);
}

void LaserScanner::write(OutputSink& sink) const {
  static const std::vector<TableColumn> columns{
      {"ring", "%lld", true},    {"beam", "%lld", true}, {"azimuth_deg", "%.9g"},
      {"elevation_deg", "%.9g"}, {"range_m", "%.9g"},    {"error_bound_m", "%.9g"},
      {"x_m", "%.9g"},           {"y_m", "%.9g"},        {"z_m", "%.9g"}};
  constexpr double kDegrees = 180 / std::numbers::pi;
  std::vector<double> values;
  values.reserve(scan_.range_m.size() * columns.size());
  for (std::uint32_t ring = 0; ring < scan_.rings; ++ring) {
    const double e = scan_.elevation_rad[ring];
    for (std::uint32_t beam = 0; beam < scan_.columns; ++beam) {
      const double a = scan_.azimuth_rad[beam];
      const std::size_t index = std::size_t{ring} * scan_.columns + beam;
      if (index >= scan_.range_m.size()) return;
      const double range = scan_.range_m[index];
      const double r = std::isfinite(range) ? range : std::numeric_limits<double>::quiet_NaN();
      values.insert(values.end(), {static_cast<double>(ring), static_cast<double>(beam), a * kDegrees, e * kDegrees,
                                   range, static_cast<double>(scan_.error_bound_m[index]),
                                   r * std::cos(e) * std::cos(a), r * std::cos(e) * std::sin(a), r * std::sin(e)});
    }
  }
  sink.rows(columns, values);
}

std::string LaserScanner::method() const { return std::string(kMethods[static_cast<std::size_t>(desc_.method)]); }

std::optional<double> LaserScanner::cast_share() const {
  if (!casts(desc_.method)) return {};
  return static_cast<double>(hits_.size()) / static_cast<double>(directions_.size());
}

}  // namespace simvis
