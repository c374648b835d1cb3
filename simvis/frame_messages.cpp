#include "simvis/frame_messages.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <utility>
#include <variant>

#include <simvis/error.h>
#include <simvis/pose.h>
#include "elements/described_robot.h"
#include "exchange/messages/from_events.h"
#include "exchange/messages/from_image.h"
#include "exchange/messages/from_reading.h"
#include "exchange/messages/types/output_types.h"
#include "exchange/messages/types/system_types.h"
#include "sensors/delayed_sensor.h"
#include "sensors/sample_period.h"
#include "sensors/timing_faults.h"
#include "simvis/ros/object_markers.h"
#include "simvis/ros/sensor_topics.h"
#include "simvis/sharing/output_message.h"

namespace simvis {
namespace {

const std::string kObjectsTopic = "/simvis/objects";

const void* memory_of(const MeasuredNumbers& numbers) {
  return std::visit([](const auto& all) -> const void* { return all.data(); }, numbers);
}

ros::Parameter parameter_message(const Parameters& parameters, std::size_t index) {
  constexpr std::uint8_t kDouble = 3;
  ros::Parameter message;
  message.name = parameters.name(index);
  message.value.type = kDouble;
  message.value.double_value = parameters.values()[index];
  return message;
}

struct ImageTopic {
  std::string_view what;
  std::string_view encoding;
  ros::TopicForm form;
  bool compressed;
};
// Names are those of image_transport, which puts compressed images below the topic of the raw ones, and looks for
// camera_info beside it.
constexpr ImageTopic kColorTopics[] = {{"image_raw", "rgb8", ros::TopicForm::own, false},
                                       {"image_raw/bgr8", "bgr8", ros::TopicForm::other, false},
                                       {"image_raw/mono16", "mono16", ros::TopicForm::other, false},
                                       {"image_raw/compressed", "jpeg", ros::TopicForm::other, true},
                                       {"image_raw/compressed_png", "png", ros::TopicForm::other, true}};
constexpr ImageTopic kDepthTopics[] = {
    {"depth/image_raw", "32FC1", ros::TopicForm::own, false},
    {"depth/image_raw/compressedDepth", ros::kCompressedDepth, ros::TopicForm::other, true},
    {"depth/millimetres", "16UC1", ros::TopicForm::other, false}};
// Counts are the pixels of a thermal camera.
constexpr std::string_view kCountsTopic = "thermal/image_raw";
constexpr std::pair<ImageContent, std::string_view> kInfoTopics[] = {{ImageContent::color, "camera_info"},
                                                                     {ImageContent::depth, "depth/camera_info"},
                                                                     {ImageContent::counts, "thermal/camera_info"}};

}  // namespace

std::vector<std::string> unmatched_warnings(std::string_view outlet, const ros::TopicFilter& topics) {
  std::vector<std::string> warnings;
  for (const std::string& pattern : topics.unmatched()) {
    warnings.push_back(std::string(outlet) + ": no topic of the first frame matches " + in_quotes(pattern));
  }
  return warnings;
}

void check_messages(const BuiltScene& scene, std::string_view node) {
  FrameTree().follow(scene);
  check_topics(scene, node);
}

/// Turns one measurement into a job.
class FrameMessages::SensorMessages {
 public:
  SensorMessages(FrameMessages& messages, const PlacedSensor& placed)
      : messages_(messages),
        placed_(placed),
        sensor_(placed.sensor),
        frame_(messages.frames_.of_sensor(placed.sensor)),
        topics_(placed.sensor) {}

