// Effects on the image of a camera.
//
// An image passes through two stages, and an effect may take part in both:
//
//   configure_rays  once, before anything is rendered: the viewing ray of each pixel and the time of each row
//   post_process    for each image: changes its linear colour after rendering
//
// Without an effect that implements configure_rays(), the image is one pinhole view. Otherwise see
// sensors/camera/camera_views.h.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/camera_layout.h>
#include <simvis/effect.h>
#include <simvis/export.h>
#include <simvis/frame_plan.h>
#include <simvis/frame_time.h>
#include <simvis/image.h>
#include <simvis/location.h>
#include <simvis/philox.h>

namespace simvis {

/// One effect of one camera. It holds the effect's settings, and no state of the frame unless it remembers().
///
/// Threads  calls for one camera come from one thread at a time. Cameras of several simulations may be used in several
///          threads at once.
class SIMVIS_API CameraEffect {
 public:
  virtual ~CameraEffect() = default;

  /// Changes the layout that the camera and the effects before it have made.
  virtual void configure_rays(CameraLayout&) const {}

  /// Changes `color`, whose shape and units are those of Image. Alpha stays 1.
  virtual void post_process(const FrameTime&, const CameraLayout&, Image& /*color*/) const {}

  /// Whether an image depends on those before it. Its camera then leaves out none, and calls post_process() in the
  /// order of time; a time that is not after the last one repeats that image.
  virtual bool remembers() const { return false; }
};

/// The order in which effects are called at each stage: the order in which light and signal pass through a camera.
/// Effects with the same value are called in the order of their names.
enum class CameraOrder : std::uint8_t {
  lens,         ///< where pixels look: distortion
  shutter,      ///< when rows look: rolling shutter
  aperture,     ///< how much light passes: vignetting
  exposure,     ///< how much light is collected
  electronics,  ///< how the signal is read: noise
  mosaic        ///< which colour each pixel has read
};

/// What an effect's `create` function gets. It is valid during that call only.
struct CameraEffectContext {
  const AttributeValues& attributes;  ///< of the sensor's command
  std::uint64_t seed = 0;             ///< of all random numbers of the run
  std::string camera;                 ///< the sensor's name; for one camera of a stereo pair, with its side
  std::uint8_t outputs = 0;           ///< the outputs that the camera has, as a sum of EffectOutput

  /// The random numbers of one effect of this camera. They are independent of those of its other effects.
  SensorRandom random(std::string_view effect) const { return {seed, camera + '/' + std::string(effect)}; }
};

/// The description of a camera effect for the catalogue.
struct CameraEffectType {
  /// Its `needs` is kHasImageSensor, kHasLens, kHasPixelRays, or some of them. An effect that sets the rays of pixels
  /// in configure_rays() needs kHasLens; one that sets times of rows, or the exposure, needs kHasPixelRays, which
  /// depth, thermal and event cameras do not have.
  EffectType type;
  CameraOrder order = CameraOrder::electronics;  ///< when it is called
  /// Returns null if the sensor's attributes do not request the effect. Throws InputError, with the place, if they
  /// contradict each other.
  std::unique_ptr<CameraEffect> (*create)(const CameraEffectContext& context);
};

/// Adds a camera effect to the catalogue, under the rules of EffectRegistration.
struct SIMVIS_API CameraEffectRegistration {
  /// `built_for` is the version of the headers that the caller is compiled with.
  explicit CameraEffectRegistration(const CameraEffectType& type, std::string_view built_for = kHeaderVersion);
};

/// An effect that a camera has.
struct ChosenCameraEffect {
  const EffectType* type = nullptr;            ///< valid as long as the catalogue has the type
  std::shared_ptr<const CameraEffect> effect;  ///< never null in the result of camera_effects()

  bool operator==(const ChosenCameraEffect&) const = default;  ///< the same objects
};

/// The effects that the attributes of a sensor with these capabilities request and that its outputs can show, in
/// calling order. `capabilities` are those of its type.
///
/// Errors   InputError, with the place, if attributes of an effect contradict each other.
SIMVIS_API std::vector<ChosenCameraEffect> camera_effects(std::uint8_t capabilities,
                                                          const CameraEffectContext& context);

}  // namespace simvis
