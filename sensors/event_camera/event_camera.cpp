#include "sensors/event_camera/event_camera.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <simvis/pose.h>
#include "sensors/camera/camera_outputs.h"
#include "sensors/camera/pinhole_view.h"

namespace simvis {
namespace {

// A surface that crosses more pixels than this between two measurements is followed in longer steps.
constexpr double kMaxIntervals = 65536;
// Pixels that a thread follows at a time: their work differs, so that a piece is small.
constexpr std::size_t kPiece = 64;

constexpr const char* kExactTime = "time_s";

std::vector<TableColumn> event_columns() {
  const auto whole = [](const char* name, const char* unit, const char* meaning) {
    return TableColumn{.name = name, .format = "%lld", .integer = true, .unit = unit, .meaning = meaning};
  };
  return {
      {.name = kExactTime, .format = std::string(kExactFormat), .unit = "s", .meaning = "simulated time of the event"},
      whole("t_us", "us", "the same in whole microseconds, rounded down"),
      whole("x", "", "column of the pixel, from the left"),
      whole("y", "", "row of the pixel, from the top"),
      whole("polarity", "", "1: brighter, 0: darker")};
}

constexpr const char* kPicture = "picture";
constexpr const char* kEventMessage = "event_camera_msgs/msg/EventPacket";

std::vector<OutputSpec> event_camera_outputs(const SensorContext& context) {
  std::vector<OutputSpec> outputs = reading_outputs(context, event_columns(), false);
  for (OutputSpec& each : outputs) {
    if (each.name != kExactTime) each.message = kEventMessage;
  }
  outputs.push_back({.name = kPicture,
                     .kind = OutputKind::image,
                     .value_type = ValueType::f32,
                     .shape = image_shape(context.attributes, 4),
                     .content = ImageContent::color,
                     .frame = "optical",
                     .meaning = "red where the last event of the measurement is positive, blue where it is negative",
                     .message = std::string(kImageMessage),
                     .when = "picture=\"on\"",
                     .given = context.attributes.choice("picture") == "on"});
  return outputs;
}

const SensorRegistration kEventCameraRegistration(
    {.name = "event_camera",
     .summary = "An event camera: a row for each change of light in a pixel, with its exact time.",
     .notes = "Events between two measurements come at the times at which the logarithm of a pixel's light crosses its "
              "thresholds, whatever the frame rate. Light is the mean over the pixel's square and is computed exactly "
              "at edges. The thresholds, leak, noise and latency of a real sensor are off unless their attributes ask "
              "for them: see docs/event-cameras.md.",
     .capabilities = kHasLens,
     .attributes = rows_of<EventCameraDesc>().table(),
     .create = create_sensor<EventCamera, EventCameraDesc>,
     .outputs = event_camera_outputs});

double microseconds_of(double time_ns) { return std::floor(time_ns / 1000); }

// What of a list changes the light of pixels beside places: not the air, which a pixel does not show.
DrawList tables_of(const DrawList& list) {
  DrawList tables = list;
  tables.world_from_node.clear();
  tables.medium = {};
  return tables;
}

}  // namespace

AttributeRows<EventCameraDesc> EventCameraDesc::rows() {
  using Desc = EventCameraDesc;
  return {nested(&Desc::pinhole, PinholeDesc::rows()),
          row(&Desc::step_px, "step", "px", AttributeLimits{.min = 0.001, .max = 1},
              "no surface moves by more between two times at which the light of a pixel is computed"),
          row(&Desc::time_error_s, "time_error", "s", AttributeLimits{.min = 1e-9, .max = 1},
              "by which a line through the light of two times may displace a crossing; more times are computed "
              "otherwise"),
          nested(&Desc::model, EventModelDesc::rows()),
          row(&Desc::picture, "picture", {{false, "off"}, {true, "on"}},
              "on: also a picture of the events of each measurement"),
          kRateAttribute};
}

void EventCameraDesc::complete(const SensorContext& context) {
  check_cast_pixels(pinhole, context.attributes);
  effects = camera_effects(kHasLens, {context.attributes, context.seed, context.name, shown_outputs(true, true)});
}

EventCamera::EventCamera(std::string name, const EventCameraDesc& desc)
    : ReadingSensor(event_columns(), false),
      name_(std::move(name)),
      desc_(desc),
      optics_(name_, camera_layout(desc.pinhole, desc.effects), desc.pinhole.near_m),
      light_(optics_, desc.pinhole.near_m),
      memory_{.pixels = {desc.model, std::size_t{desc.pinhole.width_px} * desc.pinhole.height_px, desc.seed, name_}},
      before_(memory_) {
  set_constant("width_px", desc.pinhole.width_px);
  set_constant("height_px", desc.pinhole.height_px);
}

// A frame that was not finished is repeated: it follows the same measurement again.
void EventCamera::begin(const FrameTime& time) {
  time_ = time;
  if (!is_first() && memory_.time_ns >= time.time_ns) memory_ = before_;
}

// Revisions are those of one simulation. The memory of another one is compared by content.
bool EventCamera::has_same_tables(const DrawList& list) const {
  if (memory_.tables == nullptr) return content_hash(tables_of(list)) == memory_.tables_hash;
  const DrawList::Revisions &now = list.revisions, &then = memory_.tables->revisions;
  return now.structure == then.structure && now.materials == then.materials && now.lights == then.lights &&
         list.environment == memory_.tables->environment && list.sky == memory_.tables->sky;
}

// Whether the light may differ for other reasons than the moves of items and of the camera.
bool EventCamera::has_changed_otherwise(const DrawList& list) const {
  if (!has_same_tables(list) || list.world_from_node.size() != memory_.world_from_node.size()) return true;
  const auto is_elsewhere = [&](std::uint32_t node) {
    return list.world_from_node[node] != memory_.world_from_node[node];
  };
  for (const LightItem& light : list.lights) {
    if (is_elsewhere(light.transform)) return true;
  }
  auto move = moves_.begin();  // ascending by item
  for (std::uint32_t item = 0; item < list.items.size(); ++item) {
    while (move != moves_.end() && move->item < item) ++move;
    const bool is_followed = move != moves_.end() && move->item == item;
    if (!is_followed && is_elsewhere(list.items[item].transform)) return true;
  }
  return false;
}

void EventCamera::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  ReadingSensor::plan(world_from_sensor, list, plan);
  list_ = &list;
  plan_effects(name_, desc_.effects, plan);
  const glm::dmat4 now = world_from_sensor * sensor_from_view();
  static const MotionPath kStill;
  scene_.set(list, is_first() ? std::span<const ItemMove>() : moves_, is_first() ? kStill : *path_, now);
  all_pixels_ = is_first() || has_changed_otherwise(list);
  light_.set(scene_, all_pixels_);
  const std::uint64_t pixels = std::uint64_t{desc_.pinhole.width_px} * desc_.pinhole.height_px;
  pixels_sampled_ = 0;
  for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) pixels_sampled_ += all_pixels_ || light_.in_motion(pixel);
  if (pixels_sampled_ == 0) return;
  const char* const why = is_first()    ? ": the first light of all pixels"
                          : all_pixels_ ? ": all pixels, because more has changed than places"
                                        : ": pixels in which something moves";
  plan.casts.push_back({.name = name_,
                        .reason = "light of " + std::to_string(pixels_sampled_) + " of " + std::to_string(pixels) +
                                  " pixels of event camera " + name_ + why + ", every " + format_number(desc_.step_px) +
                                  " px of its way",
                        .max_rays = pixels_sampled_,
                        .colors = true});
}