  /// All messages; `period_s` is the time between measurements.
  void add(const Measurement& measurement, double period_s) {
    const std::string_view message = find_sensor_type(sensor_.type)->message;
    if (const Scan* const scan = sensor_.sensor->scan()) {
      add_scan(*scan, limits_of(measurement), period_s);
      for (const MeasuredArray& each : measurement.arrays) add_layout(each);
    } else if (const Reading* const reading = sensor_.sensor->reading();
               reading != nullptr && ros::reading_topic(message)) {
      add_reading(*reading, message, measurement);
    } else if (const CameraCalibration* const camera = camera_of_events(measurement)) {
      add_events(*sensor_.sensor->reading(), *camera);
      for (const MeasuredArray& each : measurement.arrays) {
        if (each.kind == OutputKind::table_column && !is_in_packet(each)) {
          add_output(each, ros::header_of(stamp_ns(), frame_), ros::TopicForm::other);
        }
      }
    } else {
      for (const MeasuredArray& each : measurement.arrays) {
        if (each.kind == OutputKind::scalar) add_number(each);
        if (each.kind == OutputKind::table_column) add_output(each, ros::header_of(stamp_ns(), frame_));
      }
    }
    if (const DelayedSensor* const delayed = sensor_.delayed) {
      messages_.add(topic("", kCaptureTime), ros::Float64{delayed->capture_time_s()});
      messages_.add(topic("", kArrivalTime), ros::Float64{delayed->arrival_time_s()});
    }
    if (measurement.calibrations != nullptr) add_views(measurement);
    for (const MeasuredArray& each : measurement.arrays) {
      if (each.kind == OutputKind::image) add_image(each, measurement);
    }
    finish_images();
  }

 private:
  static ros::RangeLimits limits_of(const Measurement& measurement) {
    ros::RangeLimits limits{0, std::numeric_limits<double>::infinity()};
    for (const NamedValue& each : measurement.constants) {
      if (each.name == "range_min_m") limits.min_m = each.value;
      if (each.name == "range_max_m") limits.max_m = each.value;
    }
    return limits;
  }

  static bool is_in_packet(const MeasuredArray& array) { return array.message == ros::EventPacket::kName; }

  /// The camera whose events are sent as packets; null: there is none, or a packet cannot address its pixels.
  const CameraCalibration* camera_of_events(const Measurement& measurement) const {
    if (std::ranges::none_of(measurement.arrays, is_in_packet)) return nullptr;
    const CameraCalibration* const camera = measurement.calibration("");
    return camera != nullptr && ros::fits_event_packet(camera->width_px, camera->height_px) ? camera : nullptr;
  }

  // One after the other, so that each packet begins where the one before ends.
  void add_events(const Reading& reading, const CameraCalibration& camera) {
    const std::string name = topic("", "events");
    if (!messages_.outlet_.wants<ros::EventPacket>(name)) return;
    ros::PacketPlace& next =
        messages_.event_packets_.try_emplace(sensor_.id, ros::PacketPlace{0, stamp_ns()}).first->second;
    const ros::PacketPlace place = std::exchange(next, {next.number + 1, stamp_ns()});
    add_job(reading.values().size() * sizeof(double), 1,
            [=, reading = reading, width = camera.width_px, height = camera.height_px,
             frame = optical_frame(frame_, ""), time = time_ns()](ros::MessageSink& sink) {
              sink.write(name, time, ros::event_packet(reading, width, height, frame, place));
            });
  }

  // Views without images and events have no messages.
  void add_views(const Measurement& measurement) {
    const bool has_events = camera_of_events(measurement) != nullptr;
    for (const Calibration& each : *measurement.calibrations) {
      const auto is_seen = [&](ImageContent content) {
        if (has_events && content == ImageContent::color) return true;
        return std::ranges::any_of(measurement.arrays, [&](const MeasuredArray& array) {
          return array.view == each.view && array.content == content;
        });
      };
      const bool any = std::ranges::any_of(kInfoTopics, [&](const auto& each) { return is_seen(each.first); });
      if (!any) continue;
      glm::dmat4 sensor_from_optical = sensor_from_view();
      sensor_from_optical[3] = glm::dvec4(0, -each.camera.baseline_m, 0, 1);
      messages_.transforms_.set(frame_, optical_frame(frame_, each.view), sensor_from_optical, false);
      for (const auto& [content, what] : kInfoTopics) {
        if (!is_seen(content)) continue;
        messages_.add(topic(each.view, what), ros::camera_info(each.camera, header_of(each.view)));
      }
    }
  }

