#include "tests/combinations/geometry_checks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <exception>
#include <numbers>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include <simvis/simulation.h>

namespace simvis::combined {
namespace {

constexpr Real kFloat = 0x1p-24L;  // half a unit in the last place of float32, relative
// Numbers in double that have no stated bound: a hundred roundings of ranges
// and poses.
constexpr Real kDoubles = 128 * 0x1p-53L;
constexpr Real kFlow_px = 1e-4L;  // documented
constexpr Real kInfinite = std::numeric_limits<Real>::infinity();
// A vertex moves by up to half a step of 1/256 pixel along each axis; the
// diagonal, and a tenth for roundings.
constexpr Real kSnapping_px = 0.5L / 256 * 1.41421356237309505L * 1.1L;

bool has_word(const std::string& words, const std::string& word) {
  return (" " + words + " ").find(" " + word + " ") != std::string::npos;
}

/// Which surfaces a sensor sees.
enum class Seen : std::uint8_t { half, any, opaque };

bool sees(double opacity, Seen seen) {
  return seen == Seen::any ? opacity > 0.5 / 255 : seen == Seen::half ? opacity >= 0.5 : opacity > 1 - 0.5 / 255;
}

/// The first surface along a ray beyond a range.
ExactHit first_of(const CombinedScene& scene, const std::vector<ExactHit>& hits, Seen seen, Real behind_m) {
  for (const ExactHit& hit : hits) {
    if (hit.range_m >= behind_m && sees(scene.bodies[static_cast<std::size_t>(hit.body)].opacity, seen)) return hit;
  }
  return {};
}

bool same_surface(const ExactHit& a, const ExactHit& b) { return a.body == b.body && a.face == b.face; }

/// The directions around one that are so far from it, as shares of a pixel or
/// radians: rings of 16.
template <class Ray>
std::vector<ExactHit> around(Real reach, const Ray& hit_at) {
  std::vector<ExactHit> all;
  for (const Real share : {Real(0.25), Real(0.5), Real(0.75), Real(1)}) {
    for (int i = 0; i < 16; ++i) {
      const Real angle = i * std::numbers::pi_v<Real> / 8;
      all.push_back(hit_at(share * reach * std::cos(angle), share * reach * std::sin(angle)));
    }
  }
  return all;
}

class Comparison {
 public:
  Comparison(const CombinedScene& scene, const Measured& measured, Tally& tally)
      : scene_(scene), measured_(measured), tally_(tally) {}

  std::vector<Failure> run() {
    for (frame_ = 0; frame_ < kFrames; ++frame_) {
      const ExactWorld world(scene_, frame_);
      world_ = &world;
      for (sensor_ = 0; sensor_ < scene_.sensors.size(); ++sensor_) {
        const Measurement& measurement = measured_.frames[frame_][sensor_];
        switch (scene_.sensors[sensor_].kind) {
          case SensorKind::scanner:
            scan(measurement);
            break;
          case SensorKind::camera:
            prefix_ = "";
            right_m_ = 0;
            camera(measurement);
            break;
          case SensorKind::stereo_camera:
            for (const bool right : {false, true}) {
              prefix_ = right ? "right_" : "left_";
              right_m_ = right ? scene_.sensors[sensor_].baseline_m : 0;
              camera(measurement);
            }
            break;
          case SensorKind::other:
            break;
          case SensorKind::range:
            single_beam(measurement);
            break;
        }
      }
    }
    return failures_;
  }

 private:
  void count(const std::string& check) { ++tally_.values[check]; }

  void fail(const std::string& check, const std::string& place, Real value, Real expected, Real allowed) {
    failures_.push_back({check, "frame " + std::to_string(frame_) + ", C" + std::to_string(sensor_) + ", " + check +
                                    ", " + place + ": " + text_of(value) + ", expected " + text_of(expected) +
                                    " within " + text_of(allowed)});
  }

  Real share_of_age(Real age_s) const { return frame_ == 0 ? Real(1) : 1 - age_s * Real(kRate_hz); }

