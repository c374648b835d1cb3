#include "tests/combinations/comparison.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <simvis/simulation.h>

namespace simvis::combined {
namespace {

bool sees(double opacity, Seen seen) {
  return seen == Seen::any ? opacity > 0.5 / 255 : seen == Seen::half ? opacity >= 0.5 : opacity > 1 - 0.5 / 255;
}

bool is_round(const Body& body, int face) {
  if (body.kind == ShapeKind::balls) return true;
  return face == 0 && (body.kind == ShapeKind::sphere || body.kind == ShapeKind::cylinder ||
                       body.kind == ShapeKind::cone || body.kind == ShapeKind::capsule);
}

bool has_triangles(const Body& body) { return body.kind == ShapeKind::triangles || body.kind == ShapeKind::heights; }

}  // namespace

ExactHit first_of(const CombinedScene& scene, const std::vector<ExactHit>& hits, Seen seen, Real behind_m) {
  for (const ExactHit& hit : hits) {
    if (hit.range_m >= behind_m && sees(scene.bodies[static_cast<std::size_t>(hit.body)].opacity, seen)) return hit;
  }
  return {};
}

HalfOfSplats half_of(const std::vector<SplatHit>& splats, Real near_m, Real end_m) {
  constexpr Real kBehind = 1e-4L;  // drawn depths are wrong by their roundings, which slant magnifies
  HalfOfSplats half;
  Real left = 1, last_m = 0;
  for (const auto& [hit, alpha] : splats) {
    const Real close = kBehind * hit.range_m;
    if (hit.range_m <= near_m - close || hit.range_m >= end_m + close) continue;
    const bool was_light = left > Real(0.5);
    left *= 1 - alpha;
    const bool is_half = was_light && left <= Real(0.5);
    const bool at_limit = std::abs(hit.range_m - near_m) < close || std::abs(hit.range_m - end_m) < close;
    const bool at_threshold = std::abs(alpha * 255 - 1) < kSplatShare || std::abs(left - Real(0.5)) < kSplatShare;
    // Splats at nearly one range may follow each other the other way round.
    const bool at_half =
        (is_half && hit.range_m - last_m < close) || (!was_light && hit.range_m - half.hit.range_m < close);
    half.is_doubtful = half.is_doubtful || at_limit || at_threshold || at_half;
    if (is_half) half.hit = hit;
    last_m = hit.range_m;
  }
  return half;
}

Failure Comparison::failure(const std::string& check, const std::string& place, const std::string& text) const {
  return {check, "frame " + std::to_string(frame) + ", C" + std::to_string(sensor) + ", " + check + ", " + place +
                     ": " + text};
}

void Comparison::fail(const std::string& check, const std::string& place, Real value, Real expected,
                      Real allowed) const {
  failures.push_back(
      failure(check, place, text_of(value) + ", expected " + text_of(expected) + " within " + text_of(allowed)));
}

Real Comparison::id(const std::string& kind, int body) const {
  if (body < 0) return 0;
  const std::string part = "S" + std::to_string(body);
  const SceneItem& found = *std::ranges::find(measured.items, part, &SceneItem::part);
  return kind == "instance" ? found.instance : kind == "shape" ? found.shape : found.semantic;
}

Real Comparison::rounding_m(const ExactHit& hit) const {
  const Real range = std::isfinite(hit.range_m) ? hit.range_m : Real(0);
  return hit.rounding_m + (world.pose_rounding_m(sensor) + kDoubles * range) / std::max(hit.cosine, Real(1e-9L));
}

Real Comparison::normal_rounding(const ExactHit& hit, Real point_m) const {
  if (hit.body < 0) return 0;
  const Body& shape = body(hit);
  // Scales from 1/2 to 2 change the bend of a surface by up to their ratio to
  // the power of three; at a cone's tip the radius is that of the hit.
  const Real radius = shape.kind == ShapeKind::cone ? std::hypot(hit.in_shape.x, hit.in_shape.y) : Real(shape.radius_m);
  // Triangles: the cross product of sides loses what their slimness costs;
  // the mesh is rounded to float32.
  return 4 * kFloat + (is_round(shape, hit.face) ? 64 * point_m / radius : Real(0)) +
         (has_triangles(shape) ? Real(1e-6L) : Real(0));
}

std::string text_of(Real value) {
  std::ostringstream text;
  text.precision(12);
  text << value;
  return text.str();
}

std::vector<Failure> compare_with_geometry(const CombinedScene& scene, const Measured& measured, Tally& tally) {
  std::vector<Failure> failures;
  for (std::size_t frame = 0; frame < kFrames; ++frame) {
    const ExactWorld world(scene, frame);
    for (std::size_t sensor = 0; sensor < scene.sensors.size(); ++sensor) {
      const Comparison comparison{scene, measured, world, frame, sensor, tally, failures};
      switch (scene.sensors[sensor].kind) {
        case SensorKind::scanner:
        case SensorKind::range:
          compare_beams(comparison);
          break;
        case SensorKind::camera:
        case SensorKind::stereo_camera:
          compare_pixels(comparison);
          break;
        case SensorKind::keypoints:
          compare_keypoints(comparison);
          break;
        case SensorKind::imu:
        case SensorKind::odometry:
          compare_motion(comparison);
          break;
        case SensorKind::other:
          break;
      }
    }
  }
  return failures;
}

}  // namespace simvis::combined
