#include "program/report/camera_costs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <simvis/device.h>
#include "engine/base/assert.h"
#include "engine/render/renderer.h"
#include "program/report/cost_run.h"
#include "program/report/report_table.h"
#include "program/report/run_report.h"

namespace simvis {

namespace {

constexpr const char* kMaxError = "max_error_px";

/// The value of max_error_px, if the type has that attribute and the sensor draws colour pictures for the simulation.
std::optional<double> max_error_of(const Command& command) {
  const SensorType* const type = find_sensor_type(command.require("type").value);
  SIMVIS_ASSERT(type != nullptr);
  const std::vector<AttributeSpec> table = all_attributes(*type);
  if (std::ranges::find(table, kMaxError, &AttributeSpec::name) == table.end()) return {};
  const AttributeValues values(command, table, kSensorCommonAttributes);
  if (!values.flag("outputs", "color")) return {};
  const auto says = [&](const char* name, const char* word) {
    return std::ranges::find(table, name, &AttributeSpec::name) != table.end() && values.choice(name) == word;
  };
  return says("view", "visualization") || says("light", "path") ? std::optional<double>() : values.number(kMaxError);
}

Command with_max_error(Command command, double max_error_px, const std::string& name) {
  std::erase_if(command.attributes, [](const CommandAttribute& attribute) {
    return attribute.name == "name" || attribute.name == "rate" || attribute.name == kMaxError;
  });
  command.attributes.push_back({"name", name, command.where});
  command.attributes.push_back({kMaxError, format_number(max_error_px), command.where});
  return command;
}

/// The colour passes of a plan with one sample for each pixel and with depth, and its shadow maps.
FramePlan compared_passes(const FramePlan& plan, double max_error_px) {
  FramePlan compared;
  for (Pass pass : plan.passes) {
    if (!pass.color && !pass.shadow_maps) continue;
    if (pass.color) {
      pass.depth = true;
      pass.supersampling = pass.msaa = 1;
      for (View& view : pass.views) view.max_error_px = max_error_px;
    }
    compared.passes.push_back(std::move(pass));
  }
  return compared;
}

void keep_largest(double& largest, double value) { largest = std::max(largest, value); }

void keep_largest(PictureDifference& largest, const PictureDifference& value) {
  keep_largest(largest.rms_color, value.rms_color);
  keep_largest(largest.silhouette_p99_px, value.silhouette_p99_px);
  keep_largest(largest.silhouette_largest_px, value.silhouette_largest_px);
  keep_largest(largest.other_surface_share, value.other_surface_share);
}

/// A pass as it was drawn, kept beyond the next frame of the renderer.
struct KeptPass {
  std::vector<glm::vec4> color;
  std::vector<float> depth;
};

/// What the values of max_error_px change in the pictures of one plan.
class Comparison {
 public:
  /// Draws the exact pictures.
  Comparison(Renderer& renderer, const DrawList& list, const FramePlan& plan)
      : renderer_(renderer), list_(list), plan_(plan) {
    for (const PassResult& result : renderer_.render(list_, compared_passes(plan_, 0))) {
      exact_.push_back({{result.color.begin(), result.color.end()}, {result.depth.begin(), result.depth.end()}});
    }
  }

  PictureDifference change_at(double max_error_px) {
    const FramePlan plan = compared_passes(plan_, max_error_px);
    const std::span<const PassResult> results = renderer_.render(list_, plan);
    PictureDifference largest;
    for (std::size_t i = 0; i < results.size(); ++i) {
      const Pass& pass = plan.passes[i];
      if (!pass.color) continue;
      keep_largest(largest, difference({pass.width_px, pass.height_px, exact_[i].color, exact_[i].depth},
                                       {pass.width_px, pass.height_px, results[i].color, results[i].depth}));
    }
    return largest;
  }

 private:
  Renderer& renderer_;
  const DrawList& list_;
  const FramePlan& plan_;
  std::vector<KeptPass> exact_;  // by pass
};

DeviceDesc same_device(const Simulation& simulation) {
  const DeviceInfo* const device = simulation.diagnostics().device();
  SIMVIS_ASSERT(device != nullptr);  // cameras draw
  DeviceDesc desc;
  desc.select = device->name;
  return desc;
}

class CameraCostRun {
 public:
  CameraCostRun(Simulation simulation, const CostDesc& desc)
      : cameras_(costed_cameras(simulation)),
        device_(same_device(simulation)),
        renderer_(device_),
        desc_(desc),
        run_(std::move(simulation), desc_) {
    for (const std::string& camera : cameras_) add(camera);
  }

  std::vector<CameraCosts> run() {
    std::vector<CameraCosts> all_costs;
    for (std::size_t i = 0; i < cameras_.size(); ++i) all_costs.push_back(costs(i));
    return all_costs;
  }

 private:
  struct Variant {
    std::string sensor;
    std::vector<FrameTimes> times;
    CameraVariantCosts costs;
  };

