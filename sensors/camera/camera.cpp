#include "sensors/camera/camera.h"

#include <array>
#include <iterator>
#include <utility>

#include "sensors/camera/camera_outputs.h"
#include "sensors/cloud_attributes.h"

namespace simvis {

namespace {

constexpr AttributeSpec kCameraAttributes[] = {
    kWidthAttribute,
    kHeightAttribute,
    kHfovAttribute,
    kNearAttribute,
    {.name = "outputs",
     .kind = AttributeKind::flags,
     .default_value = "color",
     .text = "what the camera measures",
     .choices = "color depth flow_backward "
                "flow_forward scene_flow occlusion layers boxes silhouettes"},
    kSupersamplingAttribute,
    kMsaaAttribute,
    kMaxErrorPxAttribute,
    kLayerAttribute,
    kMaxLayersAttribute,
    {.name = "view",
     .kind = AttributeKind::choice,
     .default_value = "simulation",
     .text =
         "simulation: the simulated world; visualization: also what elements draw for people (beams, paths, graphs)",
     .choices = "simulation visualization"},
    kDenseAttribute,
    kRateAttribute,
};

std::vector<OutputSpec> camera_outputs(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  std::vector<OutputSpec> outputs{color_output("color", a), depth_output("depth", a)};
  for (OutputSpec& truth : truth_outputs("", a)) outputs.push_back(std::move(truth));
  for (OutputSpec& flow : flow_outputs("", a)) outputs.push_back(std::move(flow));
  for (OutputSpec& layer : layer_outputs("", a)) outputs.push_back(std::move(layer));
  std::ranges::move(object_outputs(a, false), std::back_inserter(outputs));
  outputs.push_back(silhouettes_output("", a));
  outputs.push_back(depth_bound_output(a));
  return outputs;
}

std::unique_ptr<Sensor> create_camera(const SensorContext& context) {
  return std::make_unique<Camera>(context.name, camera_desc(context));
}

constexpr std::uint8_t kCameraCapabilities = kHasImageSensor | kHasLens | kHasPixelRays | kSeesSplats | kShowsSurfaces;

const SensorRegistration kCameraRegistration(
    {.name = "camera",
     .summary = "A pinhole camera: colour, depth, and what each pixel shows.",
     .notes =
         "The camera looks along +x of its sensor frame; image x runs to the right, y downwards. Depth is "
         "measured in metres along the optical axis and is inf where nothing is hit. Pixels are square.\nmsaa "
         "smooths the edges of shapes only, not masks, highlights or textures. supersampling smooths all of them. "
         "Depth is always that of pixel centres; next to averaged colour it needs a pass of its own.\nmax_error_px "
         "trades accuracy for speed in colour, see docs/accuracy.md; depth, and what other sensors measure, stays "
         "exact. A camera with depth too draws it in a pass of its own then.\ninstance, semantic, range, normal, "
         "object_coordinates and depth_error_bound are those of the surface at the pixel's centre; flow_backward, "
         "flow_forward, scene_flow and occlusion compare it with the previous image: see docs/truth.md. normal, "
         "occlusion, layers, and a lens, take one ray for each pixel.\nThe C++ "
         "call value(\"CAMERA\", \"depth_error_bound_m\") bounds the error of the last depth image; "
         "sensors/camera/depth_error_bound.h derives the bound.",
     .capabilities = kCameraCapabilities,
     .attributes = kCameraAttributes,
     .create = create_camera,
     .outputs = camera_outputs});

EyeDesc eye_of(const std::string& name, const CameraDesc& desc) {
  return {.name = name,
          .sensor = name,
          .title = "camera " + name,
          .color_name = "color",
          .width_px = desc.width_px,
          .height_px = desc.height_px,
          .hfov_rad = desc.hfov_rad,
          .near_m = desc.near_m,
          .color = desc.color,
          .depth = desc.depth,
          .truth = desc.truth,
          .sampling = desc.sampling,
          .max_error_px = desc.max_error_px,
          .at_once = desc.visualization,
          .effects = desc.effects};
}

}  // namespace

CameraDesc camera_desc(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  CameraDesc desc{.width_px = static_cast<std::uint32_t>(a.integer("width")),
                  .height_px = static_cast<std::uint32_t>(a.integer("height")),
                  .hfov_rad = glm::radians(a.number("hfov")),
                  .near_m = a.number("near"),
                  .color = a.flag("outputs", "color"),
                  .depth = a.flag("outputs", "depth"),
                  .truth = truth_desc(a, a.flag("outputs", "depth")),
                  .sampling = color_sampling(a),
                  .max_error_px = max_error_px(a, a.flag("outputs", "color")),
                  .visualization = a.choice("view") == "visualization"};
  desc.effects = camera_effects(
      kCameraCapabilities, {a, context.seed, context.name, shown_outputs(desc.color, desc.depth || desc.truth.any())});
  if (desc.visualization && desc.truth.any()) {
    fail_at(a.where("outputs"),
            "attribute \"outputs\": a camera that sees what is drawn for people only gives color and depth");
  }
  return desc;
}

Camera::Camera(const std::string& name, const CameraDesc& desc)
    : desc_(eye_of(name, desc)),
      optics_(desc_),
      world_(desc.truth),
      eye_(desc_, optics_, world_),
      objects_(desc.truth, 1),
      calibrations_(calibrations({{.view = "", .camera = calibration_of(optics_.layout)}})) {}

HistoryDependence Camera::history_dependence() const {
  const HistoryDependence own = eye_.history_dependence();
  return own == HistoryDependence::none ? Sensor::history_dependence() : own;
}

void Camera::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  world_.begin(list);
  eye_.begin_plan(world_from_sensor);
  for (std::size_t i = 0; i < eye_.drawings().size(); ++i) eye_.draw(i, plan);
  eye_.finish_plan(plan);
  plan_effects(desc_.sensor, desc_.effects, plan);
}

void Camera::cast(RayCaster& of_list) {
  eye_.cast(world_.layers.caster(of_list));
  if (!desc_.truth.boxes) return;
  objects_.begin();
  eye_.add_objects(objects_, 0);
}

Measurement Camera::measurement() const {
  Measurement measurement{
      .time_ns = eye_.measured_ns(), .world_from_sensor = eye_.measured_from(), .calibrations = calibrations_};
  eye_.add_to(measurement);
  objects_.add_to(measurement, std::array{""});
  return measurement;
}

std::vector<NumberOnRequest> Camera::on_request() const {
  if (!desc_.depth) return {};
  return {{std::string(kDepthErrorBound), "m", eye_.depth_bound()}};
}

}  // namespace simvis
