// Words of EVT 3.0, read by a reader that follows the document of the format.
#include "messages/evt3.h"

#include <doctest/doctest.h>

#include <string>
#include <tuple>
#include <vector>

TEST_SUITE_BEGIN("messages");

namespace simvis {
namespace {

using EventFields = std::tuple<std::int64_t, std::uint32_t, std::uint32_t, bool>;

std::vector<EventFields> fields_of(const std::vector<CameraEvent>& events) {
  std::vector<EventFields> fields;
  for (const CameraEvent& each : events) fields.emplace_back(each.time_us, each.x, each.y, each.on);
  return fields;
}

std::vector<CameraEvent> decode_evt3(const std::vector<std::uint8_t>& bytes) {
  std::vector<CameraEvent> events;
  std::int64_t turns = 0, high = 0, low = 0;
  std::uint32_t row = 0;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    const unsigned word = bytes[i] | bytes[i + 1] << 8, value = word & 0xfff;
    switch (word >> 12) {
      case 0x0:
        row = value & 0x7ff;
        break;
      case 0x2:
        events.push_back({(turns << 24) + (high << 12) + low, value & 0x7ff, row, (value & 0x800) != 0});
        break;
      case 0x6:
        low = value;
        break;
      case 0x8:
        turns += value < high;
        high = value;
        break;
      default:
        FAIL("a word of another kind");
    }
  }
  return events;
}

TEST_CASE("events survive EVT 3.0, also where its times begin again") {
  constexpr std::int64_t kTurn_us = std::int64_t{1} << 24;
  const std::vector<CameraEvent> events = {{0, 0, 0, true},
                                           {0, 5, 0, false},
                                           {0, 5, 2047, true},
                                           {4095, 2047, 2047, false},
                                           {4096, 1, 3, true},
                                           {kTurn_us - 1, 2, 3, true},
                                           {kTurn_us, 3, 3, true},
                                           {kTurn_us + 5, 3, 3, false},
                                           {4 * kTurn_us + 4097, 9, 4, true},
                                           {7 * kTurn_us - 4097, 8, 4, true},
                                           {8 * kTurn_us, 8, 4, true}};
  CHECK(fields_of(decode_evt3(encode_evt3(events))) == fields_of(events));
  CHECK(decode_evt3(encode_evt3({})).empty());
  // One word each for the beginning, the time, the row and the event.
  CHECK(encode_evt3(std::vector<CameraEvent>{{7, 2, 3, true}}) ==
        std::vector<std::uint8_t>{0x00, 0x80, 0x07, 0x60, 0x03, 0x00, 0x02, 0x28});
}

TEST_CASE("the header of an EVT 3.0 file says the format and the size") {
  CHECK(evt3_header(346, 260) == "% evt 3.0\n% format EVT3;height=260;width=346\n% geometry 346x260\n% end\n");
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