  void add_image(const MeasuredArray& array, const Measurement& measurement) {
    const ros::Header header = header_of(array.view);
    const std::optional<Image> image = to_image(array);
    if (array.content == ImageContent::color) return add_image(array.view, *image, header, kColorTopics);
    if (array.content == ImageContent::depth) return add_image(array.view, *image, header, kDepthTopics);
    if (array.content == ImageContent::counts) return add_counts(array, header);
    if (array.content != ImageContent::disparity) return add_output(array, header);
    const std::string name = topic("", array.name);
    if (!messages_.outlet_.wants<ros::DisparityImage>(name)) return;
    image_bytes_ += array.bytes();
    image_messages_.push_back([plane = *image, name, right = *measurement.calibration("right"), header,
                               time = time_ns()](ros::MessageSink& sink) {
      sink.write(name, time, ros::disparity_image(plane, right, header));
    });
  }

  void add_counts(const MeasuredArray& array, const ros::Header& header) {
    const std::string name = topic(array.view, kCountsTopic);
    if (array.count() == 0 || !messages_.outlet_.wants<ros::Image>(name)) return;
    image_bytes_ += array.bytes();
    image_messages_.push_back([array, name, header, time = time_ns()](ros::MessageSink& sink) {
      const auto& counts = std::get<SharedArray<std::uint32_t>>(array.numbers);
      sink.write(name, time, ros::counts_image(counts.numbers(), array.shape.columns, header));
    });
  }

  // An output that no standard message has.
  void add_output(const MeasuredArray& array, const ros::Header& header, ros::TopicForm form = ros::TopicForm::own) {
    const std::string name = topic("", array.name);
    if (array.count() == 0 || !messages_.outlet_.wants<ros::OutputStamped>(name, form)) return;
    image_bytes_ += array.bytes();
    image_messages_.push_back([array, name, header, time = time_ns()](ros::MessageSink& sink) {
      sink.write(name, time, ros::OutputStamped{header, to_message(array)});
    });
  }

  // Sends outputs that no ROS message carries, such as the angles of beams, once per change. Leaves out those of a
  // running pattern, which change with each scan.
  void add_layout(const MeasuredArray& array) {
    constexpr ros::Durability kLatched = ros::Durability::latched;
    if (!array.message.empty() || array.count() == 0) return;
    MeasuredNumbers& sent = messages_.sent_layouts_[{sensor_.id, array.name}];
    const std::string name = topic("", array.name);
    if (memory_of(sent) == memory_of(array.numbers)) return;
    if (!messages_.outlet_.wants<ros::OutputStamped>(name, ros::TopicForm::own, kLatched)) return;
    add_job(array.bytes(), 1, [=, array = array, frame = frame_, time = time_ns()](ros::MessageSink& sink) {
      sink.write(name, time, ros::OutputStamped{ros::header_of(time, frame), to_message(array)}, kLatched);
    });
    messages_.jobs_.back().layout = &sent;
    messages_.jobs_.back().numbers = array.numbers;
  }

  void add_number(const MeasuredArray& array) {
    if (array.count() == 0) return;
    messages_.add(topic("", array.name), ros::Float64{array.number(0)});
  }

  void add_scan(const Scan& scan, const ros::RangeLimits& limits, double scan_time_s) {
    const std::string planar = topic("", "scan"), cloud = topic("", "points");
    const bool wants_planar = scan.rings == 1 && messages_.outlet_.wants<ros::LaserScan>(planar);
    const bool wants_cloud = messages_.outlet_.wants<ros::PointCloud2>(cloud);
    if (!wants_planar && !wants_cloud) return;
    const std::size_t beam_bytes = 2 * sizeof(float) + scan.channels().size() * sizeof(double);
    add_job(scan.range_m.size() * beam_bytes, std::uint64_t{wants_planar} + std::uint64_t{wants_cloud},
            [=, scan = scan, frame = frame_, time = time_ns()](ros::MessageSink& sink) {
              if (wants_planar) {
                const std::optional<ros::LaserScan> message = ros::laser_scan(scan, frame, limits, scan_time_s);
                if (message) sink.write(planar, time, *message);
              }
              if (wants_cloud) sink.write(cloud, time, ros::point_cloud(scan, frame));
            });
  }

