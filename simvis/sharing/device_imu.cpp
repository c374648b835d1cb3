#include "simvis/sharing/device_imu.h"

#include <algorithm>
#include <array>
#include <iterator>

#include <simvis/error.h>
#include <simvis/location.h>
#include "exchange/packets/ouster_packets.h"

namespace simvis {
namespace {

constexpr std::uint16_t kOusterImuPort = 7503;
constexpr std::array kForceNames{"specific_force_x_m_s2", "specific_force_y_m_s2", "specific_force_z_m_s2"},
    kTurnNames{"angular_velocity_x_rad_s", "angular_velocity_y_rad_s", "angular_velocity_z_rad_s"};

const BuiltSensor* sensor_named(const std::string& name, const BuiltScene& scene) {
  const auto found = std::ranges::find(scene.sensors, name, &BuiltSensor::name);
  return found == scene.sensors.end() ? nullptr : &*found;
}

/// Where a sensor is inserted, as its command says.
std::array<std::string, 2> place_of(const BuiltSensor& sensor) {
  std::array<std::string, 2> place;
  for (const CommandAttribute* const each : {sensor.command.find("insert_at"), sensor.command.find("pose_offset")}) {
    if (each != nullptr) place[each->name == "insert_at" ? 0 : 1] = each->value;
  }
  return place;
}

std::array<double, 3> numbers_of(const Measurement& measurement, const std::array<const char*, 3>& names) {
  std::array<double, 3> numbers{};
  for (std::size_t i = 0; i < names.size(); ++i) numbers[i] = measurement.value(names[i]).value_or(0);
  return numbers;
}

}  // namespace

DeviceImu::DeviceImu(const std::string& scanner, const BuiltScene& scene) {
  const std::string name = scanner + "_IMU";
  const BuiltSensor* const imu = sensor_named(name, scene);
  if (imu == nullptr) return;
  if (imu->type != "imu" || place_of(*imu) != place_of(*sensor_named(scanner, scene))) {
    throw InputError("sensor " + in_quotes(name) + " is not an imu at the place of " + in_quotes(scanner) +
                     ", expected type=\"imu\" with the same insert_at and pose_offset, or another name");
  }
  sensor_ = name;
}

void DeviceImu::measure(const Frame& frame) {
  const auto placed = std::ranges::find_if(frame.sensors, [&](const PlacedSensor& each) {
    return each.sensor.name == sensor_ && each.measurement != nullptr;
  });
  if (placed == frame.sensors.end()) return;
  const Measurement& measured = *placed->measurement;
  kept_.push_back(ouster_imu_packet({.specific_force_m_s2 = numbers_of(measured, kForceNames),
                                     .angular_velocity_rad_s = numbers_of(measured, kTurnNames)},
                                    measured.time_ns));
}

std::vector<DevicePacket> DeviceImu::until(std::int64_t time_ns) {
  const auto end = std::ranges::find_if(kept_, [&](const DevicePacket& each) { return each.time_ns > time_ns; });
  std::vector<DevicePacket> taken(std::make_move_iterator(kept_.begin()), std::make_move_iterator(end));
  kept_.erase(kept_.begin(), end);
  return taken;
}

std::uint16_t DeviceImu::port() const { return kOusterImuPort; }

}  // namespace simvis
