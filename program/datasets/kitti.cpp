// KITTI odometry, and SemanticKITTI, which adds labels of points.
//
//   sequences/00/image_2/000000.png     the first view of the cameras by their names; image_3: the second
//   sequences/00/velodyne/000000.bin    float32 x y z reflectance of each point, in the scanner's frame
//   sequences/00/label_2/000000.txt     objects in the first view, see kitti_labels.h
//   sequences/00/labels/000000.label    uint32 of each point: the class in the lower 16 bits, the instance in the upper
//   sequences/00/calib.txt times.txt
//   poses/00.txt                        12 numbers for each frame: the first view's optical frame in that of frame 0
//
// Cameras  one or two views of pinhole cameras that look in the same direction, as those of a stereo camera.
// Scanner  at most one; points without a return are left out. The reflectance is the column `intensity`, or 0.
// Objects  need `instance boxes` among the outputs of the first view's camera; without them there is no label_2.
// Labels   need truth="instance semantic" of the scanner. An instance is its rank among the ids of the frame's items,
//          from 1: all frames must have the same items. 0, 0 where no item is known.
#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include "program/datasets/classes.h"
#include "program/datasets/dataset_format.h"
#include "program/datasets/kitti_labels.h"
#include "program/datasets/rigid_text.h"
#include "program/datasets/scan_points.h"
#include "program/datasets/seen_view.h"
#include "program/output/output_writer.h"
#include "scenegraph/pictures/png_file.h"

namespace simvis {
namespace {

class KittiFormat : public DatasetFormat {
 public:
  /// `labels`: SemanticKITTI.
  explicit KittiFormat(bool labels) : labels_(labels) {}
  void begin(std::span<const DatasetSensor> sensors) override;
  FramePiece frame(const DatasetFrame& frame) const override;
  std::vector<DatasetFile> whole(std::span<const Record> records) const override;

 private:
  std::string_view name() const { return labels_ ? "semantickitti" : "kitti"; }

  bool labels_;
  std::vector<std::string> views_;  // image_2 first
  std::size_t scanners_ = 0;
  bool has_boxes_ = false;  // of objects in the first view
};

constexpr const char* kSequence = "sequences/00/";
constexpr std::size_t kMaxViews = 2;

/// The projection of a rectified view, as P2 and P3 have it: pixels from a point in the first view's frame.
glm::dmat4 projection(const CameraCalibration& camera, double right_of_first_m) {
  const Pinhole& p = camera.pinhole;
  glm::dmat4 matrix(1);
  matrix[0][0] = p.fx_px;
  matrix[1][1] = p.fy_px;
  matrix[2][0] = p.cx_px - 0.5;
  matrix[2][1] = p.cy_px - 0.5;
  matrix[3][0] = -p.fx_px * right_of_first_m;
  return matrix;
}

std::string seconds(std::int64_t time_ns) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%.9e\n", static_cast<double>(time_ns) / 1e9);
  return text.data();
}

// Before the first scan it does not say which channels it has.
void require_labels(const DatasetSensor& scanner) {
  const Measurement& measurement = scanner.measurement;
  if (measurement.find("true_semantic") != nullptr && measurement.find("true_instance") != nullptr) return;
  throw InputError("--dataset semantickitti: scanner \"" + scanner.name +
                   "\" has no labels, expected truth=\"instance semantic\"");
}

void require_one_direction(const SeenView& first, const SeenView& other, std::string_view format) {
  const glm::dmat4 between = glm::inverse(first.world_from_optical) * other.world_from_optical;
  glm::dmat4 beside(1);
  beside[3].x = between[3].x;
  if (is_same_place(between, beside)) return;
  throw InputError("--dataset " + std::string(format) + ": the views \"" + first.name + "\" and \"" + other.name +
                   "\" are not side by side with the same direction, expected those of a stereo camera or one camera");
}

}  // namespace

void KittiFormat::begin(std::span<const DatasetSensor> sensors) {
  std::size_t scanners = 0;
  const char* const holds = "cameras with one or two views together, and one laser scanner";
  for (const DatasetSensor& sensor : sensors) {
    if (is_camera(sensor)) {
      require_outputs(sensor, name(), {kNeedsColor});
      require_pinhole(sensor, name());
    } else if (!is_scanner(sensor) || ++scanners > 1) {
      refuse_sensor(sensor, name(), holds);
    }
  }
  scanners_ = scanners;
  const auto first_camera = std::ranges::find_if(sensors, is_camera);
  has_boxes_ = first_camera != sensors.end() && first_camera->measurement.find("visible_pixels") != nullptr;
  views_.clear();
  for (const SeenView& view : views_of(sensors)) views_.push_back(view.name);
  if (views_.empty() || views_.size() > kMaxViews || (labels_ && scanners == 0)) {
    throw InputError("--dataset " + std::string(name()) + ": the scene has " + std::to_string(views_.size()) +
                     " views and " + std::to_string(scanners) + " laser scanners, expected " +
                     (labels_ ? "one or two views and a laser scanner" : "one or two views") +
                     "; --sensor chooses among the sensors of a scene");
  }
}

