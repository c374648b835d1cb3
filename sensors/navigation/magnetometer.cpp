#include "sensors/navigation/magnetometer.h"

#include <GeographicLib/Geocentric.hpp>
#include <algorithm>
#include <memory>
#include <string_view>

namespace simvis {

namespace {

const AttributeWords<MagneticField> kMagneticFields{
    {MagneticField::given, "given"}, {MagneticField::wmm2025, "wmm2025"}, {MagneticField::dipole, "dipole"}};

const std::vector<TableColumn> kMagnetometerColumns{{.name = "field_x_t",
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

const SensorRegistration kMagnetometerRegistration(
    {.name = "magnetometer",
     .summary = "The magnetic flux density along three axes: of a given field, or of the earth.",
     .notes =
         "The World Magnetic Model holds from 2025.0 to 2030.0. The dipole has the coefficients of degree 1 of the "
         "IGRF-13 for 2020, and errors of 10 to 30 per cent.",
     .message = "sensor_msgs/msg/MagneticField",
     .attributes = rows_of<MagnetometerDesc>().table(),
     .create = create_sensor<Magnetometer, MagnetometerDesc>,
     .outputs = column_outputs_of<kMagnetometerColumns>,
     .sees_shapes = false});

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

AttributeRows<MagnetometerDesc> MagnetometerDesc::rows() {
  using Desc = MagnetometerDesc;
  return {
      row(&Desc::model, "model", kMagneticFields,
          "given: the field of the attribute field; wmm2025: the World Magnetic Model; dipole: the earth's dipole"),
      row(&Desc::year, "year", "", {.min = kMagneticModelFrom, .max = kMagneticModelTo}, "wmm2025: the date, in years"),
      row(&Desc::field_t, "field", "T", kAnyNumber,
          "given: magnetic flux density in the world; north is y where x is east"),
      nested(&Desc::origin, geodetic_rows()),
      nested(&Desc::noise, noise_rows("", "the flux density", "T")),
      kRateAttribute};
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
    : ReadingSensor(kMagnetometerColumns), desc_(desc), noise_(desc.noise, {desc.seed, name + "/field"}) {}

std::string Magnetometer::method() const { return std::string(word_of(kMagneticFields, desc_.model)); }

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
