#include "program/report/light_costs.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>
#include <utility>

#include <simvis/effect.h>
#include "engine/base/assert.h"
#include "engine/base/words.h"
#include "program/report/cost_run.h"
#include "program/report/report_table.h"
#include "program/report/scene_lights.h"
#include "sensors/camera/path_image.h"

namespace simvis {
namespace {

// Independent pictures of the converged one, and their samples. Their noise averages out over the pixels.
constexpr std::uint32_t kReferences = 4, kReferenceSamples = 8;
constexpr const char* kMsaa = "4";
// Frames of the list: what moves with up to 1000 m/s moves by a micrometre in each.
constexpr std::chrono::nanoseconds kApart{1};
constexpr std::pair<DrawnLight, const char*> kDrawnLights[] = {{DrawnLight::plain, "drawn"},
                                                               {DrawnLight::shadows, "with shadows"},
                                                               {DrawnLight::sizes, "with area lights"},
                                                               {DrawnLight::sky, "with sky and occlusion"}};

// The attributes that decide what light a picture shows, and when it is taken. Those of the lens stay.
std::set<std::string_view> attributes_of_light() {
  std::set<std::string_view> names{"name",  "rate",         "outputs", "supersampling", "msaa",
                                   "light", "max_error_px", "bounces", "samples",       "noise",
                                   "layer", "max_layers",   "dense"};
  for (const EffectType* const effect : effect_types()) {
    if (effect->name == "lens_distortion") continue;
    for (const AttributeSpec& attribute : effect->attributes) names.insert(attribute.name);
  }
  return names;
}

using LightSetting = std::pair<std::string, std::string>;

// The command of a camera with these attributes in place of its own.
Command with_light(Command command, const std::vector<LightSetting>& settings) {
  const std::set<std::string_view> left_out = attributes_of_light();
  std::erase_if(command.attributes,
                [&](const CommandAttribute& attribute) { return left_out.contains(attribute.name); });
  for (const auto& [name, value] : settings) command.attributes.push_back({name, value, command.where});
  return command;
}

// The attributes of a camera that can take paths.
AttributeValues values_of(const Command& command) {
  const SensorType* const type = find_sensor_type(command.require("type").value);
  SIMVIS_ASSERT(type != nullptr);
  return {command, all_attributes(*type), kSensorCommonAttributes};
}

std::uint64_t whole_number(const AttributeValues& values, std::string_view name) {
  return static_cast<std::uint64_t>(values.integer(name));
}

void set_attribute(Command& command, std::string_view name, const std::string& value) {
  const auto found = std::ranges::find(command.attributes, name, &CommandAttribute::name);
  if (found != command.attributes.end()) {
    found->value = value;
  } else {
    command.attributes.push_back({std::string(name), value, command.where});
  }
}

// The polynomial of an f-theta lens (effects/camera/lenses/ftheta.cpp) for distances of `scale` as many pixels.
std::string scaled_polynomial(const AttributeValues& camera, double scale) {
  const bool of_angle = camera.choice("distortion") == "ftheta";  // else of the distance
  std::string scaled;
  double power = 1;  // scale^i
  for (const std::string_view word : words_of(camera.text("polynomial"))) {
    double coefficient = 0;
    SIMVIS_ASSERT(parse_number(word, coefficient));
    scaled += (scaled.empty() ? "" : " ") + format_number(of_angle ? coefficient * scale : coefficient / power);
    power *= scale;
  }
  return scaled;
}

// The sums over the pixels, and R, G and B, of the products of two differences.
double mean_product(const Image& picture, const Image& a, const Image& b) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < picture.pixels.size(); i += picture.channels) {
    for (std::size_t c = i; c < i + 3; ++c, ++count) {
      const double own = picture.pixels[c];
      sum += (own - static_cast<double>(a.pixels[c])) * (own - static_cast<double>(b.pixels[c]));
    }
  }
  return sum / static_cast<double>(count);
}

double mean_radiance_of(const Image& picture) {
  double sum = 0;
  for (std::size_t i = 0; i < picture.pixels.size(); i += picture.channels) {
    for (std::size_t c = i; c < i + 3; ++c) sum += static_cast<double>(picture.pixels[c]);
  }
  return sum / (3.0 * picture.width * picture.height);
}

}  // namespace