  void add(const std::string& camera) {
    const Command command = run_.simulation().diagnostics().command(camera);
    const double own = *max_error_of(command);
    std::vector<double> values(std::begin(kCostedErrors_px), std::end(kCostedErrors_px));
    values.push_back(own);
    std::ranges::sort(values);
    values.erase(std::unique(values.begin(), values.end()), values.end());
    std::vector<Variant>& variants = variants_.emplace_back();
    for (const double value : values) {
      Variant variant{.sensor = CostRun::variant_name(camera, variants.size()),
                      .times = {},
                      .costs = {.max_error_px = value, .in_scene = value == own, .change = {}}};
      run_.add(camera, with_max_error(command, value, variant.sensor), variant.sensor, run_.frames_of_turns());
      variants.push_back(std::move(variant));
    }
  }

  CameraCosts costs(std::size_t camera) {
    std::vector<Variant>& variants = variants_[camera];
    for (std::uint64_t turn = 0; turn < desc_.warm_up; ++turn) measure(camera, 1, turn, false);
    for (Variant& variant : variants) variant.times.clear();
    for (std::uint64_t frame = 1; frame <= desc_.frames; ++frame) measure(camera, frame, frame, true);
    CameraCosts result{.camera = cameras_[camera], .frames = desc_.frames, .load = run_.load(), .variants = {}};
    double least_ms = std::numeric_limits<double>::infinity();
    for (Variant& variant : variants) {
      set_times(variant.times, variant.costs);
      least_ms = std::min(least_ms, variant.costs.median_ms);
    }
    for (Variant& variant : variants) {
      variant.costs.ratio = variant.costs.median_ms / least_ms;
      result.variants.push_back(variant.costs);
    }
    return result;
  }

  /// All variants measure `frame`, in an order that rotates with `turn`.
  void measure(std::size_t camera, std::uint64_t frame, std::uint64_t turn, bool compares) {
    std::vector<Variant>& variants = variants_[camera];
    for (std::size_t i = 0; i < variants.size(); ++i) {
      Variant& variant = variants[(i + turn) % variants.size()];
      variant.times.push_back(run_.time(variant.sensor, "camera \"" + cameras_[camera] + '"', frame));
      count(variant.costs);
    }
    if (!compares) return;
    const Diagnostics drawn = run_.simulation().diagnostics();
    Comparison comparison(renderer_, drawn.draw_list(), drawn.frame_plan());
    for (Variant& variant : variants)
      keep_largest(variant.costs.change, comparison.change_at(variant.costs.max_error_px));
  }

  void count(CameraVariantCosts& costs) {
    const Diagnostics drawn = run_.simulation().diagnostics();
    costs.triangles = drawn.counters().triangles;
    costs.coarse_items = 0;
    for (const Pass& pass : drawn.frame_plan().passes) {
      for (const View& view : pass.views) {
        for (const DrawnLevel& level : view.levels) {
          costs.coarse_items += level.items;
          keep_largest(costs.bound_px, level.error_px);
        }
      }
    }
  }

