#include "simvis/sharing/device_scanner.h"

#include <algorithm>
#include <string_view>

#include <simvis/error.h>
#include <simvis/location.h>
#include <simvis/sensor.h>
#include "exchange/packets/ouster_packets.h"

namespace simvis {
namespace {

constexpr std::uint16_t kVelodynePort = 2368, kOusterPort = 7502;

const BuiltSensor& scanner_of(const std::string& name, const BuiltScene& scene) {
  const BuiltSensor* found = nullptr;
  std::string names;
  std::size_t scanners = 0;
  for (const BuiltSensor& each : scene.sensors) {
    if (each.sensor->scan() == nullptr) continue;
    ++scanners;
    names += (names.empty() ? "" : ", ") + each.name;
    if (name.empty() || each.name == name) found = &each;
  }
  if (found == nullptr) {
    throw InputError((name.empty() ? "the scene has no laser scanner" : in_quotes(name) + " is not a laser scanner") +
                     ", expected " + (names.empty() ? "a scanner with the beams of a device" : "one of: " + names));
  }
  if (name.empty() && scanners > 1) {
    throw InputError("the scene has several laser scanners, expected the name of one: " + names);
  }
  return *found;
}

}  // namespace

DeviceScanner::DeviceScanner(const std::string& sensor, const BuiltScene& scene) {
  const BuiltSensor& scanner = scanner_of(sensor, scene);
  sensor_ = scanner.name;
  table_ = scanner.sensor->scan()->beam_table;
  if (table_ == nullptr || table_->device == nullptr) {
    throw InputError(
        "sensor " + in_quotes(sensor_) +
        " does not have the beams of a device whose packets are known, expected pattern=\"device:NAME\", a "
        "preset of Velodyne or Ouster, or the metadata of an Ouster sensor");
  }
  const CommandAttribute* const reported = scanner.command.find("return");
  if (reported == nullptr) return;
  if (reported->value == "last") reported_ = VelodyneReturn::last;
  if (reported->value != "dual") return;
  if (!has_dual_packets(*table_->device)) {
    throw InputError("sensor " + in_quotes(sensor_) +
                     " has return=\"dual\", and packets with two returns are known of a "
                     "VLP-16 and of an HDL-32E only, expected another return");
  }
  reported_ = VelodyneReturn::dual;
}

std::vector<DevicePacket> DeviceScanner::packets(const Frame& frame) {
  const auto placed = std::ranges::find_if(frame.sensors, [&](const PlacedSensor& each) {
    return each.sensor.name == sensor_ && each.measurement != nullptr;
  });
  if (placed == frame.sensors.end()) return {};
  const Scan* const scan = placed->sensor.sensor->scan();
  if (scan == nullptr || scan->beam_table != table_ || scan->range_m.size() != table_->size()) return {};
  const std::uint32_t number = scans_++;
  if (table_->device->format == PacketFormat::ouster) return ouster_packets(*scan, *table_, number);
  return velodyne_packets(*scan, *table_, reported_);
}

std::uint16_t DeviceScanner::port() const {
  return table_->device->format == PacketFormat::ouster ? kOusterPort : kVelodynePort;
}

}  // namespace simvis
