// The effect `dropout`: beams are lost because too little light returns, or by chance.
//
// Law      A receiver reports an echo whose amplitude, including the Gaussian noise of the receiver, is above a
//          threshold. An echo of power P (see Echo) is therefore lost with the probability
//              erfc((P - T) / (s T sqrt(2))) / 2,    T = dropout_power,  s = dropout_noise
//          which is one half at P = T and falls from 0.98 to 0.02 within 2 s T on either side; with s = 0 it is a step.
//          As P = reflectance x cosine / range^2, dark, slanted or far surfaces are lost first. A data sheet's "10 %
//          reflectance up to 10 m" means T = 0.1 / 10^2 = 0.001 1/m^2.
//          After that each reading is lost with the probability `dropout`, independent of the surface.
// Several  Each echo of a beam is lost or kept independently; the remaining echo may be a weaker one.
// Special  A lost beam reads inf with a bound of 0, like a beam that hit nothing. A blocked beam keeps its 0.
// Reference  R. D. Richmond, S. C. Cain, Direct-Detection LADAR Systems, SPIE Tutorial Texts TT85 (2010): probability
//            of detection of a pulse in Gaussian noise.
#include <limits>

#include <simvis/scan_effect.h>
#include "effects/scanner/detection_law.h"

namespace simvis {
namespace {

constexpr AttributeSpec kDropoutAttributes[] = {
    {.name = "dropout",
     .default_value = "0",
     .text = "probability that a beam is lost, whatever it hits",
     .min = 0,
     .max = 1},
    {.name = "dropout_power",
     .default_value = "0",
     .unit = "1/m^2",
     .text = "half of the echoes of this power, reflectance x cosine / range^2, are lost; 0: none",
     .min = 0},
    {.name = "dropout_noise",
     .default_value = "0.1",
     .text = "standard deviation of the receiver's noise as a share of dropout_power; 0: a sharp threshold",
     .min = 0},
};

class Dropout : public ScanEffect {
 public:
  explicit Dropout(const ScanEffectContext& context)
      : by_chance_(context.attributes.number("dropout")),
        threshold_(context.attributes.number("dropout_power")),
        noise_(context.attributes.number("dropout_noise")),
        random_(context.random("dropout")) {}

  bool traces() const override { return threshold_ > 0; }

  void receive(const ScanContext& context, std::uint32_t beam, std::vector<Echo>& echoes) const override {
    if (threshold_ == 0) return;
    std::uint32_t draw = 0;  // draw 0 belongs to the reading, see finish()
    std::erase_if(echoes, [&](const Echo& echo) {
      return random_.uniform(random_key(context.time), beam, ++draw) < lost_share(echo.power, threshold_, noise_);
    });
  }

  void finish(const ScanContext& context, std::span<const Echo>, Scan& scan) const override {
    if (by_chance_ == 0) return;
    const auto [ranges_m, bounds_m] = scan.edit_ranges();
    for (std::uint32_t beam = 0; beam < ranges_m.size(); ++beam) {
      if (ranges_m[beam] == 0) continue;
      if (random_.uniform(random_key(context.time), beam, 0) >= by_chance_) continue;
      ranges_m[beam] = std::numeric_limits<float>::infinity();
      bounds_m[beam] = 0;
    }
  }

 private:
  double by_chance_, threshold_, noise_;
  SensorRandom random_;
};

const ScanEffectRegistration kDropoutRegistration({
    .type =
        {.name = "dropout",
         .summary = "Beams are lost because too little light returns, or by chance.",
         .notes =
             "An echo of power P is lost with the probability erfc((P - T) / (s T sqrt 2)) / 2, where T is "
             "dropout_power and s is dropout_noise: an amplitude with Gaussian noise against a threshold. "
             "dropout_power follows beams. A target of 10 % reflectance that is detected up to 10 m means T = 0.001.",
         .source = "attribute dropout or dropout_power above 0",
         .outputs = kShownInRanges,
         .reference = "detection of a pulse in Gaussian noise: Richmond and Cain, Direct-Detection LADAR Systems "
                      "(SPIE 2010)",
         .needs = kCastsBeams,
         .attributes = kDropoutAttributes},
    .order = ScanOrder::disturbance,
    .create = [](const ScanEffectContext& context) -> std::unique_ptr<ScanEffect> {
      const AttributeValues& a = context.attributes;
      if (a.number("dropout") == 0 && a.number("dropout_power") == 0) return nullptr;
      return std::make_unique<Dropout>(context);
    },
});

}  // namespace
}  // namespace simvis
