#include "simvis/kept_measurements.h"

#include <algorithm>
#include <utility>

#include "simvis/library_of.h"

namespace simvis {

namespace {

/// Collects the images that a sensor passes on.
class ImagesOf : public OutputSink {
 public:
  void picture(const std::string&, const Image* color, const Image* depth) override {
    for (const Image* const image : {color, depth}) {
      if (image != nullptr) images.push_back(image);
    }
  }
  void plane(const std::string&, const std::string&, const Image& plane) override { images.push_back(&plane); }
  void text(const std::string&, const std::string&, std::string_view) override {}
  void rows(std::span<const TableColumn>, std::span<const double>) override {}

  std::vector<const Image*> images;
};

// A sensor of a plug-in may read its last measurement while it makes the next one. Those of the library do not.
bool overwrites_blindly(const BuiltSensor& sensor) { return is_of_the_library(*find_sensor_type(sensor.type)); }

// Sensors hand out what they hold as const; the objects themselves are not.
template <typename T>
std::vector<T>* writable(const std::vector<T>& numbers) {
  return const_cast<std::vector<T>*>(&numbers);
}

}  // namespace

struct KeptMeasurement::Lease {
  std::shared_ptr<KeptMeasurement> kept;
  explicit Lease(std::shared_ptr<KeptMeasurement> of) : kept(std::move(of)) {
    kept->leases_.fetch_add(1, std::memory_order_relaxed);
  }
  ~Lease() { kept->leases_.fetch_sub(1, std::memory_order_release); }
  Lease(const Lease&) = delete;
  Lease& operator=(const Lease&) = delete;
};

KeptMeasurement::KeptMeasurement(const Sensor& sensor) {
  if (const Scan* const scan = sensor.scan()) {
    floats_ = {{writable(scan->range_m)}, {writable(scan->error_bound_m)}};
    channels_in_sensor_ = writable(scan->channels);
    return;
  }
  ImagesOf images;
  sensor.write(images);
  for (const Image* const image : images.images) {
    std::vector<float>* const pixels = writable(image->pixels);
    if (std::ranges::find(floats_, pixels, &Floats::in_sensor) == floats_.end()) floats_.push_back({pixels});
  }
}

std::shared_ptr<const void> KeptMeasurement::lease(const std::shared_ptr<KeptMeasurement>& self) {
  std::shared_ptr<const void> lease = lease_.lock();
  if (lease == nullptr) lease_ = lease = std::make_shared<Lease>(self);
  return lease;
}

std::size_t KeptMeasurement::bytes() const {
  std::size_t bytes = 0;
  for (const Floats& each : floats_) bytes += each.here.size() * sizeof(float);
  for (const ScanChannel& channel : channels_) bytes += channel.values.size() * sizeof(double);
  return bytes;
}

void KeptMeasurement::take(KeptMeasurement* spare) {
  for (std::size_t i = 0; i < floats_.size(); ++i) {
    const bool has_memory = spare != nullptr && i < spare->floats_.size();
    floats_[i].here =
        std::exchange(*floats_[i].in_sensor, has_memory ? std::move(spare->floats_[i].here) : std::vector<float>());
  }
  if (channels_in_sensor_ != nullptr) channels_ = std::exchange(*channels_in_sensor_, {});
}

void KeptMeasurement::give_back() {
  for (Floats& each : floats_) *each.in_sensor = std::move(each.here);
  if (channels_in_sensor_ != nullptr) *channels_in_sensor_ = std::move(channels_);
}

void KeptMeasurement::take_and_leave_copy() {
  take(nullptr);
  for (const Floats& each : floats_) *each.in_sensor = each.here;
  if (channels_in_sensor_ != nullptr) *channels_in_sensor_ = channels_;
}

KeptMeasurements::~KeptMeasurements() {
  for (auto& [id, kept] : of_) {
    if (kept.last != nullptr && kept.last->is_leased()) kept.last->take(nullptr);
  }
}

std::shared_ptr<const void> KeptMeasurements::keep(const BuiltSensor& sensor) {
  std::shared_ptr<KeptMeasurement>& last = of_[sensor.id].last;
  if (last == nullptr) last = std::make_shared<KeptMeasurement>(*sensor.sensor);
  return last->lease(last);
}

std::size_t KeptMeasurements::bytes() const {
  std::size_t bytes = 0;
  for (const auto& [id, kept] : of_) {
    for (const auto& each : kept.before) bytes += each->bytes();
  }
  return bytes;
}

void KeptMeasurements::leave_sensors() {
  for (auto& [id, kept] : of_) {
    if (kept.last != nullptr && kept.last->is_leased()) kept.last->take_and_leave_copy();
  }
  of_.clear();
}

std::shared_ptr<KeptMeasurement> Kept::take_spare() {
  const auto found = std::ranges::find_if_not(before, [](const auto& each) { return each->is_leased(); });
  if (found == before.end()) return nullptr;
  std::shared_ptr<KeptMeasurement> spare = std::move(*found);
  before.erase(found);
  return spare;
}

void Kept::drop_spares() {
  bool has_one = false;
  std::erase_if(before, [&](const auto& each) { return !each->is_leased() && std::exchange(has_one, true); });
}

KeptMeasurements::Overwriting::Overwriting(KeptMeasurements& kept, const BuiltSensor& sensor) {
  const auto found = kept.of_.find(sensor.id);
  if (found == kept.of_.end()) return;
  Kept& of_sensor = found->second;
  of_sensor.drop_spares();  // a queue that was emptied may have left many
  if (of_sensor.last == nullptr || !of_sensor.last->is_leased()) return;
  if (!overwrites_blindly(sensor)) {
    of_sensor.last->take_and_leave_copy();
    of_sensor.last = nullptr;
    return;
  }
  kept_ = &of_sensor;
  of_sensor.last->take(of_sensor.take_spare().get());
}

KeptMeasurements::Overwriting::~Overwriting() {
  if (kept_ != nullptr) kept_->last->give_back();
}

void KeptMeasurements::Overwriting::done() {
  if (kept_ == nullptr) return;
  kept_->before.push_back(std::exchange(kept_->last, nullptr));
  kept_ = nullptr;
}

}  // namespace simvis