  std::vector<std::string> cameras_;
  Device device_;
  Renderer renderer_;
  const CostDesc& desc_;
  CostRun run_;
  std::vector<std::vector<Variant>> variants_;  // by camera
};

using Style = NumberFormat::Style;
constexpr NumberFormat kCameraTime{Style::fixed, 3}, kCameraRatio{Style::fixed, 2}, kThreeDigits{Style::general, 3};

struct CameraCostRow {
  const CameraCosts& costs;
  const CameraVariantCosts& variant;
};

template <auto kMember>
ReportValue camera_value(const CameraCostRow& row) {
  return row.variant.*kMember;
}

template <double PictureDifference::*kMember>
ReportValue change_of(const CameraCostRow& row) {
  return row.variant.change.*kMember;
}

std::string max_error_text(const CameraCostRow& row) {
  return format_number(row.variant.max_error_px) + (row.variant.in_scene ? " *" : "");
}

/// The tolerances for which this variant is recommended: "0.5 1".
std::string cheapest_of(const CameraCosts& costs, std::size_t variant) {
  std::string text;
  for (const double tolerance_px : kCostTolerances_px) {
    if (cheapest_for(costs, tolerance_px) == variant) text += (text.empty() ? "" : " ") + format_number(tolerance_px);
  }
  return text;
}

/// "CAM: for 0 px write max_error_px="0" (9.1 ms); for 0.5 1 px ...", in the order of the tolerances.
std::string camera_advice(const CameraCosts& costs) {
  std::string text = costs.camera;
  std::optional<std::size_t> said;
  for (const double tolerance_px : kCostTolerances_px) {
    const std::size_t variant = cheapest_for(costs, tolerance_px);
    if (variant == said) continue;
    const CameraVariantCosts& row = costs.variants[variant];
    text += std::string(said ? "; for " : ": for ") + cheapest_of(costs, variant) + " px write max_error_px=\"" +
            format_number(row.max_error_px) + "\" (" + number_cell(kCameraTime, row.median_ms) + " ms)";
    said = variant;
  }
  return text;
}

using V = CameraVariantCosts;
using D = PictureDifference;

constexpr ReportColumn<CameraCostRow> kCameraColumns[] = {
    {"camera", [](const CameraCostRow& row) -> ReportValue { return row.costs.camera; }},
    {"frames", [](const CameraCostRow& row) -> ReportValue { return row.costs.frames; }},
    {"load", [](const CameraCostRow& row) -> ReportValue { return row.costs.load; }},
    {.name = "max_error_px",
     .get = [](const CameraCostRow& row) -> ReportValue { return format_number(row.variant.max_error_px); },
     .head1 = "",
     .head2 = "max_error_px",
     .text = max_error_text},
    {"in_scene", camera_value<&V::in_scene>},
    {"median_ms", camera_value<&V::median_ms>, "", "ms", kCameraTime},
    {"first_quartile_ms", camera_value<&V::first_quartile_ms>, "first", "quartile", kCameraTime},
    {"third_quartile_ms", camera_value<&V::third_quartile_ms>, "third", "quartile", kCameraTime},
    {"processor_ms", camera_value<&V::processor_ms>, "processor", "ms", kCameraTime},
    {"ratio", camera_value<&V::ratio>, "", "ratio", kCameraRatio},
    {"triangles", camera_value<&V::triangles>, "drawn", "triangles"},
    {"coarse_items", camera_value<&V::coarse_items>, "items", "coarser"},
    {"bound_px", camera_value<&V::bound_px>, "bound", "px", kThreeDigits},
    {"silhouette_p99_px", change_of<&D::silhouette_p99_px>, "silhouette", "p99", kThreeDigits},
    {"silhouette_largest_px", change_of<&D::silhouette_largest_px>, "px", "largest", kThreeDigits},
    {"other_surface_share", change_of<&D::other_surface_share>, "other", "surface %", kThreeDigits, 100},
    {"rms_color", change_of<&D::rms_color>, "colour", "RMS", kThreeDigits},
    {"cheapest_for",
     [](const CameraCostRow& row) -> ReportValue {
       return cheapest_of(row.costs, static_cast<std::size_t>(&row.variant - row.costs.variants.data()));
     },
     "", "cheapest for"}};

std::vector<CameraCostRow> camera_rows(std::span<const CameraCosts> all_costs) {
  std::vector<CameraCostRow> rows;
  for (const CameraCosts& costs : all_costs) {
    for (const CameraVariantCosts& variant : costs.variants) rows.push_back({costs, variant});
  }
  return rows;
}

}  // namespace

std::vector<std::string> costed_cameras(const Simulation& simulation) {
  std::vector<std::string> names;
  for (const SensorInfo& sensor : simulation.sensors()) {
    if (sensor.enabled && max_error_of(simulation.diagnostics().command(sensor.name))) names.push_back(sensor.name);
  }
  return names;
}

std::vector<CameraCosts> camera_costs(Simulation simulation, const CostDesc& desc) {
  SIMVIS_ASSERT(desc.frames > 0);
  return CameraCostRun(std::move(simulation), desc).run();
}

std::size_t cheapest_for(const CameraCosts& costs, double tolerance_px) {
  const auto meets = [&](const CameraVariantCosts& each) { return each.bound_px <= tolerance_px; };
  const CameraVariantCosts* cheapest = nullptr;
  for (const CameraVariantCosts& each : costs.variants) {
    if (meets(each) && (cheapest == nullptr || each.median_ms < cheapest->median_ms)) cheapest = &each;
  }
  SIMVIS_ASSERT(cheapest != nullptr);  // the first variant is exact
  const auto found = std::ranges::find_if(costs.variants, [&](const CameraVariantCosts& each) {
    return meets(each) && each.first_quartile_ms <= cheapest->third_quartile_ms;
  });
  return static_cast<std::size_t>(found - costs.variants.begin());
}

std::string to_table(const CameraCosts& costs) {
  return cost_title(costs.camera + ": colour", costs.frames, costs.load) +
         report_text<CameraCostRow>(kCameraColumns, camera_rows({&costs, 1})) + camera_advice(costs) + '\n';
}

std::string camera_cost_legend() {
  return "ms: the median frame in which only that camera measures, with the quartiles of the frames; processor ms: of "
         "all threads; ratio: of ms to the cheapest; *: as the scene has it.\n"
         "items coarser: drawn at a coarser level; bound: no surface of theirs is displaced by more.\n"
         "silhouette, other surface, colour: largest difference of a frame from the exact picture: pixels between "
         "silhouettes (" +
         std::to_string(kFarSilhouette_px) +
         ": that far or farther), pixels whose depth differs by more than 1 %, linear colour.\n"
         "cheapest for: the most exact value with a bound of so many pixels whose first quartile is not above the "
         "third of the "
         "fastest one.\n"
         "Depth and what other sensors measure does not depend on max_error_px.\n";
}

std::string to_csv(std::span<const CameraCosts> all_costs) {
  return report_csv<CameraCostRow>(kCameraColumns, camera_rows(all_costs));
}

}  // namespace simvis
