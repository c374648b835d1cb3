// A view of a camera in one frame, as formats of datasets need it: its images by their content, its place, and the rows
// of its table of objects.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "program/datasets/dataset_format.h"

namespace simvis {

/// Formats count pixels from the centre of the first one, and SimVis from the picture's corner.
inline constexpr double kFirstCentre_px = 0.5;

/// A rectangle of pixels, in pixels from the picture's corner; x_max and y_max are the right and lower edges.
struct BoxPx {
  double x_min = 0, y_min = 0, x_max = 0, y_max = 0;
};

/// A row of the table `boxes` of docs/truth.md.
struct ObjectInView {
  std::uint32_t instance = 0, semantic = 0;
  std::uint64_t visible_pixels = 0, picture_pixels = 0, full_pixels = 0;
  double visible_fraction = 0, truncated = 0;
  BoxPx visible, picture, full;       ///< `visible` only if visible_pixels is above 0
  glm::dvec3 centre_m{0}, size_m{0};  ///< of the box in space, in the optical frame
  glm::dmat3 optical_from_box{1.0};
};

struct SeenView {
  std::string name;  ///< of the sensor; with several views SENSOR_VIEW
  CameraCalibration camera;
  glm::dmat4 world_from_optical{1.0};  ///< x right, y down, z forward
  std::optional<Image> color, depth;
  const MeasuredArray *instance = nullptr, *semantic = nullptr, *silhouettes = nullptr;  ///< null: not measured
  std::vector<ObjectInView> objects{};  ///< channel i of silhouettes is that of objects[i]
};

/// All views of the cameras among the sensors, in their order. The views point into the sensors' measurements.
std::vector<SeenView> views_of(std::span<const DatasetSensor> sensors);

/// A sensor with images and their calibrations.
bool is_camera(const DatasetSensor& sensor);
bool is_scanner(const DatasetSensor& sensor);
/// A sensor of type `keypoints`, which has the calibration of its camera and no image.
bool is_keypoints(const DatasetSensor& sensor);

/// An output of a camera that a format needs, by its word in `outputs`.
struct NeededOutput {
  const char* word;
  /// The name of the array; empty: that of the content.
  std::string_view array;
  ImageContent content = ImageContent::numbers;
};
inline constexpr NeededOutput kNeedsColor{"color", "", ImageContent::color},
    kNeedsDepth{"depth", "", ImageContent::depth}, kNeedsInstance{"instance", "instance"},
    kNeedsBoxes{"boxes", "visible_pixels"}, kNeedsSilhouettes{"silhouettes", "silhouettes"};

/// Throws InputError if a camera lacks one of the outputs. `format` is the name of the format.
void require_outputs(const DatasetSensor& camera, std::string_view format, std::initializer_list<NeededOutput> outputs);
/// Throws InputError if a view of the camera has a lens.
void require_pinhole(const DatasetSensor& camera, std::string_view format);
/// Throws InputError if none of the sensors is a camera.
void require_views(std::span<const DatasetSensor> sensors, std::string_view format);
/// Throws InputError if two views have one name, and with it the same files.
void require_own_names(std::span<const DatasetSensor> sensors, std::string_view format);
/// Throws InputError: the format cannot hold this sensor, because it holds only `holds`.
[[noreturn]] void refuse_sensor(const DatasetSensor& sensor, std::string_view format, std::string_view holds);

}  // namespace simvis
