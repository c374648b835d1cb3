// The element `fog`: fills the air of the whole scene with haze, fog, rain, snow or dust, for cameras and lasers.
//
//   <element type="fog" name="WEATHER" insert_at="ROOT" kind="fog" visibility="50"/>
//
// Kinds    haze, fog and dust are set by `visibility`, rain by `rain_rate`, snow by `snow_rate`; dust also has
//          `grain_diameter`. An attribute of another kind is an error.
// Parameters  (live) visibility (m): the distance at which the contrast of a black object against the horizon has
//          fallen to 0.02, so that extinction = -ln(0.02) / visibility = 3.912 / visibility (Koschmieder, "Theorie der
//          horizontalen Sichtweite", Beitr. Phys. freien Atm. 12, 1924). rain_rate, snow_rate (mm/h of water): at 0 the
//          air is clear. grain_diameter (m): see Dust.
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
// Snow     Flakes of the melted diameter M have the distribution N0 exp(-L M). With the rate R in mm/h, N0 is
//          2500 R^-0.94 in 1/(m3 mm) and L is 22.9 R^-0.45 in 1/cm (Sekhon and Srivastava, "Snow size spectra and radar
//          reflectivity", J. Atmos. Sci. 27, 1970). A flake of the mass m has the cross-section S with m / mg = 0.012
//          (S / mm2)^1.5 (Sasyo and Matsuo, "On the statistical investigation of fall velocity of snowflakes", Pap.
//          Meteorol. Geophys. 31, 1980): it is as wide as a disc of kFlakeOverMelted M. It removes twice its
//          cross-section, as a drop does, and its lidar ratio is 25 sr, which retrievals assume for ice clouds (Young
//          and Vaughan, J. Atmos. Oceanic Technol. 26, 2009; not compared with the text). Those that were measured in
//          ice clouds vary much more: mostly 5 to 15 sr (Ansmann et al., Appl. Opt. 31, 1992), 19 to 74 sr (Larroza et
//          al., Atmos. Meas. Tech. 6, 2013).
// Dust     with a grain_diameter D0 has grains whose diameters are distributed exponentially with this mean, as many
//          as give its extinction, each with twice its cross-section: N = extinction / (pi D0^2). Which of them return
//          echoes of their own is for the scanner, see effects/scanner/atmosphere.h; the backscatter stays the same.
// Echo     A particle returns as much light as a matte disc of its diameter with the reflectance p. N of them with
//          exponential diameters have the backscatter N D0^2 p / 2, so that a lidar ratio S means p = 2 pi / S.
// Several  If a scene has several fog elements, the last one in traversal order applies.
#pragma once

#include <cstdint>
#include <memory>
#include <numbers>

#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {

/// The reflectance of a matte disc that returns as much light as a water drop of the same diameter. In geometric optics
/// the front of the drop reflects R and the back R (1 - R)^2 (n / (2 - n))^2 of what a mirroring sphere reflects
/// (paraxial rays; R at normal incidence, n = 1.33). A matte disc of reflectance p returns 4 p times the light of a
/// mirroring sphere.
inline constexpr double kDropReflectance = 0.0240;

/// The same of a flake: 2 pi / 25 sr.
inline constexpr double kFlakeReflectance = 2 * std::numbers::pi / 25;

/// The diameter of a disc with a flake's cross-section over the flake's melted diameter: sqrt(4 / pi) (pi / (6 x
/// 0.012))^(1/3).
inline constexpr double kFlakeOverMelted = 3.9725;

enum class FogKind : std::uint8_t { haze, fog, rain, snow, dust };

/// What a command `fog` says. Each kind has some of the numbers.
struct FogDesc {
  FogKind kind = FogKind::fog;
  double visibility_m = 200;
  double rain_mm_per_h = 10, snow_mm_per_h = 1;
  double grain_diameter_m = 0;
  glm::vec3 airlight{Medium().airlight};
};

class FogElement : public Element {
 public:
  /// Throws InputError at an attribute that the element's kind does not have.
  explicit FogElement(const ElementContext& context);
  void adapt_parameters(std::vector<AttributeSpec>& live_rows) const override;
  void update(ParameterView values) override;

 private:
  FogDesc desc_;
  std::shared_ptr<MediumNode> node_;
};

}  // namespace simvis
