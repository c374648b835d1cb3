#include "simvis/output/evt3_file.h"

#include <vector>

#include "engine/base/assert.h"
#include "messages/evt3.h"

namespace simvis {

bool has_events(const TableFrame& table) {
  const glm::uvec2& size = table.image_size_px;
  return fits_evt3(size.x, size.y) && table.find("t_us") && table.find("x") && table.find("y") &&
         table.find("polarity");
}

std::string encode_evt3_file(const TableFrame& table) {
  SIMVIS_ASSERT(has_events(table));
  const std::size_t time = *table.find("t_us"), x = *table.find("x"), y = *table.find("y"),
                    polarity = *table.find("polarity");
  std::vector<CameraEvent> events;
  events.reserve(table.rows());
  for (std::size_t row = 0; row < table.rows(); ++row) {
    events.push_back({static_cast<std::int64_t>(table.at(row, time)), static_cast<std::uint32_t>(table.at(row, x)),
                      static_cast<std::uint32_t>(table.at(row, y)), table.at(row, polarity) != 0});
  }
  const std::vector<std::uint8_t> words = encode_evt3(events);
  std::string bytes = evt3_header(table.image_size_px.x, table.image_size_px.y);
  bytes.append(words.begin(), words.end());
  return bytes;
}

}  // namespace simvis
