// EVT 3.0, the stream of events of Prophesee's sensors, as files `.raw` hold it.
//
// Words    16 bits, little-endian; the upper four are the kind: 0 row (11 bits), 2 column (11 bits) and above it the
//          polarity, which sends an event; 6 and 8 the lower and the upper 12 bits of a time in microseconds, which
//          begins again after 2^24 us. Rows and times hold for all events that follow. (Prophesee, "EVT 3.0 Format",
//          docs.prophesee.ai, section Data formats.)
// Writer   Vectors of columns (kinds 3 to 5) are not written. Each time that the 24 bits begin again is written, also
//          where nothing happens, so that a reader that counts them gets the whole time.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/base/program_api.h"
#include "exchange/messages/camera_events.h"

namespace simvis {

/// The largest width and height that 11 bits address.
inline constexpr std::uint32_t kMaxEvt3Size_px = 2048;

/// Whether the format can address all pixels of an image of this size.
constexpr bool fits_evt3(std::uint32_t width_px, std::uint32_t height_px) {
  return width_px > 0 && width_px <= kMaxEvt3Size_px && height_px <= kMaxEvt3Size_px;
}

/// The time after which the 24 bits begin again.
inline constexpr std::int64_t kEvt3Turn_us = std::int64_t{1} << 24;

/// The words of events in the order of time. A reader begins at the time 0.
SIMVIS_PROGRAM_API std::vector<std::uint8_t> encode_evt3(std::span<const CameraEvent> events);

/// A part of a stream: the words of the events from `begin_us` to `end_us`, which include both. A reader that has read
/// the part that ends at `begin_us` goes on with the whole time; one that begins with this part gets times since the
/// multiple of kEvt3Turn_us before `begin_us`.
SIMVIS_PROGRAM_API std::vector<std::uint8_t> encode_evt3(std::span<const CameraEvent> events, std::int64_t begin_us,
                                                         std::int64_t end_us);

/// The text in front of the words in a file.
SIMVIS_PROGRAM_API std::string evt3_header(std::uint32_t width_px, std::uint32_t height_px);

}  // namespace simvis