  void add_reading(const Reading& reading, std::string_view message, const Measurement& measurement) {
    const ros::ReadingTopic kind = *ros::reading_topic(message);
    const std::string name = topic("", kind.topic);
    const bool is_wanted = messages_.outlet_.wants({.name = name, .type = kind.type}, ros::TopicForm::own);
    if (std::optional<ros::ReadingMessage> made =
            is_wanted ? ros::message_of(reading, message, frame_) : std::nullopt) {
      if (auto* const odometry = std::get_if<ros::Odometry>(&made->message)) *odometry = of_part(std::move(*odometry));
      std::visit([&](auto& each) { messages_.add(name, std::move(each)); }, made->message);
    }
    // What the message has no place for.
    for (const MeasuredArray& each : measurement.arrays) {
      if (each.kind == OutputKind::scalar && each.message != message) add_number(each);
    }
  }

  /// What moves is the part that carries the sensor.
  ros::Odometry of_part(ros::Odometry odometry) const {
    odometry.header.frame_id = odometry_frame(sensor_);
    const std::optional<glm::dmat4> part_from_sensor = messages_.frames_.point_from_sensor(placed_);
    if (!part_from_sensor) return odometry;
    return ros::of_body(odometry, *part_from_sensor, messages_.frames_.of_point(insertion_point(sensor_)));
  }

  /// Adds the job of the images, if any of them is wanted.
  void finish_images() {
    if (image_messages_.empty()) return;
    const std::size_t count = image_messages_.size();
    add_job(image_bytes_, count, [all = std::move(image_messages_)](ros::MessageSink& sink) {
      for (const auto& write : all) write(sink);
    });
  }

  static std::size_t bytes_of(const Image& image) { return image.pixels.size() * sizeof(float); }
  std::int64_t time_ns() const { return messages_.time_.time_ns; }
  std::int64_t stamp_ns() const { return placed_.measurement->time_ns; }
  /// In the optical frame of the view; of the second camera of a pair in that of the first one, from which P[3] leads
  /// to its own place: sensor_msgs/CameraInfo, as image_geometry and the camera display of RViz read it.
  ros::Header header_of(const std::string& stem) const {
    const CameraCalibration* const camera = placed_.measurement->calibration(stem);
    const bool is_second = camera != nullptr && camera->baseline_m != 0;
    return ros::header_of(stamp_ns(),
                          optical_frame(frame_, is_second ? placed_.measurement->calibrations->front().view : stem));
  }
  std::string topic(const std::string& stem, std::string_view what) const {
    return topics_.of(stem.empty() ? std::string(what) : stem + "/" + std::string(what));
  }

  void add_job(std::size_t held_bytes, std::uint64_t messages, std::function<void(ros::MessageSink&)> run) {
    messages_.jobs_.push_back(
        {{ros::MessageJob::Kind::measurement, held_bytes, messages, std::move(run)}, nullptr, {}});
  }

  void add_image(const std::string& stem, const Image& image, const ros::Header& header,
                 std::span<const ImageTopic> topics) {
    bool is_counted = false;
    for (const ImageTopic& each : topics) {
      const std::string name = topic(stem, each.what);
      const bool is_wanted = each.compressed ? messages_.outlet_.wants<ros::CompressedImage>(name, each.form)
                                             : messages_.outlet_.wants<ros::Image>(name, each.form);
      if (!is_wanted) continue;
      if (!std::exchange(is_counted, true)) image_bytes_ += bytes_of(image);
      image_messages_.push_back([image, name, each, header, time = time_ns()](ros::MessageSink& sink) {
        if (each.encoding == ros::kCompressedDepth) {
          sink.write(name, time, ros::compressed_depth(image, header));
        } else if (each.compressed) {
          sink.write(name, time, ros::compressed_image(image, header, each.encoding));
        } else {
          sink.write(name, time, ros::to_image(image, header, each.encoding));
        }
      });
    }
  }

