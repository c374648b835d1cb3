#include "sensors/camera/camera_outputs.h"

#include <limits>
#include <utility>

#include "sensors/camera/depth_error_bound.h"

namespace simvis {
namespace {

OutputSpec image_output(std::string name, std::uint32_t channels, const char* flag, const AttributeValues& attributes) {
  return {.name = std::move(name),
          .kind = OutputKind::image,
          .value_type = ValueType::f32,
          .shape = image_shape(attributes, channels),
          .frame = "optical",
          .message = std::string(kImageMessage),
          .when = std::string(flag) + " among outputs",
          .given = attributes.flag("outputs", flag)};
}

}  // namespace

OutputShape image_shape(const AttributeValues& attributes, std::uint32_t channels) {
  return {.rows = static_cast<std::uint32_t>(attributes.integer("height")),
          .columns = static_cast<std::uint32_t>(attributes.integer("width")),
          .channels = channels};
}

OutputSpec color_output(std::string name, const AttributeValues& attributes) {
  OutputSpec output = image_output(std::move(name), 4, "color", attributes);
  output.content = ImageContent::color;
  output.meaning = "linear RGB radiance, and alpha, which is always 1";
  return output;
}

OutputSpec depth_output(std::string name, const AttributeValues& attributes) {
  OutputSpec output = image_output(std::move(name), 1, "depth", attributes);
  output.content = ImageContent::depth;
  output.unit = "m";
  output.meaning = "depth along the optical axis";
  output.nothing = std::numeric_limits<double>::infinity();
  output.bound = kDepthErrorBound;
  return output;
}

OutputSpec disparity_output(const AttributeValues& attributes) {
  OutputSpec output = image_output("disparity", 1, "disparity", attributes);
  output.content = ImageContent::disparity;
  output.unit = "px";
  output.meaning = "disparity of the left image: fx x baseline / depth";
  output.nothing = 0;
  output.message = "stereo_msgs/msg/DisparityImage";
  return output;
}

OutputSpec depth_bound_output(const AttributeValues& attributes) {
  return {.name = std::string(kDepthErrorBound),
          .unit = "m",
          .meaning = "largest error of all depths of the frame",
          .nothing = std::numeric_limits<double>::infinity(),
          .when = "depth among outputs",
          .given = attributes.flag("outputs", "depth"),
          .on_request = true};
}

}  // namespace simvis
