#include "exchange/messages/from_events.h"

#include <algorithm>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/time_units.h"
#include "exchange/messages/evt3.h"
#include "exchange/messages/from_pose.h"

namespace simvis::ros {
namespace {

std::vector<CameraEvent> events_in(const Reading& reading) {
  return events_of(reading.rows(), [&](std::string_view name) {
    const auto found = std::ranges::find(reading.arrays, name, &MeasuredArray::name);
    SIMVIS_ASSERT(found != reading.arrays.end());
    return [&values = reading.values(), column = found->first, columns = found->stride](std::size_t row) {
      return values[row * columns + column];
    };
  });
}

}  // namespace

bool fits_event_packet(std::uint32_t width_px, std::uint32_t height_px) { return fits_evt3(width_px, height_px); }

EventPacket event_packet(const Reading& reading, std::uint32_t width_px, std::uint32_t height_px,
                         const std::string& frame_id, const PacketPlace& place) {
  const std::vector<CameraEvent> events = events_in(reading);
  const std::int64_t end_us = reading.time_ns / kMicrosecond_ns;
  std::int64_t begin_us = std::min(place.begin_ns / kMicrosecond_ns, end_us);
  if (!events.empty()) begin_us = std::min(begin_us, events.front().time_us);
  EventPacket packet;
  packet.header = header_of(begin_us * kMicrosecond_ns, frame_id);
  packet.height = height_px;
  packet.width = width_px;
  packet.seq = place.number;
  packet.time_base = static_cast<std::uint64_t>(begin_us / kEvt3Turn_us * kEvt3Turn_us * kMicrosecond_ns);
  packet.encoding = "evt3";
  packet.events = encode_evt3(events, begin_us, end_us);
  return packet;
}

}  // namespace simvis::ros