void EventCamera::cast(RayCaster& threads) {
  workers_.resize(threads.threads());
  for (Worker& worker : workers_) worker.light.begin();
  const bool first = is_first();
  before_ = memory_;
  if (first) {
    begin_light(threads);
    publish({});
  } else {
    std::vector<PixelEvent> events = std::exchange(memory_.delayed, {});
    const std::vector<PixelEvent> now = follow_all(threads);
    events.insert(events.end(), now.begin(), now.end());
    publish(std::move(events));
  }
  samples_ = 0;
  for (const Worker& worker : workers_) samples_ += worker.light.samples();
}

void EventCamera::begin_light(RayCaster& threads) {
  memory_.light.resize(std::size_t{desc_.pinhole.width_px} * desc_.pinhole.height_px);
  threads.parallel_for(memory_.light.size(), kPiece, [&](std::size_t slot, std::size_t first, std::size_t count) {
    for (std::size_t pixel = first; pixel < first + count; ++pixel) {
      const auto number = static_cast<std::uint32_t>(pixel);
      memory_.light[pixel] = light_.light(number, 1, workers_[slot].light);
      memory_.pixels.begin(number, memory_.light[pixel]);
    }
  });
}

// The events of all pixels, pixel by pixel: the same for any number of threads.
std::vector<PixelEvent> EventCamera::follow_all(RayCaster& threads) {
  const std::size_t pixels = memory_.light.size();
  std::vector<std::vector<PixelEvent>> events_of((pixels + kPiece - 1) / kPiece);  // by piece
  threads.parallel_for(pixels, kPiece, [&](std::size_t slot, std::size_t first, std::size_t count) {
    for (std::size_t pixel = first; pixel < first + count; ++pixel) {
      follow(static_cast<std::uint32_t>(pixel), workers_[slot], events_of[first / kPiece]);
    }
  });
  std::vector<PixelEvent> all;
  for (const std::vector<PixelEvent>& each : events_of) all.insert(all.end(), each.begin(), each.end());
  return all;
}

