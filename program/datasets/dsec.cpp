// DSEC: event cameras with frame cameras, flow and disparity (Gehrig, Aarents, Gehrig, Scaramuzza, IEEE RA-L 6(3),
// 2021).
//
//   events/left/events.h5 rectify_map.h5         the first event camera by its name; right: the second
//   images/left/rectified/000000.png             the first view with colour; right: the second
//   images/timestamps.txt
//   flow/forward/000000.png forward_timestamps.txt
//   disparity/event/000000.png image/000000.png timestamps.txt
//   calibration/cam_to_cam.yaml
//
// Frames   All sensors measure in all frames. Times are microseconds of the simulation, rounded down.
// Truth    A camera with the place and the picture of the left event camera gives flow by `flow_forward`, and the
//          disparity to the right event camera by `depth`. `depth` of the left view gives the disparity of two views.
//          Other cameras have no `flow_forward`.
// Pairs    Two event cameras, and two views, look in the same direction, side by side, and have the same pictures.
// Cameras  They have no lens: cam0 and cam3 are the event cameras, cam1 and cam2 the views. They stand on one body.
#include <cstdint>
#include <iterator>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include <simvis/pose.h>
#include "engine/base/time_units.h"
#include "program/datasets/dataset_format.h"
#include "program/datasets/dsec_events.h"
#include "program/datasets/dsec_pictures.h"
#include "program/datasets/rigid_text.h"
#include "program/datasets/seen_view.h"
#include "program/output/output_writer.h"
#include "scenegraph/pictures/png_file.h"

namespace simvis {
namespace {

class DsecFormat : public DatasetFormat {
 public:
  void begin(std::span<const DatasetSensor> sensors) override;
  FramePiece frame(const DatasetFrame& frame) const override;
  std::vector<DatasetFile> whole(std::span<const Record> records) const override;

 private:
  struct Cameras;
  Cameras cameras_of(const DatasetFrame& frame) const;

