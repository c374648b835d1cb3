// Made-up values for every field of a message, and all fields as JSON, by the names of fields.
#pragma once

#include <cstdio>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "exchange/messages/cdr.h"
#include "exchange/messages/types/event_types.h"
#include "exchange/messages/types/follow_types.h"
#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/livox_types.h"
#include "exchange/messages/types/marker_types.h"
#include "exchange/messages/types/sensor_types.h"
#include "exchange/messages/types/system_types.h"
#include "exchange/messages/types/vision_types.h"

namespace simvis::ros::test {

/// Calls action.operator()<M>() for each type of ROS 2 that SimVis sends.
template <typename Action>
void for_each_type(const Action& action) {
  const auto all = [&]<typename... M>() { (action.template operator()<M>(), ...); };
  all.template
  operator()<LaserScan, PointCloud2, Image, CompressedImage, CameraInfo, Range, DisparityImage, TFMessage, PoseStamped,
             TwistStamped, Odometry, Path, Clock, DiagnosticArray, ParameterEvent, Float64, Imu, NavSatFix,
             TwistWithCovarianceStamped, MagneticField, FluidPressure, JointState, Illuminance, WrenchStamped,
             EventPacket, MarkerArray, CustomMsg, Detection2DArray, Detection3DArray>();
}

/// As for_each_type(), with those that SimVis reads, and with its own.
template <typename Action>
void for_each_message(const Action& action) {
  for_each_type(action);
  const auto more = [&]<typename... M>() { (action.template operator()<M>(), ...); };
  more.template operator()<String, ChangeLog, HostFrame, OutputStamped, HostMeasurement>();
}

using Random = std::mt19937;

template <typename T>
void fill(T& value, Random& random);
inline void fill(std::string& text, Random& random);
template <typename T, std::size_t kCount>
void fill(std::array<T, kCount>& values, Random& random);
template <typename T>
void fill(std::vector<T>& values, Random& random);

template <typename T>
void fill(T& value, Random& random) {
  if constexpr (Message<T>) {
    for_each_field(value, [&](auto& field) { fill(field, random); });
  } else if constexpr (std::floating_point<T>) {
    value = static_cast<T>(std::normal_distribution<double>(0, 1e3)(random));
  } else if constexpr (std::same_as<T, bool>) {
    value = random() % 2 == 0;
  } else {
    value = static_cast<T>(random());
  }
}
inline void fill(std::string& text, Random& random) {
  text.assign(random() % 6, ' ');
  for (char& c : text) c = static_cast<char>('!' + random() % 90);
}
template <typename T, std::size_t kCount>
void fill(std::array<T, kCount>& values, Random& random) {
  for (T& value : values) fill(value, random);
}
template <typename T>
void fill(std::vector<T>& values, Random& random) {
  values.clear();
  for (std::uint32_t count = random() % 4; count > 0; --count) {
    T value{};
    fill(value, random);
    values.push_back(value);
  }
}

using Json = nlohmann::ordered_json;

template <typename T>
Json to_json(const T& value);
template <typename T, std::size_t kCount>
Json to_json(const std::array<T, kCount>& values);
template <typename T>
Json to_json(const std::vector<T>& values);

template <typename T>
Json to_json(const T& value) {
  if constexpr (Message<T>) {
    Json json = Json::object();
    std::string_view names = T::kFieldNames;
    for_each_field(value, [&](const auto& field) { json[std::string(take_field_name(names))] = to_json(field); });
    return json;
  } else if constexpr (std::floating_point<T>) {
    char hexadecimal[40];
    std::snprintf(hexadecimal, sizeof hexadecimal, "%a", static_cast<double>(value));
    return hexadecimal;
  } else if constexpr (std::same_as<T, std::byte>) {
    return static_cast<int>(value);
  } else {
    return value;
  }
}
template <typename T, std::size_t kCount>
Json to_json(const std::array<T, kCount>& values) {
  Json json = Json::array();
  for (const T& value : values) json.push_back(to_json(value));
  return json;
}
template <typename T>
Json to_json(const std::vector<T>& values) {
  Json json = Json::array();
  for (const T& value : values) json.push_back(to_json(value));
  return json;
}

}  // namespace simvis::ros::test