void EventCamera::follow(std::uint32_t pixel, Worker& worker, std::vector<PixelEvent>& events) {
  double& last = memory_.light[pixel];
  std::vector<LightKnot>& knots = worker.knots;
  knots.assign(1, {0, last});
  if (light_.in_motion(pixel)) {
    const double intervals = std::clamp(std::ceil(light_.way_px(pixel) / desc_.step_px), 1.0, kMaxIntervals);
    const LightCurveDesc curve{.duration_s = static_cast<double>(time_.time_ns - memory_.time_ns) / 1e9,
                               .time_error_s = desc_.time_error_s,
                               .darkness = desc_.model.darkness};
    const LightSource source{
        .light = [&](double share) { return light_.light(pixel, share, worker.light); },
        .has_edges = [&](double begin, double end) { return light_.find_edges(pixel, begin, end, worker.light); },
        .touches = [&](std::span<const double> looked_at,
                       std::vector<double>& shares) { light_.add_touches(pixel, looked_at, worker.light, shares); }};
    add_light_curve(curve, static_cast<std::uint32_t>(intervals), source, knots);
  } else if (all_pixels_) {
    const double now = light_.light(pixel, 1, worker.light);
    knots.insert(knots.end(), {{0, now}, {1, now}});
  } else if (memory_.pixels.acts_in_constant_light()) {
    knots.push_back({1, last});
  } else {
    return;
  }
  last = knots.back().light;
  memory_.pixels.follow(pixel, random_key(time_), {memory_.time_ns, time_.time_ns, knots}, events);
}