  struct EventSize {
    std::uint32_t width_px, height_px;
  };
  std::vector<EventSize> event_sizes_;  // of the event cameras, left first
  std::vector<std::string> views_;      // left first
};

constexpr std::string_view kDsec = "dsec",
                           kDsecHolds = "one or two event cameras, and cameras with one or two views that have colour";
constexpr const char* kSides[] = {"left", "right"};
constexpr const char* kFlow = "flow_forward";
// Names of the matrices of pairs.
constexpr const char *kEventPair = "cams_03", *kViewPair = "cams_12";
// The numbers of the cameras in cam_to_cam.yaml, by side.
constexpr int kEventCams[] = {0, 3}, kViewCams[] = {1, 2};

[[noreturn]] void fail(const std::string& what) { throw InputError("--dataset dsec: " + what); }

/// A camera, or an event camera, as cam_to_cam.yaml describes it.
struct PlacedCamera {
  int number;
  std::string name;
  CameraCalibration camera;
  glm::dmat4 world_from_optical;
};

bool is_same_picture(const CameraCalibration& a, const CameraCalibration& b) {
  return a.width_px == b.width_px && a.height_px == b.height_px && a.pinhole == b.pinhole;
}

/// The distance from the left one to the right one of a pair.
double baseline_m(const PlacedCamera& left, const PlacedCamera& right) {
  const glm::dmat4 between = glm::inverse(left.world_from_optical) * right.world_from_optical;
  glm::dmat4 beside(1);
  beside[3].x = between[3].x;
  if (between[3].x > 0 && is_same_place(between, beside) && is_same_picture(left.camera, right.camera)) {
    return between[3].x;
  }
  fail("\"" + right.name + "\" is not to the right of \"" + left.name +
       "\" with the same direction and picture, expected that, or one of them alone");
}

Record camera_record(const PlacedCamera& camera) {
  const Pinhole& p = camera.camera.pinhole;
  return {{"cam", camera.number},
          {"name", camera.name},
          {"matrix", {p.fx_px, p.fy_px, p.cx_px - kFirstCentre_px, p.cy_px - kFirstCentre_px}},
          {"resolution", {camera.camera.width_px, camera.camera.height_px}},
          {"pose", rigid_record(camera.world_from_optical)}};
}

std::string rows_yaml(const glm::dmat4& matrix) {
  std::string text;
  for (int row = 0; row < 4; ++row) {
    text += "  -";
    for (int column = 0; column < 4; ++column) {
      text += (column == 0 ? " [" : ", ") + format_number(matrix[column][row]);
    }
    text += "]\n";
  }
  return text;
}

std::string key_of(const char* before, const Record& camera) {
  return before + std::to_string(camera.at("cam").get<int>());
}

/// The matrix that leads from (column, row, disparity, 1) of the left camera to a point in its frame.
std::string disparity_yaml(const std::string& name, const Record& left, double baseline_m) {
  const Record& k = left.at("matrix");
  glm::dmat4 q(0);
  q[0][0] = q[1][1] = 1;
  q[3][0] = -k.at(2).get<double>();
  q[3][1] = -k.at(3).get<double>();
  q[3][2] = k.at(0).get<double>();
  q[2][3] = 1 / baseline_m;
  return "  " + name + ":\n" + rows_yaml(q);
}

std::string intrinsics_yaml(const std::string& name, const Record& camera) {
  return "  " + name + ":\n    camera_matrix: " + camera.at("matrix").dump() +
         "\n    camera_model: pinhole\n    distortion_coeffs: [0.0, 0.0, 0.0, 0.0]\n    distortion_model: radtan\n" +
         "    resolution: " + camera.at("resolution").dump() + "\n";
}

std::string time_line(const Record& record) {
  return std::to_string(record.at("time_ns").get<std::int64_t>() / kMicrosecond_ns);
}

/// Throws InputError if cameras are elsewhere on their body than in the first frame.
void require_one_body(std::span<const Record> records) {
  const auto place = [](const Record& record, std::size_t i) {
    const Record& cameras = record.at("cameras");
    return glm::inverse(rigid_of(cameras.at(0).at("pose"))) * rigid_of(cameras.at(i).at("pose"));
  };
  for (const Record& record : records) {
    for (std::size_t i = 1; i < records.front().at("cameras").size(); ++i) {
      if (is_same_place(place(records.front(), i), place(record, i))) continue;
      fail("in frame " + std::to_string(&record - records.data()) + " \"" +
           record.at("cameras").at(i).at("name").get<std::string>() + "\" is elsewhere relative to \"" +
           record.at("cameras").at(0).at("name").get<std::string>() + "\" than in frame 0, expected both on one body");
    }
  }
}

/// cam_to_cam.yaml: T_ba leads from camera a to camera b.
std::string calibration_yaml(const Record& record) {
  std::string intrinsics = "intrinsics:\n", extrinsics = "extrinsics:\n", disparity;
  const Record* before = nullptr;
  for (const Record& camera : record.at("cameras")) {
    intrinsics += intrinsics_yaml(key_of("cam", camera), camera) + intrinsics_yaml(key_of("camRect", camera), camera);
    if (before != nullptr) {
      const std::string between = key_of("T_", camera) + std::to_string(before->at("cam").get<int>());
      const glm::dmat4 own_from_before = glm::inverse(rigid_of(camera.at("pose"))) * rigid_of(before->at("pose"));
      extrinsics += "  " + between + ":\n" + rows_yaml(own_from_before);
    }
    extrinsics += "  " + key_of("R_rect", camera) + ": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]\n";
    before = &camera;
  }
  const auto with_number = [&](int number) -> const Record& {
    for (const Record& camera : record.at("cameras")) {
      if (camera.at("cam") == number) return camera;
    }
    throw std::out_of_range("no camera of this number");
  };
  for (const auto& [name, pair] : record.at("baselines").items()) {
    disparity +=
        disparity_yaml(name, with_number(name == kEventPair ? kEventCams[0] : kViewCams[0]), pair.get<double>());
  }
  return intrinsics + extrinsics + (disparity.empty() ? "" : "disparity_to_depth:\n" + disparity);
}

std::string kept_name(std::size_t side, std::uint64_t frame) {
  return std::string(kSides[side]) + "/" + frame_name(frame) + ".bin";
}

}  // namespace

struct DsecFormat::Cameras {
  std::vector<PlacedCamera> events, views;
  std::vector<SeenView> seen;            ///< what the views show
  std::vector<DatasetSensor> of_frames;  ///< which have the views
  const DatasetSensor* truth = nullptr;  ///< the camera in the place of the left event camera; null: none is there

