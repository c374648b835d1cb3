#include "program/report/camera_price.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <simvis/device.h>
#include "engine/base/assert.h"
#include "engine/render/renderer.h"
#include "program/output/item_file.h"
#include "program/output/number_text.h"
#include "program/report/aligned_table.h"
#include "program/report/priced_run.h"
#include "program/report/run_report.h"

namespace simvis {

namespace {

constexpr const char* kDial = "max_error_px";

/// The value of max_error_px, if the type has that attribute and the sensor takes colour pictures for the simulation.
std::optional<double> dial_of(const Command& command) {
  const SensorType* const type = find_sensor_type(command.require("type").value);
  SIMVIS_ASSERT(type != nullptr);
  const std::vector<AttributeSpec> table = all_attributes(*type);
  if (std::ranges::find(table, kDial, &AttributeSpec::name) == table.end()) return {};
  const AttributeValues values(command, table, kSensorCommonAttributes);
  if (!values.flag("outputs", "color")) return {};
  const bool for_people =
      std::ranges::find(table, "view", &AttributeSpec::name) != table.end() && values.choice("view") == "visualization";
  return for_people ? std::optional<double>() : values.number(kDial);
}

Command with_dial(Command command, double max_error_px, const std::string& name) {
  std::erase_if(command.attributes, [](const CommandAttribute& attribute) {
    return attribute.name == "name" || attribute.name == "rate" || attribute.name == kDial;
  });
  command.attributes.push_back({"name", name, command.where});
  command.attributes.push_back({kDial, format_number(max_error_px), command.where});
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

/// What the values of the dial change in the pictures of one plan.
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
  DeviceDesc desc;
  desc.select = simulation.diagnostics().device().name;
  return desc;
}

class CameraPricing {
 public:
  CameraPricing(Simulation simulation, const PriceDesc& desc)
      : cameras_(cameras_to_price(simulation)),
        device_(same_device(simulation)),
        renderer_(device_),
        desc_(desc),
        run_(std::move(simulation), desc_) {
    for (const std::string& camera : cameras_) add(camera);
  }

  std::vector<CameraPrice> run() {
    std::vector<CameraPrice> prices;
    for (std::size_t i = 0; i < cameras_.size(); ++i) prices.push_back(price(i));
    return prices;
  }

 private:
  struct Variant {
    std::string sensor;
    std::vector<double> times_ms, processor_ms;
    CameraVariantPrice price;
  };

  void add(const std::string& camera) {
    const Command command = run_.simulation().diagnostics().command(camera);
    const double own = *dial_of(command);
    std::vector<double> values(std::begin(kPricedErrors_px), std::end(kPricedErrors_px));
    values.push_back(own);
    std::ranges::sort(values);
    values.erase(std::unique(values.begin(), values.end()), values.end());
    std::vector<Variant>& variants = variants_.emplace_back();
    for (const double value : values) {
      Variant variant{.sensor = PricedRun::variant_name(camera, variants.size()),
                      .times_ms = {},
                      .processor_ms = {},
                      .price = {.max_error_px = value, .in_scene = value == own, .change = {}}};
      run_.add(camera, with_dial(command, value, variant.sensor), variant.sensor);
      variants.push_back(std::move(variant));
    }
  }

  CameraPrice price(std::size_t camera) {
    std::vector<Variant>& variants = variants_[camera];
    for (std::uint64_t turn = 0; turn < desc_.warm_up; ++turn) measure(camera, 1, turn, false);
    for (Variant& variant : variants) {
      variant.times_ms.clear();
      variant.processor_ms.clear();
    }
    for (std::uint64_t frame = 1; frame <= desc_.frames; ++frame) measure(camera, frame, frame, true);
    CameraPrice result{.camera = cameras_[camera], .frames = desc_.frames, .variants = {}};
    double least_ms = std::numeric_limits<double>::infinity();
    for (Variant& variant : variants) {
      variant.price.median_ms = percentile(variant.times_ms, 50);
      variant.price.processor_ms = percentile(variant.processor_ms, 50);
      least_ms = std::min(least_ms, variant.price.median_ms);
    }
    for (Variant& variant : variants) {
      variant.price.ratio = variant.price.median_ms / least_ms;
      result.variants.push_back(variant.price);
    }
    return result;
  }

  /// All variants measure `frame`, in an order that rotates with `turn`.
  void measure(std::size_t camera, std::uint64_t frame, std::uint64_t turn, bool compares) {
    std::vector<Variant>& variants = variants_[camera];
    for (std::size_t i = 0; i < variants.size(); ++i) {
      Variant& variant = variants[(i + turn) % variants.size()];
      const FramePrice price = run_.price(variant.sensor, "camera \"" + cameras_[camera] + '"', frame);
      variant.times_ms.push_back(price.wall_ms);
      variant.processor_ms.push_back(price.processor_ms);
      count(variant.price);
    }
    if (!compares) return;
    const Diagnostics drawn = run_.simulation().diagnostics();
    Comparison comparison(renderer_, drawn.draw_list(), drawn.frame_plan());
    for (Variant& variant : variants)
      keep_largest(variant.price.change, comparison.change_at(variant.price.max_error_px));
  }

