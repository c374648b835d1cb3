#include "elements/fog.h"

#include <cmath>
#include <numbers>

#include "scenegraph/language/attribute_rows.h"

namespace simvis {
namespace {

// Live rows in the order in which update() reads them. Each kind has one of the first two.
constexpr AttributeSpec kFogAttributes[] = {
    {.name = "kind",
     .kind = AttributeKind::choice,
     .default_value = "fog",
     .text = "dry haze, droplets of fog, rain, snow or dust",
     .choices = "haze fog rain snow dust"},
    {.name = "visibility",
     .default_value = "200",
     .unit = "m",
     .text = "haze, fog, dust: distance at which contrast has fallen to 0.02",
     .min = 1,
     .max = 1e6,
     .live = true},
    {.name = "rain_rate",
     .default_value = "10",
     .unit = "mm/h",
     .text = "rain: rate of rainfall; 0 is clear air",
     .min = 0,
     .max = 500,
     .live = true},
    {.name = "snow_rate",
     .default_value = "1",
     .unit = "mm/h",
     .text = "snow: rate of snowfall as water; 0 is clear air",
     .min = 0,
     .max = 50,
     .live = true},
    {.name = "grain_diameter",
     .default_value = "0",
     .unit = "m",
     .text = "dust: mean diameter of its grains, which then return echoes of their own where a laser detects them; 0: "
             "they are too fine for that",
     .min = 0,
     .max = 0.01,
     .live = true},
};
const AttributeRows<Medium> kAirlightRows =
    color_rows(&Medium::airlight, "airlight_", {.min = 0, .max = 1e12},
               "linear radiance that the air scatters towards a camera, seen at infinity");

const ElementRegistration kFogRegistration({
    .name = "fog",
    .summary = "Fills the air of the whole scene with haze, fog, rain, snow or dust.",
    .notes = "Of several fog elements the last one counts. Cameras then show the effect fog, laser scanners the effect "
             "atmosphere. Each kind has only the parameters that it needs.",
    .attributes = AttributeRows<Medium>{AttributeTable(kFogAttributes), kAirlightRows}.table(),
    .create = create_element<FogElement>,
});

bool has(std::string_view kind, std::string_view attribute) {
  if (attribute == "visibility") return kind != "rain" && kind != "snow";
  if (attribute == "snow_rate") return kind == "snow";
  if (attribute == "grain_diameter") return kind == "dust";
  if (attribute == "rain_rate") return kind == "rain";
  return true;
}

// The exponent q of the wavelength after Kim et al.
double wavelength_exponent(double visibility_m) {
  const double v = visibility_m / 1000;
  if (v > 50) return 1.6;
  if (v > 6) return 1.3;
  if (v > 1) return 0.16 * v + 0.34;
  if (v > 0.5) return v - 0.5;
  return 0;
}

Medium aerosol(std::string_view kind, double visibility_m) {
  constexpr double kContrast = 0.02, kLaserOverVisible = 905.0 / 550;
  const double extinction = -std::log(kContrast) / visibility_m;
  const double q = kind == "dust" ? 0 : wavelength_exponent(visibility_m);
  const double of_lasers = extinction * std::pow(kLaserOverVisible, -q);
  const double lidar_ratio_sr = kind == "fog" ? 18.8 : kind == "haze" ? 53 : 69;
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
  Medium medium = aerosol("dust", visibility_m);
  if (grain_m == 0) return medium;
  medium.particles_per_m3 = medium.laser_extinction_per_m / (std::numbers::pi * grain_m * grain_m);
  medium.particle_diameter_m = grain_m;
  return medium;
}

Medium medium_of(std::string_view kind, ParameterView values) {
  if (kind == "rain") return rain(values[0]);
  if (kind == "snow") return snow(values[0]);
  return kind == "dust" ? dust(values[0], values[1]) : aerosol(kind, values[0]);
}

}  // namespace

FogElement::FogElement(const ElementContext& context)
    : kind_(context.attributes.choice("kind")), node_(std::make_shared<MediumNode>(Medium())) {
  for (const CommandAttribute& attribute : context.command.attributes) {
    if (has(kind_, attribute.name)) continue;
    fail_at(attribute.where,
            "attribute " + in_quotes(attribute.name) + " is not allowed for a fog of the kind " + in_quotes(kind_));
  }
  node_->name = context.command.require("name").value;
  context.scene.insert(context.command, node_);
}

void FogElement::adapt_parameters(std::vector<AttributeSpec>& live_rows) const {
  std::erase_if(live_rows, [this](const AttributeSpec& row) { return !has(kind_, row.name); });
}

// Clear air is the default Medium, as in a scene without this element.
void FogElement::update(ParameterView values) {
  Medium medium = medium_of(kind_, values);
  if (medium.extinction_per_m > 0) kAirlightRows.set(medium, values.last(3));
  node_->set_medium(medium);
}

}  // namespace simvis
