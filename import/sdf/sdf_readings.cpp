#include "import/sdf/sdf_readings.h"

#include <cmath>

namespace simvis {
namespace {

struct NoiseRow {
  const char* tag;
  const char* attribute;
};
constexpr NoiseRow kNoiseRows[] = {{"stddev", "stddev"},
                                   {"bias_stddev", "bias_stddev"},
                                   {"dynamic_bias_stddev", "dynamic_bias_stddev"},
                                   {"dynamic_bias_correlation_time", "dynamic_bias_correlation_time"},
                                   {"precision", "precision"}};

double reading_deviation(const SdfElement& element) {
  const double value = element.number(0);
  if (!(value >= 0 && std::isfinite(value))) {
    element.fail("is " + format_number(value) + ", expected a finite number that is not negative");
  }
  return value;
}

// <noise>, whose <mean> is a bias that no run changes.
void add_noise(const SdfElement& noise, const std::string& prefix, SdfCommand& command, ImportReport& report) {
  if (!noise) return;
  const std::string type = noise.child("type") ? noise.child("type").text() : noise.attribute("type");
  if (type.empty() || type == "none") return;
  if (!type.starts_with("gaussian")) return report.leave_out("noise of type " + in_quotes(type), noise.at());
  const double mean = noise.child("mean").number(0) + noise.child("bias_mean").number(0);
  if (mean != 0) command.add((prefix + "bias_mean").c_str(), mean);
  const bool drifts = reading_deviation(noise.child("dynamic_bias_stddev")) > 0 &&
                      reading_deviation(noise.child("dynamic_bias_correlation_time")) > 0;
  for (const NoiseRow& row : kNoiseRows) {
    const double value = reading_deviation(noise.child(row.tag));
    const bool is_drift = std::string_view(row.tag).starts_with("dynamic");
    if (value > 0 && (!is_drift || drifts)) command.add((prefix + row.attribute).c_str(), value);
  }
}

// SDF has a noise for each axis, of which the first counts.
void add_axis_noise(const SdfElement& quantity, const char* prefix, SdfCommand& command, ImportReport& report) {
  const SdfElement first = quantity.child("x").child("noise");
  add_noise(first, prefix, command, report);
  for (const char* const axis : {"y", "z"}) {
    const SdfElement other = quantity.child(axis).child("noise");
    for (const NoiseRow& row : kNoiseRows) {
      if (first.child(row.tag).number(0) == other.child(row.tag).number(0)) continue;
      return report.leave_out("noise of a sensor's axis that differs from that of x", other ? other.at() : first.at());
    }
  }
}

void add_origin(const SdfElement& world, SdfCommand& command, ImportReport& report) {
  const SdfElement origin = world.child("spherical_coordinates");
  if (!origin) return;
  command.add("latitude", origin.child("latitude_deg").number(0));
  command.add("longitude", origin.child("longitude_deg").number(0));
  command.add("elevation", origin.child("elevation").number(0));
  command.add("heading", origin.child("heading_deg").number(0));
  const SdfElement axes = origin.child("world_frame_orientation");
  if (axes && axes.text() != "ENU") report.leave_out("<world_frame_orientation> other than ENU", axes.at());
}

}  // namespace

std::optional<SdfCommand> sdf_reading_command(const SdfElement& sensor, const SdfElement& world, const SdfPlace& place,
                                              const glm::dmat4& point_from_sensor, ImportReport& report) {
  const std::string type = sensor.attribute("type");
  const auto begin = [&](const char* own) {
    SdfCommand command(CommandKind::sensor, own, place);
    add_sdf_sensor_place(sensor, point_from_sensor, command);
    return command;
  };
  if (type == "imu") {
    SdfCommand command = begin("imu");
    if (const SdfElement gravity = world.child("gravity")) {
      command.add("gravity", gravity.vector(glm::dvec3(0, 0, -9.8)));
    }
    const SdfElement imu = sensor.child("imu");
    if (imu.child("enable_orientation").flag(true)) command.add("orientation", "on");
    add_axis_noise(imu.child("angular_velocity"), "gyroscope_", command, report);
    add_axis_noise(imu.child("linear_acceleration"), "accelerometer_", command, report);
    return command;
  }
  if (type == "navsat" || type == "gps") {
    SdfCommand command = begin("gnss");
    add_origin(world, command, report);
    const SdfElement own = sensor.child("navsat") ? sensor.child("navsat") : sensor.child("gps");
    add_noise(own.child("position_sensing").child("horizontal").child("noise"), "horizontal_", command, report);
    add_noise(own.child("position_sensing").child("vertical").child("noise"), "vertical_", command, report);
    add_noise(own.child("velocity_sensing").child("horizontal").child("noise"), "velocity_", command, report);
    return command;
  }
  if (type == "magnetometer") {
    SdfCommand command = begin("magnetometer");
    if (const SdfElement field = world.child("magnetic_field")) command.add("field", field.vector(glm::dvec3(0)));
    add_axis_noise(sensor.child("magnetometer"), "", command, report);
    return command;
  }
  if (type == "air_pressure") {
    SdfCommand command = begin("barometer");
    const SdfElement own = sensor.child("air_pressure");
    if (const SdfElement altitude = own.child("reference_altitude")) command.add("elevation", altitude.number(0));
    add_noise(own.child("pressure").child("noise"), "", command, report);
    return command;
  }
  if (type == "contact") {
    SdfCommand command = begin("contact");
    command.add("without_physics", "nothing");
    return command;
  }
  if (type == "altimeter") {
    SdfCommand command = begin("altimeter");
    const SdfElement own = sensor.child("altimeter");
    add_noise(own.child("vertical_position").child("noise"), "vertical_position_", command, report);
    add_noise(own.child("vertical_velocity").child("noise"), "vertical_velocity_", command, report);
    return command;
  }
  return std::nullopt;
}

std::string sdf_force_torque_command(const SdfElement& sensor, const std::string& joint, const SdfPlace& place,
                                     const glm::dmat4& point_from_child, ImportReport& report) {
  SdfCommand command(CommandKind::sensor, "force_torque", place);
  add_sdf_sensor_place(sensor, point_from_child, command);
  command.add("joint", joint);
  command.add("without_physics", "nothing");
  const SdfElement own = sensor.child("force_torque"), frame = own.child("frame"),
                   direction = own.child("measure_direction");
  if (frame && frame.text() != "child") report.leave_out("<frame> other than child of a sensor", frame.at());
  if (direction && direction.text() != "child_to_parent") {
    report.leave_out("<measure_direction> other than child_to_parent", direction.at());
  }
  add_axis_noise(own.child("force"), "force_", command, report);
  add_axis_noise(own.child("torque"), "torque_", command, report);
  return command.text();
}

}  // namespace simvis
