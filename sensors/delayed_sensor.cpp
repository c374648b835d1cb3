#include "sensors/delayed_sensor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

namespace simvis {
namespace {

// What the random numbers of a measurement are for.
constexpr std::uint32_t kDropDraw = 0, kFreezeDraw = 1, kDelayDraw = 2;

// The columns or channels of times that a measurement gives itself, the second one in whole microseconds.
constexpr std::string_view kOwnTimes = "time_s", kOwnMicroseconds = "t_us";

std::int64_t whole_ns(double seconds) { return std::llround(seconds * 1e9); }
double seconds(std::int64_t time_ns) { return static_cast<double>(time_ns) / 1e9; }

void set_numbers(MeasuredArray& array, std::vector<double> numbers) {
  array.numbers = SharedArray<double>(std::move(numbers));
  array.first = 0;
  array.stride = 1;
}

template <typename Map>
void map_times(std::vector<MeasuredArray>& arrays, const Map& map) {
  const auto times = std::ranges::find(arrays, kOwnTimes, &MeasuredArray::name);
  if (times == arrays.end() || times->count() == 0) return;
  std::vector<double> times_s(times->count()), whole_us;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    times_s[i] = map(times->number(i));
    whole_us.push_back(std::floor(times_s[i] * 1e6));
  }
  const auto rounded = std::ranges::find(arrays, kOwnMicroseconds, &MeasuredArray::name);
  set_numbers(*times, std::move(times_s));
  if (rounded != arrays.end()) set_numbers(*rounded, std::move(whole_us));
}

// The columns of a reading share one block, row by row.
template <typename Map>
void map_times(Reading& reading, const Map& map) {
  std::vector<MeasuredArray> columns = reading.arrays;
  map_times(columns, map);
  const std::size_t rows = reading.rows();
  reading.set_values([&](std::vector<double>& all) {
    all.clear();
    for (std::size_t row = 0; row < rows; ++row) {
      for (const MeasuredArray& column : columns) all.push_back(column.number(row));
    }
  });
}

}  // namespace

DelayedSensor::DelayedSensor(std::unique_ptr<Sensor> sensor, const TimingFaults& faults, const SensorRandom& random)
    : sensor_(std::move(sensor)), faults_(faults), random_(random) {
  nothing_ = state_.arrived = std::make_shared<const Given>(take());
}

void DelayedSensor::begin(const FrameTime& time) {
  sensor_->rate_hz = rate_hz;
  sensor_->begin(time);
}

DelayedSensor::Given DelayedSensor::take() const {
  const Scan* const scan = sensor_->scan();
  const Reading* const reading = sensor_->reading();
  return {.measurement = sensor_->measurement(),
          .scan = scan == nullptr ? std::nullopt : std::optional(*scan),
          .reading = reading == nullptr ? std::nullopt : std::optional(*reading),
          .on_request = sensor_->on_request()};
}

void DelayedSensor::begin_frame(const FrameTime& time) {
  is_made_again_ = frame_ns_ == time.time_ns;
  if (is_made_again_) {
    state_ = before_;
  } else {
    before_ = state_;
  }
  frame_ns_ = time.time_ns;
}

void DelayedSensor::lose(const FrameTime& time) {
  begin_frame(time);
  state_.under_way.clear();
  state_.latest_ns = 0;
}

bool DelayedSensor::pass_on(const FrameTime& time, bool has_measured) {
  begin_frame(time);
  if (has_measured) capture(time.time_ns);
  std::deque<SharedGiven>& under_way = state_.under_way;
  if (under_way.empty() || under_way.front()->arrives_ns > time.time_ns) return false;
  state_.arrived = std::move(under_way.front());
  under_way.pop_front();
  state_.has_arrived = true;
  return true;
}

void DelayedSensor::capture(std::int64_t time_ns) {
  const auto draw = [&](std::uint32_t use) { return random_.uniform(static_cast<std::uint64_t>(time_ns), 0, use); };
  const bool repeats = state_.kept && draw(kFreezeDraw) < faults_.freeze;
  Given given = repeats ? *state_.kept : take();
  if (!repeats) given.captured_ns = time_ns;
  if (!repeats && faults_.freeze > 0) state_.kept = std::make_shared<const Given>(given);
  if (draw(kDropDraw) < faults_.drop) return;
  const double delay_s = faults_.delay_s + faults_.delay_jitter_s * draw(kDelayDraw);
  given.arrives_ns = std::max(state_.latest_ns, time_ns + whole_ns(delay_s));
  state_.latest_ns = given.arrives_ns;
  stamp(given, time_ns);
  state_.under_way.push_back(std::make_shared<const Given>(std::move(given)));
}