  /// By their numbers.
  std::vector<PlacedCamera> all() const {
    std::vector<PlacedCamera> cameras = events;
    cameras.insert(cameras.begin() + 1, views.begin(), views.end());
    return cameras;
  }
};

void DsecFormat::begin(std::span<const DatasetSensor> sensors) {
  event_sizes_.clear();
  views_.clear();
  for (const DatasetSensor& sensor : sensors) {
    if (is_events(sensor.measurement)) {
      const CameraCalibration& camera = *sensor.measurement.calibration("");
      event_sizes_.push_back({camera.width_px, camera.height_px});
      continue;
    }
    if (!is_camera(sensor)) refuse_sensor(sensor, kDsec, kDsecHolds);
    require_pinhole(sensor, kDsec);
    if (sensor.measurement.find(kFlow) == nullptr) require_outputs(sensor, kDsec, {kNeedsColor});
    for (const SeenView& view : views_of({&sensor, 1})) {
      if (view.color) views_.push_back(view.name);
    }
  }
  constexpr std::size_t kMost = std::size(kSides);
  if (!event_sizes_.empty() && event_sizes_.size() <= kMost && views_.size() <= kMost) return;
  fail(
      "the scene has " + std::to_string(event_sizes_.size()) + " event cameras and " + std::to_string(views_.size()) +
      " views with colour that are on, expected one or two event cameras and at most two views; --sensor chooses among "
      "the sensors of a scene");
}

DsecFormat::Cameras DsecFormat::cameras_of(const DatasetFrame& frame) const {
  Cameras all;
  for (const DatasetSensor& sensor : frame.sensors) {
    if (!is_events(sensor.measurement)) {
      all.of_frames.push_back(sensor);
    } else {
      all.events.push_back({kEventCams[all.events.size()], sensor.name, *sensor.measurement.calibration(""),
                            sensor.world_from_sensor * sensor_from_view()});
    }
  }
  for (SeenView& view : views_of(all.of_frames)) {
    if (!view.color) continue;
    all.views.push_back({kViewCams[all.views.size()], view.name, view.camera, view.world_from_optical});
    all.seen.push_back(std::move(view));
  }
  if (all.events.size() != event_sizes_.size() || all.views.size() != views_.size()) {
    fail("not all sensors measure in frame " + frame_name(frame.time.index) +
         ", expected sensors that are due in the same frames");
  }
  const PlacedCamera& left = all.events.front();
  for (const DatasetSensor& sensor : all.of_frames) {
    const CameraCalibration* const camera = sensor.measurement.calibration("");
    const bool is_there = camera != nullptr && is_same_picture(*camera, left.camera) &&
                          is_same_place(sensor.world_from_sensor * sensor_from_view(), left.world_from_optical);
    if (is_there && all.truth == nullptr) {
      all.truth = &sensor;
    } else if (sensor.measurement.find(kFlow) != nullptr) {
      fail("camera \"" + sensor.name + "\" measures " + kFlow + ", which the format has once, for the event camera \"" +
           left.name + "\": expected the place, size and hfov of that camera");
    }
  }
  return all;
}

FramePiece DsecFormat::frame(const DatasetFrame& frame) const {
  const std::uint64_t number = frame.time.index;
  if (frame.time.time_ns / kMicrosecond_ns > kMaxDsecTime_us) {
    fail("frame " + frame_name(number) + " is at " + format_number(static_cast<double>(frame.time.time_ns) / 1e9) +
         " s, and times of events end at " + format_number(static_cast<double>(kMaxDsecTime_us) / 1e6) +
         " s, expected fewer frames");
  }
  const Cameras all = cameras_of(frame);
  FramePiece piece;
  Record cameras = Record::array(), counts = Record::array(), baselines = Record::object();
  for (const PlacedCamera& camera : all.all()) cameras.push_back(camera_record(camera));
  std::size_t side = 0;
  for (const DatasetSensor& sensor : frame.sensors) {
    if (!is_events(sensor.measurement)) continue;
    std::string events = pack_events(sensor.measurement);
    counts.push_back(events.size() / kEventBytes);
    piece.kept.push_back(text_file(kept_name(side++, number), std::move(events)));
  }
  for (std::size_t i = 0; i < all.seen.size(); ++i) {
    piece.files.push_back({"images/" + std::string(kSides[i]) + "/rectified/" + frame_name(number) + ".png",
                           [color = *all.seen[i].color] { return encode_png(color); },
                           all.seen[i].color->pixels.size() * sizeof(float)});
  }
  const auto add_disparity = [&](const char* folder, const char* matrix, const std::vector<PlacedCamera>& pair,
                                 const std::optional<Image>& depth) {
    if (pair.size() < 2) return;
    const double distance_m = baseline_m(pair[0], pair[1]);
    if (!depth) return;
    baselines[matrix] = distance_m;
    piece.files.push_back({"disparity/" + std::string(folder) + "/" + frame_name(number) + ".png",
                           [depth = *depth, product = distance_m * pair[0].camera.pinhole.fx_px] {
                             return disparity_png(depth, product);
                           },
                           depth->pixels.size() * sizeof(float)});
  };
  if (all.truth != nullptr) {
    const SeenView truth = views_of({all.truth, 1}).front();
    add_disparity("event", kEventPair, all.events, truth.depth);
    const MeasuredArray* const flow = all.truth->measurement.find(kFlow);
    if (flow != nullptr && number > 0) {  // from the pixels of the frame before
      piece.files.push_back({"flow/forward/" + frame_name(number - 1) + ".png",
                             [flow = *flow] { return flow_png(flow); }, flow->bytes()});
    }
    piece.record["flow"] = flow != nullptr;
  } else {
    add_disparity("event", kEventPair, all.events, std::nullopt);
  }
  add_disparity("image", kViewPair, all.views, all.seen.empty() ? std::nullopt : all.seen.front().depth);
  piece.record["time_ns"] = frame.time.time_ns;
  piece.record["events"] = std::move(counts);
  piece.record["cameras"] = std::move(cameras);
  piece.record["baselines"] = std::move(baselines);
  return piece;
}

std::vector<DatasetFile> DsecFormat::whole(std::span<const Record> records) const {
  require_one_body(records);
  const Record& first = records.front();
  std::string times, flow_times = "# from_timestamp_us, to_timestamp_us\n";
  for (const Record& record : records) {
    times += time_line(record) + "\n";
    if (&record != &first) flow_times += time_line(*(&record - 1)) + ", " + time_line(record) + "\n";
  }
  const std::int64_t end_us = records.back().at("time_ns").get<std::int64_t>() / kMicrosecond_ns;
  if (end_us > kMaxDsecTime_us) throw std::out_of_range("time");
  std::vector<DatasetFile> files;
  for (std::size_t side = 0; side < event_sizes_.size(); ++side) {
    std::vector<std::uint64_t> counts;
    for (const Record& record : records) counts.push_back(record.at("events").at(side).get<std::uint64_t>());
    const std::uint64_t all_events = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
    const std::string folder = "events/" + std::string(kSides[side]) + "/";
    files.push_back({folder + "events.h5",
                     [this, counts, side, end_us] {
                       const auto piece = [&](std::size_t frame) {
                         return read_kept(kept_name(side, frame), kEventBytes * counts[frame]);
                       };
                       return events_h5(counts.size(), piece, end_us);
                     },
                     2 * kEventBytes * all_events});
    files.push_back({folder + "rectify_map.h5",
                     [size = event_sizes_[side]] { return rectify_map_h5(size.width_px, size.height_px); },
                     std::size_t{8} * event_sizes_[side].width_px * event_sizes_[side].height_px});
  }
  if (!views_.empty()) files.push_back(text_file("images/timestamps.txt", times));
  if (!first.at("baselines").empty()) files.push_back(text_file("disparity/timestamps.txt", times));
  if (first.value("flow", false)) files.push_back(text_file("flow/forward_timestamps.txt", flow_times));
  files.push_back(text_file("calibration/cam_to_cam.yaml", calibration_yaml(first)));
  return files;
}

namespace {

const DatasetFormatRegistration kDsecRegistration(kDsec, [](double) -> std::unique_ptr<DatasetFormat> {
  return std::make_unique<DsecFormat>();
});

}  // namespace
}  // namespace simvis
