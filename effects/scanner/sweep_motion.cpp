#include "effects/scanner/sweep_motion.h"

#include <algorithm>

#include "scenegraph/motion_path.h"

namespace simvis {
namespace {

// Errors in u = 2^-53 for each displacement of a path. Of a direction: product of two rotations (6), its quaternion
// (6), axis times angle (6 of an angle of at most pi: 19), the matrix of the turn (12), its products with the sensor's
// rotation (12), the rotated direction (8). Of an origin, as a share of the lengths that round: the difference of two
// positions (1), rotated (6), the logarithm (12), the error of its turn (31), the sum of three terms (12), the sensor's
// axes (6). The way and the turn of an extrapolated motion have their errors as often. A beam's own origin is rotated
// as a direction is, and added (1).
constexpr double kDirectionError = 63 * 0x1p-53, kOriginError = 68 * 0x1p-53, kSumError = 0x1p-53;

constexpr AttributeSpec kSweepMotionAttributes[] = {
    {.name = "sweep",
     .default_value = "0",
     .unit = "s",
     .text = "time from the first beam of a scan to the last; 0: all beams leave at once",
     .min = 0},
    {.name = "sweep_direction",
     .kind = AttributeKind::choice,
     .default_value = "ccw",
     .text = "ccw: from min_angle to max_angle; cw: the other way",
     .choices = "ccw cw"},
    {.name = "firing",
     .kind = AttributeKind::choice,
     .default_value = "together",
     .text = "pattern: beams leave at the times of the pattern, the last one at the time of the scan",
     .choices = "together pattern"},
};

const TableColumn kSweepMotionColumns[] = {
    {.name = "time_s", .format = "%.9f", .unit = "s", .meaning = "when the beam left"}};

std::unique_ptr<ScanEffect> create_sweep_motion(const ScanEffectContext& context) {
  const FiringTimes times(context.attributes);
  return times.together() ? nullptr : std::make_unique<SweepMotion>(times);
}

const ScanEffectRegistration kSweepMotionRegistration(
    {.type = {.name = "sweep_motion",
              .summary = "Each beam leaves at its own time, from where the sensor was then.",
              .notes =
                  "The last beam leaves at the time of the frame. The sensor and all objects move along "
                  "their joints since its previous measurement; at its first measurement they stand still. Ranges and "
                  "x, y, z are in the frame at the time of emission; the column time_s has the time of each beam.",
              .source = "attribute sweep above 0, or firing=\"pattern\"",
              .outputs = kShownInRanges,
              .reference = "closed form of a scanner that moves past a wall, towards it, and turns",
              .needs = kCastsBeams,
              .attributes = kSweepMotionAttributes},
     .order = ScanOrder::pose,
     .create = create_sweep_motion,
     .columns = kSweepMotionColumns});

}  // namespace

// Rays that leave together stand side by side: they have the same origin, which is faster to cast.
void SweepMotion::sort_by_age(const ScanContext& context, std::vector<BeamRay>& rays) const {
  if (times_.by_table) {
    std::ranges::stable_sort(rays, {}, [&](const BeamRay& ray) { return times_.age_s(context, ray.beam); });
  } else {
    std::ranges::stable_sort(rays, {}, [&](const BeamRay& ray) { return ray.beam % context.beams; });
  }
}

void SweepMotion::aim(const ScanContext& context, std::vector<BeamRay>& rays) const {
  if (!context.before || context.before->time_ns >= context.time.time_ns) return;
  const double interval_s = static_cast<double>(context.time.time_ns - context.before->time_ns) / 1e9;
  const glm::dmat4& now = context.world_from_sensor;
  const glm::dmat3 world_from_axes(now), axes_from_world = glm::transpose(world_from_axes);
  const MotionPath screw =
      context.path != nullptr ? MotionPath{} : path_between(context.before->world_from_sensor, now);
  const MotionPath& path = context.path != nullptr ? *context.path : screw;
  const double error_rad = kDirectionError * static_cast<double>(displacements(path));
  for (BeamRay& ray : rays) {
    ray.back = times_.age_s(context, ray.beam) / interval_s;
    Displacement then = displacement(path, -ray.back, glm::dvec3(now[3]));
    then = {axes_from_world * then.turn * world_from_axes, axes_from_world * then.way_m};
    const double parts = extrapolation(path, -ray.back);
    const glm::dvec3 start_m = ray.origin_m;
    ray.error_rad = error_rad * parts;
    ray.origin_m = then.way_m;
    ray.origin_error_m = kOriginError * parts * rounded_length_m(path, glm::dvec3(now[3]), parts);
    if (start_m != glm::dvec3(0)) {
      ray.origin_m += then.turn * start_m;
      ray.origin_error_m += ray.error_rad * glm::length(start_m) + kSumError * glm::length(ray.origin_m);
    }
    ray.direction = glm::normalize(then.turn * ray.direction);
  }
  sort_by_age(context, rays);
}

void SweepMotion::finish(const ScanContext& context, std::span<const Echo>, Scan& scan) const {
  std::vector<double> times_s;
  for (std::uint32_t beam = 0; beam < scan.range_m.size(); ++beam) {
    times_s.push_back(static_cast<double>(context.time.time_ns) / 1e9 - times_.age_s(context, beam));
  }
  scan.add_channel(kSweepMotionColumns[0], std::move(times_s));
}

}  // namespace simvis