  FrameMessages& messages_;
  const PlacedSensor& placed_;
  const BuiltSensor& sensor_;
  std::string frame_;
  SensorTopics topics_;
  std::size_t image_bytes_ = 0;  // of the images that messages are made of
  std::vector<std::function<void(ros::MessageSink&)>> image_messages_;
};

FrameMessages::FrameMessages(ros::MessageOutlet& outlet, const BuiltScene& scene, std::string_view node)
    : outlet_(outlet), node_(node) {
  check_names(scene);
}

void FrameMessages::check_names(const BuiltScene& scene) {
  frames_.follow(scene);
  const std::size_t changes = count_changes(scene);
  if (checked_ == changes) return;
  checked_ = changes;
  std::set<std::size_t> ids;
  for (const BuiltSensor& sensor : scene.sensors) ids.insert(sensor.id);
  std::erase_if(sent_layouts_, [&](const auto& each) { return !ids.contains(each.first.first); });
  std::erase_if(sensors_before_, [&](const auto& each) { return !ids.contains(each.first); });
  std::erase_if(event_packets_, [&](const auto& each) { return !ids.contains(each.first); });
  check_topics(scene, node_);
}

template <ros::Message M>
void FrameMessages::add(const std::string& topic, M message, ros::Durability durability) {
  if (!outlet_.wants<M>(topic, ros::TopicForm::own, durability)) return;
  outlet_.add({.run = [=, time = time_.time_ns, message = std::move(message)](ros::MessageSink& sink) {
    sink.write(topic, time, message, durability);
  }});
}

void FrameMessages::add_frame(const Frame& frame) {
  const BuiltScene& scene = frame.scene;
  const std::span<const PlacedSensor> sensors = frame.sensors;
  check_names(scene);
  time_ = frame.time;
  jobs_.clear();
  transforms_.begin(time_.time_ns);
  add("/clock", ros::Clock{ros::to_time(time_.time_ns)});
  add_parameters(scene.parameters);
  add_descriptions(scene);
  add_warnings(scene.scene.warnings());
  frames_.update(scene, sensors);
  for (const FrameTransform& each : frames_.transforms()) {
    transforms_.set(each.parent, each.child, each.parent_from_child, each.moves);
  }
  add_objects(frame);
  add_bodies(sensors);
  add_poses(sensors);
  add_measurements(sensors);
  if (const std::optional<ros::TFMessage> fixed = transforms_.new_fixed()) {
    add("/tf_static", *fixed, ros::Durability::latched);
  }
  if (!transforms_.moving().transforms.empty()) add("/tf", transforms_.moving());
  for (Pending& each : jobs_) {
    if (outlet_.add(std::move(each.job)) && each.layout != nullptr) *each.layout = std::move(each.numbers);
  }
}

void FrameMessages::add_objects(const Frame& frame) {
  if (!outlet_.wants<ros::MarkerArray>(kObjectsTopic, ros::TopicForm::other)) return;
  ros::MarkerArray markers = object_markers(frame.objects(), frame.list, frames_.world(), time_.time_ns);
  outlet_.add({.run = [time_ns = time_.time_ns, markers = std::move(markers)](ros::MessageSink& sink) {
    sink.write(kObjectsTopic, time_ns, markers);
  }});
}

void FrameMessages::add_bodies(std::span<const PlacedSensor> sensors) {
  std::set<std::string> points;  // that carry sensors
  for (const PlacedSensor& placed : sensors) points.insert(insertion_point(placed.sensor));
  for (const auto& [point, world_from_point] : frames_.world_from_point()) {
    if (!points.contains(point)) continue;
    Body& body = bodies_[point];
    const ros::PoseAt now{time_.time_ns, world_from_point};
    if (body.before) {
      add(ros::topic_name(point, "odom"), ros::odometry(*body.before, now, frames_.world(), frames_.of_point(point)));
    }
    if (outlet_.wants<ros::Path>(ros::topic_name(point, "path"), ros::TopicForm::at_end)) body.path.add(now);
    body.before = now;
  }
}

void FrameMessages::add_poses(std::span<const PlacedSensor> sensors) {
  for (const auto& [sensor, world_from_sensor, measurement] : sensors) {
    if (measurement == nullptr) continue;
    const SensorTopics topics(sensor);
    const ros::PoseAt now{time_.time_ns, world_from_sensor};
    add(topics.of("pose"), ros::pose_stamped(now, frames_.world()));
    const auto [before, is_first] = sensors_before_.try_emplace(sensor.id, now);
    if (is_first) continue;
    add(topics.of("twist"), ros::TwistStamped{ros::header_of(time_.time_ns, frames_.of_sensor(sensor)),
                                              ros::mean_twist(before->second, now)});
    before->second = now;
  }
}

void FrameMessages::add_measurements(std::span<const PlacedSensor> sensors) {
  for (const PlacedSensor& placed : sensors) {
    if (placed.measurement == nullptr) continue;
    SensorMessages messages(*this, placed);
    messages.add(*placed.measurement, sample_period_s(placed.sensor.sensor->rate_hz, time_));
  }
}

// The first event after frames without a listener has all parameters, as new ones. Listeners that come later get all
// values from the services of the node.
void FrameMessages::add_parameters(const Parameters& parameters) {
  if (!outlet_.wants<ros::ParameterEvent>("/parameter_events")) return values_.clear();
  ros::ParameterEvent event;
  event.stamp = ros::to_time(time_.time_ns);
  event.node = node_;
  const std::span<const double> values = parameters.values();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::optional<double> now = parameters.is_removed(i) ? std::nullopt : std::optional(values[i]);
    const std::optional<double> before = i < values_.size() ? values_[i] : std::nullopt;
    if (now == before) continue;
    (!before ? event.new_parameters
     : now   ? event.changed_parameters
             : event.deleted_parameters)
        .push_back(parameter_message(parameters, i));
    values_.resize(std::max(values_.size(), i + 1));
    values_[i] = now;
  }
  const bool changes =
      !event.new_parameters.empty() || !event.changed_parameters.empty() || !event.deleted_parameters.empty();
  if (changes) add("/parameter_events", event);
}

