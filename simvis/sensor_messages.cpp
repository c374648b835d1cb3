// What one measurement gives as ROS 2 messages.
#include <algorithm>
#include <limits>
#include <memory>
#include <utility>
#include <variant>

#include <simvis/depth_points.h>
#include <simvis/pose.h>
#include "exchange/messages/from_image.h"
#include "exchange/messages/from_reading.h"
#include "exchange/messages/types/output_types.h"
#include "exchange/messages/types/system_types.h"
#include "exchange/packets/driver_clouds.h"
#include "sensors/cloud_attributes.h"
#include "sensors/delayed_sensor.h"
#include "sensors/sample_period.h"
#include "sensors/timing_faults.h"
#include "simvis/frame_messages.h"
#include "simvis/ros/sensor_topics.h"
#include "simvis/ros/topic_kinds.h"
#include "simvis/sharing/output_message.h"

namespace simvis {
namespace {

const void* memory_of(const MeasuredNumbers& numbers) {
  return std::visit([](const auto& all) -> const void* { return all.data(); }, numbers);
}

struct ImageTopic {
  std::string_view what;
  std::string_view encoding;
  ros::TopicForm form;
  bool compressed;
};
// Names are those of image_transport, which puts compressed images below the topic of the raw ones, and looks for
// camera_info beside it.
constexpr ImageTopic kColorTopics[] = {{kImage, "rgb8", ros::TopicForm::own, false},
                                       {"image_raw/bgr8", "bgr8", ros::TopicForm::other, false},
                                       {"image_raw/mono16", "mono16", ros::TopicForm::other, false},
                                       {"image_raw/compressed", "jpeg", ros::TopicForm::other, true},
                                       {"image_raw/compressed_png", "png", ros::TopicForm::other, true}};
constexpr ImageTopic kDepthTopics[] = {
    {kDepthImage, "32FC1", ros::TopicForm::own, false},
    {"depth/image_raw/compressedDepth", ros::kCompressedDepth, ros::TopicForm::other, true},
    {kDepthMillimetres, "16UC1", ros::TopicForm::other, false}};
constexpr std::pair<ImageContent, std::string_view> kInfoTopics[] = {
    {ImageContent::color, kCameraInfo}, {ImageContent::depth, kDepthInfo}, {ImageContent::counts, kCountsInfo}};

}  // namespace

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
      add_reading(*reading, measurement);
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
    if (ros::has_boxes(measurement.arrays)) add_detections(measurement);
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
    const std::string name = topic("", kEvents);
    if (!outlet().wants<ros::EventPacket>(name)) return;
    ros::PacketPlace& next =
        messages_.event_packets_.try_emplace(sensor_.id, ros::PacketPlace{0, stamp_ns()}).first->second;
    const ros::PacketPlace place = std::exchange(next, {next.number + 1, stamp_ns()});
    add_job(reading.values().size() * sizeof(double), 1,
            [=, reading = reading, width = camera.width_px, height = camera.height_px,
             frame = optical_frame(frame_, ""), time = time_ns()](ros::MessageSink& sink) {
              sink.write(name, time, ros::event_packet(reading, width, height, frame, place));
            });
  }

  // Views without images, events and boxes have no messages.
  void add_views(const Measurement& measurement) {
    const bool has_events = camera_of_events(measurement) != nullptr, has_boxes = ros::has_boxes(measurement.arrays);
    for (const Calibration& each : *measurement.calibrations) {
      const auto is_seen = [&](ImageContent content) {
        if (has_events && content == ImageContent::color) return true;
        return std::ranges::any_of(measurement.arrays, [&](const MeasuredArray& array) {
          return array.view == each.view && array.content == content;
        });
      };
      const bool any = std::ranges::any_of(kInfoTopics, [&](const auto& each) { return is_seen(each.first); });
      if (!any && !has_boxes) continue;
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
    if (array.content == ImageContent::depth) {
      add_depth_cloud(array.view, *image, measurement);
      return add_image(array.view, *image, header, kDepthTopics);
    }
    if (array.content == ImageContent::counts) return add_counts(array, header);
    if (array.content != ImageContent::disparity) return add_output(array, header);
    const std::string name = topic("", array.name);
    if (!outlet().wants<ros::DisparityImage>(name)) return;
    image_bytes_ += array.bytes();
    image_messages_.push_back([plane = *image, name, right = *measurement.calibration("right"), header,
                               time = time_ns()](ros::MessageSink& sink) {
      sink.write(name, time, ros::disparity_image(plane, right, header));
    });
  }

  // The points of a depth image, with the colour of the same view.
  void add_depth_cloud(const std::string& view, const Image& depth, const Measurement& measurement) {
    const std::string name = topic(view, kPoints);
    const CameraCalibration* const camera = measurement.calibration(view);
    if (camera == nullptr || !outlet().wants<ros::PointCloud2>(name, form_of(view, kPoints))) return;
    const auto found = std::ranges::find_if(measurement.arrays, [&](const MeasuredArray& each) {
      return each.content == ImageContent::color && each.view == view && each.count() == 4 * depth.pixels.size();
    });
    const std::optional<Image> color = found == measurement.arrays.end() ? std::nullopt : to_image(*found);
    image_bytes_ += bytes_of(depth);
    image_messages_.push_back([depth, color, camera = *camera, name, header = own_header(view), dense = is_dense(),
                               time = time_ns()](ros::MessageSink& sink) {
      const std::vector<glm::dvec3> points = optical_points(depth, camera);
      if (points.size() != depth.pixels.size()) return;  // the lens of a plug-in
      const std::optional<ImageSpan> colors = color ? std::optional<ImageSpan>(*color) : std::nullopt;
      sink.write(name, time, ros::depth_cloud(points, depth.height, colors ? &*colors : nullptr, header, dense));
    });
  }

  void add_detections(const Measurement& measurement) {
    if (measurement.calibrations == nullptr) return;
    const std::vector<Calibration>& views = *measurement.calibrations;
    for (std::uint32_t i = 0; i < views.size(); ++i) {
      const std::string& view = views[i].view;
      const std::string in_image = topic(view, kDetections), in_space = topic(view, kDetections3D);
      const bool wants_image = outlet().wants<ros::Detection2DArray>(in_image, form_of(view, kDetections)),
                 wants_space = outlet().wants<ros::Detection3DArray>(in_space, form_of(view, kDetections3D));
      if (!wants_image && !wants_space) continue;
      const ros::Detections found =
          ros::detections(measurement.arrays, views.size() > 1 ? std::optional(i) : std::nullopt,
                          messages_.class_names_(), own_header(view));
      if (wants_image) add_own(in_image, found.in_image);
      if (wants_space) add_own(in_space, found.in_space);
    }
  }

  /// Adds a message whose topic is wanted.
  template <ros::Message M>
  void add_own(const std::string& name, const M& message) {
    add_job(0, 1, [=, time = time_ns()](ros::MessageSink& sink) { sink.write(name, time, message); });
  }

  void add_counts(const MeasuredArray& array, const ros::Header& header) {
    const std::string name = topic(array.view, kCountsImage);
    if (array.count() == 0 || !outlet().wants<ros::Image>(name)) return;
    image_bytes_ += array.bytes();
    image_messages_.push_back([array, name, header, time = time_ns()](ros::MessageSink& sink) {
      const auto& counts = std::get<SharedArray<std::uint32_t>>(array.numbers);
      sink.write(name, time, ros::counts_image(counts.numbers(), array.shape.columns, header));
    });
  }

  // An output that no standard message has.
  void add_output(const MeasuredArray& array, const ros::Header& header, ros::TopicForm form = ros::TopicForm::own) {
    const std::string name = topic("", array.name);
    if (array.count() == 0 || !outlet().wants<ros::OutputStamped>(name, form_of("", array.name, form))) return;
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
    if (!outlet().wants<ros::OutputStamped>(name, ros::TopicForm::own, kLatched)) return;
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
    const std::string planar = topic("", kScan), cloud = topic("", kPoints), custom = topic("", kLivox);
    const CommandAttribute* const written = sensor_.command.find(kLayoutAttribute.name);
    const std::string layout(written == nullptr ? kLayoutAttribute.default_value : std::string_view(written->value));
    const bool wants_planar = scan.rings == 1 && outlet().wants<ros::LaserScan>(planar);
    const bool wants_cloud = outlet().wants<ros::PointCloud2>(cloud);
    const bool wants_custom = layout == "livox" && outlet().wants<ros::CustomMsg>(custom);
    if (!wants_planar && !wants_cloud && !wants_custom) return;
    const std::size_t beam_bytes = 2 * sizeof(float) + scan.channels().size() * sizeof(double);
    const std::uint64_t count = std::uint64_t{wants_planar} + std::uint64_t{wants_cloud} + std::uint64_t{wants_custom};
    add_job(scan.range_m.size() * beam_bytes, count,
            [=, scan = scan, frame = frame_, dense = is_dense(), time = time_ns()](ros::MessageSink& sink) {
              if (wants_planar) {
                const std::optional<ros::LaserScan> message = ros::laser_scan(scan, frame, limits, scan_time_s);
                if (message) sink.write(planar, time, *message);
              }
              if (wants_cloud) {
                sink.write(cloud, time,
                           layout == kLayoutAttribute.default_value ? ros::point_cloud(scan, frame, dense)
                                                                    : ros::driver_cloud(layout, scan, frame, dense));
              }
              if (wants_custom) sink.write(custom, time, ros::livox_message(scan, frame));
            });
  }

  // Each message that the outputs name, and the numbers for which none has a place.
  void add_reading(const Reading& reading, const Measurement& measurement) {
    std::vector<std::string_view> types;
    for (const MeasuredArray& each : measurement.arrays) {
      if (ros::reading_topic(each.message)) {
        if (std::ranges::find(types, each.message) == types.end()) types.push_back(each.message);
      } else if (each.kind == OutputKind::scalar) {
        add_number(each);
      }
    }
    for (const std::string_view type : types) add_reading(reading, type);
  }

  void add_reading(const Reading& reading, std::string_view type) {
    const ros::ReadingTopic kind = *ros::reading_topic(type);
    const std::string name = topic("", kind.topic);
    if (!outlet().wants({.name = name, .type = kind.type}, ros::TopicForm::own)) return;
    std::optional<ros::ReadingMessage> made = ros::message_of(reading, type, frame_);
    if (!made) return;
    if (auto* const odometry = std::get_if<ros::Odometry>(&made->message)) *odometry = of_part(std::move(*odometry));
    std::visit([&](auto& each) { messages_.add(name, std::move(each)); }, made->message);
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
  /// In the optical frame of the view itself.
  ros::Header own_header(const std::string& view) const {
    return ros::header_of(stamp_ns(), optical_frame(frame_, view));
  }
  static std::string kind_of(const std::string& view, std::string_view what) {
    return view.empty() ? std::string(what) : view + "/" + std::string(what);
  }
  std::string topic(const std::string& view, std::string_view what) const { return topics_.of(kind_of(view, what)); }
  /// Of topics in another form: a scene that gives one a name requests it.
  ros::TopicForm form_of(const std::string& view, std::string_view what,
                         ros::TopicForm form = ros::TopicForm::other) const {
    return topics_.named().contains(kind_of(view, what)) ? ros::TopicForm::own : form;
  }
  ros::MessageOutlet& outlet() { return messages_.outlet_; }
  bool is_dense() const {
    const CommandAttribute* const written = sensor_.command.find(kDenseAttribute.name);
    return written != nullptr && written->value != kDenseAttribute.default_value;
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
      const ros::TopicForm form = form_of(stem, each.what, each.form);
      const bool is_wanted =
          each.compressed ? outlet().wants<ros::CompressedImage>(name, form) : outlet().wants<ros::Image>(name, form);
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

void FrameMessages::add_measurement(const PlacedSensor& placed) {
  SensorMessages messages(*this, placed);
  messages.add(*placed.measurement, sample_period_s(placed.sensor.sensor->rate_hz, time_));
}

}  // namespace simvis
