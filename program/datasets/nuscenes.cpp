// nuScenes: the tables of its schema v1.0, pictures of pinhole cameras and sweeps of laser scanners.
//
//   v1.0-simvis/*.json                  the thirteen tables; one scene, "scene-0001"
//   samples/SENSOR/000000.png .bin      of key frames; sweeps/SENSOR/... of all others
//   maps/none.png                       a map of one pixel, which says nothing: there is no map
//
// Frames   A key frame is one in which all sensors measure. The frame "ego" is that of the first scanner by its name.
//          Without a scanner it is that of the first camera: x forward, y left, z up. Its pose is in three dimensions.
//          Sensors must be on one body. A camera's frame is its optical one (x right, y down, z forward); the principal
//          point counts from the centre of the first pixel.
// Points   float32 x y z intensity ring, in metres in the scanner's frame. The intensity is not scaled to 255; it is 0
//          for a scanner without the column `intensity`.
// Boxes    of all shapes with a class in key frames, seen or not, in metres in the world: width (y), length (x),
//          height (z). num_lidar_pts counts points that are on the shape, so scanners need truth="instance". Visibility
//          is the share of visible_pixels in picture_pixels over all cameras with `boxes`; without them it is empty.
// Times    microseconds of simulated time. Tokens are numbers of 32 digits, unique in the dataset.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include <simvis/location.h>
#include <simvis/pose.h>
#include "engine/base/time_units.h"
#include "engine/draw/oriented_box.h"
#include "program/datasets/classes.h"
#include "program/datasets/dataset_format.h"
#include "program/datasets/rigid_text.h"
#include "program/datasets/scan_points.h"
#include "program/datasets/seen_view.h"
#include "program/output/output_writer.h"
#include "scenegraph/pictures/png_bytes.h"
#include "scenegraph/pictures/png_file.h"

namespace simvis {
namespace {

class NuscenesFormat : public DatasetFormat {
 public:
  void begin(std::span<const DatasetSensor> sensors) override;
  FramePiece frame(const DatasetFrame& frame) const override;
  std::vector<DatasetFile> whole(std::span<const Record> records) const override;

 private:
  std::vector<std::string> sensors_;  // names of scanners and views; the first one stands in the frame "ego"
};

constexpr std::string_view kNuscenes = "nuscenes", kNuscenesHolds = "pinhole cameras and laser scanners";
constexpr const char *kTables = "v1.0-simvis/", *kMap = "maps/none.png";

enum class TokenOf : std::uint8_t {
  category,
  instance,
  sensor,
  calibrated_sensor,
  ego_pose,
  log,
  scene,
  sample,
  sample_data,
  sample_annotation,
  map
};

/// 32 hexadecimal digits; the same numbers give the same token.
std::string token(TokenOf table, std::uint64_t row, std::uint64_t column = 0) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%04x%012llx%016llx", static_cast<unsigned>(table),
                static_cast<unsigned long long>(row), static_cast<unsigned long long>(column));
  return text.data();
}

