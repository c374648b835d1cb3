#include "elements/fog.h"

#include <cmath>
#include <numbers>

namespace simvis {
namespace {

constexpr AttributeSpec airlight(std::string_view name) {
  return {.name = name,
          .default_value = "0.7",
          .text = "linear radiance that the air scatters towards a camera, seen at infinity",
          .min = 0,
          .max = 1e12,
          .live = true};
}

// Live rows in the order in which update() reads them. Each kind has one of the first two.
constexpr AttributeSpec kFogAttributes[] = {
    {.name = "kind",
     .kind = AttributeKind::choice,
     .default_value = "fog",
     .text = "dry haze, droplets of fog, rain or dust",
     .choices = "haze fog rain dust"},
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
    airlight("airlight_red"),
    airlight("airlight_green"),
    airlight("airlight_blue"),
};

const ElementRegistration kFogRegistration({
    .name = "fog",
    .summary = "Fills the air of the whole scene with haze, fog, rain or dust.",
    .notes = "Of several fog elements the last one counts. Cameras then show the effect fog, laser scanners the effect "
             "atmosphere. Each kind has only the parameters that it needs.",
    .attributes = kFogAttributes,
    .create = [](const ElementContext& context) -> std::unique_ptr<Element> {
      return std::make_unique<FogElement>(context);
    },
});

bool has(std::string_view kind, std::string_view attribute) {
  if (attribute == "visibility") return kind != "rain";
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

Medium rain(double rate_mm_per_h) {
  if (rate_mm_per_h == 0) return {};
  constexpr double kN0 = 8000e3;  // 1/m^4
  const double diameter_m = std::pow(rate_mm_per_h, 0.21) / 4.1 * 1e-3;
  const double extinction = std::numbers::pi * kN0 * diameter_m * diameter_m * diameter_m;
  return {.extinction_per_m = extinction,
          .laser_extinction_per_m = extinction,
          .particles_per_m3 = kN0 * diameter_m,
          .particle_diameter_m = diameter_m};
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
  Medium medium = kind_ == "rain" ? rain(values[0]) : aerosol(kind_, values[0]);
  if (medium.extinction_per_m > 0) medium.airlight = glm::vec3(values[1], values[2], values[3]);
  node_->set_medium(medium);
}

}  // namespace simvis
