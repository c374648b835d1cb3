// Effects on what a camera's image shows.
//
// An image goes through stages, and an effect takes part in any of them:
//
//   lay_out  once, before anything is rendered: where each pixel looks, and when each row does
//   develop  of each image: what becomes of its colour, linear and after it was rendered
//
// Without an effect that lays out, the image is one pinhole view. Otherwise see sensors/camera_views.h.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/effect.h>
#include <simvis/frame_plan.h>
#include <simvis/frame_time.h>
#include <simvis/image.h>
#include <simvis/location.h>
#include <simvis/philox.h>

namespace simvis {

/// Where and when the pixels of an image look.
///
/// Frames   V = view frame: x right, y down, z forward, of the camera at the row's time.
struct CameraLayout {
  std::uint32_t width_px = 0, height_px = 0;
  Pinhole pinhole;                                             ///< fx, fy, cx, cy, also those of a distorted image
  std::string_view distortion_model = "plumb_bob";             ///< as ROS names it
  std::vector<double> distortion_coefficients{0, 0, 0, 0, 0};  ///< in ROS's order
  /// [y * width + x], V, unit length, through the pixel's centre; zero: the pixel sees nothing. Empty: the pinhole's.
  std::vector<glm::dvec3> rays{};
  double oversampling = 1;          ///< with rays: pixels rendered per pixel of the image, in its middle
  Location oversampling_at{};       ///< where that was written, for messages
  double row_time_s = 0;            ///< from one row to the next; the last one is taken at the frame's time
  std::uint32_t rows_per_pose = 1;  ///< with a row time: rows that share a pose, that of their middle

  /// Cosine of the angle between the optical axis and what a pixel looks at.
  double axis_cosine(std::uint32_t x, std::uint32_t y) const;
};

class CameraEffect {
 public:
  virtual ~CameraEffect() = default;

  virtual void configure_rays(CameraLayout&) const {}

  /// `color` as Image says; alpha stays 1.
  virtual void post_process(const FrameTime&, const CameraLayout&, Image& /*color*/) const {}
};

/// In which order effects are called at each stage: as light passes them. Those of one place by their names.
enum class CameraOrder : std::uint8_t { lens, shutter, aperture, exposure, electronics };

/// What an effect is made of.
struct CameraEffectContext {
  const AttributeValues& attributes;
  std::uint64_t seed = 0;
  std::string camera;        ///< the sensor's name; of a pair, with its side
  std::uint8_t outputs = 0;  ///< of EffectOutput, that the camera has

  /// The numbers of one effect of this camera, unrelated to those of its others.
  SensorRandom random(std::string_view effect) const { return {seed, camera + '/' + std::string(effect)}; }
};

struct CameraEffectType {
  EffectType type;  ///< its `sensors` are of "camera" and "stereo_camera"; the latter's are never laid out
  CameraOrder order = CameraOrder::electronics;
  /// Null where the sensor's attributes do not call for it. Throws InputError, with the place, where they contradict
  /// each other.
  std::unique_ptr<CameraEffect> (*create)(const CameraEffectContext& context);
};

/// As EffectRegistration.
struct CameraEffectRegistration {
  explicit CameraEffectRegistration(const CameraEffectType& type);
};

/// An effect that a camera has.
struct ChosenCameraEffect {
  const EffectType* type = nullptr;
  std::shared_ptr<const CameraEffect> effect;
};

/// What the attributes of a sensor of this type call for and its outputs can show, in the order in which they are
/// called.
std::vector<ChosenCameraEffect> camera_effects(std::string_view sensor_type, const CameraEffectContext& context);

}  // namespace simvis