Record vector_record(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

/// w first.
Record rotation_record(const glm::dmat4& pose) {
  const glm::dvec4 q = quaternion_xyzw(pose);
  return {q.w, q.x, q.y, q.z};
}

Record place_record(const glm::dmat4& pose) {
  return {{"translation", vector_record(glm::dvec3(pose[3]))}, {"rotation", rotation_record(pose)}};
}

Record matrix_record(const Pinhole& p) {
  return {Record{p.fx_px, 0.0, p.cx_px - kFirstCentre_px}, Record{0.0, p.fy_px, p.cy_px - kFirstCentre_px},
          Record{0.0, 0.0, 1.0}};
}

/// How much of one object the sensors of a frame see.
struct SeenObject {
  std::uint64_t points = 0, visible_pixels = 0, picture_pixels = 0;

  /// The token of a row of the table `visibility`. Empty without `is_known`, if no camera has the table `boxes`.
  std::string visibility(bool is_known) const {
    if (!is_known) return "";
    const double share =
        picture_pixels == 0 ? 0 : static_cast<double>(visible_pixels) / static_cast<double>(picture_pixels);
    return share < 0.4 ? "1" : share < 0.6 ? "2" : share < 0.8 ? "3" : "4";
  }
};

Record visibility_table() {
  Record table = Record::array();
  const char* const levels[] = {"0-40", "40-60", "60-80", "80-100"};
  for (std::size_t i = 0; i < std::size(levels); ++i) {
    table.push_back({{"token", std::to_string(i + 1)},
                     {"level", std::string("v") + levels[i]},
                     {"description", std::string("visible share of the pixels in all cameras: ") + levels[i] + " %"}});
  }
  return table;
}

/// Whether the object has a class, an end, and a surface that is not hidden.
bool has_box(const SceneObject& object, const DrawList& list) {
  return object.semantic != 0 && std::isfinite(object.low_m.x) &&
         std::ranges::any_of(object.surfaces, [&](const ObjectSurface& each) { return list.items[each.item].visible; });
}

/// The objects with a class, in the order of the scene.
Record objects_record(const DatasetFrame& frame, const std::map<std::uint32_t, SeenObject>& seen,
                      bool knows_visibility) {
  Record objects = Record::array();
  for (const SceneObject& object : frame.objects) {
    if (!has_box(object, frame.list)) continue;
    const OrientedBox box = oriented_box(object.low_m, object.high_m, frame.list.world_from_node[object.transform]);
    const auto found = seen.find(object.instance);
    const SeenObject own = found == seen.end() ? SeenObject{} : found->second;
    const glm::dquat& q = box.orientation;
    objects.push_back({{"instance", object.instance},
                       {"class", object.semantic},
                       {"translation", vector_record(box.centre_m)},
                       {"size", {box.size_m.y, box.size_m.x, box.size_m.z}},
                       {"rotation", {q.w, q.x, q.y, q.z}},
                       {"points", own.points},
                       {"visibility", own.visibility(knows_visibility)}});
  }
  return objects;
}

/// Classes of nuScenes: those that nuscenes-devkit 1.2.0 has a color for, in nuscenes/utils/color_map.py.
constexpr std::string_view kColoredClasses[] = {"animal",
                                                "flat.driveable_surface",
                                                "flat.other",
                                                "flat.sidewalk",
                                                "flat.terrain",
                                                "human.pedestrian.adult",
                                                "human.pedestrian.child",
                                                "human.pedestrian.construction_worker",
                                                "human.pedestrian.personal_mobility",
                                                "human.pedestrian.police_officer",
                                                "human.pedestrian.stroller",
                                                "human.pedestrian.wheelchair",
                                                "movable_object.barrier",
                                                "movable_object.debris",
                                                "movable_object.pushable_pullable",
                                                "movable_object.trafficcone",
                                                "noise",
                                                "static.manmade",
                                                "static.other",
                                                "static.vegetation",
                                                "static_object.bicycle_rack",
                                                "vehicle.bicycle",
                                                "vehicle.bus.bendy",
                                                "vehicle.bus.rigid",
                                                "vehicle.car",
                                                "vehicle.construction",
                                                "vehicle.ego",
                                                "vehicle.emergency.ambulance",
                                                "vehicle.emergency.police",
                                                "vehicle.motorcycle",
                                                "vehicle.trailer",
                                                "vehicle.truck"};

/// A warning of each class of boxes that the devkit cannot draw.
std::vector<std::string> warnings_of_colors(const DatasetFrame& frame) {
  std::set<std::string> unknown;
  for (const SceneObject& object : frame.objects) {
    if (has_box(object, frame.list) && std::ranges::count(kColoredClasses, object.label) == 0)
      unknown.insert(object.label);
  }
  std::vector<std::string> warnings;
  warnings.reserve(unknown.size());
  for (const std::string& name : unknown) {
    warnings.push_back("--dataset nuscenes: nuscenes-devkit has no color for the class " + in_quotes(name) +
                       ", and a KeyError ends the drawing of its boxes; expected a class of nuScenes, such as "
                       "\"vehicle.car\", or colors for all classes, given to it as NuScenes(colormap=...)");
  }
  return warnings;
}

/// One frame's files and the records of its sensors.
class FrameParts {
 public:
  FrameParts(std::uint64_t frame, bool is_key)
      : folder_(is_key ? "samples/" : "sweeps/"), name_("/" + frame_name(frame)) {}

  void add(const SeenView& view, FramePiece& piece) {
    const std::string file = folder_ + view.name + name_ + ".png";
    piece.files.push_back(
        {file, [color = *view.color] { return encode_png(color); }, view.color->pixels.size() * sizeof(float)});
    piece.record["sensors"][view.name] = {{"modality", "camera"},
                                          {"file", file},
                                          {"fileformat", "png"},
                                          {"pose", rigid_record(view.world_from_optical)},
                                          {"matrix", matrix_record(view.camera.pinhole)},
                                          {"width", view.camera.width_px},
                                          {"height", view.camera.height_px}};
    for (const ObjectInView& object : view.objects) {
      SeenObject& own = seen_[object.instance];
      own.visible_pixels += object.visible_pixels;
      own.picture_pixels += object.picture_pixels;
    }
  }

  void add(const DatasetSensor& scanner, FramePiece& piece) {
    const std::string file = folder_ + scanner.name + name_ + ".bin";
    const ScanPoints points(scanner.measurement);
    if (!points.has_instances()) {
      throw InputError("--dataset nuscenes: scanner \"" + scanner.name +
                       "\" does not say which objects its points are on, expected truth=\"instance\"");
    }
    piece.files.push_back(text_file(file, points.xyz_intensity_ring()));
    piece.record["sensors"][scanner.name] = {{"modality", "lidar"},
                                             {"file", file},
                                             {"fileformat", "bin"},
                                             {"pose", rigid_record(scanner.world_from_sensor)},
                                             {"matrix", Record::array()},
                                             {"width", 0},
                                             {"height", 0}};
    for (const auto& [instance, count] : points.points_of()) seen_[instance].points += count;
  }

  const std::map<std::uint32_t, SeenObject>& seen() const { return seen_; }

 private:
  std::string folder_, name_;
  std::map<std::uint32_t, SeenObject> seen_;  // by instance
};

/// Writes the tables from the records of all frames.
class Tables {
 public:
  Tables(std::span<const Record> records, std::span<const std::string> sensors) : records_(records) {
    for (std::size_t i = 0; i < records.size(); ++i) {
      if (records[i].at("is_key").get<bool>()) keys_.push_back(i);
    }
    if (keys_.empty()) {
      throw InputError(
          "--dataset nuscenes: there is no frame in which all sensors measure, expected rates with common frames, or "
          "more frames");
    }
    for (std::size_t i = 0; i < sensors.size(); ++i) add_sensor(sensors[i], sensors.front(), i);
    for (std::size_t i = 0; i < records.size(); ++i) add_frame(i);
    for (const std::size_t key : keys_) add_sample(key);
    for (const auto& [name, chain] : data_) link(chain, "sample_data");
    for (const auto& [instance, chain] : annotations_) link(chain, "sample_annotation");
    add_instances();
    add_scene();
  }

  std::vector<DatasetFile> files() const {
    std::vector<DatasetFile> files;
    for (const char* const name : {"category", "attribute", "visibility", "instance", "sensor", "calibrated_sensor",
                                   "ego_pose", "log", "scene", "sample", "sample_data", "sample_annotation", "map"}) {
      const auto found = tables_.find(name);
      const Record table = found == tables_.end() ? Record::array() : found->second;
      files.push_back(text_file(std::string(kTables) + name + ".json", table.dump(0) + "\n"));
    }
    files.push_back(
        text_file(kMap, png_bytes({.width = 1, .height = 1, .bits = 8, .channels = 1}, std::array<std::uint8_t, 1>{})));
    return files;
  }

 private:
  Record& table(const std::string& name) { return tables_.try_emplace(name, Record::array()).first->second; }

  static glm::dmat4 pose_of(const Record& record, const std::string& sensor) {
    return rigid_of(record.at("sensors").at(sensor).at("pose"));
  }

  // World from ego; `first` is the sensor that stands in the frame "ego".
  static glm::dmat4 ego_of(const Record& record, const std::string& first) {
    const bool is_camera = record.at("sensors").at(first).at("modality") == "camera";
    return pose_of(record, first) * (is_camera ? glm::inverse(sensor_from_view()) : glm::dmat4(1));
  }

  void add_sensor(const std::string& name, const std::string& first, std::size_t number) {
    numbers_[name] = number;
    glm::dmat4& ego_from_sensor = ego_from_sensor_[name];
    for (const std::size_t key : keys_) {
      const glm::dmat4 now = glm::inverse(ego_of(records_[key], first)) * pose_of(records_[key], name);
      if (key == keys_.front()) ego_from_sensor = now;
      if (is_same_place(ego_from_sensor, now)) continue;
      throw InputError("--dataset nuscenes: in frame " + std::to_string(key) + " \"" + name +
                       "\" is elsewhere relative to \"" + first + "\" than before, expected both on one body");
    }
    const Record& own = records_[keys_.front()].at("sensors").at(name);
    table("sensor").push_back(
        {{"token", token(TokenOf::sensor, number)}, {"channel", name}, {"modality", own.at("modality")}});
    Record calibrated{{"token", token(TokenOf::calibrated_sensor, number)},
                      {"sensor_token", token(TokenOf::sensor, number)}};
    calibrated.update(place_record(ego_from_sensor));
    calibrated["camera_intrinsic"] = own.at("matrix");
    table("calibrated_sensor").push_back(std::move(calibrated));
  }

  // The key frame that follows, or the last one.
  std::size_t key_of(std::size_t frame) const {
    const auto next = std::ranges::lower_bound(keys_, frame);
    return next == keys_.end() ? keys_.back() : *next;
  }

  void add_frame(std::size_t frame) {
    const Record& record = records_[frame];
    const Record& sensors = record.at("sensors");
    if (sensors.empty()) return;
    const std::string& any = sensors.begin().key();
    Record ego{{"token", token(TokenOf::ego_pose, frame)}, {"timestamp", record.at("time_us")}};
    ego.update(place_record(pose_of(record, any) * glm::inverse(ego_from_sensor_.at(any))));
    table("ego_pose").push_back(std::move(ego));
    for (const auto& [name, own] : sensors.items()) {
      data_[name].push_back(table("sample_data").size());
      table("sample_data")
          .push_back({{"token", token(TokenOf::sample_data, frame, numbers_.at(name))},
                      {"sample_token", token(TokenOf::sample, key_of(frame))},
                      {"ego_pose_token", token(TokenOf::ego_pose, frame)},
                      {"calibrated_sensor_token", token(TokenOf::calibrated_sensor, numbers_.at(name))},
                      {"filename", own.at("file")},
                      {"fileformat", own.at("fileformat")},
                      {"width", own.at("width")},
                      {"height", own.at("height")},
                      {"timestamp", record.at("time_us")},
                      {"is_key_frame", record.at("is_key")}});
    }
  }

  void add_sample(std::size_t key) {
    const auto at = std::ranges::find(keys_, key);
    table("sample").push_back({{"token", token(TokenOf::sample, key)},
                               {"timestamp", records_[key].at("time_us")},
                               {"scene_token", token(TokenOf::scene, 0)},
                               {"prev", at == keys_.begin() ? "" : token(TokenOf::sample, *std::prev(at))},
                               {"next", std::next(at) == keys_.end() ? "" : token(TokenOf::sample, *std::next(at))}});
    for (const Record& object : records_[key].at("things")) {
      const auto id = object.at("instance").get<std::uint32_t>();
      annotations_[id].push_back(table("sample_annotation").size());
      classes_[id] = object.at("class").get<std::uint32_t>();
      table("sample_annotation")
          .push_back({{"token", token(TokenOf::sample_annotation, key, id)},
                      {"sample_token", token(TokenOf::sample, key)},
                      {"instance_token", token(TokenOf::instance, id)},
                      {"attribute_tokens", Record::array()},
                      {"visibility_token", object.at("visibility")},
                      {"translation", object.at("translation")},
                      {"size", object.at("size")},
                      {"rotation", object.at("rotation")},
                      {"num_lidar_pts", object.at("points")},
                      {"num_radar_pts", 0}});
    }
  }

  // Links the given rows of a table by `prev` and `next`.
  void link(const std::vector<std::size_t>& rows, const std::string& name) {
    Record& all = table(name);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      all[rows[i]]["prev"] = i == 0 ? Record("") : all[rows[i - 1]].at("token");
      all[rows[i]]["next"] = i + 1 == rows.size() ? Record("") : all[rows[i + 1]].at("token");
    }
  }

  void add_instances() {
    for (const auto& [instance, rows] : annotations_) {
      table("instance")
          .push_back({{"token", token(TokenOf::instance, instance)},
                      {"category_token", token(TokenOf::category, classes_.at(instance))},
                      {"nbr_annotations", rows.size()},
                      {"first_annotation_token", table("sample_annotation")[rows.front()].at("token")},
                      {"last_annotation_token", table("sample_annotation")[rows.back()].at("token")}});
    }
    for (const auto& [id, name] : all_classes(records_)) {
      table("category")
          .push_back({{"token", token(TokenOf::category, id)}, {"name", name}, {"description", ""}, {"index", id}});
    }
    table("visibility") = visibility_table();
  }

  // Simulated time counts from the first second of 1970.
  void add_scene() {
    table("log").push_back({{"token", token(TokenOf::log, 0)},
                            {"logfile", ""},
                            {"vehicle", "SimVis"},
                            {"date_captured", "1970-01-01"},
                            {"location", "simulation"}});
    table("scene").push_back({{"token", token(TokenOf::scene, 0)},
                              {"name", "scene-0001"},
                              {"description", "made with SimVis"},
                              {"log_token", token(TokenOf::log, 0)},
                              {"nbr_samples", keys_.size()},
                              {"first_sample_token", token(TokenOf::sample, keys_.front())},
                              {"last_sample_token", token(TokenOf::sample, keys_.back())}});
    table("map").push_back({{"token", token(TokenOf::map, 0)},
                            {"log_tokens", Record::array({token(TokenOf::log, 0)})},
                            {"category", "semantic_prior"},
                            {"filename", kMap}});
  }

  std::span<const Record> records_;
  std::vector<std::size_t> keys_;  // key frames
  std::map<std::string, Record> tables_;
  std::map<std::string, std::size_t> numbers_;                     // of sensors
  std::map<std::string, glm::dmat4> ego_from_sensor_;              // by sensor
  std::map<std::string, std::vector<std::size_t>> data_;           // rows of sample_data by sensor
  std::map<std::uint32_t, std::vector<std::size_t>> annotations_;  // rows of sample_annotation by instance
  std::map<std::uint32_t, std::uint32_t> classes_;                 // by instance
};

}  // namespace