FramePiece KittiFormat::frame(const DatasetFrame& frame) const {
  FramePiece piece;
  const std::string file = frame_name(frame.time.index);
  const std::vector<SeenView> views = views_of(frame.sensors);
  const auto scans = static_cast<std::size_t>(std::ranges::count_if(frame.sensors, is_scanner));
  if (views.size() != views_.size() || scans != scanners_) {
    throw InputError("--dataset " + std::string(name()) + ": not all sensors measure in frame " + file +
                     ", expected sensors that are due in the same frames");
  }
  Record projections = Record::array();
  for (std::size_t i = 0; i < views.size(); ++i) {
    require_one_direction(views[0], views[i], name());
    const glm::dmat4 first_from_view = glm::inverse(views[0].world_from_optical) * views[i].world_from_optical;
    projections.push_back(rigid_record(projection(views[i].camera, first_from_view[3].x)));
    piece.files.push_back({kSequence + std::string("image_") + std::to_string(2 + i) + "/" + file + ".png",
                           [color = *views[i].color] { return encode_png(color); },
                           views[i].color->pixels.size() * sizeof(float)});
  }
  piece.record = {{"time_ns", frame.time.time_ns},
                  {"pose", rigid_record(views[0].world_from_optical)},
                  {"projections", std::move(projections)},
                  {"classes", classes_record(frame.items)}};
  if (has_boxes_) {
    const std::map<std::uint32_t, std::string> classes = all_classes(std::span(&piece.record, 1));
    piece.files.push_back(text_file(kSequence + ("label_2/" + file) + ".txt", kitti_labels(views[0], classes)));
  }
  std::set<std::uint32_t> instances;
  for (const SceneItem& item : frame.items) instances.insert(item.instance);
  piece.record["instances"] = instances;
  for (const DatasetSensor& sensor : frame.sensors) {
    if (!is_scanner(sensor)) continue;
    const ScanPoints points(sensor.measurement);
    piece.files.push_back(text_file(kSequence + ("velodyne/" + file) + ".bin", points.xyz_intensity()));
    if (labels_) require_labels(sensor);
    if (labels_) piece.files.push_back(text_file(kSequence + ("labels/" + file) + ".label", points.labels(instances)));
    piece.record["scanner"] = rigid_record(glm::inverse(views[0].world_from_optical) * sensor.world_from_sensor);
  }
  return piece;
}

std::vector<DatasetFile> KittiFormat::whole(std::span<const Record> records) const {
  const Record& first = records.front();
  const glm::dmat4 first_from_world = glm::inverse(rigid_of(first.at("pose")));
  std::string poses, times;
  for (const Record& record : records) {
    const std::string frame = std::to_string(&record - records.data());
    if (first.contains("scanner") && !is_same_place(rigid_of(first.at("scanner")), rigid_of(record.at("scanner")))) {
      throw InputError("--dataset " + std::string(name()) + ": in frame " + frame +
                       " the scanner is elsewhere relative to the camera than in frame 0, expected both on one body");
    }
    if (labels_ && record.at("instances") != first.at("instances")) {
      throw InputError("--dataset semantickitti: frame " + frame + " has other items than frame 0, expected the same");
    }
    // Frame 0 is the origin itself, without the rounding of the inverse.
    const glm::dmat4 pose = &record == &first ? glm::dmat4(1) : first_from_world * rigid_of(record.at("pose"));
    poses += twelve_numbers(pose) + "\n";
    times += seconds(record.at("time_ns").get<std::int64_t>());
  }
  const Record& projections = first.at("projections");
  const std::string left = twelve_numbers(rigid_of(projections.front())),
                    right = twelve_numbers(rigid_of(projections.back()));
  std::string calibration;
  for (const auto& [key, numbers] : {std::pair("P0", &left), {"P1", &right}, {"P2", &left}, {"P3", &right}}) {
    calibration += std::string(key) + ": " + *numbers + "\n";
  }
  if (first.contains("scanner")) calibration += "Tr: " + twelve_numbers(rigid_of(first.at("scanner"))) + "\n";
  std::vector<DatasetFile> files;
  files.push_back(text_file(kSequence + std::string("calib.txt"), calibration));
  files.push_back(text_file(kSequence + std::string("times.txt"), times));
  files.push_back(text_file("poses/00.txt", poses));
  return files;
}

namespace {

const DatasetFormatRegistration kKittiRegistration("kitti", [](double) -> std::unique_ptr<DatasetFormat> {
  return std::make_unique<KittiFormat>(false);
});
const DatasetFormatRegistration kSemanticKittiRegistration("semantickitti",
                                                           [](double) -> std::unique_ptr<DatasetFormat> {
                                                             return std::make_unique<KittiFormat>(true);
                                                           });

}  // namespace
}  // namespace simvis
