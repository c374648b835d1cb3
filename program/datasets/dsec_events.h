// The events of an event camera as DSEC has them: `events.h5` of the whole, from pieces of one frame each.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <simvis/measurement.h>

namespace simvis {

/// A measurement with the columns t_us, x, y and polarity.
bool is_events(const Measurement& measurement);

/// The last time that the numbers of `events.h5` hold. Columns and rows are below 2^16: no event camera is larger.
inline constexpr std::int64_t kMaxDsecTime_us = 0xffffffff;

/// The events of one measurement, kEventBytes each: the time in microseconds (u32), column and row (u16), polarity
/// (u8).
std::string pack_events(const Measurement& measurement);
inline constexpr std::size_t kEventBytes = 9;

/// `events.h5`: events/x, y (u16), t (u32, microseconds), p (u8), ms_to_idx (u64), and t_offset, which is 0. `piece`
/// returns pack_events() of a frame. `ms_to_idx` goes up to the last millisecond that `end_us` has begun, and has the
/// number of all events for those after the last event. Throws what `piece` throws.
std::string events_h5(std::size_t frames, const std::function<std::string(std::size_t frame)>& piece,
                      std::int64_t end_us);

/// `rectify_map.h5` of a camera without a lens: each pixel is its own place.
std::string rectify_map_h5(std::uint32_t width_px, std::uint32_t height_px);

}  // namespace simvis
