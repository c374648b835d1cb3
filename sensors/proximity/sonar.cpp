#include "sensors/proximity/sonar.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include <simvis/surface_point.h>
#include "sensors/range_limits.h"

namespace simvis {

namespace {

constexpr AttributeSpec kSonarCone[] = {
    {.name = "opening",
     .default_value = "25",
     .unit = "deg",
     .text = "full angle of the cone of sound",
     .min = 0,
     .max = 180,
     .open_min = true,
     .open_max = true},
    {.name = "rays",
     .kind = AttributeKind::integer,
     .default_value = "512",
     .text = "rays of equal solid angle in the cone",
     .min = 1,
     .max = 1e6},
    {.name = "lobe_exponent",
     .default_value = "30",
     .text = "how fast the echo falls with the angle of incidence: its cosine to this power",
     .min = 0},
    {.name = "threshold",
     .default_value = "0.002",
     .text = "echo that is detected; a wall across the cone returns about 1 at 1 m",
     .min = 0,
     .open_min = true},
    {.name = "pulse_length",
     .default_value = "0.02",
     .unit = "m",
     .text = "echoes within this difference of range add up",
     .min = 0},
};

AttributeTable sonar_attributes() {
  static const AttributeTable table = join_tables({{std::begin(kSonarCone), std::end(kSonarCone)},
                                                   range_limit_rows("0.15", "5"),
                                                   noise_rows("", "the range", "m"),
                                                   {kRateAttribute}});
  return table;
}

std::vector<TableColumn> sonar_columns() {
  return {{.name = "range_m",
           .format = "%.12g",
           .unit = "m",
           .meaning = "distance of the first echo; 0: nearer than range_min",
           .nothing = std::numeric_limits<double>::infinity()},
          {.name = "echo",
           .format = "%.9g",
           .meaning = "strength of that echo; 0: no echo reaches the threshold",
           .in_message = false}};
}

std::unique_ptr<Sensor> create_sonar(const SensorContext& context) {
  return std::make_unique<Sonar>(context.name, sonar_desc(context));
}

const SensorRegistration kSonarRegistration(
    {.name = "sonar",
     .summary = "An ultrasonic range sensor: a cone of sound, and the first echo that reaches a threshold.",
     .notes =
         "Each ray of the cone returns an echo that falls with the square of the range and with the angle of "
         "incidence. Slanted walls are therefore missed, and a wide cone reports its near edge.\nA range is inf if "
         "no echo reaches the threshold within range_max, and 0 if one does nearer than range_min.",
     .message = "sensor_msgs/msg/Range",
     .attributes = sonar_attributes(),
     .create = create_sonar,
     .outputs = [](const SensorContext& context) { return reading_outputs(context, sonar_columns()); }});

}  // namespace

SonarDesc sonar_desc(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  const auto [min_m, max_m] = read_range_limits(a);
  return {.opening_rad = glm::radians(a.number("opening")),
          .rays = static_cast<std::uint32_t>(a.integer("rays")),
          .range_min_m = min_m,
          .range_max_m = max_m,
          .lobe_exponent = a.number("lobe_exponent"),
          .threshold = a.number("threshold"),
          .pulse_length_m = a.number("pulse_length"),
          .noise = NoiseDesc::read(a, ""),
          .seed = context.seed};
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
    : RaySensor(sonar_columns(), std::move(name), "cone of sound of sonar", {"range", desc.noise, desc.seed},
                cone_directions(desc.opening_rad, desc.rays)),
      desc_(desc) {
  set_constant("radiation_type", kUltrasoundRange);
  set_constant("field_of_view_rad", desc.opening_rad);
  set_constant("range_min_m", desc.range_min_m);
  set_constant("range_max_m", desc.range_max_m);
}

void Sonar::cast(RayCaster& rays) {
  const std::span<const RayHit> hits = hits_of(rays);
  std::vector<SonarEcho> echoes;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (!(hits[i].range_m <= desc_.range_max_m)) continue;
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
  set_row({reported_range({desc_.range_min_m, desc_.range_max_m}, crossing.range_m), crossing.strength});
}

}  // namespace simvis
