// The measurements of sensors, each in one of a few slots.
#include <algorithm>
#include <atomic>
#include <cstring>
#include <iterator>
#include <variant>

#include "engine/base/assert.h"
#include "exchange/clients/host.h"
#include "exchange/clients/shared_object.h"
#include "exchange/clients/shared_words.h"
#include "scenegraph/array_bytes.h"

namespace simvis {
namespace {

// How many measurements of a sensor are there at a time: a reader has the time of this many less one to read one.
constexpr std::uint32_t kSlots = 4;
constexpr std::uint64_t kCacheLine = 64;

simvis_number_type type_of(const MeasuredArray& array) {
  constexpr simvis_number_type kTypes[] = {SIMVIS_FLOAT32, SIMVIS_FLOAT64, SIMVIS_UINT8, SIMVIS_UINT32, SIMVIS_INT32};
  static_assert(std::size(kTypes) == std::variant_size_v<MeasuredNumbers>);
  return kTypes[array.numbers.index()];
}

void copy_text(std::string_view text, unsigned char* to) {
  std::ranges::copy(text, to);
  to[text.size()] = 0;
}

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
  add_free(own.slots_offset, own.slot_size * kSlots);
  own.slots_offset = own.slot_size = own.measurement = 0;
}

// Joins the piece with those beside it.
void SharedHost::add_free(std::uint64_t offset, std::uint64_t bytes) {
  auto next = free_slots_.upper_bound(offset);
  if (next != free_slots_.end() && next->first == offset + bytes) {
    bytes += next->second;
    next = free_slots_.erase(next);
  }
  if (next != free_slots_.begin()) {
    const auto before = std::prev(next);
    if (before->first + before->second == offset) {
      before->second += bytes;
      return;
    }
  }
  free_slots_.emplace(offset, bytes);
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
                         std::span<const double> world_from_sensor, std::span<const MeasuredArray> arrays) {
  SIMVIS_ASSERT(sensor < sensors_.size() && world_from_sensor.size() == 16);
  const std::uint64_t size = place_outputs(arrays);
  make_slots(sensor, size);
  Sensor& own = sensors_[sensor];
  const std::uint64_t number = own.measurement + 1;
  unsigned char* const start = object_->at(own.slots_offset + own.measurement % kSlots * own.slot_size);
  auto& slot = *reinterpret_cast<simvis_slot*>(start);
  store_relaxed(slot.sequence, 2 * ++publications_ - 1);
  std::atomic_thread_fence(std::memory_order_release);
  slot.measurement = number;
  slot.frame = frame;
  slot.time_ns = time_ns;
  std::ranges::copy(world_from_sensor, slot.world_from_sensor);
  slot.output_count = static_cast<std::uint32_t>(arrays.size());
  if (!placed_.empty()) std::memcpy(start + sizeof slot, placed_.data(), placed_.size() * sizeof(simvis_output));
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    copy_text(arrays[i].name, start + placed_[i].name_offset);
    copy_text(arrays[i].unit, start + placed_[i].unit_offset);
    copy_numbers(arrays[i], start + placed_[i].offset);
  }
  store(slot.sequence, 2 * publications_);
  own.measurement = number;
  store(shared_sensor(sensor).measurement, number);
}

// The head, the outputs, their texts, then their numbers. Returns the bytes of all.
std::uint64_t SharedHost::place_outputs(std::span<const MeasuredArray> arrays) {
  placed_.clear();
  std::uint64_t end = sizeof(simvis_slot) + arrays.size() * sizeof(simvis_output);
  const auto text = [&](std::string_view of) {
    const std::uint64_t offset = end;
    end += of.size() + 1;
    return static_cast<std::uint32_t>(offset);
  };
  for (const MeasuredArray& each : arrays) {
    placed_.push_back({.offset = 0,
                       .name_offset = text(each.name),
                       .name_size = static_cast<std::uint32_t>(each.name.size()),
                       .unit_offset = text(each.unit),
                       .unit_size = static_cast<std::uint32_t>(each.unit.size()),
                       .rows = each.shape.rows,
                       .columns = each.shape.columns,
                       .channels = each.shape.channels,
                       .type = static_cast<std::uint32_t>(type_of(each))});
  }
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    placed_[i].offset = round_up(end, kCacheLine);
    end = placed_[i].offset + own_size(arrays[i]);
  }
  return end;
}

// Larger slots if the measurement does not fit. A table that grows row by row gets half as much again: so the pieces
// that it leaves, joined, have room for it before long.
void SharedHost::make_slots(std::size_t sensor, std::uint64_t size) {
  Sensor& own = sensors_[sensor];
  if (size <= own.slot_size) return;
  const std::uint64_t measurements = own.measurement, before = own.slot_size;
  free_slots(sensor);
  own.measurement = measurements;
  own.slot_size = round_up(std::max(size, before + before / 2), kPage);
  own.slots_offset = take_slots(own.slot_size * kSlots);
  store(shared_sensor(sensor).slot_size, own.slot_size);
  store(shared_sensor(sensor).slots_offset, own.slots_offset);
}

}  // namespace simvis
