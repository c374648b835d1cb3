#include "datasets/kitti.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <set>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include "datasets/classes.h"
#include "datasets/rigid_text.h"
#include "datasets/seen_view.h"
#include "scenegraph/pictures/png_file.h"
#include "sensors/measured_table.h"
#include "simvis/output/output_writer.h"

namespace simvis {
namespace {

constexpr const char* kSequence = "sequences/00/";
constexpr std::size_t kMaxViews = 2;

// By how much the scanner may be elsewhere relative to the camera than in frame 0, in metres and as a difference of the
// entries of rotations: poses far from the origin are rounded to about 1e-9.
constexpr double kSamePlace = 1e-6;

/// The points of a scan, in the order of its beams.
class PointRows {
 public:
  explicit PointRows(const Measurement& scan) : table_(measured_table(scan)) {
    const char* const names[] = {"x_m", "y_m", "z_m", "intensity", "true_semantic", "true_instance"};
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const auto found = std::ranges::find(table_.columns, names[i], &TableColumn::name);
      columns_[i] = static_cast<std::size_t>(found - table_.columns.begin());
    }
    for (std::size_t row = 0; row < table_.rows(); ++row) {
      if (!std::isnan(number(row, 0))) rows_.push_back(row);
    }
  }

  std::string points() const {
    std::string bytes;
    for (const std::size_t row : rows_) {
      for (std::size_t column = 0; column < 4; ++column) append(static_cast<float>(number_or_0(row, column)), bytes);
    }
    return bytes;
  }

  /// `instances` are all that the scene has.
  std::string labels(const std::set<std::uint32_t>& instances) const {
    std::string bytes;
    for (const std::size_t row : rows_) {
      const auto semantic = static_cast<std::uint32_t>(number_or_0(row, 4)),
                 instance = static_cast<std::uint32_t>(number_or_0(row, 5));
      const auto found = instances.find(instance);
      const auto rank =
          found == instances.end() ? 0 : static_cast<std::uint32_t>(std::distance(instances.begin(), found)) + 1;
      append(semantic | rank << 16, bytes);
    }
    return bytes;
  }

 private:
  double number(std::size_t row, std::size_t column) const {
    return table_.values[row * table_.columns.size() + columns_[column]];
  }
  double number_or_0(std::size_t row, std::size_t column) const {
    if (columns_[column] == table_.columns.size()) return 0;
    const double value = number(row, column);
    return std::isnan(value) ? 0 : value;
  }
  template <typename Number>
  static void append(Number value, std::string& bytes) {
    std::array<char, sizeof value> raw{};
    std::memcpy(raw.data(), &value, sizeof value);
    bytes.append(raw.data(), raw.size());
  }

  MeasuredTable table_;
  std::array<std::size_t, 6> columns_{};
  std::vector<std::size_t> rows_;
};

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

bool is_same_place(const glm::dmat4& a, const glm::dmat4& b) {
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) {
      if (!(std::abs(a[column][row] - b[column][row]) <= kSamePlace)) return false;
    }
  }
  return true;
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
  std::set<std::uint32_t> instances;
  for (const SceneItem& item : frame.items) instances.insert(item.instance);
  piece.record["instances"] = instances;
  for (const DatasetSensor& sensor : frame.sensors) {
    if (!is_scanner(sensor)) continue;
    const PointRows rows(sensor.measurement);
    piece.files.push_back(text_file(kSequence + ("velodyne/" + file) + ".bin", rows.points()));
    if (labels_) require_labels(sensor);
    if (labels_) piece.files.push_back(text_file(kSequence + ("labels/" + file) + ".label", rows.labels(instances)));
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

}  // namespace simvis
