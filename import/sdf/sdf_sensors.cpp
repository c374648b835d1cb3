#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <string_view>

#include <simvis/pose.h>
#include "import/sdf/sdf_camera_types.h"
#include "import/sdf/sdf_command.h"
#include "import/sdf/sdf_labels.h"
#include "import/sdf/sdf_lens.h"
#include "import/sdf/sdf_messages.h"
#include "import/sdf/sdf_readings.h"

namespace simvis {
namespace {

// Limits of the sensors `camera` and `laser_scanner`, and of the rays of one scan.
constexpr double kMaxPixels = 16384, kMaxSamples = 1'000'000, kMaxRings = 100'000, kMaxBeams = 50'000'000;
constexpr double kMaxRange_m = 1e6;
// Files round pi to a few digits: a turn that is larger by this is a full turn.
constexpr double kTurnTolerance_deg = 0.01;

void add_sensor_pose(const glm::dmat4& point_from_sensor, SdfCommand& command) {
  if (point_from_sensor == glm::dmat4(1)) return;
  command.add("pose_offset", glm::dvec3(point_from_sensor[3]));
  const glm::dquat q = glm::normalize(glm::quat_cast(point_from_sensor));
  command.add("quaternion",
              format_number(q.w) + " " + format_number(q.x) + " " + format_number(q.y) + " " + format_number(q.z));
}

void add_rate(const SdfElement& sensor, SdfCommand& command) {
  const double rate_hz = sensor.child("update_rate").number(0);
  if (rate_hz > 0 && std::isfinite(rate_hz)) command.add("rate", rate_hz);
}

void add_visibility_mask(const SdfElement& sensor, SdfCommand& command) {
  if (const auto mask = sdf_visibility_bits(sensor, "visibility_mask")) command.add("visibility_mask", *mask);
}

double whole(const SdfElement& parent, const char* tag, double fallback, double largest) {
  const double value = parent.child(tag).number(fallback);
  if (!(value >= 1 && value <= largest && value == std::floor(value))) {
    parent.fail("has a <" + std::string(tag) + "> that is not allowed, expected a whole number from 1 to " +
                format_number(largest));
  }
  return value;
}

// The standard deviation of <noise>. What else it describes is reported.
double gaussian(const SdfElement& noise, ImportReport& report) {
  if (!noise) return 0;
  const std::string type = noise.child("type") ? noise.child("type").text() : noise.attribute("type");
  if (type.empty() || type == "none") return 0;
  const bool is_biased = noise.child("mean").number(0) != 0 || noise.child("bias_mean").number(0) != 0 ||
                         noise.child("bias_stddev").number(0) != 0;
  if (type.starts_with("gaussian") && is_biased) report.leave_out("mean or bias of a sensor's noise", noise.at());
  if (!type.starts_with("gaussian")) report.leave_out("noise of type " + in_quotes(type), noise.at());
  const double deviation = type.starts_with("gaussian") ? noise.child("stddev").number(0) : 0;
  if (!(deviation >= 0 && std::isfinite(deviation)))
    noise.fail("has a <stddev> that is not allowed, expected 0 or more");
  return deviation;
}

// Whether radial distortion k reaches the radius `corner` before it folds: r (1 + k1 r^2 + k2 r^4 + k3 r^6) is
// followed in small steps for as long as it grows.
bool fills_picture(const std::array<double, 3>& k, double corner) {
  constexpr int kSteps = 10'000;
  constexpr double kReach = 20;     // radii of the corner
  constexpr double kMargin = 1.02;  // for tangential distortion and the size of a step
  double reached = 0;
  for (int i = 1; i <= kSteps; ++i) {
    const double r = i * kReach * corner / kSteps, q = r * r;
    const double distorted = r * (1 + q * (k[0] + q * (k[1] + q * k[2])));
    if (!(distorted > reached)) return false;
    reached = distorted;
    if (reached >= kMargin * corner) return true;
  }
  return false;
}

void add_distortion(const SdfElement& camera, double width, double height, double hfov, SdfCommand& command,
                    ImportReport& report) {
  const SdfElement distortion = camera.child("distortion");
  std::array<double, 5> values{};
  constexpr const char* kNames[] = {"k1", "k2", "k3", "p1", "p2"};
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = distortion.child(kNames[i]).number(0);
  if (values == std::array<double, 5>{}) return;
  const double corner = std::tan(hfov / 2) * std::hypot(1, height / width);
  if (!fills_picture({values[0], values[1], values[2]}, corner)) {
    report.leave_out("a lens distortion that folds within the picture", distortion.at());
    return;
  }
  command.add("distortion", "brown_conrady");
  for (std::size_t i = 0; i < values.size(); ++i) command.add(kNames[i], values[i]);
}

// SDF's noise is added to a picture from 0 to 1. A full well of so many electrons has next to no noise of its own: the
// standard deviation of a full pixel is 3e-5 of its value.
constexpr double kNoiselessWell_e = 1e9;

void add_picture_noise(const SdfElement& noise, SdfCommand& command, ImportReport& report) {
  const double deviation = gaussian(noise, report);
  if (!(deviation > 0)) return;
  command.add("full_well_e", kNoiselessWell_e);
  command.add("read_noise_e", std::min(deviation, 1.0) * kNoiselessWell_e);
}

// A sensor with the picture and the lens of a <camera>.
SdfCommand pixel_command(const SdfElement& sensor, const char* type, std::string_view outputs, bool is_wide_angle,
                         const SdfPlace& place, const glm::dmat4& point_from_sensor, ImportReport& report) {
  const SdfElement camera = sensor.child("camera");
  if (!camera) sensor.fail("has no <camera>");
  SdfCommand command(CommandKind::sensor, type, place);
  add_sensor_pose(point_from_sensor * read_sdf_pose(camera).matrix, command);
  const SdfElement image = camera.child("image"), lens = camera.child("lens");
  const double width = image ? whole(image, "width", 320, kMaxPixels) : 320;
  const double height = image ? whole(image, "height", 240, kMaxPixels) : 240;
  command.add("width", width);
  command.add("height", height);
  const double hfov = camera.child("horizontal_fov").number(1.047);
  if (!(hfov > 0 && hfov < std::numbers::pi)) camera.fail("has a <horizontal_fov> that is not between 0 and pi");
  const double near_m = camera.child("clip").child("near").number(0.1);
  if (!(near_m > 0 && near_m <= kMaxRange_m)) camera.fail("has a clip plane <near> that is not above 0");
  command.add("near", near_m);
  command.add("outputs", std::string(outputs));
  if (!is_wide_angle) add_distortion(camera, width, height, hfov, command, report);
  if (!add_sdf_lens(lens, is_wide_angle, width, height, hfov, command, report)) command.add("hfov", hfov * kSdfDegrees);
  add_rate(sensor, command);
  add_visibility_mask(camera, command);
  const bool has_color = std::string_view(type) == "camera" && outputs.starts_with("color");
  if (has_color) add_picture_noise(camera.child("noise"), command, report);
  if (!has_color && gaussian(camera.child("noise"), report) > 0) {
    report.leave_out("noise of a camera without colour", camera.child("noise").at());
  }
  return command;
}

struct ScanAxis {
  double samples = 1, min_deg = 0, max_deg = 0;
};

ScanAxis scan_axis(const SdfElement& axis, double largest, double turn_deg) {
  if (!axis) return {};
  const double resolution = axis.child("resolution").number(1);
  // Files of several tools give one ring and a resolution far below 1.
  const double samples = std::max(1.0, std::round(whole(axis, "samples", 640, largest) * resolution));
  if (!(samples >= 1 && samples <= largest)) axis.fail("has too many or too few samples");
  ScanAxis scan{samples, axis.child("min_angle").number(0) * kSdfDegrees,
                axis.child("max_angle").number(0) * kSdfDegrees};
  const double span = scan.max_deg - scan.min_deg;
  if (!(span >= 0 && span <= turn_deg + kTurnTolerance_deg)) {
    axis.fail("has angles that are not allowed, expected <max_angle> from <min_angle> to " + format_number(turn_deg) +
              " degrees above it");
  }
  if (span > turn_deg) scan.max_deg = scan.min_deg + turn_deg;
  return scan;
}

SdfCommand scanner_command(const SdfElement& sensor, const SdfPlace& place, const glm::dmat4& point_from_sensor,
                           ImportReport& report) {
  const SdfElement ray = sensor.child("ray") ? sensor.child("ray") : sensor.child("lidar");
  if (!ray) sensor.fail("has no <ray> or <lidar>");
  const SdfElement scan = ray.child("scan"), range = ray.child("range");
  const ScanAxis across = scan_axis(scan.child("horizontal"), kMaxSamples, 360);
  ScanAxis up = scan_axis(scan.child("vertical"), kMaxRings, 180);
  if (up.min_deg < -90 - kTurnTolerance_deg || up.max_deg > 90 + kTurnTolerance_deg) {
    scan.fail("has vertical angles beyond a quarter turn");
  }
  up.min_deg = std::max(up.min_deg, -90.0);
  up.max_deg = std::min(up.max_deg, 90.0);
  if (across.samples * up.samples > kMaxBeams) scan.fail("has more than " + format_number(kMaxBeams) + " beams");
  SdfCommand command(CommandKind::sensor, "laser_scanner", place);
  add_sensor_pose(point_from_sensor, command);
  command.add("samples", across.samples);
  command.add("min_angle", across.min_deg);
  command.add("max_angle", across.max_deg);
  command.add("vertical_samples", up.samples);
  command.add("vertical_min_angle", up.min_deg);
  command.add("vertical_max_angle", up.max_deg);
  const double min_m = range.child("min").number(0), max_m = range.child("max").number(kMaxRange_m);
  if (!(min_m >= 0 && max_m > 0 && max_m >= min_m)) ray.fail("has a <range> that is not allowed");
  command.add("range_min", std::min(min_m, kMaxRange_m));
  command.add("range_max", std::min(max_m, kMaxRange_m));
  const double noise_m = gaussian(ray.child("noise"), report);
  if (noise_m > 0) command.add("range_noise", noise_m);
  add_rate(sensor, command);
  add_visibility_mask(ray, command);
  return command;
}

// What a depth camera of Gazebo classic publishes has colour too.
bool publishes_color(const SdfElement& sensor) {
  return std::ranges::any_of(sensor.children(), [](const SdfElement& child) {
    const std::string file = child.tag() == "plugin" ? child.attribute("filename") : "";
    return file.find("gazebo_ros_") != file.npos;
  });
}

std::optional<SdfCommand> command_of(const SdfElement& sensor, const SdfElement& world, const SdfPlace& place,
                                     const glm::dmat4& point_from_sensor, ImportReport& report) {
  const std::string type = sensor.attribute("type");
  if (const SdfCameraType* const camera = find_sdf_camera_type(type)) {
    const bool has_color = camera->outputs == "depth" && publishes_color(sensor);
    return pixel_command(sensor, camera->type, has_color ? "color depth" : camera->outputs, type.starts_with("wide"),
                         place, point_from_sensor, report);
  }
  if (type == "ray" || type == "lidar" || type == "gpu_ray" || type == "gpu_lidar") {
    return scanner_command(sensor, place, point_from_sensor, report);
  }
  return sdf_reading_command(sensor, world, place, point_from_sensor, report);
}

}  // namespace

void add_sdf_sensor_place(const SdfElement& sensor, const glm::dmat4& point_from_sensor, SdfCommand& command) {
  add_sensor_pose(point_from_sensor, command);
  add_rate(sensor, command);
}

std::optional<std::string> sdf_sensor_command(const SdfElement& sensor, const SdfElement& world, const SdfPlace& place,
                                              const glm::dmat4& point_from_sensor, SdfMessages& messages,
                                              ImportReport& report) {
  std::optional<SdfCommand> command = command_of(sensor, world, place, point_from_sensor, report);
  if (!command) {
    report.leave_out("sensor of type " + in_quotes(sensor.attribute("type")), sensor.at());
    return std::nullopt;
  }
  const bool has_offset =
      point_from_sensor != glm::dmat4(1) || read_sdf_pose(sensor.child("camera")).matrix != glm::dmat4(1);
  messages.add(sensor, place, has_offset, *command, report);
  return command->text();
}

}  // namespace simvis
