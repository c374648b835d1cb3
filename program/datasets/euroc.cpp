// EuRoC: the ASL layout of the EuRoC MAV datasets, for cameras with an inertial measurement unit.
//
//   mav0/body.yaml
//   mav0/cam0/data/TIME.png data.csv sensor.yaml     the first view of the cameras by their names; cam1: the next one
//   mav0/imu0/data.csv sensor.yaml                   the sensor of type `imu`, if there is one
//   mav0/state_groundtruth_estimate0/data.csv sensor.yaml
//
// Times    TIME is the frame's time in nanoseconds. Sensors may have rates of their own.
// Body     the frame of the imu, or without one the optical frame of cam0. T_BS leads from a sensor's frame to the
//          body's; that of a camera is its optical frame (x right, y down, z forward). Sensors must be on one body.
// Cameras  pinhole, with the lens brown_conrady without k3 (radial-tangential) or kannala_brandt (equidistant); the
//          principal point counts from the centre of the first pixel. Pictures are grey: sRGB codes of the luminance.
// State    a row for each frame in which the sensor of the body frame measures: position, orientation with qw first,
//          velocity in the world, true biases of the imu. A velocity is the mean since the row before; the first is 0.
// Noise    in imu0/sensor.yaml: stddev counts as white noise, and both drifts together as a random walk.
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include "engine/base/srgb.h"
#include "program/datasets/dataset_format.h"
#include "program/datasets/rigid_text.h"
#include "program/datasets/seen_view.h"
#include "scenegraph/pictures/png_bytes.h"

namespace simvis {
namespace {

class EurocFormat : public DatasetFormat {
 public:
  void begin(std::span<const DatasetSensor> sensors) override;
  FramePiece frame(const DatasetFrame& frame) const override;
  std::vector<DatasetFile> whole(std::span<const Record> records) const override;

 private:
  std::vector<std::string> views_;  // names of the views; cam0 first
  std::string imu_;                 // name of the imu; empty if the scene has none
};

constexpr std::string_view kEuroc = "euroc", kEurocHolds = "cameras and one imu";

constexpr const char *kTurn[] = {"angular_velocity_x_rad_s", "angular_velocity_y_rad_s", "angular_velocity_z_rad_s"},
                     *kForce[] = {"specific_force_x_m_s2", "specific_force_y_m_s2", "specific_force_z_m_s2"},
                     *kNoise[] = {"gyroscope_noise_density", "gyroscope_random_walk", "accelerometer_noise_density",
                                  "accelerometer_random_walk"},
                     *kBiases[] = {"gyroscope_bias_x_rad_s",    "gyroscope_bias_y_rad_s",
                                   "gyroscope_bias_z_rad_s",    "accelerometer_bias_x_m_s2",
                                   "accelerometer_bias_y_m_s2", "accelerometer_bias_z_m_s2"};

bool is_imu(const DatasetSensor& sensor) {
  return sensor.measurement.find(kTurn[0]) != nullptr && sensor.measurement.find(kForce[0]) != nullptr;
}

/// The first number of each of these arrays.
template <std::size_t n>
Record numbers_of(const Measurement& measurement, const char* const (&names)[n]) {
  Record numbers = Record::array();
  for (const char* const name : names) numbers.push_back(measurement.find(name)->number(0));
  return numbers;
}

/// The constants of these names; 0 for one that the measurement does not have.
template <std::size_t n>
Record constants_of(const Measurement& measurement, const char* const (&names)[n]) {
  Record numbers = Record::array();
  for (const char* const name : names) {
    const auto found = std::ranges::find(measurement.constants, name, &NamedValue::name);
    numbers.push_back(found == measurement.constants.end() ? 0 : found->value);
  }
  return numbers;
}

/// The luminance of Rec. 709 as grey codes.
std::string grey_png(const Image& color) {
  Image grey = color;
  std::vector<float>& pixels = grey.pixels.edit();
  for (std::size_t i = 0; i < pixels.size(); i += 4) {
    const float luminance = 0.2126f * pixels[i] + 0.7152f * pixels[i + 1] + 0.0722f * pixels[i + 2];
    pixels[i] = pixels[i + 1] = pixels[i + 2] = luminance;
  }
  std::vector<std::uint8_t> rgb(pixels.size() / 4 * 3);
  srgb_codes(pixels, rgb);
  std::vector<std::uint8_t> codes;
  codes.reserve(rgb.size() / 3);
  for (std::size_t i = 0; i < rgb.size(); i += 3) codes.push_back(rgb[i]);
  return png_bytes({.width = color.width, .height = color.height, .bits = 8, .channels = 1}, codes);
}

/// ASL's name of the lens model and its coefficients. Throws InputError for a lens that ASL does not have.
std::pair<std::string, std::array<double, 4>> asl_lens(const CameraCalibration& camera, const std::string& sensor) {
  const std::vector<double>& k = camera.distortion_coefficients;
  if (camera.distortion_model == "equidistant" && k.size() == 4) return {"equidistant", {k[0], k[1], k[2], k[3]}};
  if (camera.distortion_model == "plumb_bob" && k.size() == 5 && k[4] == 0) {
    return {"radial-tangential", {k[0], k[1], k[2], k[3]}};
  }
  throw InputError("--dataset euroc: camera \"" + sensor +
                   "\" has a lens that the format cannot describe, expected distortion=\"none\", kannala_brandt, or "
                   "brown_conrady without k3");
}

template <typename Numbers>
std::string yaml_list(const Numbers& numbers) {
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "" : ", ") + format_number(number);
  return "[" + text + "]";
}

std::string transform_yaml(const glm::dmat4& body_from_sensor) {
  std::vector<double> data;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) data.push_back(body_from_sensor[column][row]);
  }
  return "T_BS:\n  cols: 4\n  rows: 4\n  data: " + yaml_list(data) + "\n";
}

