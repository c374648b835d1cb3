// All outputs of the pixels of cameras.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/combinations/pixel_rays.h"

namespace simvis::combined {
namespace {

constexpr Real kFlow_px = 1e-4L;  // documented

/// What a pixel has. Flow towards a frame belongs to the pixels of the frame before.
struct PixelValues {
  const Measurement& measurement;
  const std::string& prefix;
  int x = 0, y = 0;
  std::size_t at = 0;
  Real share = 1;

  Real number(const std::string& name, std::size_t channel = 0, std::size_t channels = 1) const {
    return measurement.find(prefix + name)->number(at * channels + channel);
  }
};

class PixelComparison {
 public:
  PixelComparison(const Comparison& comparison, std::string prefix, Real right_m)
      : with_(comparison),
        desc_(comparison.desc()),
        prefix_(std::move(prefix)),
        rays_(comparison, right_m),
        largest_bound_m_(comparison.measurement().value("depth_error_bound_m").value_or(kInfinite)) {}

  void run() {
    const bool has_forward = has_word(desc_.outputs, "flow_forward") && desc_.row_time_s == 0;
    for (int y = 0; y < desc_.height_px; ++y) {
      for (int x = 0; x < desc_.width_px; ++x) {
        PixelValues values{with_.measurement(),  prefix_, x, y, static_cast<std::size_t>(y * desc_.width_px + x),
                           rays_.share_of_row(y)};
        compare(values, [&](const PixelRay& pixel, Report* report, bool beside) {
          return pixel_agrees(values, pixel, report, beside);
        });
        if (!has_forward) continue;
        values.share = with_.frame == 0 ? 1 : 0;
        compare(values,
                [&](const PixelRay& pixel, Report* report, bool) { return forward_agrees(values, pixel, report); });
      }
    }
    if (has_word(desc_.outputs, "boxes")) compare_boxes(rays_);
  }

 private:
  using Report = std::vector<Failure>;

  /// Compares values with a surface, and reports what differs if there is a report.
  class Check {
   public:
    Check(const Comparison& with, const PixelValues& values, Report* report)
        : with_(with), values_(values), report_(report) {}

    void operator()(const std::string& check, Real got, Real expected, Real allowed) {
      if (report_ != nullptr) with_.count(check);
      const bool right =
          std::isnan(expected) ? std::isnan(got) : got == expected || std::abs(got - expected) <= allowed;
      all_ = all_ && right;
      if (right || report_ == nullptr) return;
      const std::string place = "pixel " + std::to_string(values_.x) + " " + std::to_string(values_.y);
      report_->push_back(with_.failure(
          check, place, text_of(got) + ", expected " + text_of(expected) + " within " + text_of(allowed)));
    }
    bool all() const { return all_; }

   private:
    const Comparison& with_;
    const PixelValues& values_;
    Report* report_;
    bool all_ = true;
  };

  /// `agrees` compares the values with what the ray hits. Beside an edge the pixel may show the surface beyond it.
  template <class Agrees>
  void compare(const PixelValues& values, const Agrees& agrees) {
    const auto pixel_at = [&](Real dx, Real dy) {
      return rays_.pixel(Real(values.x) + Real(0.5) + dx, Real(values.y) + Real(0.5) + dy, values.share);
    };
    const PixelRay centre = pixel_at(0, 0);
    if (centre.is_doubtful) {
      ++with_.tally.at_edges;
      return;
    }
    Report report;
    if (agrees(centre, &report, false)) return;
    bool found = false;
    around(rays_.reach_px(centre.hit.range_m), [&](Real dx, Real dy) {
      if (found) return;
      PixelRay beside = pixel_at(dx, dy);
      if (same_surface(beside.hit, centre.hit) && same_surface(beside.surface, centre.surface)) return;
      beside.ray = centre.ray;  // drawn on over its edge
      found = agrees(beside, nullptr, true);
    });
    if (found) {
      ++with_.tally.at_edges;
    } else if (!rays_.is_cast() && is_narrow(centre.hit, pixel_at)) {
      ++with_.tally.narrow;
    } else {
      with_.failures.insert(with_.failures.end(), report.begin(), report.end());
    }
  }

