// The element `fog`: fills the air of the whole scene with haze, fog, dust or rain, for cameras and lasers.
//
//   <element type="fog" name="WEATHER" insert_at="ROOT" kind="fog" visibility="50"/>
//
// Kinds    haze, fog and dust are set by `visibility`, rain is set by `rain_rate`. The attribute of the other group is
//          an error.
// Parameters  (live) visibility (m): the distance at which the contrast of a black object against the horizon has
//          fallen to 0.02, so that extinction = -ln(0.02) / visibility = 3.912 / visibility (Koschmieder, "Theorie der
//          horizontalen Sichtweite", Beitr. Phys. freien Atm. 12, 1924). rain_rate (mm/h): at 0 the air is clear.
//          airlight_red airlight_green airlight_blue: the linear radiance that the air scatters towards a camera along
//          an infinitely long path.
// Lasers   have an assumed wavelength of 905 nm. For haze and fog the extinction is multiplied by (905 nm / 550 nm)^-q,
//          where q depends on the visibility after Kim, McArthur and Korevaar, "Comparison of laser beam propagation at
//          785 nm and 1550 nm in fog and haze", Proc. SPIE 4214, 2001. Dust is coarse, so q = 0. The backscatter per
//          metre and steradian is the extinction divided by the lidar ratio: 18.8 sr for droplets (O'Connor,
//          Illingworth and Hogan, J. Atmos. Oceanic Technol. 21, 2004), 53 sr for haze (Mueller et al., J. Geophys.
//          Res. 112, D16202, 2007), 69 sr for dust (Haarig et al., Atmos. Chem. Phys. 22, 2022).
// Rain     Drops of diameter D have the distribution N0 exp(-D / D0), with N0 = 8000 /(m3 mm) and D0 = (rate /
//          (mm/h))^0.21 / 4.1 mm (Marshall and Palmer, "The distribution of raindrops with size", J. Meteorol. 5,
//          1948). Each drop removes twice its cross-section from a beam of any wavelength (van de Hulst, "Light
//          Scattering by Small Particles", 1957, section 8.22), so that extinction = pi N0 D0^3.
// Several  If a scene has several fog elements, the last one in traversal order applies.
#pragma once

#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {

class FogElement : public Element {
 public:
  /// Throws InputError at an attribute that the element's kind does not have.
  explicit FogElement(const ElementContext& context);
  void adapt_parameters(std::vector<AttributeSpec>& live_rows) const override;
  void update(ParameterView values) override;

 private:
  std::string kind_;
  std::shared_ptr<MediumNode> node_;
};

}  // namespace simvis
