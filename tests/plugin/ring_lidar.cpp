// A scanner that lives in a plug-in library: one ring of beams about the z axis of its frame. It declares that it casts
// beams, so effects, --method, --max-error, --price and --summary treat it as they treat laser_scanner.
//
//     <sensor type="ring_lidar" name="LIDAR" insert_at="ROBOT" beams="90"/>
//
// Method `raycast` is exact; `coarse` rounds ranges to multiples of twice max_error_m.
//
// Output  NAME.csv with the columns of every scan.
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

#include <simvis/scan_effect.h>
#include <simvis/sensor.h>

namespace simvis {
namespace {

constexpr AttributeSpec kAttributes[] = {
    {.name = "beams",
     .kind = AttributeKind::integer,
     .default_value = "90",
     .text = "number of beams, counter-clockwise from +x",
     .min = 1,
     .max = 1e6},
    {.name = "method",
     .kind = AttributeKind::choice,
     .text = "how ranges are measured; default: coarse with max_error_m, raycast without",
     .choices = "raycast coarse"},
    {.name = "max_error_m",
     .unit = "m",
     .text = "coarse: largest error bound; default: 0.05",
     .min = 0,
     .open_min = true},
    kRateAttribute,
};

constexpr double kRangeMax_m = 50, kMaxError_m = 0.05;

class RingLidar : public Sensor {
 public:
  explicit RingLidar(const SensorContext& context) : name_(context.name) {
    const AttributeValues& a = context.attributes;
    method_ = a.is_set("method") ? a.choice("method") : a.is_set("max_error_m") ? "coarse" : "raycast";
    if (a.is_set("max_error_m")) max_error_m_ = a.number("max_error_m");
    const auto beams = static_cast<std::uint32_t>(a.integer("beams"));
    context_.rings = 1;
    context_.beams = beams;
    context_.range_max_m = kRangeMax_m;
    std::vector<double> azimuths_rad;
    for (std::uint32_t beam = 0; beam < beams; ++beam) {
      azimuths_rad.push_back(2 * std::numbers::pi * beam / beams);
      directions_.push_back(beam_direction(azimuths_rad.back(), 0));
    }
    scan_ = Scan(1, beams);
    scan_.set_angles(std::move(azimuths_rad), {0});
    effects_ = scan_effects({.attributes = a,
                             .rings = 1,
                             .beams = beams,
                             .range_max_m = kRangeMax_m,
                             .seed = context.seed,
                             .sensor = name_});
  }

  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override {
    context_.world_from_sensor = world_from_sensor;
    context_.medium = list.medium;
    list_ = &list;
    active_ = called_for(effects_, list);
    plan.casts.push_back(
        {.name = name_, .reason = "every beam of ring lidar " + name_, .max_rays = directions_.size()});
    for (const ChosenScanEffect& each : active_) {
      plan.effects.push_back({name_, std::string(each.type->name), std::string(each.type->source)});
    }
  }

  void collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) override { context_.time = time; }

  void cast(RayCaster& rays) override {
    TracedScan traced(directions_, active_);
    std::span<const Echo> detected;
    if (any_traces(active_)) detected = traced.trace(context_, *list_, rays);
    std::vector<RayHit> hits(directions_.size());
    if (detected.empty()) rays.cast(context_.world_from_sensor, directions_, hits);
    scan_.clear_channels();
    const auto [ranges_m, bounds_m] = scan_.overwrite_ranges();
    for (std::size_t beam = 0; beam < directions_.size(); ++beam) {
      const double range_m = detected.empty() ? hits[beam].range_m : detected[beam].range_m;
      const double bound_m = detected.empty() ? hits[beam].error_bound_m : detected[beam].error_bound_m;
      std::tie(ranges_m[beam], bounds_m[beam]) = measured(range_m, bound_m);
    }
    for (const ChosenScanEffect& each : active_) each.effect->finish(context_, detected, scan_);
    context_.before = {context_.time.time_ns, context_.world_from_sensor};
  }

  const Scan* scan() const override { return &scan_; }
  std::string method() const override { return method_; }

  Measurement measurement() const override { return scan_; }

 private:
  // The range and the bound of a beam.
  std::pair<float, float> measured(double range_m, double bound_m) const {
    if (range_m > kRangeMax_m) return {std::numeric_limits<float>::infinity(), 0.0f};
    if (method_ == "coarse") {
      range_m = std::round(range_m / (2 * max_error_m_)) * 2 * max_error_m_;
      bound_m += max_error_m_;
    }
    // A range is stored as float, which rounds by at most half a unit in the last place.
    return {static_cast<float>(range_m), static_cast<float>(bound_m + range_m * 0x1p-24)};
  }

  std::string name_, method_;
  double max_error_m_ = kMaxError_m;
  std::vector<glm::dvec3> directions_;
  std::vector<ChosenScanEffect> effects_, active_;  // of the sensor, of this frame's scene
  const DrawList* list_ = nullptr;                  // of this frame
  ScanContext context_;
  Scan scan_;
};

const SensorRegistration kRingLidar({
    .name = "ring_lidar",
    .summary = "one ring of beams about the z axis of its frame",
    .capabilities = kCastsBeams,
    .attributes = kAttributes,
    .create = [](const SensorContext& context) -> std::unique_ptr<Sensor> {
      return std::make_unique<RingLidar>(context);
    },
    .outputs =
        [](const SensorContext& context) {
          const auto beams = static_cast<std::uint32_t>(context.attributes.integer("beams"));
          std::vector<OutputSpec> outputs = scan_outputs(1, beams);
          const std::vector<OutputSpec> channels = scan_effect_outputs({.attributes = context.attributes,
                                                                        .rings = 1,
                                                                        .beams = beams,
                                                                        .range_max_m = kRangeMax_m,
                                                                        .seed = context.seed,
                                                                        .sensor = context.name});
          outputs.insert(outputs.end(), channels.begin(), channels.end());
          return outputs;
        },
});

}  // namespace
}  // namespace simvis
