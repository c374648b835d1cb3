#include "program/output/evt3_file.h"

#include <vector>

#include "engine/base/assert.h"
#include "exchange/messages/evt3.h"
#include "program/output/formats.h"

namespace simvis {

bool has_events(const TableFrame& table) {
  const glm::uvec2& size = table.image_size_px;
  return fits_evt3(size.x, size.y) &&
         has_event_columns([&](std::string_view name) { return table.find(name).has_value(); });
}

std::string encode_evt3_file(const TableFrame& table) {
  SIMVIS_ASSERT(has_events(table));
  const std::vector<CameraEvent> events = events_of(table.rows(), [&](std::string_view name) {
    return [&, column = *table.find(name)](std::size_t row) { return table.at(row, column); };
  });
  const std::vector<std::uint8_t> words = encode_evt3(events);
  std::string bytes = evt3_header(table.image_size_px.x, table.image_size_px.y);
  bytes.append(words.begin(), words.end());
  return bytes;
}

namespace {

const FormatRegistration kEvt3Format(
    {.kind = "scan",
     .name = "evt3",
     .file = "EVENTS/000000.raw",
     .text = "of event cameras of up to 2048 x 2048 pixels: the events as Prophesee's EVT 3.0 with its header",
     .order = 60,
     .encode_table = encode_evt3_file,
     .fits = has_events});

}  // namespace

}  // namespace simvis
