// Events of pixels, and how they are read from the columns of an event camera: from measurements, readings and tables
// alike.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace simvis {

/// An event of a pixel.
struct CameraEvent {
  std::int64_t time_us = 0;  ///< at least 0
  std::uint32_t x = 0, y = 0;
  bool on = false;  ///< brighter
};

/// The columns that an event has: its time in microseconds, its place in pixels, 1 if it is brighter.
inline constexpr std::string_view kEventColumns[] = {"t_us", "x", "y", "polarity"};

/// Whether there are all of these columns. `has` says it for one, by its name.
template <class Has>
bool has_event_columns(const Has& has) {
  return std::ranges::all_of(kEventColumns, has);
}

/// The events of a number of rows. `column` gives, for the name of a column, a function from a row to its number.
template <class ColumnOf>
std::vector<CameraEvent> events_of(std::size_t rows, const ColumnOf& column) {
  const auto time = column(kEventColumns[0]), x = column(kEventColumns[1]), y = column(kEventColumns[2]),
             polarity = column(kEventColumns[3]);
  std::vector<CameraEvent> events;
  events.reserve(rows);
  for (std::size_t row = 0; row < rows; ++row) {
    events.push_back({static_cast<std::int64_t>(time(row)), static_cast<std::uint32_t>(x(row)),
                      static_cast<std::uint32_t>(y(row)), polarity(row) != 0});
  }
  return events;
}

}  // namespace simvis
