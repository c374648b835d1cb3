#include "program/datasets/dsec_events.h"

#include <bit>
#include <map>
#include <string_view>
#include <utility>

#include "engine/base/assert.h"
#include "exchange/messages/camera_events.h"
#include "program/datasets/h5_file.h"

namespace simvis {
namespace {

constexpr std::size_t kTimeBytes = 4, kPlaceBytes = 2;
constexpr std::int64_t kMillisecond_us = 1000;

void append(std::string& bytes, std::uint64_t number, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) bytes += static_cast<char>(number >> 8 * i & 0xff);
}

std::uint64_t number_at(std::string_view bytes) {
  std::uint64_t number = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) number = number << 8 | static_cast<std::uint8_t>(bytes[i]);
  return number;
}

}  // namespace

bool is_events(const Measurement& measurement) {
  return has_event_columns([&](std::string_view name) { return measurement.find(name) != nullptr; }) &&
         measurement.calibration("") != nullptr;
}

std::string pack_events(const Measurement& measurement) {
  const std::size_t rows = measurement.find(kEventColumns[0])->count();
  std::string bytes;
  bytes.reserve(rows * kEventBytes);
  const auto column = [&](std::string_view name) {
    return [array = measurement.find(name)](std::size_t row) { return array->number(row); };
  };
  for (const CameraEvent& event : events_of(rows, column)) {
    append(bytes, static_cast<std::uint64_t>(event.time_us), kTimeBytes);
    append(bytes, event.x, kPlaceBytes);
    append(bytes, event.y, kPlaceBytes);
    append(bytes, event.on ? 1 : 0, 1);
  }
  return bytes;
}

std::string events_h5(std::size_t frames, const std::function<std::string(std::size_t frame)>& piece,
                      std::int64_t end_us) {
  std::string x, y, t, p, index;
  std::uint64_t events = 0;
  std::int64_t next_ms = 0;
  const auto index_up_to = [&](std::int64_t time_us) {
    for (; next_ms * kMillisecond_us <= time_us; ++next_ms) append(index, events, sizeof events);
  };
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const std::string bytes = piece(frame);
    SIMVIS_ASSERT(bytes.size() % kEventBytes == 0);
    for (std::string_view left = bytes; !left.empty(); left.remove_prefix(kEventBytes)) {
      index_up_to(static_cast<std::int64_t>(number_at(left.substr(0, kTimeBytes))));
      t += left.substr(0, kTimeBytes);
      x += left.substr(kTimeBytes, kPlaceBytes);
      y += left.substr(kTimeBytes + kPlaceBytes, kPlaceBytes);
      p += left[kTimeBytes + 2 * kPlaceBytes];
      ++events;
    }
  }
  index_up_to(end_us);
  std::map<std::string, H5Group> groups;
  H5Group &own = groups["events"], &top = groups[""];
  own["x"] = {H5Type::u16, {events}, std::move(x)};
  own["y"] = {H5Type::u16, {events}, std::move(y)};
  own["t"] = {H5Type::u32, {events}, std::move(t)};
  own["p"] = {H5Type::u8, {events}, std::move(p)};
  top["ms_to_idx"] = {H5Type::u64, {static_cast<std::uint64_t>(next_ms)}, std::move(index)};
  top["t_offset"] = {H5Type::i64, {}, std::string(sizeof(std::int64_t), '\0')};
  return encode_h5(groups);
}

std::string rectify_map_h5(std::uint32_t width_px, std::uint32_t height_px) {
  std::string bytes;
  for (std::uint32_t y = 0; y < height_px; ++y) {
    for (std::uint32_t x = 0; x < width_px; ++x) {
      for (const std::uint32_t place : {x, y}) {
        append(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(place)), sizeof(float));
      }
    }
  }
  return encode_h5({{"", {{"rectify_map", {H5Type::f32, {height_px, width_px, 2}, std::move(bytes)}}}}});
}

}  // namespace simvis
