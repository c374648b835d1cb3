#include "sensors/navigation/magnetometer.h"

#include <GeographicLib/Geocentric.hpp>
#include <algorithm>
#include <memory>
#include <string_view>

namespace simvis {

namespace {

AttributeTable magnetometer_attributes() {
  static const AttributeTable table =
      join_tables({{{.name = "model",
                     .kind = AttributeKind::choice,
                     .default_value = "given",
                     .text = "given: the field of the attribute field; wmm2025: the World Magnetic Model; dipole: the "
                             "earth's dipole",
                     .choices = "given wmm2025 dipole"},
                    {.name = "year",
                     .default_value = "2025",
                     .text = "wmm2025: the date, in years",
                     .min = kMagneticModelFrom,
                     .max = kMagneticModelTo},
                    {.name = "field",
                     .kind = AttributeKind::vector,
                     .default_value = "0 2e-5 -4.5e-5",
                     .unit = "T",
                     .text = "given: magnetic flux density in the world; north is y where x is east"}},
                   geodetic_rows(),
                   noise_rows("", "the flux density", "T"),
                   {kRateAttribute}});
  return table;
}

std::vector<TableColumn> magnetometer_columns() {
  return {{.name = "field_x_t",
           .format = "%.12g",
           .unit = "T",
           .meaning = "magnetic flux density along x",
           .frame = "sensor"},
          {.name = "field_y_t",
           .format = "%.12g",
           .unit = "T",
           .meaning = "magnetic flux density along y",
           .frame = "sensor"},
          {.name = "field_z_t",
           .format = "%.12g",
           .unit = "T",
           .meaning = "magnetic flux density along z",
           .frame = "sensor"}};
}

std::unique_ptr<Sensor> create_magnetometer(const SensorContext& context) {
  return std::make_unique<Magnetometer>(context.name, magnetometer_desc(context));
}

const SensorRegistration kMagnetometerRegistration(
    {.name = "magnetometer",
     .summary = "The magnetic flux density along three axes: of a given field, or of the earth.",
     .notes =
         "The World Magnetic Model holds from 2025.0 to 2030.0. The dipole has the coefficients of degree 1 of the "
         "IGRF-13 for 2020, and errors of 10 to 30 per cent.",
     .message = "sensor_msgs/msg/MagneticField",
     .attributes = magnetometer_attributes(),
     .create = create_magnetometer,
     .outputs = [](const SensorContext& context) { return reading_outputs(context, magnetometer_columns()); }});

// In the order of MagneticField.
constexpr std::string_view kModelNames[] = {"given", "dipole", "wmm2025"};

// In the earth's frame, at a place in it.
glm::dvec3 dipole_field_t(const glm::dvec3& place_m) {
  const glm::dvec3 moment_t = 1e-9 * glm::dvec3(-1450.9, 4652.5, -29404.8);  // g11, h11, g10
  constexpr double kRadius_m = 6371.2e3;
  const double distance_m = glm::length(place_m);
  const glm::dvec3 outwards = place_m / distance_m;
  const double ratio = kRadius_m / distance_m;
  return ratio * ratio * ratio * (3 * glm::dot(moment_t, outwards) * outwards - moment_t);
}

}  // namespace

MagnetometerDesc magnetometer_desc(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  const auto& field = a.vector("field");
  return {.model = static_cast<MagneticField>(std::ranges::find(kModelNames, a.choice("model")) - kModelNames),
          .field_t = {field[0], field[1], field[2]},
          .origin = read_geodetic_origin(a),
          .year = a.number("year"),
          .noise = NoiseDesc::read(a, ""),
          .seed = context.seed};
}

glm::dvec3 earth_field_t(MagneticField model, const GeodeticOrigin& origin, double year, const glm::dvec3& point_m) {
  glm::dvec3 place_m;
  std::vector<double> rotation(9);  // by rows: geocentric from east, north, up
  GeographicLib::Geocentric::WGS84().Forward(origin.latitude_deg, origin.longitude_deg, origin.elevation_m, place_m.x,
                                             place_m.y, place_m.z, rotation);
  const glm::dmat3 local_from_earth(rotation[0], rotation[1], rotation[2], rotation[3], rotation[4], rotation[5],
                                    rotation[6], rotation[7], rotation[8]);
  place_m += glm::transpose(local_from_earth) * origin.to_east_north_up(point_m);
  const glm::dvec3 field_t =
      model == MagneticField::dipole ? dipole_field_t(place_m) : world_magnetic_model_t(place_m, year);
  return origin.from_east_north_up(local_from_earth * field_t);
}

Magnetometer::Magnetometer(const std::string& name, const MagnetometerDesc& desc)
    : ReadingSensor(magnetometer_columns()), desc_(desc), noise_(desc.noise, {desc.seed, name + "/field"}) {}

std::string Magnetometer::method() const { return std::string(kModelNames[static_cast<std::size_t>(desc_.model)]); }

glm::dvec3 Magnetometer::true_field_t() const {
  if (desc_.model == MagneticField::given) return desc_.field_t;
  return earth_field_t(desc_.model, desc_.origin, desc_.year, glm::dvec3(world_from_sensor()[3]));
}

void Magnetometer::collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) {
  const glm::dvec3 field_t = glm::transpose(glm::dmat3(world_from_sensor())) * true_field_t();
  const double period_s = sample_period_s(rate_hz, time);
  set_constant("field_variance", desc_.noise.white_variance(period_s));
  set_reading(time, {noise_.apply(field_t.x, 0, time, period_s), noise_.apply(field_t.y, 1, time, period_s),
                     noise_.apply(field_t.z, 2, time, period_s)});
}

}  // namespace simvis
