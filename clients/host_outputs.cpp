// The measurements of sensors, each in one of a few slots.
#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>

#include "clients/host.h"
#include "clients/shared_object.h"
#include "clients/shared_words.h"
#include "engine/base/assert.h"

namespace simvis {
namespace {

// How many measurements of a sensor are there at a time: a reader has the time of this many less one to read one.
constexpr std::uint32_t kSlots = 4;
constexpr std::uint64_t kCacheLine = 64;

}  // namespace

std::size_t SharedHost::add_sensor(std::string_view name, std::string_view type) {
  simvis_region& table = object_->layout().sensors;
  *object_->append<simvis_sensor>(table, 1) = {.name = add_text(name),
                                               .type = add_text(type),
                                               .slots_offset = 0,
                                               .slot_size = 0,
                                               .slot_count = kSlots,
                                               .removed = 0,
                                               .measurement = 0};
  sensors_.emplace_back();
  object_->publish_count(table, sensors_.size());
  return sensors_.size() - 1;
}

simvis_sensor& SharedHost::shared_sensor(std::size_t sensor) {
  return reinterpret_cast<simvis_sensor*>(object_->at(object_->layout().sensors.offset))[sensor];
}

void SharedHost::remove_sensor(std::size_t sensor) {
  store(shared_sensor(sensor).removed, 1u);
  free_slots(sensor);
}

// A client that still reads there finds another sequence and knows that its view is not whole any more.
void SharedHost::free_slots(std::size_t sensor) {
  Sensor& own = sensors_.at(sensor);
  if (own.slot_size == 0) return;
  simvis_sensor& shared = shared_sensor(sensor);
  store(shared.measurement, std::uint64_t{0});
  store(shared.slots_offset, std::uint64_t{0});
  store(shared.slot_size, std::uint64_t{0});
  object_->give_back(own.slots_offset, own.slot_size * kSlots);
  free_slots_.emplace(own.slots_offset, own.slot_size * kSlots);
  own.slots_offset = own.slot_size = own.measurement = 0;
}

// The first free piece that is large enough, else new memory.
std::uint64_t SharedHost::take_slots(std::uint64_t bytes) {
  const auto free = std::ranges::find_if(free_slots_, [&](const auto& each) { return each.second >= bytes; });
  if (free != free_slots_.end()) {
    const auto [offset, size] = *free;
    object_->allocate(offset, bytes);
    free_slots_.erase(free);
    if (size > bytes) free_slots_.emplace(offset + bytes, size - bytes);
    return offset;
  }
  simvis_region& outputs = object_->layout().outputs;
  object_->append<char>(outputs, bytes);
  const std::uint64_t offset = outputs.offset + outputs.count;
  object_->publish_count(outputs, outputs.count + bytes);
  return offset;
}

void SharedHost::publish(std::size_t sensor, std::uint64_t frame, std::int64_t time_ns,
                         std::span<const double> world_from_sensor, std::span<const SharedOutput> outputs) {
  SIMVIS_ASSERT(sensor < sensors_.size() && world_from_sensor.size() == 16 && outputs.size() <= SIMVIS_SHM_MAX_OUTPUTS);
  Sensor& own = sensors_[sensor];
  simvis_sensor& shared = shared_sensor(sensor);
  constexpr std::uint64_t kNumberSize[] = {0, sizeof(float), sizeof(double), 1};
  std::uint64_t size = round_up(sizeof(simvis_slot), kCacheLine);
  std::array<std::uint64_t, SIMVIS_SHM_MAX_OUTPUTS> offsets{}, bytes{};
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    offsets[i] = size;
    bytes[i] = std::uint64_t{outputs[i].rows} * outputs[i].columns * outputs[i].channels * kNumberSize[outputs[i].type];
    size = round_up(size + bytes[i], kCacheLine);
  }
  if (size > own.slot_size) {
    const std::uint64_t measurements = own.measurement;
    free_slots(sensor);
    own.measurement = measurements;
    own.slot_size = round_up(size, kPage);
    own.slots_offset = take_slots(own.slot_size * kSlots);
    store(shared.slot_size, own.slot_size);
    store(shared.slots_offset, own.slots_offset);
  }
  const std::uint64_t number = own.measurement + 1;
  unsigned char* const start = object_->at(own.slots_offset + own.measurement % kSlots * own.slot_size);
  auto& slot = *reinterpret_cast<simvis_slot*>(start);
  store_relaxed(slot.sequence, 2 * ++publications_ - 1);
  std::atomic_thread_fence(std::memory_order_release);
  slot.measurement = number;
  slot.frame = frame;
  slot.time_ns = time_ns;
  std::ranges::copy(world_from_sensor, slot.world_from_sensor);
  slot.output_count = static_cast<std::uint32_t>(outputs.size());
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    simvis_output& output = slot.outputs[i];
    output = {};
    outputs[i].name.copy(output.name, sizeof output.name - 1);
    output.offset = offsets[i];
    output.rows = outputs[i].rows;
    output.columns = outputs[i].columns;
    output.channels = outputs[i].channels;
    output.type = outputs[i].type;
    if (bytes[i] > 0) std::memcpy(start + offsets[i], outputs[i].data, bytes[i]);
  }
  store(slot.sequence, 2 * publications_);
  own.measurement = number;
  store(shared.measurement, number);
}

}  // namespace simvis
