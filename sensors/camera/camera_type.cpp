// The type of sensor `camera`: its attributes, outputs and description.
#include <iterator>
#include <utility>

#include "sensors/camera/camera.h"
#include "sensors/camera/camera_outputs.h"

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
     .choices = "color depth instance semantic range normal object_coordinates depth_error_bound flow_backward "
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

constexpr std::uint8_t kCameraCapabilities = kHasImageSensor | kHasPixelRays | kSeesSplats;

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

}  // namespace simvis
