// TUM: the RGB-D sequences of the Technical University of Munich, for one camera.
//
//   rgb/TIME.png depth/TIME.png     TIME in seconds with six decimals
//   rgb.txt depth.txt               lines "TIME FILE"
//   groundtruth.txt                 lines "TIME tx ty tz qx qy qz qw": the optical frame (x right, y down, z
//                                   forward) in the world
//
// Depth    along the optical axis: 16-bit codes, 5000 for each metre; 0: nothing, or farther than 13.1 m.
// Times    A file is named by its frame's time in whole microseconds; two frames with the same number are refused.
#include <array>
#include <cstdio>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include "program/datasets/dataset_format.h"
#include "program/datasets/rigid_text.h"
#include "program/datasets/seen_view.h"
#include "program/output/depth_png_file.h"
#include "scenegraph/pictures/png_file.h"

namespace simvis {
namespace {

class TumFormat : public DatasetFormat {
 public:
  void begin(std::span<const DatasetSensor> sensors) override;
  FramePiece frame(const DatasetFrame& frame) const override;
  std::vector<DatasetFile> whole(std::span<const Record> records) const override;
};

constexpr std::string_view kTum = "tum", kHolds = "one camera";
constexpr double kDepthUnit_m = 1.0 / 5000;

std::string time_text(std::int64_t time_ns) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%lld.%06lld", static_cast<long long>(time_ns / kSecond),
                static_cast<long long>(time_ns % kSecond / 1000));
  return text.data();
}

std::string pose_line(const Record& record) {
  const glm::dmat4 pose = rigid_of(record.at("pose"));
  const glm::dvec4 q = quaternion_xyzw(pose);
  std::string line = record.at("time").get<std::string>();
  for (const double number : {pose[3].x, pose[3].y, pose[3].z, q.x, q.y, q.z, q.w}) line += " " + format_number(number);
  return line + "\n";
}

}  // namespace

void TumFormat::begin(std::span<const DatasetSensor> sensors) {
  for (const DatasetSensor& sensor : sensors) {
    if (!is_camera(sensor) || sensor.measurement.calibrations->size() > 1 || &sensor != sensors.data()) {
      refuse_sensor(sensor, kTum, kHolds);
    }
    require_outputs(sensor, kTum, {kNeedsColor, kNeedsDepth});
  }
  require_views(sensors, kTum);
}

FramePiece TumFormat::frame(const DatasetFrame& frame) const {
  FramePiece piece;
  for (const SeenView& view : views_of(frame.sensors)) {
    const std::string time = time_text(frame.time.time_ns);
    const std::size_t bytes = view.color->pixels.size() * sizeof(float);
    piece.files.push_back({"rgb/" + time + ".png", [color = *view.color] { return encode_png(color); }, bytes});
    piece.files.push_back(
        {"depth/" + time + ".png", [depth = *view.depth] { return encode_depth_png(depth, kDepthUnit_m); }, bytes / 4});
    piece.record = {{"time", time}, {"pose", rigid_record(view.world_from_optical)}};
  }
  return piece;
}

std::vector<DatasetFile> TumFormat::whole(std::span<const Record> records) const {
  std::string color = "# color images\n# timestamp filename\n", depth = "# depth maps\n# timestamp filename\n",
              poses = "# ground truth trajectory\n# timestamp tx ty tz qx qy qz qw\n", last;
  for (const Record& record : records) {
    if (!record.contains("time")) continue;
    const auto time = record.at("time").get<std::string>();
    if (time == last) {
      throw InputError("--dataset tum: two frames have the time " + time + " s, expected a lower --rate");
    }
    last = time;
    color += time;
    color += " rgb/" + time + ".png\n";
    depth += time;
    depth += " depth/" + time + ".png\n";
    poses += pose_line(record);
  }
  std::vector<DatasetFile> files;
  files.push_back(text_file("rgb.txt", color));
  files.push_back(text_file("depth.txt", depth));
  files.push_back(text_file("groundtruth.txt", poses));
  return files;
}

namespace {

const DatasetFormatRegistration kTumRegistration(kTum, [](double) -> std::unique_ptr<DatasetFormat> {
  return std::make_unique<TumFormat>();
});

}  // namespace
}  // namespace simvis
