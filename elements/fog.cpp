#include "elements/fog.h"

#include <cmath>
#include <numbers>

#include "scenegraph/language/attribute_rows.h"

namespace simvis {
namespace {

bool has_visibility(const FogDesc& fog) { return fog.kind != FogKind::rain && fog.kind != FogKind::snow; }

auto is_of(FogKind kind) {
  return [kind](const FogDesc& fog) { return fog.kind == kind; };
}

AttributeRows<FogDesc> fog_rows() {
  using Desc = FogDesc;
  return {
      row(&Desc::kind, "kind",
          {{FogKind::haze, "haze"},
           {FogKind::fog, "fog"},
           {FogKind::rain, "rain"},
           {FogKind::snow, "snow"},
           {FogKind::dust, "dust"}},
          "dry haze, droplets of fog, rain, snow or dust"),
      row(&Desc::visibility_m, "visibility", "m", {.min = 1, .max = 1e6},
          "haze, fog, dust: distance at which contrast has fallen to 0.02")
          .live()
          .only("for haze, fog and dust", has_visibility),
      row(&Desc::rain_mm_per_h, "rain_rate", "mm/h", {.min = 0, .max = 500}, "rain: rate of rainfall; 0 is clear air")
          .live()
          .only("for rain", is_of(FogKind::rain)),
      row(&Desc::snow_mm_per_h, "snow_rate", "mm/h", {.min = 0, .max = 50},
          "snow: rate of snowfall as water; 0 is clear air")
          .live()
          .only("for snow", is_of(FogKind::snow)),
      row(&Desc::grain_diameter_m, "grain_diameter", "m", {.min = 0, .max = 0.01},
          "dust: mean diameter of its grains, which then return echoes of their own where a laser detects them; "
          "0: they are too fine for that")
          .live()
          .only("for dust", is_of(FogKind::dust)),
      color_rows(&Desc::airlight, "airlight_", {.min = 0, .max = 1e12},
                 "linear radiance that the air scatters towards a camera, seen at infinity")};
}
const AttributeRows<FogDesc> kFogRows = fog_rows();

const ElementRegistration kFogRegistration({
    .name = "fog",
    .summary = "Fills the air of the whole scene with haze, fog, rain, snow or dust.",
    .notes = "Of several fog elements the last one counts. Cameras then show the effect fog, laser scanners the effect "
             "atmosphere. Each kind has only the parameters that it needs.",
    .attributes = kFogRows.table(),
    .create = create_element<FogElement>,
});

// The exponent q of the wavelength after Kim et al.
double wavelength_exponent(double visibility_m) {
  const double v = visibility_m / 1000;
  if (v > 50) return 1.6;
  if (v > 6) return 1.3;
  if (v > 1) return 0.16 * v + 0.34;
  if (v > 0.5) return v - 0.5;
  return 0;
}

Medium aerosol(FogKind kind, double visibility_m) {
  constexpr double kContrast = 0.02, kLaserOverVisible = 905.0 / 550;
  const double extinction = -std::log(kContrast) / visibility_m;
  const double q = kind == FogKind::dust ? 0 : wavelength_exponent(visibility_m);
  const double of_lasers = extinction * std::pow(kLaserOverVisible, -q);
  const double lidar_ratio_sr = kind == FogKind::fog ? 18.8 : kind == FogKind::haze ? 53 : 69;
  return {.extinction_per_m = extinction,
          .laser_extinction_per_m = of_lasers,
          .backscatter_per_m_sr = of_lasers / lidar_ratio_sr};
}

// Particles with exponential diameters: each removes twice its cross-section, and returns what a matte disc does.
Medium particles(double per_m3, double diameter_m, double disc_reflectance) {
  const double squares = per_m3 * diameter_m * diameter_m;
  const double extinction = std::numbers::pi * squares;
  return {.extinction_per_m = extinction,
          .laser_extinction_per_m = extinction,
          .backscatter_per_m_sr = squares * disc_reflectance / 2,
          .particles_per_m3 = per_m3,
          .particle_diameter_m = diameter_m};
}

Medium rain(double rate_mm_per_h) {
  if (rate_mm_per_h == 0) return {};
  constexpr double kN0 = 8000e3;  // 1/m^4
  const double diameter_m = std::pow(rate_mm_per_h, 0.21) / 4.1 * 1e-3;
  return particles(kN0 * diameter_m, diameter_m, kDropReflectance);
}

Medium snow(double rate_mm_per_h) {
  if (rate_mm_per_h == 0) return {};
  const double melted_m = std::pow(rate_mm_per_h, 0.45) / 2290;
  const double per_m3 = 2.5e6 * std::pow(rate_mm_per_h, -0.94) * melted_m;
  return particles(per_m3, kFlakeOverMelted * melted_m, kFlakeReflectance);
}

Medium dust(double visibility_m, double grain_m) {
  Medium medium = aerosol(FogKind::dust, visibility_m);
  if (grain_m == 0) return medium;
  medium.particles_per_m3 = medium.laser_extinction_per_m / (std::numbers::pi * grain_m * grain_m);
  medium.particle_diameter_m = grain_m;
  return medium;
}

Medium medium_of(const FogDesc& fog) {
  switch (fog.kind) {
    case FogKind::rain:
      return rain(fog.rain_mm_per_h);
    case FogKind::snow:
      return snow(fog.snow_mm_per_h);
    case FogKind::dust:
      return dust(fog.visibility_m, fog.grain_diameter_m);
    default:
      return aerosol(fog.kind, fog.visibility_m);
  }
}

}  // namespace

FogElement::FogElement(const ElementContext& context)
    : desc_(kFogRows.read(context.command, context.attributes)), node_(std::make_shared<MediumNode>(Medium())) {
  node_->name = context.command.require("name").value;
  context.scene.insert(context.command, node_);
}

void FogElement::adapt_parameters(std::vector<AttributeSpec>& live_rows) const { kFogRows.adapt(desc_, live_rows); }

// Clear air is the default Medium, as in a scene without this element.
void FogElement::update(ParameterView values) {
  kFogRows.set(desc_, values);
  Medium medium = medium_of(desc_);
  if (medium.extinction_per_m > 0) medium.airlight = desc_.airlight;
  node_->set_medium(medium);
}

}  // namespace simvis