Command listed_camera(Command command) {
  const AttributeValues camera = values_of(command);
  const auto width_px = static_cast<double>(whole_number(camera, "width")),
             height_px = static_cast<double>(whole_number(camera, "height"));
  if (width_px * height_px <= kListedPixels) return command;
  const double listed_px = std::max(1.0, std::round(width_px * std::sqrt(kListedPixels / (width_px * height_px))));
  const double scale = listed_px / width_px;
  set_attribute(command, "width", format_number(listed_px));
  set_attribute(command, "height", format_number(std::max(1.0, std::round(height_px * scale))));
  for (const char* const focal : {"fx", "fy"}) {
    if (camera.is_set(focal)) set_attribute(command, focal, format_number(camera.number(focal) * scale));
  }
  for (const char* const centre : {"cx", "cy"}) {  // from the centre of the first pixel
    if (!camera.is_set(centre)) continue;
    set_attribute(command, centre, format_number((camera.number(centre) + 0.5) * scale - 0.5));
  }
  if (camera.choice("distortion").starts_with("ftheta")) {
    set_attribute(command, "polynomial", scaled_polynomial(camera, scale));
  }
  return command;
}

LightError light_error(const Image& picture, std::span<const Image> references) {
  const std::size_t count = references.size();
  SIMVIS_ASSERT(count >= 2);
  std::vector<double> of_reference(count, 0);  // sums of the products with the others
  double all = 0;
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const double product = mean_product(picture, references[a], references[b]);
      of_reference[a] += product;
      of_reference[b] += product;
      all += product;
    }
  }
  const auto pairs = [](std::size_t n) { return static_cast<double>(n * (n - 1)) / 2; };
  const double square = all / pairs(count);
  double spread = 0;
  for (const double without : of_reference) {
    const double off = count > 2 ? (all - without) / pairs(count - 1) - square : square;
    spread += off * off;
  }
  const double error = std::sqrt(spread * (static_cast<double>(count) - 1) / static_cast<double>(count));
  const double rms = std::sqrt(std::max(0.0, square));
  // The uncertainty of the root: of a square that is 0 within its own, all of it.
  return {rms, square > error ? error / (2 * rms) : std::sqrt(error)};
}

namespace {

class LightCostRun {
 public:
  LightCostRun(Simulation simulation, const CostDesc& desc)
      : cameras_(costed_lights(simulation)), desc_(desc), run_(std::move(simulation), desc_, kApart) {
    for (const std::string& camera : cameras_) add(camera);
  }

  std::vector<LightCosts> run() {
    std::vector<LightCosts> all;
    for (std::size_t i = 0; i < cameras_.size(); ++i) all.push_back(costs(i));
    return all;
  }

 private:
  struct DrawnRow {
    DrawnLight light;
    std::string sensor, says;
    std::vector<FrameTimes> times{};
    Image first{};
  };
  struct Sensors {
    std::uint64_t width_px = 0, height_px = 0, bounces = 0;
    std::string plain, smooth;  // drawn, without and with msaa
    std::vector<std::string> paths, references;
  };

  std::string add(const std::string& camera, const Command& command, std::vector<LightSetting> settings,
                  std::uint64_t frames) {
    const std::string name = CostRun::variant_name(camera, ++variants_);
    settings.emplace_back("name", name);
    settings.emplace_back("outputs", "color");
    run_.add(camera, with_light(command, settings), name, frames);
    return name;
  }

  void add(const std::string& camera) {
    const Command command = listed_camera(run_.simulation().diagnostics().command(camera));
    const AttributeValues values = values_of(command);
    Sensors& sensors = sensors_.emplace_back();
    sensors.width_px = whole_number(values, "width");
    sensors.height_px = whole_number(values, "height");
    sensors.bounces = values.is_set("bounces") ? whole_number(values, "bounces") : PathSampling{}.number_of_bounces();
    const auto paths = [&](std::uint32_t samples) {
      return add(
          camera, command,
          {{"light", "path"}, {"samples", std::to_string(samples)}, {"bounces", std::to_string(sensors.bounces)}}, 1);
    };
    sensors.plain = add(camera, command, {}, std::size(kDrawnLights) * run_.frames_of_turns());
    sensors.smooth = add(camera, command, {{"msaa", kMsaa}}, run_.frames_of_turns());
    for (const std::uint32_t samples : kCostedSamples) sensors.paths.push_back(paths(samples));
    for (std::uint32_t i = 0; i < kReferences; ++i) sensors.references.push_back(paths(kReferenceSamples));
  }

