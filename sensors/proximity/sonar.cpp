#include "sensors/proximity/sonar.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include <simvis/surface_point.h>

namespace simvis {

namespace {

const std::vector<TableColumn> kSonarColumns{{.name = "range_m",
                                              .format = "%.12g",
                                              .unit = "m",
                                              .meaning = "distance of the first echo; 0: nearer than range_min",
                                              .nothing = std::numeric_limits<double>::infinity()},
                                             {.name = "echo",
                                              .format = "%.9g",
                                              .meaning = "strength of that echo; 0: no echo reaches the threshold",
                                              .in_message = false}};

const SensorRegistration kSonarRegistration(
    {.name = "sonar",
     .summary = "An ultrasonic range sensor: a cone of sound, and the first echo that reaches a threshold.",
     .notes =
         "Each ray of the cone returns an echo that falls with the square of the range and with the angle of "
         "incidence. Slanted walls are therefore missed, and a wide cone reports its near edge.\nA range is inf if "
         "no echo reaches the threshold within range_max, and 0 if one does nearer than range_min.",
     .capabilities = kSeesSplats | kRaysHitSplats,
     .message = "sensor_msgs/msg/Range",
     .attributes = rows_of<SonarDesc>().table(),
     .create = create_sensor<Sonar, SonarDesc>,
     .outputs = column_outputs_of<kSonarColumns>});

}  // namespace

AttributeRows<SonarDesc> SonarDesc::rows() {
  using Desc = SonarDesc;
  return {
      row(&Desc::opening_rad, "opening", kDegrees, {.min = 0, .max = 180, .open_min = true, .open_max = true},
          "full angle of the cone of sound"),
      row(&Desc::rays, "rays", "", {.min = 1, .max = 1e6}, "rays of equal solid angle in the cone"),
      row(&Desc::lobe_exponent, "lobe_exponent", "", kNotNegative,
          "how fast the echo falls with the angle of incidence: its cosine to this power"),
      row(&Desc::threshold, "threshold", "", kAboveZero,
          "echo that is detected; a wall across the cone returns about 1 at 1 m"),
      row(&Desc::pulse_length_m, "pulse_length", "m", kNotNegative, "echoes within this difference of range add up"),
      nested(&Desc::limits, range_limit_rows()),
      nested(&Desc::noise, noise_rows("", "the range", "m")),
      kRateAttribute};
}

std::vector<glm::dvec3> cone_directions(double opening_rad, std::uint32_t count) {
  const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0)), height = 1 - std::cos(opening_rad / 2);
  std::vector<glm::dvec3> directions;
  directions.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const double x = 1 - height * (i + 0.5) / count, radius = std::sqrt(1 - x * x), angle = i * golden_angle;
    directions.push_back(glm::normalize(glm::dvec3(x, radius * std::cos(angle), radius * std::sin(angle))));
  }
  return directions;
}

SonarEcho first_crossing(std::vector<SonarEcho> echoes, double threshold, double pulse_length_m) {
  std::ranges::sort(echoes, {}, &SonarEcho::range_m);
  double sum = 0;
  for (std::size_t last = 0, first = 0; last < echoes.size(); ++last) {
    sum += echoes[last].strength;
    for (; echoes[first].range_m < echoes[last].range_m - pulse_length_m; ++first) sum -= echoes[first].strength;
    if (sum >= threshold) return {echoes[last].range_m, sum};
  }
  return {std::numeric_limits<double>::infinity(), 0};
}

Sonar::Sonar(std::string name, const SonarDesc& desc)
    : RaySensor(kSonarColumns, std::move(name), "cone of sound of sonar", {"range", desc.noise, desc.seed},
                cone_directions(desc.opening_rad, desc.rays)),
      desc_(desc) {
  set_constant("radiation_type", kUltrasoundRange);
  set_constant("field_of_view_rad", desc.opening_rad);
  set_constant("range_min_m", desc.limits.min_m);
  set_constant("range_max_m", desc.limits.max_m);
}

void Sonar::cast(RayCaster& rays) {
  const std::span<const RayHit> hits = hits_of(rays);
  std::vector<SonarEcho> echoes;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (!(hits[i].range_m <= desc_.limits.max_m)) continue;
    const glm::dvec3& direction = directions()[i];
    const SurfacePoint point = surface_point(list(), world_from_sensor(), direction, hits[i]);
    const double cosine = std::max(0.0, -glm::dot(point.normal, direction));
    // A surface that touches the sensor would return without limit.
    const double range_m = std::max(hits[i].range_m, 1e-3);
    const double strength = std::pow(cosine, desc_.lobe_exponent) / (range_m * range_m) / desc_.rays;
    echoes.push_back({hits[i].range_m, strength});
  }
  const SonarEcho crossing = first_crossing(std::move(echoes), desc_.threshold, desc_.pulse_length_m);
  set_constant("range_variance", white_variance());
  set_row({reported_range(desc_.limits, crossing.range_m), crossing.strength});
}

}  // namespace simvis