void NuscenesFormat::begin(std::span<const DatasetSensor> sensors) {
  sensors_.clear();
  for (const DatasetSensor& sensor : sensors) {
    if (is_camera(sensor)) {
      require_outputs(sensor, kNuscenes, {kNeedsColor});
      require_pinhole(sensor, kNuscenes);
    } else if (!is_scanner(sensor)) {
      refuse_sensor(sensor, kNuscenes, kNuscenesHolds);
    } else {
      sensors_.push_back(sensor.name);
    }
  }
  require_own_names(sensors, kNuscenes);
  for (const SeenView& view : views_of(sensors)) {
    if (std::ranges::count(sensors_, view.name) > 0) {
      throw InputError("--dataset nuscenes: a view and a scanner have the name \"" + view.name +
                       "\", expected another name for one of them");
    }
    sensors_.push_back(view.name);
  }
  if (sensors_.empty()) {
    throw InputError("--dataset nuscenes: the scene has no camera or scanner that is on, expected at least one");
  }
}

FramePiece NuscenesFormat::frame(const DatasetFrame& frame) const {
  FramePiece piece;
  const std::vector<SeenView> views = views_of(frame.sensors);
  const auto scanners = static_cast<std::size_t>(std::ranges::count_if(frame.sensors, is_scanner));
  const bool is_key = views.size() + scanners == sensors_.size();
  piece.record = {{"time_us", frame.time.time_ns / kMicrosecond_ns}, {"is_key", is_key}, {"sensors", Record::object()}};
  FrameParts parts(frame.time.index, is_key);
  for (const SeenView& view : views) parts.add(view, piece);
  bool knows_visibility = false;
  for (const DatasetSensor& sensor : frame.sensors) {
    if (is_scanner(sensor)) parts.add(sensor, piece);
    knows_visibility |= is_camera(sensor) && sensor.measurement.find("visible_pixels") != nullptr;
  }
  piece.record["things"] = is_key ? objects_record(frame, parts.seen(), knows_visibility) : Record::array();
  piece.record["classes"] = classes_record(frame.items);
  if (is_key) piece.warnings = warnings_of_colors(frame);
  return piece;
}

std::vector<DatasetFile> NuscenesFormat::whole(std::span<const Record> records) const {
  return Tables(records, sensors_).files();
}

namespace {

const DatasetFormatRegistration kNuscenesRegistration(kNuscenes, [](double) -> std::unique_ptr<DatasetFormat> {
  return std::make_unique<NuscenesFormat>();
});

}  // namespace
}  // namespace simvis
