// The sensor `altimeter`: height above a reference, and its rate.
//
//   <sensor type="altimeter" name="ALT" insert_at="DRONE" reference="1.5" vertical_position_stddev="0.05"/>
//
// Values   vertical_position_m: z of the sensor's origin in the world less `reference`. vertical_velocity_m_s: the mean
//          since the previous frame of the simulation (Motion in <simvis/pose.h>). The names are those of SDF's
//          altimeter.
// Noise    of both: sensors/noise_model.h.
// Message  std_msgs/Float64 for each value.
#include <memory>
#include <string>

#include <simvis/reading_sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/noise_model.h"

namespace simvis {
namespace {

struct AltimeterDesc {
  double reference_m = 0;
  NoiseDesc position{}, velocity{};
  std::uint64_t seed = 0;

  static AttributeRows<AltimeterDesc> rows();
};

class Altimeter : public ReadingSensor {
 public:
  Altimeter(const std::string& name, const AltimeterDesc& desc);

  SensorNeeds needs() const override { return {.motion = true}; }
  void sense(const SensedWorld& world) override { velocity_mps_ = world.motion().velocity_mps.z; }
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  std::string method() const override { return "height"; }

 private:
  AltimeterDesc desc_;
  NoiseModel position_, velocity_;
  double velocity_mps_ = 0;
};

const std::vector<TableColumn> kAltimeterColumns{{.name = "vertical_position_m",
                                                  .format = "%.12g",
                                                  .unit = "m",
                                                  .meaning = "height above the reference",
                                                  .frame = "world"},
                                                 {.name = "vertical_velocity_m_s",
                                                  .format = "%.12g",
                                                  .unit = "m/s",
                                                  .meaning = "rate of the height",
                                                  .frame = "world"}};

const SensorRegistration kAltimeterRegistration({.name = "altimeter",
                                                 .summary = "The height above a reference, and its rate.",
                                                 .attributes = rows_of<AltimeterDesc>().table(),
                                                 .create = create_sensor<Altimeter, AltimeterDesc>,
                                                 .outputs = column_outputs_of<kAltimeterColumns>,
                                                 .sees_shapes = false});

}  // namespace

AttributeRows<AltimeterDesc> AltimeterDesc::rows() {
  using Desc = AltimeterDesc;
  return {row(&Desc::reference_m, "reference", "m", kAnyNumber, "height in the world that reads 0"),
          nested(&Desc::position, noise_rows("vertical_position_", "the height", "m")),
          nested(&Desc::velocity, noise_rows("vertical_velocity_", "the rate", "m/s")), kRateAttribute};
}

Altimeter::Altimeter(const std::string& name, const AltimeterDesc& desc)
    : ReadingSensor(kAltimeterColumns),
      desc_(desc),
      position_(desc.position, {desc.seed, name + "/position"}),
      velocity_(desc.velocity, {desc.seed, name + "/velocity"}) {}

void Altimeter::collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) {
  const double period_s = sample_period_s(rate_hz, time);
  set_reading(time, {position_.apply(world_from_sensor()[3].z - desc_.reference_m, 0, time, period_s),
                     velocity_.apply(velocity_mps_, 0, time, period_s)});
}

}  // namespace simvis
