// Messages from the events of event cameras: one packet for each measurement.
#pragma once

#include <cstdint>
#include <string>

#include <simvis/measurement.h>
#include "exchange/messages/types/event_types.h"

namespace simvis::ros {

/// Whether a packet can hold the events of a sensor with an image of this size.
bool fits_event_packet(std::uint32_t width_px, std::uint32_t height_px);

/// Where a packet stands in the stream of its sensor.
struct PacketPlace {
  std::uint64_t number = 0;   ///< of packets before it
  std::int64_t begin_ns = 0;  ///< the end of the packet before it; any time for the first one
};

/// The packet of a reading with the columns t_us, x, y and polarity, of an image that fits_event_packet(), in EVT 3.0.
/// A packet without events says how far the time is.
///
/// Times    The packet goes from `place.begin_ns`, or its first event if that is earlier, to the time of the reading.
///          header.stamp is its beginning, as drivers have it. A reader that decodes all packets one after the other
///          gets times from the beginning of the first one; `time_base` is what a reader of this packet alone adds.
EventPacket event_packet(const Reading& reading, std::uint32_t width_px, std::uint32_t height_px,
                         const std::string& frame_id, const PacketPlace& place);

}  // namespace simvis::ros
