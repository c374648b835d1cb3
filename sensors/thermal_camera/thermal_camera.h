// The sensor `thermal_camera`: a long-wave infrared camera with a microbolometer, which sees how warm surfaces are.
//
//   <sensor type="thermal_camera" name="THERMAL" insert_at="ROBOT" preset="lepton_3_5" outputs="temperature raw16"/>
//
// Frames   The camera looks along +x of its sensor frame; image x points to the right, y down. Pixels are square, and
//          the optical axis goes through the middle of the image.
// Radiance A surface with the temperature T and the emissivity e sends e L(T) + (1 - e) L(ambient) to the camera, where
//          L is the radiance of a black body from 8 to 14 um (band_radiance.h); where nothing is hit it is L(sky).
//          Elements `temperature` and `thermal_surroundings` set these numbers. A pixel is the mean of the radiance
//          over `footprint_rays` rays of its square.
// Rays     see surfaces from their front sides, as a camera does. A surface that covers anything is opaque, as window
//          glass is in this band; cut-outs of masks are holes.
// Detector see bolometer.h: time constant, fixed pattern and noise act on the radiance.
// Values   temperature: the apparent temperature in kelvin, that of the black body with this radiance; a surface of low
//          emissivity therefore appears about as warm as the surroundings. 0: less radiance than a black body of
//          kColdest_k has. It is at most kHottest_k.
//          raw16: the apparent temperature in steps of `kelvin_per_count`, rounded, from 0 to 65535 (FLIR's TLinear).
//          color: false colours of it (false_color.h), black at `color_min` and below, white at `color_max` and above;
//          without these attributes they are the lowest and the highest temperature of the frame.
// Limits   Emissivity does not depend on the angle, surroundings are the same on all sides, the air neither absorbs nor
//          glows. Through a lens, pixels that see nothing get no radiance.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <simvis/sensor.h>
#include <simvis/state_archive.h>
#include "sensors/camera/pinhole_view.h"
#include "sensors/camera/pixel_optics.h"
#include "sensors/camera/surface_layer.h"
#include "sensors/camera/surface_rays.h"
#include "sensors/described_sensor.h"
#include "sensors/thermal_camera/bolometer.h"

namespace simvis {

struct ThermalCameraDesc {
  PinholeDesc pinhole{.width_px = 160, .height_px = 120};
  std::uint32_t footprint_rays = 1;  ///< of each pixel, a square number
  BolometerDesc bolometer{};
  double kelvin_per_count = 0.01;
  std::optional<double> color_min_k{}, color_max_k{};  ///< empty: of the frame
  bool temperature = true, raw16 = false, color = false;
  std::vector<ChosenCameraEffect> effects{};  ///< of the lens
  std::uint64_t seed = 0;

  static AttributeRows<ThermalCameraDesc> rows();
  void complete(const SensorContext& context);
};

class ThermalCamera : public Sensor, public Stateful {
 public:
  ThermalCamera(std::string name, const ThermalCameraDesc& desc);

  bool draws() const override { return false; }
  HistoryDependence history_dependence() const override;
  SensorNeeds needs() const override { return {.heat = true}; }
  void archive(StateArchive& state) override { bolometer_.archive(state); }
  void sense(const SensedWorld& world) override { heat_ = world.heat(); }
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) override { moment_.time = time; }
  void cast(RayCaster& of_list) override;
  Measurement measurement() const override;
  std::string method() const override { return "raycast"; }

 private:
  void cast_rays(RayCaster& caster, const PixelFan& fan);
  double radiance_of(const SeenSurface& surface, const glm::dvec3& direction) const;
  double textured_radiance(const SeenSurface& surface, const glm::dvec3& direction, const SurfaceHeat& heat) const;
  void prepare_textures();
  void publish();

  std::string name_;
  ThermalCameraDesc desc_;
  PixelOptics optics_;
  std::vector<PixelFan> footprint_;   // made in the first frame
  std::vector<std::uint32_t> tiled_;  // all pixels, neighbours close together
  LayerWorld layer_world_;
  SurfaceRays rays_;
  Bolometer bolometer_;
  SensorMoment moment_, measured_;  // of this frame, of the last measurement
  glm::dmat4 world_from_view_{1.0};
  SensedHeat heat_{};
  const DrawList* list_ = nullptr;
  DrawList textured_list_;  // with the pictures of temperatures as materials; empty without any
  double ambient_radiance_ = 0, sky_radiance_ = 0;
  std::vector<double> emitted_;   // by surface of heat_, with what it reflects
  std::vector<double> radiance_;  // by pixel
  Image temperature_, color_;
  SharedArray<std::uint32_t> counts_;
};

}  // namespace simvis