  /// Ids are those of the item with the body's part.
  const SceneItem& item(int body) const {
    const std::string part = "S" + std::to_string(body);
    return *std::ranges::find(measured_.items, part, &SceneItem::part);
  }
  Real id(const std::string& kind, int body) const {
    if (body < 0) return 0;
    const SceneItem& found = item(body);
    return kind == "instance" ? found.instance : kind == "shape" ? found.shape : found.semantic;
  }

  /// A range, as a scanner reports it.
  static Real reading(const SensorDesc& sensor, Real range_m) {
    return range_m < Real(sensor.range_min_m) ? Real(0) : range_m > Real(sensor.range_max_m) ? kInfinite : range_m;
  }

  Real rounding_m(const ExactHit& hit) const {
    const Real range = std::isfinite(hit.range_m) ? hit.range_m : Real(0);
    return (world_->pose_rounding_m(sensor_) + kDoubles * range) / std::max(hit.cosine, Real(1e-9L));
  }

  void scan(const Measurement& measurement) {
    const SensorDesc& desc = scene_.sensors[sensor_];
    const Scan scan(measurement);
    for (std::size_t i = 0; i < scan.range_m.size(); ++i) {
      const std::size_t beam = i % scan.beams, ring = i / scan.beams;
      const Real degree = std::numbers::pi_v<Real> / 180;
      const Real azimuth = degree * Real(desc.half_width_deg) * (2 * Real(beam) / (desc.beams - 1) - 1),
                 elevation = desc.rings == 1
                                 ? Real(0)
                                 : degree * Real(desc.half_height_deg) * (2 * Real(ring) / (desc.rings - 1) - 1);
      const Real age_s = desc.sweep_s * (1 - Real(beam) / (desc.beams - 1));
      const auto hit_at = [&](Real share, Real da, Real de) {
        const Frame sensor = world_->sensor(sensor_, share);
        const Real a = azimuth + da, e = elevation + de;
        const Vector direction(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
        return first_of(scene_, world_->hits(sensor.at, sensor.turn * direction, share), Seen::half, 0);
      };
      const Real share = share_of_age(desc.sweep_s > 0 ? age_s : Real(0));
      const std::string place = "beam " + std::to_string(beam) + " of ring " + std::to_string(ring);
      range(place, scan.range_m[i], scan.error_bound_m[i], [&](Real da, Real de) { return hit_at(share, da, de); });
      if (desc.truth) beam_truth(measurement, i, place, [&](Real da, Real de) { return hit_at(1, da, de); });
    }
  }

  template <class HitAt>
  void range(const std::string& place, Real value, Real bound_m, const HitAt& hit_at) {
    const SensorDesc& desc = scene_.sensors[sensor_];
    const ExactHit hit = hit_at(0, 0);
    const std::string check = desc.method + " range";
    count(check);
    if (std::isinf(bound_m)) {
      ++tally_.unbounded;
      if (desc.method == "raycast" || desc.method == "hybrid") fail(check + " unbounded", place, value, hit.range_m, 0);
      return;
    }
    const auto agrees = [&](const ExactHit& each) {
      const Real expected = reading(desc, each.range_m), allowed = bound_m + rounding_m(each);
      if (value == expected || std::abs(value - expected) <= allowed) return true;
      // Beside a limit of the ranges either side is right.
      return reading(desc, each.range_m - allowed) == value || reading(desc, each.range_m + allowed) == value;
    };
    if (agrees(hit)) return;
    const bool cast = desc.method == "raycast" || desc.method == "hybrid";
    const Real range = std::isfinite(hit.range_m) ? hit.range_m : Real(1);
    const Real spread_rad = 8 * (world_->pose_rounding_m(sensor_) / range + kDoubles);
    const std::vector<ExactHit> beside = around(spread_rad, hit_at);
    if (std::ranges::any_of(beside, [&](const ExactHit& each) { return !same_surface(each, hit) && agrees(each); })) {
      ++tally_.at_edges;
      return;
    }
    if (!cast || desc.method == "hybrid") {
      // Rendered: three pixels of the method's coarsest view.
      const Real pixel_rad = 2 * std::numbers::pi_v<Real> / 2 / (desc.rings == 1 ? 4096 : 1024);
      const std::vector<ExactHit> wide = around(3 * pixel_rad, hit_at);
      if (std::ranges::any_of(wide, [&](const ExactHit& each) { return !same_surface(each, hit); })) {
        ++tally_.narrow;
        return;
      }
    }
    fail(check, place, value, reading(desc, hit.range_m), bound_m);
  }

  template <class HitAt>
  void beam_truth(const Measurement& measurement, std::size_t i, const std::string& place, const HitAt& hit_at) {
    const ExactHit hit = hit_at(0, 0);
    const auto number = [&](const char* name) { return static_cast<Real>(measurement.find(name)->number(i)); };
    std::vector<std::pair<std::string, std::string>> wrong;  // check, and the value with what was expected
    const auto agrees = [&](const ExactHit& each, bool report) {
      bool all = true;
      const auto value = [&](const char* name, Real expected, Real allowed) {
        const Real got = number(name);
        if (report) count(name);
        const bool right =
            std::isnan(expected) ? std::isnan(got) : got == expected || std::abs(got - expected) <= allowed;
        if (!right && report) wrong.emplace_back(name, text_of(got) + ", expected " + text_of(expected));
        all = all && right;
      };
      const bool nothing = each.body < 0;
      const Real rounding = rounding_m(each), none = std::numeric_limits<Real>::quiet_NaN();
      value("true_range_m", each.range_m, rounding);
      value("true_instance", nothing ? none : id("instance", each.body), 0);
      value("true_shape", nothing ? none : id("shape", each.body), 0);
      value("true_semantic", nothing ? none : id("semantic", each.body), 0);
      const Frame sensor = world_->sensor(sensor_, 1);
      const Vector normal = glm::transpose(sensor.turn) * each.normal;
      const Real bend = normal_rounding(each, rounding);
      const Vector velocity =
          nothing ? Vector(0)
                  : world_->way_per_frame(static_cast<std::size_t>(each.body), point(each)) * Real(kRate_hz);
      for (int k = 0; k < 3; ++k) {
        const std::string axis(1, "xyz"[k]);
        value(("true_normal_" + axis).c_str(), nothing ? none : normal[k], bend);
        // Positions of two frames, and the point at which the beam meets the
        // thing.
        const Real rounding_mps = (8 * world_->pose_rounding_m(sensor_) + 2 * rounding) * Real(kRate_hz);
        value(("true_velocity_" + axis + "_mps").c_str(), nothing ? none : velocity[k], rounding_mps);
      }
      return all;
    };
    if (agrees(hit, true)) return;
    const Real range = std::isfinite(hit.range_m) ? hit.range_m : Real(1);
    const Real spread_rad = 8 * (world_->pose_rounding_m(sensor_) / range + kDoubles);
    for (const ExactHit& each : around(spread_rad, hit_at)) {
      if (same_surface(each, hit) || !agrees(each, false)) continue;
      ++tally_.at_edges;
      return;
    }
    for (const auto& [check, text] : wrong) {
      failures_.push_back({check, "frame " + std::to_string(frame_) + ", C" + std::to_string(sensor_) + ", " + check +
                                      ", " + place + ": " + text});
    }
  }

  /// A normal is wrong by the way of the point over the radius of the surface,
  /// and by rounding.
  Real normal_rounding(const ExactHit& hit, Real point_m) const {
    if (hit.body < 0) return 0;
    const Body& body = scene_.bodies[static_cast<std::size_t>(hit.body)];
    const bool round = hit.face == 0 && body.kind != ShapeKind::box && body.kind != ShapeKind::plane &&
                       body.kind != ShapeKind::triangles;
    // Scales from 1/2 to 2 change the bend of a surface by up to their ratio to
    // the power of three; at a cone's tip the radius is that of the hit.
    const Real radius = body.kind == ShapeKind::cone ? std::hypot(hit.in_shape.x, hit.in_shape.y) : Real(body.radius_m);
    // Triangles: the cross product of sides loses what their slimness costs;
    // the mesh is rounded to float32.
    return 4 * kFloat + (round ? 64 * point_m / radius : Real(0)) +
           (body.kind == ShapeKind::triangles ? Real(1e-6L) : Real(0));
  }

  Vector point(const ExactHit& hit) const {
    const Frame body = world_->body(static_cast<std::size_t>(hit.body), 1);
    return body.turn * (hit.in_shape * Vector(scene_.bodies[static_cast<std::size_t>(hit.body)].scale)) + body.at;
  }

  void single_beam(const Measurement& measurement) {
    const SensorDesc& desc = scene_.sensors[sensor_];
    count("single beam");
    const Real value = *measurement.value("range_m");
    const Frame sensor = world_->sensor(sensor_, 1);
    const auto hit_at = [&](Real dy, Real dz) {
      return first_of(scene_, world_->hits(sensor.at, sensor.turn * glm::normalize(Vector(1, dy, dz)), 1), Seen::half,
                      0);
    };
    const auto agrees = [&](const ExactHit& each) {
      const Real expected = reading(desc, each.range_m), allowed = rounding_m(each);
      return value == expected || std::abs(value - expected) <= allowed ||
             reading(desc, each.range_m - allowed) == value || reading(desc, each.range_m + allowed) == value;
    };
    const ExactHit hit = hit_at(0, 0);
    if (agrees(hit)) return;
    const Real range = std::isfinite(hit.range_m) ? hit.range_m : Real(1);
    for (const ExactHit& each : around(8 * (world_->pose_rounding_m(sensor_) / range + kDoubles), hit_at)) {
      if (same_surface(each, hit) || !agrees(each)) continue;
      ++tally_.at_edges;
      return;
    }
    fail("single beam", "", value, reading(desc, hit.range_m), rounding_m(hit));
  }

  // Cameras.

  struct PixelRay {
    bool sees = false;  ///< false: beyond the lens
    Vector ray{0};      ///< optical frame
    ExactHit hit;
    std::vector<ExactHit> hits{};
  };

  static Vector sensor_of_optical(const Vector& v) { return {v.z, -v.x, -v.y}; }
  static Vector optical_of_sensor(const Vector& v) { return {-v.y, -v.z, v.x}; }

  Real share_of_row(int row) const {
    const SensorDesc& desc = scene_.sensors[sensor_];
    return share_of_age(desc.row_time_s * (desc.height_px - 1 - row));
  }

  /// The camera that the pixels are of: of two, the right one stands beside the
  /// sensor.
  Frame eye(Real share) const { return world_->sensor(sensor_, share) * Frame{Matrix(1), {0, -right_m_, 0}}; }

  PixelRay pixel(Real x_px, Real y_px, Real share) const {
    const SensorDesc& desc = scene_.sensors[sensor_];
    PixelRay result;
    const std::optional<Vector> ray = ray_of_pixel(desc, x_px, y_px);
    if (!ray) return result;
    result.sees = true;
    result.ray = *ray;
    const Frame sensor = eye(share);
    result.hits = world_->hits(sensor.at, sensor.turn * sensor_of_optical(*ray), share);
    std::erase_if(result.hits, [&](const ExactHit& hit) {
      return hit.from_behind && scene_.bodies[static_cast<std::size_t>(hit.body)].single_sided;
    });
    const Seen seen = desc.layer == "first" ? Seen::any : desc.layer == "visible" ? Seen::half : Seen::opaque;
    const Real behind_m = ray->z > 0 ? desc.near_m / ray->z : Real(desc.near_m);
    result.hit = first_of(scene_, result.hits, seen, behind_m);
    return result;
  }

  bool is_cast() const {
    const SensorDesc& desc = scene_.sensors[sensor_];
    return desc.lens != "none" || desc.layer != "visible" || has_word(desc.outputs, "normal") ||
           has_word(desc.outputs, "layers");
  }

  void camera(const Measurement& measurement) {
    const SensorDesc& desc = scene_.sensors[sensor_];
    largest_bound_m_ = measurement.value("depth_error_bound_m").value_or(kInfinite);
    for (int y = 0; y < desc.height_px; ++y) {
      for (int x = 0; x < desc.width_px; ++x) compare_pixel(measurement, x, y);
    }
  }

  /// What a pixel has, and the surfaces that it may show.
  struct PixelValues {
    const Measurement& measurement;
    const std::string& prefix;
    std::size_t at = 0;
    Real share = 1;
    int x = 0, y = 0;
    Real number(const std::string& name, std::size_t channel = 0, std::size_t channels = 1) const {
      return measurement.find(prefix + name)->number(at * channels + channel);
    }
  };

  void compare_pixel(const Measurement& measurement, int x, int y) {
    const SensorDesc& desc = scene_.sensors[sensor_];
    const PixelValues values{measurement,     prefix_, static_cast<std::size_t>(y * desc.width_px + x),
                             share_of_row(y), x,       y};
    const auto pixel_at = [&](Real dx, Real dy) {
      return pixel(Real(x) + Real(0.5) + dx, Real(y) + Real(0.5) + dy, values.share);
    };
    const PixelRay centre = pixel_at(0, 0);
    std::vector<Failure> wrong;
    if (pixel_agrees(values, centre, &wrong)) return;
    // Drawn edges are snapped to a grid; those of rays are decided but for
    // rounding.
    const Real range = std::isfinite(centre.hit.range_m) ? centre.hit.range_m : Real(1);
    const Real rounding_px = 8 * focal_px(desc) * (world_->pose_rounding_m(sensor_) / range + kDoubles);
    const Real reach_px = is_cast() ? rounding_px : kSnapping_px + rounding_px;
    std::vector<PixelRay> beside;
    around(reach_px, [&](Real dx, Real dy) {
      beside.push_back(pixel_at(dx, dy));
      return beside.back().hit;
    });
    for (const PixelRay& each : beside) {
      if (same_surface(each.hit, centre.hit)) continue;
      if (!agrees_beside(values, centre, each)) continue;
      ++tally_.at_edges;
      return;
    }
    if (!is_cast() && is_narrow(centre.hit, pixel_at)) {
      ++tally_.narrow;
      return;
    }
    failures_.insert(failures_.end(), wrong.begin(), wrong.end());
  }

  /// The bound of depth is stated for surfaces that are flat over three pixels
  /// in a row and in a column.
  template <class PixelAt>
  bool is_narrow(const ExactHit& hit, const PixelAt& pixel_at) const {
    if (hit.body < 0) return false;
    const ShapeKind kind = scene_.bodies[static_cast<std::size_t>(hit.body)].kind;
    if (kind != ShapeKind::box && kind != ShapeKind::plane && kind != ShapeKind::triangles) return false;
    for (const bool along_row : {true, false}) {
      bool flat = false;
      for (int first = -2; first <= 0 && !flat; ++first) {
        flat = true;
        for (int i = first; i <= first + 2; ++i) {
          flat = flat && same_surface(pixel_at(along_row ? i : 0, along_row ? 0 : i).hit, hit);
        }
      }
      if (!flat) return true;
    }
    return false;
  }

  /// Whether the pixel shows the surface beside its centre, drawn on over its
  /// edge.
  bool agrees_beside(const PixelValues& values, const PixelRay& centre, const PixelRay& beside) const {
    PixelRay extended = beside;
    extended.ray = centre.ray;
    return pixel_agrees(values, extended, nullptr, true);
  }

  // The largest difference of ranges over a snapped edge, which is no error of
  // the value.
  Real snapped_m(const PixelRay& pixel) const {
    const SensorDesc& desc = scene_.sensors[sensor_];
    const Real across = pixel.hit.range_m * kSnapping_px / focal_px(desc) * 2;
    return across / std::max(pixel.hit.cosine, Real(1e-6L)) * 2;
  }

  /// Compares all outputs of a pixel with one surface. `wrong` gets what
  /// differs.
  bool pixel_agrees(const PixelValues& values, const PixelRay& pixel, std::vector<Failure>* wrong,
                    bool beside = false) const {
    const SensorDesc& desc = scene_.sensors[sensor_];
    const ExactHit& hit = pixel.hit;
    const bool nothing = hit.body < 0;
    const Real none = std::numeric_limits<Real>::quiet_NaN();
    bool all = true;
    const auto value = [&](const std::string& check, Real got, Real expected, Real allowed) {
      if (wrong != nullptr) ++tally_.values[check];
      const bool right =
          std::isnan(expected) ? std::isnan(got) : got == expected || std::abs(got - expected) <= allowed;
      all = all && right;
      if (right || wrong == nullptr) return;
      wrong->push_back({check, "frame " + std::to_string(frame_) + ", C" + std::to_string(sensor_) + ", " + check +
                                   ", pixel " + std::to_string(values.x) + " " + std::to_string(values.y) + ": " +
                                   text_of(got) + ", expected " + text_of(expected) + " within " + text_of(allowed)});
    };
    const Real depth = nothing ? kInfinite : hit.range_m * pixel.ray.z;
    const Real rounding = nothing ? Real(0) : rounding_m(hit) + (beside && !is_cast() ? snapped_m(pixel) : Real(0));
    Real bound = is_cast() && !nothing ? rounding + kFloat * depth : largest_bound_m_;
    if (has_word(desc.outputs, "depth_error_bound")) {
      const Real stated = values.number("depth_error_bound");
      if (is_cast() && !nothing) value("depth bound of rays", std::isinf(stated), 0, 0);
      value("bound below the largest", stated * (1 - 4 * kFloat) > largest_bound_m_ && std::isfinite(stated), 0, 0);
      bound = stated;
    }
    if (std::isinf(bound) && wrong != nullptr && !nothing) ++tally_.unbounded;
    if (nothing) bound = 0;
    if (has_word(desc.outputs, "depth")) {
      value(is_cast() ? "cast depth" : "drawn depth", values.number("depth"), depth, bound + rounding);
    }
    for (const char* const kind : {"instance", "shape", "semantic"}) {
      if (has_word(desc.outputs, kind)) value(kind, values.number(kind), id(kind, hit.body), 0);
    }
    const Real along = nothing ? Real(0) : bound / std::abs(pixel.ray.z) + rounding;  // of the range
    if (has_word(desc.outputs, "range")) {
      value("range of pixels", values.number("range"), hit.range_m,
            along + 3 * kFloat * (nothing ? Real(0) : hit.range_m));
    }
    const Frame sensor = eye(values.share);
    if (has_word(desc.outputs, "disparity") && right_m_ == 0) {
      const Real at_one_m = focal_px(desc) * Real(desc.baseline_m), expected = nothing ? Real(0) : at_one_m / depth;
      const Real allowed =
          nothing ? Real(0)
                  : at_one_m / std::max(depth - bound - rounding, depth / 1000) - expected + 4 * kFloat * expected;
      value("disparity", static_cast<Real>(values.measurement.find("disparity")->number(values.at)), expected, allowed);
    }
    if (has_word(desc.outputs, "normal")) {
      const Vector normal = optical_of_sensor(glm::transpose(sensor.turn) * hit.normal);
      for (int k = 0; k < 3; ++k) {
        value("normal", values.number("normal", static_cast<std::size_t>(k), 3), nothing ? none : normal[k],
              normal_rounding(hit, rounding));
      }
    }
    if (has_word(desc.outputs, "object_coordinates")) coordinates(values, hit, along, value);
    if (has_word(desc.outputs, "layers") && !beside) layers(values, pixel, value);
    if (frame_ > 0 && desc.row_time_s == 0 && !nothing) flow(values, pixel, along, value);
    return all;
  }

  template <class Value>
  void coordinates(const PixelValues& values, const ExactHit& hit, Real along, const Value& value) const {
    const bool nothing = hit.body < 0;
    // A scale of 1/2 doubles what is wrong. The mesh of a box is brought to its
    // size in double.
    const Real size = nothing ? Real(0) : glm::length(hit.in_shape);
    for (int k = 0; k < 3; ++k) {
      value("object coordinates", values.number("object_coordinates", static_cast<std::size_t>(k), 3),
            nothing ? std::numeric_limits<Real>::quiet_NaN() : hit.in_shape[k],
            2 * along + 4 * kFloat * (size + along));
    }
  }

  template <class Value>
  void layers(const PixelValues& values, const PixelRay& pixel, const Value& value) const {
    const SensorDesc& desc = scene_.sensors[sensor_];
    constexpr std::size_t kLayers = 4;
    std::size_t layer = 0;
    Real transmission = 1, before_m = -1;
    for (const ExactHit& hit : pixel.hits) {
      if (layer == kLayers || transmission == 0) break;
      if (hit.range_m * pixel.ray.z < Real(desc.near_m)) continue;
      if (hit.range_m - before_m <= rounding_m(hit)) continue;  // two surfaces at one range count once
      before_m = hit.range_m;
      value("range of layers", values.number("layer_range", layer, kLayers), hit.range_m,
            rounding_m(hit) + kFloat * hit.range_m);
      value("instance of layers", values.number("layer_instance", layer, kLayers), id("instance", hit.body), 0);
      value("transmission of layers", values.number("layer_transmission", layer, kLayers), transmission, 8 * kFloat);
      transmission *= 1 - Real(scene_.bodies[static_cast<std::size_t>(hit.body)].opacity);
      ++layer;
    }
    for (; layer < kLayers; ++layer) {
      value("range of layers", values.number("layer_range", layer, kLayers), kInfinite, 0);
      value("instance of layers", values.number("layer_instance", layer, kLayers), 0, 0);
    }
  }

  template <class Value>
  void flow(const PixelValues& values, const PixelRay& pixel, Real along, const Value& value) const {
    const SensorDesc& desc = scene_.sensors[sensor_];
    const auto body = static_cast<std::size_t>(pixel.hit.body);
    const Frame sensor = eye(1), before = eye(0);
    const Frame matter_before = world_->body(body, 0) * inverse(world_->body(body, 1));
    const auto way_of = [&](Real range_m) {
      const Vector now = sensor.turn * sensor_of_optical(range_m * pixel.ray) + sensor.at;
      return std::pair(now, matter_before.turn * now + matter_before.at);
    };
    const auto [now, then] = way_of(pixel.hit.range_m);
    // How much a wrong range changes the result.
    const auto [now_off, then_off] = way_of(pixel.hit.range_m + std::min(along, pixel.hit.range_m));
    if (has_word(desc.outputs, "scene_flow")) {
      const Matrix optical = glm::transpose(sensor.turn);
      const Vector way = optical_of_sensor(optical * (now - then)),
                   off = optical_of_sensor(optical * (now_off - then_off)) - way;
      for (int k = 0; k < 3; ++k) {
        value("scene flow", values.number("scene_flow", static_cast<std::size_t>(k), 3), way[k],
              2 * std::abs(off[k]) + kFloat * std::abs(way[k]) + 8 * world_->pose_rounding_m(sensor_));
      }
    }
    if (!has_word(desc.outputs, "flow_backward")) return;
    const auto place_of = [&](const Vector& point) {
      return pixel_of_ray(desc, optical_of_sensor(glm::transpose(before.turn) * (point - before.at)));
    };
    const auto place = place_of(then), place_off = place_of(then_off);
    // Behind the camera, and where a lens ends, there is no place, or one that
    // its model does not define.
    const Vector view = optical_of_sensor(glm::transpose(before.turn) * (then - before.at));
    if (!place || !place_off || view.z < Real(0.2L) * glm::length(view)) return;
    for (int k = 0; k < 2; ++k) {
      const Real centre = (k == 0 ? values.x : values.y) + Real(0.5);
      value("flow", values.number("flow_backward", static_cast<std::size_t>(k), 2), (*place)[k] - centre,
            kFlow_px + 2 * std::abs((*place_off)[k] - (*place)[k]) + kFloat * std::abs((*place)[k] - centre));
    }
  }

  const CombinedScene& scene_;
  const Measured& measured_;
  Tally& tally_;
  const ExactWorld* world_ = nullptr;
  std::size_t frame_ = 0, sensor_ = 0;
  std::string prefix_;                // of the outputs of a view
  Real right_m_ = 0;                  // of the view from the sensor
  Real largest_bound_m_ = kInfinite;  // of the depths of the image
  std::vector<Failure> failures_;
};

}  // namespace

std::string text_of(Real value) {
  std::ostringstream text;
  text.precision(12);
  text << value;
  return text.str();
}

std::vector<Failure> compare_with_geometry(const CombinedScene& scene, const Measured& measured, Tally& tally) {
  return Comparison(scene, measured, tally).run();
}

}  // namespace simvis::combined