  LightCosts costs(std::size_t i) {
    const Sensors& sensors = sensors_[i];
    LightCosts costs{.camera = cameras_[i],
                     .load = run_.load(),
                     .width_px = sensors.width_px,
                     .height_px = sensors.height_px,
                     .bounces = sensors.bounces};
    try {
      take(sensors.paths.front(), costs.camera);  // makes the trees
    } catch (const InputError& error) {
      costs.refused = error.what();
      run_.simulation().enable(sensors.paths.front(), false);
      return costs;
    }
    std::vector<Image> references;
    for (const std::string& sensor : sensors.references) references.push_back(take(sensor, costs.camera).second);
    for (const Image& each : references) costs.mean_radiance += mean_radiance_of(each) / kReferences;
    add_drawn(sensors, references, costs);
    for (std::size_t k = 0; k < std::size(kCostedSamples); ++k) {
      const auto [times, picture] = take(sensors.paths[k], costs.camera);
      add_row("paths " + std::to_string(kCostedSamples[k]), {&times, 1}, light_error(picture, references), costs);
    }
    return costs;
  }

  // The picture of the first frame, and the time that it takes.
  std::pair<FrameTimes, Image> take(const std::string& sensor, const std::string& camera) {
    const FrameTimes times = run_.time_alone(sensor, "camera \"" + camera + '"', 1);
    return {times, run_.simulation().color(sensor)};
  }

  void add_drawn(const Sensors& sensors, std::span<const Image> references, LightCosts& costs) {
    SceneLights lights(run_.simulation());
    std::vector<DrawnRow> rows;
    for (const auto& [light, says] : kDrawnLights) {
      if (lights.offers(light)) rows.push_back({.light = light, .sensor = sensors.plain, .says = says});
    }
    rows.push_back({.light = rows.back().light, .sensor = sensors.smooth, .says = "and msaa " + std::string(kMsaa)});
    for (std::uint64_t turn = 0; turn < desc_.warm_up + desc_.frames; ++turn) {
      for (std::size_t k = 0; k < rows.size(); ++k) measure(rows[(k + turn) % rows.size()], lights, turn, costs.camera);
    }
    for (const DrawnRow& row : rows) add_row(row.says, row.times, light_error(row.first, references), costs);
    lights.restore();
  }

  void measure(DrawnRow& row, SceneLights& lights, std::uint64_t turn, const std::string& camera) {
    lights.show(row.light);
    const bool timed = turn >= desc_.warm_up;
    const std::uint64_t frame = timed ? turn - desc_.warm_up + 1 : 1;
    const FrameTimes times = run_.time(row.sensor, "camera \"" + camera + '"', frame);
    if (!timed) return;
    row.times.push_back(times);
    if (frame == 1) row.first = run_.simulation().color(row.sensor);
  }

  static void add_row(const std::string& light, std::span<const FrameTimes> times, const LightError& error,
                      LightCosts& costs) {
    LightVariantCosts row{.light = light, .frames = times.size(), .error = error};
    set_times(times, row);
    costs.variants.push_back(row);
  }