void EventCamera::publish(std::vector<PixelEvent> events) {
  const auto late = std::partition(events.begin(), events.end(), [&](const PixelEvent& event) {
    return event.time_ns <= static_cast<double>(time_.time_ns);
  });
  memory_.delayed.assign(late, events.end());
  events.erase(late, events.end());
  std::ranges::sort(events, {},
                    [](const PixelEvent& event) { return std::tuple(event.time_ns, event.pixel, event.on); });
  if (memory_.tables == nullptr || !has_same_tables(*list_)) {
    memory_.tables = std::make_shared<const DrawList>(tables_of(*list_));
  }
  memory_.time_ns = time_.time_ns;
  memory_.world_from_node = list_->world_from_node;
  std::vector<double> rows;
  rows.reserve(5 * events.size());
  for (const PixelEvent& event : events) {
    const std::uint32_t x = event.pixel % desc_.pinhole.width_px, y = event.pixel / desc_.pinhole.width_px;
    rows.insert(rows.end(), {event.time_ns / 1e9, microseconds_of(event.time_ns), static_cast<double>(x),
                             static_cast<double>(y), event.on ? 1.0 : 0.0});
  }
  set_reading(time_, std::move(rows));
  if (desc_.picture) draw(events);
}

void EventCamera::draw(const std::vector<PixelEvent>& events) {
  constexpr float kGrey = 0.5f;
  picture_.width = desc_.pinhole.width_px;
  picture_.height = desc_.pinhole.height_px;
  picture_.channels = 4;
  std::vector<float>& pixels = picture_.pixels.overwrite();
  pixels.assign(4 * memory_.light.size(), kGrey);
  for (std::size_t pixel = 0; pixel < memory_.light.size(); ++pixel) pixels[4 * pixel + 3] = 1;
  for (const PixelEvent& event : events) {
    float* const color = pixels.data() + 4 * std::size_t{event.pixel};
    color[0] = event.on ? 1 : 0;
    color[1] = 0;
    color[2] = event.on ? 0 : 1;
  }
}

// The memory before that of a frame is a part of the state if that frame failed, so that it is made again. Before the
// first frame, whose time may be that of no frame at all, there is none.
void EventCamera::archive(StateArchive& state) {
  archive(state, memory_);
  if (!is_first() && memory_.time_ns > state.last_ns()) {
    archive(state, before_);
  } else if (state.is_reading()) {
    forget(before_);
  }
}

// Leaves what a camera has before its first measurement.
void EventCamera::forget(Memory& memory) {
  memory.time_ns = 0;
  memory.tables = nullptr;
  memory.tables_hash = 0;
  memory.world_from_node.clear();
  memory.light.clear();
  memory.pixels.reset();
  memory.delayed.clear();
}

void EventCamera::archive(StateArchive& state, Memory& memory) const {
  constexpr double kMaxLight = 1e30;  // luminance, in the units of the scene's lights
  const std::size_t pixels = std::size_t{desc_.pinhole.width_px} * desc_.pinhole.height_px;
  state(memory.time_ns, memory.light);
  state.require(memory.light.empty() || memory.light.size() == pixels);
  state.require_past(memory.time_ns);
  for (const double light : memory.light) state.require(light >= 0 && light <= kMaxLight);
  std::uint64_t hash = memory.tables == nullptr ? memory.tables_hash : content_hash(*memory.tables);
  state(hash);
  if (state.is_reading()) {
    memory.tables = nullptr;
    memory.tables_hash = hash;
  }
  state(memory.world_from_node);
  memory.pixels.archive(state, memory.time_ns);
  state(memory.delayed);
  for (const PixelEvent& each : memory.delayed) {
    state.require(each.pixel < pixels && each.time_ns > static_cast<double>(memory.time_ns));
  }
}

Measurement EventCamera::measurement() const {
  Measurement measurement = ReadingSensor::measurement();
  measurement.calibrations = optics_.calibrations();
  if (desc_.picture) measurement.arrays.push_back(image_array(kPicture, picture_, ImageContent::color));
  return measurement;
}

SensorReport EventCamera::report() const {
  return {.notes = {{"pixels_sampled", pixels_sampled_},
                    {"light_samples", samples_},
                    {"events", std::uint64_t{reading()->rows()}}},
          .explanation = ""};
}

}  // namespace simvis