void DelayedSensor::stamp(Given& given, std::int64_t measured_ns) const {
  const bool by_arrival = faults_.stamp == Stamp::arrival;
  const double gain = by_arrival ? 0 : faults_.clock_drift;
  const std::int64_t stamp_ns =
      by_arrival ? given.arrives_ns : measured_ns + whole_ns(faults_.clock_offset_s + gain * seconds(measured_ns));
  const std::int64_t captured_ns = given.captured_ns, shift_ns = stamp_ns - captured_ns;
  given.measurement.time_ns = stamp_ns;
  if (given.scan) given.scan->time_ns = stamp_ns;
  if (given.reading) given.reading->time_ns = stamp_ns;
  if (shift_ns == 0 && gain == 0) return;
  const auto map = [&](double time_s) { return time_s + seconds(shift_ns) + gain * (time_s - seconds(captured_ns)); };
  map_times(given.measurement.arrays, map);
  if (given.scan) map_times(given.scan->arrays, map);
  if (given.reading) map_times(*given.reading, map);
}

double DelayedSensor::capture_time_s() const {
  return state_.has_arrived ? seconds(state_.arrived->captured_ns) : std::numeric_limits<double>::quiet_NaN();
}

double DelayedSensor::arrival_time_s() const {
  return state_.has_arrived ? seconds(state_.arrived->arrives_ns) : std::numeric_limits<double>::quiet_NaN();
}

std::vector<NumberOnRequest> DelayedSensor::on_request() const {
  std::vector<NumberOnRequest> all = state_.arrived->on_request;
  all.push_back({std::string(kCaptureTime), "s", [value_s = capture_time_s()] { return value_s; }});
  all.push_back({std::string(kArrivalTime), "s", [value_s = arrival_time_s()] { return value_s; }});
  return all;
}

void DelayedSensor::archive(StateArchive& state) {
  archive_state(state, *sensor_);
  archive(state, state_);
  archive(state, before_);
  state(frame_ns_, is_made_again_);
}

void DelayedSensor::archive(StateArchive& state, State& all) const {
  state(all.latest_ns, all.has_arrived);
  if (all.has_arrived) {
    archive(state, all.arrived);
    state.require(all.arrived != nullptr);
  } else {
    all.arrived = nothing_;
  }
  archive(state, all.kept);
  std::size_t count = all.under_way.size();
  state.count(count, 1);
  all.under_way.resize(count);
  for (SharedGiven& each : all.under_way) {
    archive(state, each);
    state.require(each != nullptr && each->arrives_ns >= each->captured_ns);
  }
  const auto arrival = [](const SharedGiven& each) { return each->arrives_ns; };
  state.require(std::ranges::is_sorted(all.under_way, {}, arrival));
  if (all.under_way.empty()) {
    state.require_past(all.latest_ns);
  } else {
    state.require(all.latest_ns == arrival(all.under_way.back()));
  }
}

// What the measurements of a sensor have in common is that of the sensor.
void DelayedSensor::archive(StateArchive& state, SharedGiven& shared) const {
  bool is_there = shared != nullptr;
  state(is_there);
  if (!is_there) return shared.reset();
  Given given = take();
  if (!state.is_reading()) given = *shared;
  archive_measurement(state, given.measurement);
  std::size_t on_request = given.on_request.size();
  state.count(on_request, sizeof(double));
  state.require(on_request == given.on_request.size());
  for (NumberOnRequest& each : given.on_request) {
    double value = state.is_reading() ? 0 : each.compute();
    state(value);
    each.compute = [value] { return value; };
  }
  state(given.captured_ns, given.arrives_ns);
  state.require_past(given.captured_ns);
  if (!state.is_reading()) return;
  if (given.scan) {
    std::optional<Scan> scan = to_scan(given.measurement);
    state.require(scan.has_value());
    require_scan(state, *scan);
    scan->beam_table = given.scan->beam_table;
    given.scan = std::move(scan);
  }
  if (given.reading) given.reading = reading_of(state, *std::move(given.reading), given.measurement);
  shared = std::make_shared<const Given>(std::move(given));
}

}  // namespace simvis