// Once for each robot, when it is new.
void FrameMessages::add_descriptions(const BuiltScene& scene) {
  const std::size_t changes = scene.parameters.changes().size();
  if (std::exchange(described_changes_, changes) == changes) return;
  for (const std::unique_ptr<Element>& element : scene.elements) {
    const auto* const robot = dynamic_cast<const DescribedRobot*>(element.get());
    if (robot == nullptr || std::exchange(descriptions_[robot->topic()], robot->urdf()) == robot->urdf()) continue;
    add(robot->topic(), ros::String{robot->urdf()}, ros::Durability::latched);
  }
}

void FrameMessages::add_warnings(const std::vector<std::string>& warnings) {
  constexpr std::byte kWarn{1};
  if (warnings_ >= warnings.size()) return;
  ros::DiagnosticArray message;
  message.header = ros::header_of(time_.time_ns, "");
  for (; warnings_ < warnings.size(); ++warnings_) {
    message.status.push_back({kWarn, "simvis", warnings[warnings_], "", {}});
  }
  add("/diagnostics", message);
}

void FrameMessages::add_paths() {
  for (auto& [point, body] : bodies_) {
    ros::Path path{ros::header_of(time_.time_ns, frames_.world()), {}};
    for (const ros::PoseAt& pose : body.path.poses()) path.poses.push_back(ros::pose_stamped(pose, frames_.world()));
    if (!path.poses.empty()) add(ros::topic_name(point, "path"), std::move(path));
  }
  bodies_.clear();
}

}  // namespace simvis