  /// The bound of depth is stated for surfaces that are flat over three pixels
  /// in a row and in a column.
  template <class PixelAt>
  bool is_narrow(const ExactHit& hit, const PixelAt& pixel_at) const {
    if (hit.body < 0) return false;
    const ShapeKind kind = with_.body(hit).kind;
    if (kind != ShapeKind::box && kind != ShapeKind::plane && kind != ShapeKind::triangles &&
        kind != ShapeKind::heights) {
      return false;
    }
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

  // The largest difference of ranges over a snapped edge, which is no error of
  // the value.
  Real snapped_m(const PixelRay& pixel) const {
    const Real across = pixel.hit.range_m * kSnapping_px / focal_px(desc_) * 2;
    return across / std::max(pixel.hit.cosine, Real(1e-6L)) * 2;
  }

  bool pixel_agrees(const PixelValues& values, const PixelRay& pixel, Report* report, bool beside) const {
    const ExactHit& hit = pixel.hit;
    const bool nothing = hit.body < 0, is_splat = !nothing && with_.body(hit).kind == ShapeKind::splats;
    Check value(with_, values, report);
    const Real depth = nothing ? kInfinite : hit.range_m * pixel.ray.z;
    const Real rounding =
        nothing ? Real(0) : with_.rounding_m(hit) + (beside && !rays_.is_cast() ? snapped_m(pixel) : Real(0));
    const bool is_exact = !nothing && (rays_.is_cast() || is_splat);
    Real bound = is_exact ? rounding + kFloat * std::abs(depth) : largest_bound_m_;
    if (has_word(desc_.outputs, "depth_error_bound")) {
      const Real stated = values.number("depth_error_bound");
      if (is_exact) value("depth bound of rays", std::isinf(stated), is_splat ? 1 : 0, 0);
      value("bound below the largest", stated * (1 - 4 * kFloat) > largest_bound_m_ && std::isfinite(stated), 0, 0);
      if (!is_splat) bound = stated;
    }
    if (std::isinf(bound) && report != nullptr && !nothing) ++with_.tally.unbounded;
    if (nothing) bound = 0;
    if (has_word(desc_.outputs, "depth")) {
      value(is_splat          ? "depth of splats"
            : rays_.is_cast() ? "cast depth"
                              : "drawn depth",
            values.number("depth"), depth, bound + rounding);
    }
    for (const char* const kind : {"instance", "semantic"}) {
      if (has_word(desc_.outputs, kind)) value(kind, values.number(kind), with_.id(kind, hit.body), 0);
    }
    if (has_word(desc_.outputs, "shape") && !is_splat) {
      value("shape", values.number("shape"), with_.id("shape", hit.body), 0);
    }
    const Real along = nothing ? Real(0) : bound / std::abs(pixel.ray.z) + rounding;  // of the range
    if (has_word(desc_.outputs, "range")) {
      value("range of pixels", values.number("range"), hit.range_m,
            along + 3 * kFloat * (nothing ? Real(0) : hit.range_m));
    }
    if (has_word(desc_.outputs, "disparity") && rays_.is_left()) {
      // A surface beside or behind the camera is in no rectified image.
      const bool is_rectified = !nothing && depth > 0;
      const Real at_one_m = focal_px(desc_) * Real(desc_.baseline_m),
                 expected = is_rectified ? at_one_m / depth : Real(0);
      const Real allowed =
          is_rectified ? at_one_m / std::max(depth - bound - rounding, depth / 1000) - expected + 4 * kFloat * expected
                       : Real(0);
      value("disparity", static_cast<Real>(values.measurement.find("disparity")->number(values.at)), expected, allowed);
    }
    const bool has_surface = !nothing && !is_splat;
    if (has_word(desc_.outputs, "normal")) {
      const Vector normal = ViewRays::optical_of_sensor(glm::transpose(rays_.eye(values.share).turn) * hit.normal);
      for (int k = 0; k < 3; ++k) {
        value("normal", values.number("normal", static_cast<std::size_t>(k), 3), has_surface ? normal[k] : kNone,
              with_.normal_rounding(hit, rounding));
      }
    }
    if (has_word(desc_.outputs, "object_coordinates")) coordinates(values, hit, has_surface, along, value);
    if (has_word(desc_.outputs, "layers") && !beside) layers(values, pixel, value);
    if (with_.frame > 0 && desc_.row_time_s == 0) backward(values, pixel, is_splat ? Real(0) : along, value);
    return value.all();
  }

  void coordinates(const PixelValues& values, const ExactHit& hit, bool has_surface, Real along, Check& value) const {
    const Real size = has_surface ? glm::length(hit.in_shape) : Real(0);
    const Vector expected = has_surface ? in_metres(with_.body(hit), hit.in_shape) : Vector(kNone);
    for (int k = 0; k < 3; ++k) {
      value("object coordinates", values.number("object_coordinates", static_cast<std::size_t>(k), 3), expected[k],
            2 * along + 4 * kFloat * (size + along));
    }
  }

  /// The origin of a mesh of heights is at low_m.
  static Vector in_metres(const Body& body, const Vector& in_shape) {
    const Real low_m = body.kind == ShapeKind::heights ? body.heights.low_m : 0;
    return (in_shape - Vector(0, 0, low_m)) * Vector(body.scale);
  }

  void layers(const PixelValues& values, const PixelRay& pixel, Check& value) const {
    constexpr std::size_t kLayers = 4;
    std::size_t layer = 0;
    Real transmission = 1, before_m = -1;
    for (const ExactHit& hit : pixel.hits) {
      if (layer == kLayers || transmission == 0) break;
      if (hit.range_m < rays_.near_m(pixel.ray)) continue;
      if (hit.range_m - before_m <= with_.rounding_m(hit)) continue;  // two surfaces at one range count once
      before_m = hit.range_m;
      value("range of layers", values.number("layer_range", layer, kLayers), hit.range_m,
            with_.rounding_m(hit) + kFloat * hit.range_m);
      value("instance of layers", values.number("layer_instance", layer, kLayers), with_.id("instance", hit.body), 0);
      value("transmission of layers", values.number("layer_transmission", layer, kLayers), transmission, 8 * kFloat);
      transmission *= 1 - Real(with_.body(hit).opacity);
      ++layer;
    }
    for (; layer < kLayers; ++layer) {
      value("range of layers", values.number("layer_range", layer, kLayers), kInfinite, 0);
      value("instance of layers", values.number("layer_instance", layer, kLayers), 0, 0);
    }
  }

  /// `along` is the largest error of the range.
  void backward(const PixelValues& values, const PixelRay& pixel, Real along, Check& value) const {
    if (has_word(desc_.outputs, "scene_flow") && pixel.surface.body >= 0) {
      const Matrix optical = glm::transpose(rays_.eye(1).turn);
      const auto way_at = [&](Real range_m) {
        const FollowedPoint point = follow(rays_, pixel, range_m, 1, 0);
        return ViewRays::optical_of_sensor(optical * (point.from - point.to));
      };
      const Real range = pixel.surface.range_m;
      const Vector way = way_at(range), off = way_at(range + std::min(along, range)) - way;
      for (int k = 0; k < 3; ++k) {
        value("scene flow", values.number("scene_flow", static_cast<std::size_t>(k), 3), way[k],
              2 * std::abs(off[k]) + kFloat * std::abs(way[k]) + 8 * with_.world.pose_rounding_m(with_.sensor));
      }
    }
    flow("flow_backward", values, pixel, along, 1, 0, value);
    if (has_word(desc_.outputs, "flow_backward")) occlusion("occlusion_backward", values, pixel, 1, 0, value);
  }

  bool forward_agrees(const PixelValues& values, const PixelRay& pixel, Report* report) const {
    Check value(with_, values, report);
    if (with_.frame == 0) {
      for (std::size_t k = 0; k < 2; ++k) {
        value("flow_forward", values.number("flow_forward", k, 2), kNone, 0);
      }
      return value.all();
    }
    const ExactHit& hit = pixel.surface;
    const Real bound_m = rays_.is_cast() ? Real(0)
                                         : Real(with_.measured.frames[with_.frame - 1][with_.sensor]
                                                    .value("depth_error_bound_m")
                                                    .value_or(std::numeric_limits<double>::infinity()));
    const Real along = hit.body < 0 ? Real(0) : bound_m / std::abs(pixel.ray.z) + with_.rounding_m(hit);
    flow("flow_forward", values, pixel, along, 0, 1, value);
    occlusion("occlusion_forward", values, pixel, 0, 1, value);
    return value.all();
  }

  void flow(const char* output, const PixelValues& values, const PixelRay& pixel, Real along, Real from, Real to,
            Check& value) const {
    if (!has_word(desc_.outputs, output) || !pixel.sees) return;
    const Real range = pixel.surface.range_m;
    const FollowedPoint point = follow(rays_, pixel, range, from, to),
                        off = follow(rays_, pixel, range + std::min(along, range), from, to);
    if (!point.at_px || !off.at_px || !point.is_defined) return;
    for (int k = 0; k < 2; ++k) {
      const Real centre = (k == 0 ? values.x : values.y) + Real(0.5), way = (*point.at_px)[k] - centre;
      value(output, values.number(output, static_cast<std::size_t>(k), 2), way,
            kFlow_px + 2 * std::abs((*off.at_px)[k] - (*point.at_px)[k]) + kFloat * std::abs(way));
    }
  }

  void occlusion(const char* output, const PixelValues& values, const PixelRay& pixel, Real from, Real to,
                 Check& value) const {
    if (!has_word(desc_.outputs, "occlusion") || !pixel.sees) return;
    const std::optional<bool> hidden = is_hidden(rays_, pixel, from, to);
    if (!hidden) {
      ++with_.tally.at_edges;
      return;
    }
    value("occlusion", values.number(output), *hidden ? 1 : 0, 0);
  }

  const Comparison& with_;
  const SensorDesc& desc_;
  std::string prefix_;
  ViewRays rays_;
  Real largest_bound_m_;  // of the depths of the image
};

}  // namespace

void compare_pixels(const Comparison& comparison) {
  const SensorDesc& desc = comparison.desc();
  if (desc.kind == SensorKind::camera) return PixelComparison(comparison, "", 0).run();
  PixelComparison(comparison, "left_", 0).run();
  PixelComparison(comparison, "right_", desc.baseline_m).run();
}

}  // namespace simvis::combined
