// The sensor `tof_camera`: a time-of-flight camera, which measures the phase of modulated light in every pixel.
//
//   <sensor type="tof_camera" name="TOF" insert_at="ROBOT" frequency="30e6" outputs="depth amplitude"/>
//
// Frames   The camera looks along +x of its sensor frame; image x points to the right, y down. Its light stands at the
//          same point and shines evenly into the field of view of the image, and nowhere else.
// Model    A path of light of the length l from the lamp to the pixel adds the phasor a exp(2 pi i f l / c), with the
//          modulation frequency f. The direct path to a surface at range r has l = 2 r and a = R cos(i) / r^2: R is its
//          reflectance as for laser scanners, i the angle of incidence. The unit of a is therefore that of a white
//          surface that faces the camera at 1 m. A pixel is the mean over `footprint_rays` rays of its square, so that
//          one that sees two objects measures something between or beside them. A path with one bounce, from the lamp
//          to Q, to P and to the pixel, is estimated by `bounce_rays` rays from each P, distributed by the cosine of
//          their angle to the normal:
//              a = R_P mean(R_Q cos(i_Q) / r_Q^2),   l = r_Q + |Q P| + r_P,
//          for those Q that the lamp lights on the side that P sees. Their estimate has a standard error that falls
//          with the root of their number; the rays of a pixel are the same in every frame.
// Samples  With the sum p of the phasors and the sum s of all a, the pixel takes four samples, in electrons:
//              C_k = signal_e (s + contrast |p| cos(arg p - k pi / 2)) + ambient_e,   k = 0..3,
//          each with shot noise and `read_noise_e`. The phase is atan2(C_1 - C_3, C_0 - C_2), and the range
//          c phase / (4 pi f), from 0 to c / (2 f), where it begins again. The standard deviation of a range is
//          c / (4 pi f) sqrt((C + read_noise_e^2) / 2) / (signal_e contrast |p|), with the mean C of the samples. With
//          signal_e 0 there is no noise. The amplitude is half the length of the vector of the differences, in the unit
//          of a.
// Values   Depth is the range times the cosine of the ray through the pixel's centre to the axis. Range and depth are
//          +infinity where nothing returns light, and where the amplitude is below `amplitude_min`.
// Lens     With a lens the light shines into the field of view that the lens shows. Depth is negative behind the
// camera. Limits   One frequency, no harmonics, no stray light in the lens, one bounce.
#pragma once

#include <complex>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <simvis/philox.h>
#include <simvis/sensor.h>
#include "engine/draw/splat_item.h"
#include "sensors/camera/pinhole_view.h"
#include "sensors/camera/pixel_optics.h"
#include "sensors/described_sensor.h"

namespace simvis {

struct TofCameraDesc {
  PinholeDesc pinhole{.width_px = 176, .height_px = 144};
  double frequency_hz = 30e6;
  double signal_e = 0, contrast = 1, ambient_e = 0, read_noise_e = 0;  ///< signal_e 0: no noise
  double amplitude_min = 0;
  std::uint32_t footprint_rays = 1;  ///< of each pixel, a square number
  std::uint32_t bounce_rays = 0;     ///< of each of these
  bool depth = true, range = false, amplitude = false;
  std::vector<ChosenCameraEffect> effects{};  ///< of the lens
  std::uint64_t seed = 0;

  static AttributeRows<TofCameraDesc> rows();
  void complete(const SensorContext& context);

  /// Where ranges begin again at 0.
  double wrap_m() const;
};

class TofCamera : public Sensor {
 public:
  TofCamera(std::string name, const TofCameraDesc& desc);

  bool draws() const override { return false; }
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) override { moment_.time = time; }
  void cast(RayCaster& caster) override;
  Measurement measurement() const override;
  std::string method() const override { return "raycast"; }

 private:
  /// Light that returns to a pixel.
  struct Light {
    std::complex<double> phasor;
    double sum = 0;
  };
  /// The hit of a ray that begins at this range from the origin of the view.
  struct ViewHit {
    RayHit hit;
    double begins_m = 0;
    double range_m() const { return begins_m + hit.range_m; }
  };
  /// A surface that the camera sees.
  struct LitPoint {
    std::uint32_t pixel;
    glm::dvec3 point_m, normal;  // view frame
    double range_m, reflectance;
  };
  /// Light with one bounce, if the lamp shines on lit_m.
  struct Path {
    std::uint32_t pixel;
    glm::dvec3 lit_m;  // view frame
    double amplitude, length_m;
  };
  void add(std::uint32_t pixel, double amplitude, double length_m);
  /// Splats return the light of the lamp, and reflect none to other surfaces.
  bool is_splat(const RayHit& hit) const { return is_splat_item(*list_, hit.item); }
  /// Casts rays of the view. Nothing at or before near_m counts, splats included.
  std::vector<ViewHit> cast_view(RayCaster& caster, std::span<const glm::dvec3> directions,
                                 std::span<const double> near_m) const;
  std::vector<LitPoint> cast_direct(RayCaster& caster, const PixelFan& fan);
  std::vector<Path> cast_bounce(RayCaster& caster, const std::vector<LitPoint>& lit, std::uint32_t ray,
                                std::uint32_t bounce) const;
  void add_lit(RayCaster& caster, const std::vector<Path>& paths);
  std::complex<double> sampled(std::uint32_t pixel) const;
  void publish();

  std::string name_;
  TofCameraDesc desc_;
  PixelOptics optics_;
  std::vector<PixelFan> footprint_;  // made in the first frame
  SensorRandom noise_, bounces_;
  SensorMoment moment_, measured_;  // of this frame, of the last measurement
  const DrawList* list_ = nullptr;
  std::vector<Light> lights_;  // by pixel
  Image depth_, range_, amplitude_;
};

}  // namespace simvis
