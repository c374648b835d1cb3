#include "sensors/camera/camera.h"

#include <array>
#include <iterator>
#include <utility>

#include "sensors/camera/camera_outputs.h"
#include "sensors/cloud_attributes.h"

namespace simvis {

namespace {

std::vector<OutputSpec> camera_outputs(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  std::vector<OutputSpec> outputs{color_output("color", a), color_stddev_output("color_stddev", a),
                                  depth_output("depth", a)};
  for (OutputSpec& truth : truth_outputs("", a)) outputs.push_back(std::move(truth));
  for (OutputSpec& flow : flow_outputs("", a)) outputs.push_back(std::move(flow));
  for (OutputSpec& layer : layer_outputs("", a)) outputs.push_back(std::move(layer));
  std::ranges::move(object_outputs(a, false), std::back_inserter(outputs));
  outputs.push_back(silhouettes_output("", a));
  outputs.push_back(depth_bound_output(a));
  return outputs;
}

constexpr std::uint8_t kCameraCapabilities = kHasImageSensor | kHasLens | kHasPixelRays | kSeesSplats | kShowsSurfaces;

const SensorRegistration kCameraRegistration(
    {.name = "camera",
     .summary = "A pinhole camera: colour, depth, and what each pixel shows.",
     .notes =
         "The camera looks along +x of its sensor frame; image x runs to the right, y downwards. Depth is "
         "measured in metres along the optical axis and is inf where nothing is hit. Pixels are square unless fx and "
         "fy differ.\nmsaa "
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
     .attributes = rows_of<CameraDesc>().table(),
     .create = create_sensor<Camera, CameraDesc>,
     .outputs = camera_outputs});

EyeDesc eye_of(const std::string& name, const CameraDesc& desc) {
  return {.name = name,
          .sensor = name,
          .title = "camera " + name,
          .color_name = "color",
          .pinhole = desc.pinhole,
          .color = desc.color,
          .depth = desc.depth,
          .truth = desc.truth,
          .sampling = desc.sampling,
          .paths = desc.paths,
          .at_once = desc.visualization,
          .effects = desc.effects,
          .seed = desc.seed};
}

}  // namespace

AttributeRows<CameraDesc> CameraDesc::rows() {
  using Desc = CameraDesc;
  return {nested(&Desc::pinhole, PinholeDesc::rows()),
          flags_row<Desc>("outputs", {{"color", &Desc::color}, {"depth", &Desc::depth}}, "what the camera measures",
                          "color_stddev " + std::string(kTruthWords)),
          nested(&Desc::sampling, ColorSampling::rows()),
          nested(&Desc::paths, PathSampling::rows()),
          kLayerAttribute,
          kMaxLayersAttribute,
          row(&Desc::visualization, "view", {{false, "simulation"}, {true, "visualization"}},
              "simulation: the simulated world; visualization: also what elements draw for people (beams, paths, "
              "graphs)"),
          kDenseAttribute,
          kRateAttribute};
}

void CameraDesc::complete(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  truth = truth_desc(a, depth);
  check_max_error_px(sampling, color, a);
  paths.check(a, color, sampling);
  if (paths.by_paths()) check_cast_pixels(pinhole, a);
  effects =
      camera_effects(kCameraCapabilities, {a, context.seed, context.name, shown_outputs(color, depth || truth.any())});
  if (visualization && truth.any()) {
    fail_at(a.where("outputs"),
            "attribute \"outputs\": a camera that sees what is drawn for people only gives color and depth");
  }
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
  eye_.trace(of_list);
  eye_.cast(world_.layers.caster(of_list));
  if (!desc_.truth.boxes) return;
  objects_.begin();
  eye_.add_objects(objects_, 0, of_list.threads());
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