  std::vector<std::string> cameras_;
  const CostDesc& desc_;
  CostRun run_;
  std::vector<Sensors> sensors_;  // by camera
  std::size_t variants_ = 0;
};

constexpr NumberFormat kLightTime{NumberFormat::Style::fixed, 3}, kLightPercent{NumberFormat::Style::fixed, 1},
    kLightDigits{NumberFormat::Style::general, 3}, kLightUncertainty{NumberFormat::Style::general, 2};

struct LightCostRow {
  const LightCosts& costs;
  const LightVariantCosts& variant;
};

template <auto kMember>
ReportValue light_value(const LightCostRow& row) {
  return row.variant.*kMember;
}

using Variant = LightVariantCosts;

constexpr ReportColumn<LightCostRow> kLightColumns[] = {
    {"camera", [](const LightCostRow& row) -> ReportValue { return row.costs.camera; }},
    {"load", [](const LightCostRow& row) -> ReportValue { return row.costs.load; }},
    {"width_px", [](const LightCostRow& row) -> ReportValue { return row.costs.width_px; }},
    {"height_px", [](const LightCostRow& row) -> ReportValue { return row.costs.height_px; }},
    {"bounces", [](const LightCostRow& row) -> ReportValue { return row.costs.bounces; }},
    {"mean_radiance", [](const LightCostRow& row) -> ReportValue { return row.costs.mean_radiance; }},
    {"light", light_value<&Variant::light>, "", "light"},
    {"frames", light_value<&Variant::frames>, "", "frames"},
    {"median_ms", light_value<&Variant::median_ms>, "", "ms", kLightTime},
    {"first_quartile_ms", light_value<&Variant::first_quartile_ms>, "first", "quartile", kLightTime},
    {"third_quartile_ms", light_value<&Variant::third_quartile_ms>, "third", "quartile", kLightTime},
    {"processor_ms", light_value<&Variant::processor_ms>, "processor", "ms", kLightTime},
    {"rms_error", [](const LightCostRow& row) -> ReportValue { return row.variant.error.rms; }, "RMS", "error",
     kLightDigits},
    {"rms_uncertainty", [](const LightCostRow& row) -> ReportValue { return row.variant.error.uncertainty; }, "", "+-",
     kLightUncertainty},
    {"error_share",
     [](const LightCostRow& row) -> ReportValue { return row.variant.error.rms / row.costs.mean_radiance; }, "of the",
     "mean %", kLightPercent, 100}};

std::vector<LightCostRow> light_rows(std::span<const LightCosts> all_costs) {
  std::vector<LightCostRow> rows;
  for (const LightCosts& costs : all_costs) {
    for (const LightVariantCosts& variant : costs.variants) rows.push_back({costs, variant});
  }
  return rows;
}

// A camera that takes colour for the simulation, by a type that knows paths.
bool can_take_paths(const Command& command) {
  const SensorType* const type = find_sensor_type(command.require("type").value);
  SIMVIS_ASSERT(type != nullptr);
  const std::vector<AttributeSpec> table = all_attributes(*type);
  const auto has = [&](std::string_view name) {
    return std::ranges::find(table, name, &AttributeSpec::name) != table.end();
  };
  if (!has("light") || !has("bounces")) return false;
  const AttributeValues values = values_of(command);
  return values.flag("outputs", "color") && values.choice("view") != "visualization";
}

}  // namespace

std::vector<std::string> costed_lights(const Simulation& simulation) {
  std::vector<std::string> names;
  for (const SensorInfo& sensor : simulation.sensors()) {
    if (sensor.enabled && can_take_paths(simulation.diagnostics().command(sensor.name))) names.push_back(sensor.name);
  }
  return names;
}

std::vector<LightCosts> light_costs(Simulation simulation, const CostDesc& desc) {
  SIMVIS_ASSERT(desc.frames > 0);
  return LightCostRun(std::move(simulation), desc).run();
}

std::string to_table(const LightCosts& costs) {
  if (!costs.refused.empty()) return costs.camera + ": light: no paths, " + costs.refused + "\n";
  const std::string number = report_number({NumberFormat::Style::fixed, 2}, costs.load);
  return costs.camera + ": light, " + std::to_string(costs.width_px) + " x " + std::to_string(costs.height_px) +
         " pixels, up to " + std::to_string(costs.bounces) + " bounces, load " + number +
         " at the start, mean radiance " + report_number(kLightDigits, costs.mean_radiance) + '\n' +
         report_text<LightCostRow>(kLightColumns, light_rows({&costs, 1}));
}

std::string light_cost_legend() {
  return "drawn, shadows, area lights, sky: each adds to the line above it; sky and occlusion: ambient light and skies "
         "as distant lights that things block.\n"
         "RMS error: root mean square over pixels and linear R, G and B of the difference from the converged picture "
         "of "
         "light=\"path\" with the camera's bounces, in the first frame; +-: its standard error. Paths see lamps with "
         "their sizes, and skies; all rows have the camera's view and lens in a small image, and none of its other "
         "effects.\n"
         "ms: the median frame in which only that camera measures, with the quartiles of the frames.\n";
}

std::string to_csv(std::span<const LightCosts> all_costs) {
  return report_csv<LightCostRow>(kLightColumns, light_rows(all_costs));
}

}  // namespace simvis