Record camera_record(const SeenView& view) {
  const Pinhole& p = view.camera.pinhole;
  const auto [model, coefficients] = asl_lens(view.camera, view.name);
  return {{"pose", rigid_record(view.world_from_optical)},
          {"resolution", {view.camera.width_px, view.camera.height_px}},
          {"intrinsics", {p.fx_px, p.fy_px, p.cx_px - kFirstCentre_px, p.cy_px - kFirstCentre_px}},
          {"model", model},
          {"coefficients", coefficients}};
}

/// The times of a sensor, and where it is on the body.
struct Placed {
  std::vector<std::int64_t> times_ns;
  std::optional<glm::dmat4> body_from_sensor;
  const Record* record = nullptr;  ///< the first one

  /// Measurements per second. A single measurement counts as one per `period_ns`, the period of frames.
  double rate_hz(std::int64_t period_ns) const {
    const bool several = times_ns.size() > 1;
    const std::int64_t between_ns = several ? times_ns.back() - times_ns.front() : period_ns;
    return between_ns > 0
               ? static_cast<double>(several ? times_ns.size() - 1 : 1) * 1e9 / static_cast<double>(between_ns)
               : 0;
  }
};

/// The sensor with the key `key` in records, over all frames. Throws InputError if it moves relative to `body`, or if
/// both measure in no common frame.
Placed placed(std::span<const Record> records, const std::string& key, const std::string& body) {
  Placed all;
  for (const Record& record : records) {
    const Record& sensors = record.at("sensors");
    if (!sensors.contains(key)) continue;
    const Record& own = sensors.at(key);
    if (all.record == nullptr) all.record = &own;
    all.times_ns.push_back(record.at("time_ns").get<std::int64_t>());
    if (!sensors.contains(body)) continue;
    const glm::dmat4 body_from_sensor = glm::inverse(rigid_of(sensors.at(body).at("pose"))) * rigid_of(own.at("pose"));
    if (!all.body_from_sensor) all.body_from_sensor = key == body ? glm::dmat4(1) : body_from_sensor;
    if (is_same_place(*all.body_from_sensor, body_from_sensor)) continue;
    throw InputError("--dataset euroc: in frame " + std::to_string(&record - records.data()) + " \"" + key +
                     "\" is elsewhere relative to \"" + body + "\" than before, expected both on one body");
  }
  if (all.body_from_sensor) return all;
  throw InputError("--dataset euroc: \"" + key + "\" and \"" + body +
                   "\" measure in no common frame, expected rates with common frames, or more frames");
}

