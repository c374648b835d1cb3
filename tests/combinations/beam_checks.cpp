// Ranges of scanners and single beams, with what scanners say of the surfaces that they hit.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <simvis/scan.h>
#include "tests/combinations/comparison.h"

namespace simvis::combined {
namespace {

class BeamComparison {
 public:
  explicit BeamComparison(const Comparison& comparison)
      : with_(comparison), scene_(comparison.scene), desc_(comparison.desc()), world_(comparison.world) {}

  void scan() {
    const Scan scan(with_.measurement());
    for (std::size_t i = 0; i < scan.range_m.size(); ++i) {
      const std::size_t beam = i % scan.beams, ring = i / scan.beams;
      const Real degree = std::numbers::pi_v<Real> / 180;
      const Real azimuth = degree * Real(desc_.half_width_deg) * (2 * Real(beam) / (desc_.beams - 1) - 1),
                 elevation = desc_.rings == 1
                                 ? Real(0)
                                 : degree * Real(desc_.half_height_deg) * (2 * Real(ring) / (desc_.rings - 1) - 1);
      const Real age_s = desc_.sweep_s * (1 - Real(beam) / (desc_.beams - 1));
      const auto hit_at = [&](Real share, Real da, Real de) {
        const Frame sensor = world_.sensor(with_.sensor, share);
        const Real a = azimuth + da, e = elevation + de;
        const Vector direction(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
        return first_along(sensor.at, sensor.turn * direction, share);
      };
      const Real share = with_.share_of_age(desc_.sweep_s > 0 ? age_s : Real(0));
      const std::string place = "beam " + std::to_string(beam) + " of ring " + std::to_string(ring);
      range(place, scan.range_m[i], scan.error_bound_m[i], [&](Real da, Real de) { return hit_at(share, da, de); });
      if (desc_.truth) beam_truth(i, place, [&](Real da, Real de) { return hit_at(1, da, de); });
    }
  }

  void single_beam() {
    with_.count("single beam");
    const Real value = *with_.measurement().value("range_m");
    const Frame sensor = world_.sensor(with_.sensor, 1);
    const auto hit_at = [&](Real dy, Real dz) {
      return first_along(sensor.at, sensor.turn * glm::normalize(Vector(1, dy, dz)), 1);
    };
    const ExactHit hit = hit_at(0, 0);
    if (agrees(value, 0, hit) || is_doubtful_ ||
        has_neighbour(hit, hit_at, [&](const ExactHit& each) { return agrees(value, 0, each); }))
      return;
    with_.fail("single beam", "", value, reading(hit.range_m), with_.rounding_m(hit));
  }

 private:
  /// The surface or splat that a ray hits; splats stand where they are at the frame's time. Sets is_doubtful_.
  ExactHit first_along(const Vector& origin, const Vector& direction, Real share) const {
    const ExactHit surface = first_of(scene_, world_.hits(origin, direction, share), Seen::half, 0);
    const HalfOfSplats half = half_of(world_.splats(origin, direction, 1), 0, surface.range_m);
    is_doubtful_ = half.is_doubtful;
    return half.hit.body >= 0 ? half.hit : surface;
  }

  bool is_splat(const ExactHit& hit) const { return hit.body >= 0 && with_.body(hit).kind == ShapeKind::splats; }

  /// A range, as a scanner reports it.
  Real reading(Real range_m) const {
    return range_m < Real(desc_.range_min_m) ? Real(0) : range_m > Real(desc_.range_max_m) ? kInfinite : range_m;
  }

  bool agrees(Real value, Real bound_m, const ExactHit& hit) const {
    const Real expected = reading(hit.range_m), allowed = bound_m + with_.rounding_m(hit);
    if (value == expected || std::abs(value - expected) <= allowed) return true;
    // Beside a limit of the ranges either side is right.
    return reading(hit.range_m - allowed) == value || reading(hit.range_m + allowed) == value;
  }

  /// Whether another surface, which lies within the rounding of the direction, agrees.
  template <class HitAt, class Agrees>
  bool has_neighbour(const ExactHit& hit, const HitAt& hit_at, const Agrees& agrees) const {
    const Real range = std::isfinite(hit.range_m) ? hit.range_m : Real(1);
    bool found = false;
    around(8 * (world_.pose_rounding_m(with_.sensor) / range + kDoubles), [&](Real dx, Real dy) {
      if (found) return;
      const ExactHit each = hit_at(dx, dy);
      found = !same_surface(each, hit) && agrees(each);
    });
    with_.tally.at_edges += found ? 1 : 0;
    return found;
  }

  template <class HitAt>
  void range(const std::string& place, Real value, Real bound_m, const HitAt& hit_at) {
    const ExactHit hit = hit_at(0, 0);
    const std::string check = is_splat(hit) ? "range of splats" : desc_.method + " range";
    const bool cast = desc_.method == "raycast" || desc_.method == "hybrid", is_doubtful = is_doubtful_;
    with_.count(check);
    if (std::isinf(bound_m)) {
      ++with_.tally.unbounded;
      if (cast) with_.fail(check + " unbounded", place, value, hit.range_m, 0);
      return;
    }
    if (agrees(value, bound_m, hit) || is_doubtful) return;
    if (has_neighbour(hit, hit_at, [&](const ExactHit& each) { return agrees(value, bound_m, each); })) return;
    if (desc_.method != "raycast") {
      // Rendered: three pixels of the method's coarsest view.
      const Real pixel_rad = 2 * std::numbers::pi_v<Real> / 2 / (desc_.rings == 1 ? 4096 : 1024);
      bool is_narrow = false;
      around(3 * pixel_rad, [&](Real da, Real de) { is_narrow = is_narrow || !same_surface(hit_at(da, de), hit); });
      if (is_narrow) {
        ++with_.tally.narrow;
        return;
      }
    }
    with_.fail(check, place, value, reading(hit.range_m), bound_m);
  }

  template <class HitAt>
  void beam_truth(std::size_t i, const std::string& place, const HitAt& hit_at) {
    const ExactHit hit = hit_at(0, 0);
    if (is_doubtful_) return;
    std::vector<Failure> wrong;
    if (truth_agrees(i, place, hit, &wrong)) return;
    if (has_neighbour(hit, hit_at, [&](const ExactHit& each) { return truth_agrees(i, place, each, nullptr); })) return;
    with_.failures.insert(with_.failures.end(), wrong.begin(), wrong.end());
  }

  /// `wrong` gets what differs, and each value is counted.
  bool truth_agrees(std::size_t i, const std::string& place, const ExactHit& hit, std::vector<Failure>* wrong) const {
    bool all = true;
    const auto value = [&](const std::string& name, Real expected, Real allowed) {
      const Real got = with_.measurement().find(name)->number(i);
      if (wrong != nullptr) with_.count(name);
      const bool right =
          std::isnan(expected) ? std::isnan(got) : got == expected || std::abs(got - expected) <= allowed;
      if (!right && wrong != nullptr) {
        wrong->push_back(with_.failure(name, place, text_of(got) + ", expected " + text_of(expected)));
      }
      all = all && right;
    };
    const bool nothing = hit.body < 0;
    const Real rounding = with_.rounding_m(hit);
    value("true_range_m", hit.range_m, rounding);
    for (const char* const kind : {"instance", "shape", "semantic"}) {
      if (is_splat(hit) && kind == std::string("shape")) continue;
      value(std::string("true_") + kind, nothing ? kNone : with_.id(kind, hit.body), 0);
    }
    const Frame sensor = world_.sensor(with_.sensor, 1);
    if (is_splat(hit)) {
      for (const char* const axis : {"x", "y", "z"}) value(std::string("true_normal_") + axis, kNone, 0);
      return all;
    }
    const Vector normal = glm::transpose(sensor.turn) * hit.normal;
    const Real bend = with_.normal_rounding(hit, rounding);
    const Vector velocity =
        nothing ? Vector(0) : world_.way_per_frame(static_cast<std::size_t>(hit.body), point(hit)) * Real(kRate_hz);
    for (int k = 0; k < 3; ++k) {
      const std::string axis(1, "xyz"[k]);
      value("true_normal_" + axis, nothing ? kNone : normal[k], bend);
      // Positions of two frames, and the point at which the beam meets the
      // thing.
      const Real rounding_mps = (8 * world_.pose_rounding_m(with_.sensor) + 2 * rounding) * Real(kRate_hz);
      value("true_velocity_" + axis + "_mps", nothing ? kNone : velocity[k], rounding_mps);
    }
    return all;
  }

  Vector point(const ExactHit& hit) const {
    const Frame body = world_.body(static_cast<std::size_t>(hit.body), 1);
    return body.turn * (hit.in_shape * Vector(with_.body(hit).scale)) + body.at;
  }

  const Comparison& with_;
  const CombinedScene& scene_;
  const SensorDesc& desc_;
  const ExactWorld& world_;
  mutable bool is_doubtful_ = false;  // rounding decides what the last ray of first_along() has hit
};

}  // namespace

void compare_beams(const Comparison& comparison) {
  BeamComparison beams(comparison);
  if (comparison.desc().kind == SensorKind::range) return beams.single_beam();
  beams.scan();
}

}  // namespace simvis::combined
