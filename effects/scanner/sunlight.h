// The effect `sunlight`: the light of the scene raises the noise of a scanner's receiver, so that weak echoes are lost.
//
//   <sensor type="laser_scanner" ... sunlight="3" dropout_power="1e-4"/>
//
// Light    The receiver sees the part of the scene that its beam lights up. Of each ray of the beam, with its share of
//          the light, that is the radiance L of what the ray meets, in the unit of pictures: of a surface with the
//          reflectance p, p (ambient + sum of E cos t / pi) over the directional lights of the scene that no part
//          hides, with the irradiance E at a right angle and the angle t from the normal; of a Gaussian splat, which
//          has its own light, its colour; of the sky, its background.
// Noise    Photons of this light arrive by chance. Their shot noise has a variance in proportion to their number, and
//          is independent of the receiver's own noise: the deviation of both is q = sqrt(1 + sunlight L) times that of
//          the receiver alone. So `sunlight` is the variance that the radiance 1, of a white surface with the
//          irradiance pi, adds in units of the receiver's own.
// Loss     A receiver keeps its rate of false alarms: its threshold rises with the noise. An echo of power P is lost
//          with the probability of the effect `dropout` for the threshold q T:
//              erfc((P - q T) / (q s T sqrt(2))) / 2,    T = dropout_power,  s = dropout_noise
//          Without dropout_power, T is the power of a surface of reflectance 0.1 at range_max. As P falls with the
//          square of the range, a range of R in the dark is one of R / sqrt(q). A data sheet with both ranges therefore
//          says sunlight L = (R_dark / R_light)^4 - 1.
// With `dropout`  that effect keeps an echo with the probability k(T), and this one with k(q T) / k(T).
// Limits   Light of point and spot lights, of the air, of other surfaces and of the sun's own disc is left out, and so
//          are false alarms. What a mirror or a pane shows counts as the beam's own light does there.
// Reference  R. D. Richmond, S. C. Cain, Direct-Detection LADAR Systems, SPIE Tutorial Texts TT85 (2010): background
//            light, shot noise, detection of a pulse in Gaussian noise.
#pragma once

#include <vector>

#include <simvis/scan_effect.h>

namespace simvis {

class Sunlight : public ScanEffect {
 public:
  explicit Sunlight(const ScanEffectContext& context);

  bool traces() const override { return true; }
  void aim(const ScanContext& context, std::vector<BeamRay>& rays) const override;
  void meet(const ScanContext& context, const BeamRay& ray, const SurfacePoint& surface, Echo& echo,
            std::vector<BeamRay>& onward) const override;
  void receive(const ScanContext& context, std::uint32_t beam, std::vector<Echo>& echoes) const override;

 private:
  // A directional light, in the frame of the sensor.
  struct Sun {
    glm::dvec3 towards{0};
    double irradiance = 0;
  };
  // The radiance that a light gives to a beam, unless something hides it.
  struct Lit {
    std::uint32_t beam = 0;
    double radiance = 0;
  };

  double noise(const ScanContext& context, std::uint32_t beam) const;

  double sunlight_, threshold_, spread_;
  bool has_dropout_;
  SensorRandom random_;
  // These are of the scan that is being taken.
  mutable std::vector<Sun> suns_;
  mutable std::vector<Lit> lit_;          // by question
  mutable std::vector<double> radiance_;  // by beam, without lit_
  mutable std::vector<double> sky_;       // by beam: the share of its light that met nothing
  mutable bool counted_ = false;          // whether lit_ is in radiance_
};

}  // namespace simvis