std::string camera_yaml(const Placed& camera, std::int64_t period_ns) {
  const Record& own = *camera.record;
  return "sensor_type: camera\ncomment: made with SimVis\n" + transform_yaml(*camera.body_from_sensor) +
         "rate_hz: " + format_number(camera.rate_hz(period_ns)) + "\nresolution: " + own.at("resolution").dump() +
         "\ncamera_model: pinhole\nintrinsics: " + yaml_list(own.at("intrinsics").get<std::vector<double>>()) +
         "\ndistortion_model: " + own.at("model").get<std::string>() +
         "\ndistortion_coefficients: " + yaml_list(own.at("coefficients").get<std::vector<double>>()) + "\n";
}

std::string camera_csv(const Placed& camera) {
  std::string text = "#timestamp [ns],filename\n";
  for (const std::int64_t time : camera.times_ns) text += std::to_string(time) + "," + std::to_string(time) + ".png\n";
  return text;
}

std::string imu_yaml(const Placed& imu, std::int64_t period_ns) {
  std::string text = "sensor_type: imu\ncomment: made with SimVis\n" + transform_yaml(*imu.body_from_sensor) +
                     "rate_hz: " + format_number(imu.rate_hz(period_ns)) + "\n";
  const Record& noise = imu.record->at("noise");
  for (std::size_t i = 0; i < std::size(kNoise); ++i) {
    text += std::string(kNoise[i]) + ": " + format_number(noise.at(i).get<double>()) + "\n";
  }
  return text;
}

std::string row_text(const Record& time_ns, std::initializer_list<std::vector<double>> numbers) {
  std::string text = std::to_string(time_ns.get<std::int64_t>());
  for (const std::vector<double>& some : numbers) {
    for (const double number : some) text += "," + format_number(number);
  }
  return text + "\n";
}

std::string imu_csv(std::span<const Record> records, const std::string& imu) {
  std::string text =
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],"
      "a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";
  for (const Record& record : records) {
    if (!record.at("sensors").contains(imu)) continue;
    const Record& own = record.at("sensors").at(imu);
    text += row_text(record.at("time_ns"),
                     {own.at("turn").get<std::vector<double>>(), own.at("force").get<std::vector<double>>()});
  }
  return text;
}

std::string state_csv(std::span<const Record> records, const std::string& body) {
  std::string text =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], "
      "v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], "
      "b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]\n";
  std::optional<std::pair<std::int64_t, glm::dvec3>> before;
  for (const Record& record : records) {
    if (!record.at("sensors").contains(body)) continue;
    const Record& own = record.at("sensors").at(body);
    const glm::dmat4 pose = rigid_of(own.at("pose"));
    const glm::dvec4 q = quaternion_xyzw(pose);
    const auto time_ns = record.at("time_ns").get<std::int64_t>();
    glm::dvec3 velocity_mps(0);
    if (before && time_ns > before->first) {
      velocity_mps = (glm::dvec3(pose[3]) - before->second) / (static_cast<double>(time_ns - before->first) / 1e9);
    }
    before.emplace(time_ns, glm::dvec3(pose[3]));
    text += row_text(record.at("time_ns"), {{pose[3].x, pose[3].y, pose[3].z},
                                            {q.w, q.x, q.y, q.z},
                                            {velocity_mps.x, velocity_mps.y, velocity_mps.z},
                                            own.value("biases", std::vector<double>(std::size(kBiases), 0))});
  }
  return text;
}

}  // namespace