  void count(CameraVariantPrice& price) {
    const Diagnostics drawn = run_.simulation().diagnostics();
    price.triangles = drawn.counters().triangles;
    price.coarse_items = 0;
    for (const Pass& pass : drawn.frame_plan().passes) {
      for (const View& view : pass.views) {
        for (const DrawnLevel& level : view.levels) {
          price.coarse_items += level.items;
          keep_largest(price.bound_px, level.error_px);
        }
      }
    }
  }

  std::vector<std::string> cameras_;
  Device device_;
  Renderer renderer_;
  const PriceDesc& desc_;
  PricedRun run_;
  std::vector<std::vector<Variant>> variants_;  // by camera
};

using Style = NumberFormat::Style;
constexpr NumberFormat kCameraTime{Style::fixed, 3}, kCameraRatio{Style::fixed, 2}, kPixels{Style::general, 3};
constexpr NumberFormat kShare{Style::general, 3}, kFull{Style::general, 9};

}  // namespace

std::vector<std::string> cameras_to_price(const Simulation& simulation) {
  std::vector<std::string> names;
  for (const SensorInfo& sensor : simulation.sensors()) {
    if (sensor.enabled && dial_of(simulation.diagnostics().command(sensor.name))) names.push_back(sensor.name);
  }
  return names;
}

std::vector<CameraPrice> price_cameras(Simulation simulation, const PriceDesc& desc) {
  SIMVIS_ASSERT(desc.frames > 0);
  return CameraPricing(std::move(simulation), desc).run();
}

std::string to_table(const CameraPrice& price) {
  std::vector<std::vector<std::string>> rows = {
      {"", "", "processor", "", "drawn", "items", "bound", "silhouette", "px", "other", "colour"},
      {"max_error_px", "ms", "ms", "ratio", "triangles", "coarser", "px", "p99", "largest", "surface %", "RMS"}};
  for (const CameraVariantPrice& v : price.variants) {
    rows.push_back({format_number(v.max_error_px) + (v.in_scene ? " *" : ""), number_cell(kCameraTime, v.median_ms),
                    number_cell(kCameraTime, v.processor_ms), number_cell(kCameraRatio, v.ratio),
                    std::to_string(v.triangles), std::to_string(v.coarse_items), number_cell(kPixels, v.bound_px),
                    number_cell(kPixels, v.change.silhouette_p99_px),
                    number_cell(kPixels, v.change.silhouette_largest_px),
                    number_cell(kShare, 100 * v.change.other_surface_share), number_cell(kShare, v.change.rms_color)});
  }
  return price.camera + ": colour, " + std::to_string(price.frames) + (price.frames == 1 ? " frame" : " frames") +
         " of each\n" + aligned(rows);
}

std::string camera_price_legend() {
  return "ms: the median frame in which only that camera measures; processor ms: of all threads; ratio: of ms to the "
         "cheapest; *: as the scene has it.\n"
         "items coarser: drawn at a coarser level; bound: no surface of theirs is displaced by more.\n"
         "silhouette, other surface, colour: largest difference of a frame from the exact picture: pixels between "
         "silhouettes (" +
         std::to_string(kFarSilhouette_px) +
         ": that far or farther), pixels whose depth differs by more than 1 %, linear colour.\n"
         "Depth and what other sensors measure does not depend on max_error_px.\n";
}

std::string to_csv(std::span<const CameraPrice> prices) {
  std::string text =
      "camera,frames,max_error_px,in_scene,median_ms,processor_ms,ratio,triangles,coarse_items,bound_px,"
      "silhouette_p99_px,silhouette_largest_px,other_surface_share,rms_color\n";
  for (const CameraPrice& price : prices) {
    for (const CameraVariantPrice& v : price.variants) {
      text += csv_field(price.camera) + ',' + std::to_string(price.frames) + ',' + format_number(v.max_error_px) + ',' +
              (v.in_scene ? "1" : "0");
      for (const double value : {v.median_ms, v.processor_ms, v.ratio, static_cast<double>(v.triangles),
                                 static_cast<double>(v.coarse_items), v.bound_px, v.change.silhouette_p99_px,
                                 v.change.silhouette_largest_px, v.change.other_surface_share, v.change.rms_color}) {
        text += ',' + number_cell(kFull, value);
      }
      text += '\n';
    }
  }
  return text;
}

}  // namespace simvis
