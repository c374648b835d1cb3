// The sensor `magnetometer`: the magnetic flux density along three axes.
//
//   <sensor type="magnetometer" name="MAG" insert_at="ROBOT" model="dipole" latitude="49.44" longitude="7.75"/>
//
// Frame    the sensor frame: x forward, y left, z up.
// Models   given: the same field everywhere, in the world: the attribute `field`.
//          wmm2025: the World Magnetic Model at the place and in the `year`, see world_magnetic_model.h.
//          dipole: the earth's field as that of a magnetic dipole at its centre, by the three coefficients of degree 1
//          of the IGRF-13 for 2020.0: g10 = -29404.8 nT, g11 = -1450.9 nT, h11 = 4652.5 nT, with the radius 6371.2 km
//          (Alken et al., "International Geomagnetic Reference Field: the thirteenth generation", Earth, Planets and
//          Space 73:49, 2021). The true field differs from it by 10 to 30 per cent, and in direction by 10 degrees or
//          so. How the world stands on the earth: sensors/navigation/geodetic_origin.h.
// Values   field_{x,y,z}_t in tesla.
// Noise    sensors/noise_model.h; iron of the robot itself is a bias: bias_mean.
// Message  sensor_msgs/MagneticField.
#pragma once

#include <string>

#include <simvis/reading_sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/navigation/geodetic_origin.h"
#include "sensors/navigation/world_magnetic_model.h"
#include "sensors/noise_model.h"

namespace simvis {

enum class MagneticField : std::uint8_t { given, dipole, wmm2025 };

struct MagnetometerDesc {
  MagneticField model = MagneticField::given;
  glm::dvec3 field_t{0, 2e-5, -4.5e-5};  ///< of the model `given`, in the world
  GeodeticOrigin origin;
  double year = kMagneticModelFrom;  ///< of wmm2025
  NoiseDesc noise{};
  std::uint64_t seed = 0;

  static AttributeRows<MagnetometerDesc> rows();
};

/// The field of a model of the earth in tesla at a point of the world, in the world. `model` is not `given`.
glm::dvec3 earth_field_t(MagneticField model, const GeodeticOrigin& origin, double year, const glm::dvec3& point_m);

class Magnetometer : public ReadingSensor {
 public:
  Magnetometer(const std::string& name, const MagnetometerDesc& desc);

  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  std::string method() const override;

 private:
  glm::dvec3 true_field_t() const;

  MagnetometerDesc desc_;
  NoiseModel noise_;
};

}  // namespace simvis
