// The sensor `beacon`: which beacons it receives, and where they are: RFID tags, infrared or radio beacons, markers.
//
//   <sensor type="beacon" name="RFID" insert_at="ROBOT" beacons="TAG_*" range_max="3" line_of_sight="no"/>
//
// Beacons  are the insertion points whose names match the pattern `beacons`, in which * stands for any text and ? for
//          any character; each part has one. A beacon that is switched off is not received.
// Received is a beacon whose origin is within range_max of the sensor and within the cone of `opening` about +x of the
//          sensor frame, and, with line_of_sight, that no surface hides. Surfaces within `radius` of the beacon's
//          origin belong to it and hide nothing.
// Values   a table with a row for each received beacon, in the order of their names: beacon, its number; range_m,
//          azimuth_rad (counter-clockwise about +z), elevation_rad; strength, 1 at 1 m and falling with the square of
//          the range. The number is the beacon's place by name among all that match the pattern, from 0 on; run.json
//          has the names of those that were received last.
// Noise    of the range: sensors/noise_model.h; the axis of the random numbers is the beacon's number. A noisy range is
//          at least 0.
// Message  sensor_msgs/PointCloud2.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <simvis/pose.h>
#include <simvis/reading_sensor.h>
#include "effects/reported_range.h"
#include "sensors/described_sensor.h"
#include "sensors/noise_model.h"

namespace simvis {
namespace {

struct BeaconDesc {
  std::string beacons = "*";
  double range_max_m = 10, opening_rad = glm::radians(360.0), radius_m = 0.05;
  bool line_of_sight = true;
  NoiseDesc noise{};
  std::uint64_t seed = 0;

  static AttributeRows<BeaconDesc> rows();
};

class BeaconSensor : public ReadingSensor {
 public:
  BeaconSensor(std::string name, const BeaconDesc& desc);

  SensorNeeds needs() const override { return {.points = desc_.beacons}; }
  void sense(const SensedWorld& world) override { points_ = world.points(); }
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) override { time_ = time; }
  void cast(RayCaster& rays) override;
  std::string method() const override { return desc_.line_of_sight ? "raycast" : "distance"; }
  SensorReport report() const override;

 private:
  std::string name_;
  BeaconDesc desc_;
  NoiseModel noise_;
  std::vector<SensedPoint> points_;  // of this frame; from cast() on, those that are received
  FrameTime time_;
};

const std::vector<TableColumn> kBeaconColumns{
    {.name = "beacon", .format = "%lld", .integer = true, .meaning = "number of the beacon; run.json has its name"},
    {.name = "range_m", .format = "%.12g", .unit = "m", .meaning = "distance to the beacon"},
    {.name = "azimuth_rad",
     .format = "%.12g",
     .unit = "rad",
     .meaning = "direction, counter-clockwise from +x about +z",
     .frame = "sensor"},
    {.name = "elevation_rad",
     .format = "%.12g",
     .unit = "rad",
     .meaning = "direction, positive upwards",
     .frame = "sensor"},
    {.name = "strength", .format = "%.9g", .meaning = "1 / range^2, with the range in metres; 0 at the beacon"}};

const SensorRegistration kBeaconRegistration(
    {.name = "beacon",
     .summary = "Which beacons are received, and where they are: RFID tags, infrared or radio beacons, markers.",
     .notes = "Beacons are the insertion points whose names match. A table has a row for each that is received.",
     .message = "sensor_msgs/msg/PointCloud2",
     .attributes = rows_of<BeaconDesc>().table(),
     .create = create_sensor<BeaconSensor, BeaconDesc>,
     .outputs = column_outputs_of<kBeaconColumns, false>});

}  // namespace

AttributeRows<BeaconDesc> BeaconDesc::rows() {
  using Desc = BeaconDesc;
  return {
      row(&Desc::beacons, AttributeKind::objects, "beacons",
          "names and patterns of the insertion points that are beacons; * stands for any text, ? for any character"),
      row(&Desc::range_max_m, "range_max", "m", kAboveZero, "largest distance at which a beacon is received"),
      row(&Desc::opening_rad, "opening", kDegrees, {.min = 0, .max = 360, .open_min = true},
          "full angle of the cone about +x in which beacons are received"),
      row(&Desc::line_of_sight, "line_of_sight", {{true, "yes"}, {false, "no"}},
          "yes: a surface between sensor and beacon hides it; no: it does not, as with radio"),
      row(&Desc::radius_m, "radius", "m", kNotNegative,
          "surfaces so near to a beacon's origin belong to it and hide nothing"),
      nested(&Desc::noise, noise_rows("", "the range", "m")),
      kRateAttribute};
}

BeaconSensor::BeaconSensor(std::string name, const BeaconDesc& desc)
    : ReadingSensor(kBeaconColumns, false),
      name_(std::move(name)),
      desc_(desc),
      noise_(desc.noise, {desc.seed, name_ + "/range"}) {}

void BeaconSensor::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  ReadingSensor::plan(world_from_sensor, list, plan);
  if (!desc_.line_of_sight || points_.empty()) return;
  plan.casts.push_back(
      {.name = name_, .reason = "lines of sight of beacon sensor " + name_, .max_rays = points_.size()});
}

void BeaconSensor::cast(RayCaster& rays) {
  const glm::dmat4 sensor_from_world = rigid_inverse(world_from_sensor());
  const double period_s = sample_period_s(rate_hz, time_);
  std::vector<double> values;
  std::erase_if(points_, [&](const SensedPoint& point) {
    const glm::dvec3 place_m(sensor_from_world * point.world_from_point[3]);
    const double range_m = glm::length(place_m);
    const glm::dvec3 way = range_m > 0 ? place_m / range_m : glm::dvec3(1, 0, 0);
    if (range_m > desc_.range_max_m || std::acos(std::clamp(way.x, -1.0, 1.0)) > desc_.opening_rad / 2) return true;
    if (desc_.line_of_sight) {
      RayHit hit;
      rays.cast(world_from_sensor(), {&way, 1}, {&hit, 1});
      if (hit.range_m < range_m - desc_.radius_m) return true;
    }
    values.insert(values.end(), {static_cast<double>(point.number),
                                 reported_range_m(noise_.apply(range_m, point.number, time_, period_s)),
                                 std::atan2(place_m.y, place_m.x), std::asin(std::clamp(way.z, -1.0, 1.0)),
                                 range_m > 0 ? 1 / (range_m * range_m) : 0});
    return false;
  });
  set_reading(time_, std::move(values));
}

SensorReport BeaconSensor::report() const {
  std::string names;
  for (const SensedPoint& point : points_) {
    names += (names.empty() ? "" : ", ") + std::to_string(point.number) + ": " + point.name;
  }
  return {.notes = {{"received", names}}, .explanation = ""};
}

}  // namespace simvis