void EurocFormat::begin(std::span<const DatasetSensor> sensors) {
  imu_.clear();
  views_.clear();
  for (const DatasetSensor& sensor : sensors) {
    if (is_camera(sensor)) {
      require_outputs(sensor, kEuroc, {kNeedsColor});
    } else if (!is_imu(sensor) || !imu_.empty()) {
      refuse_sensor(sensor, kEuroc, kEurocHolds);
    } else {
      imu_ = sensor.name;
    }
  }
  require_views(sensors, kEuroc);
  require_own_names(sensors, kEuroc);
  for (const SeenView& view : views_of(sensors)) {
    asl_lens(view.camera, view.name);
    views_.push_back(view.name);
    if (view.name == imu_) {
      throw InputError("--dataset euroc: a view and the imu have the name \"" + imu_ +
                       "\", expected another name for one of them");
    }
  }
}

FramePiece EurocFormat::frame(const DatasetFrame& frame) const {
  FramePiece piece;
  Record sensors = Record::object();
  const std::string time = std::to_string(frame.time.time_ns);
  for (const SeenView& view : views_of(frame.sensors)) {
    const auto number = std::ranges::find(views_, view.name) - views_.begin();
    piece.files.push_back({"mav0/cam" + std::to_string(number) + "/data/" + time + ".png",
                           [color = *view.color] { return grey_png(color); },
                           view.color->pixels.size() * sizeof(float)});
    sensors[view.name] = camera_record(view);
  }
  for (const DatasetSensor& sensor : frame.sensors) {
    if (!is_imu(sensor)) continue;
    sensors[sensor.name] = {{"pose", rigid_record(sensor.world_from_sensor)},
                            {"turn", numbers_of(sensor.measurement, kTurn)},
                            {"force", numbers_of(sensor.measurement, kForce)},
                            {"noise", constants_of(sensor.measurement, kNoise)},
                            {"biases", constants_of(sensor.measurement, kBiases)}};
  }
  piece.record = {
      {"time_ns", frame.time.time_ns}, {"period_ns", frame.time.period_ns}, {"sensors", std::move(sensors)}};
  return piece;
}

std::vector<DatasetFile> EurocFormat::whole(std::span<const Record> records) const {
  const std::string& body = imu_.empty() ? views_.front() : imu_;
  const auto period_ns = records.front().at("period_ns").get<std::int64_t>();
  std::vector<DatasetFile> files;
  for (std::size_t i = 0; i < views_.size(); ++i) {
    const Placed camera = placed(records, views_[i], body);
    const std::string folder = "mav0/cam" + std::to_string(i) + "/";
    files.push_back(text_file(folder + "data.csv", camera_csv(camera)));
    files.push_back(text_file(folder + "sensor.yaml", camera_yaml(camera, period_ns)));
  }
  if (!imu_.empty()) {
    files.push_back(text_file("mav0/imu0/data.csv", imu_csv(records, imu_)));
    files.push_back(text_file("mav0/imu0/sensor.yaml", imu_yaml(placed(records, imu_, body), period_ns)));
  }
  const std::string state = "mav0/state_groundtruth_estimate0/";
  files.push_back(text_file(state + "data.csv", state_csv(records, body)));
  files.push_back(
      text_file(state + "sensor.yaml",
                "sensor_type: visual-inertial\ncomment: the true state, by SimVis\n" + transform_yaml(glm::dmat4(1))));
  files.push_back(text_file("mav0/body.yaml", "comment: made with SimVis\n"));
  return files;
}

namespace {

const DatasetFormatRegistration kEurocRegistration(kEuroc, [](double) -> std::unique_ptr<DatasetFormat> {
  return std::make_unique<EurocFormat>();
});

}  // namespace
}  // namespace simvis
