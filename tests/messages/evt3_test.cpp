// Words of EVT 3.0, read by a reader that follows the document of the format.
#include "exchange/messages/evt3.h"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "tests/messages/evt3_reader.h"

TEST_SUITE_BEGIN("messages");

namespace simvis {
namespace {

using test::EventFields, test::Evt3Reader;

std::vector<EventFields> fields_of(const std::vector<CameraEvent>& events) {
  std::vector<EventFields> fields;
  for (const CameraEvent& each : events) fields.emplace_back(each.time_us, each.x, each.y, each.on);
  return fields;
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
  CHECK(Evt3Reader().read(encode_evt3(events)) == fields_of(events));
  CHECK(Evt3Reader().read(encode_evt3({})).empty());
  // One word each for the beginning, the time, the row and the event.
  CHECK(encode_evt3(std::vector<CameraEvent>{{7, 2, 3, true}}) ==
        std::vector<std::uint8_t>{0x00, 0x80, 0x07, 0x60, 0x03, 0x00, 0x02, 0x28});
}

TEST_CASE("parts of a stream are read one after the other, and each alone since the last turn") {
  struct Part {
    std::int64_t begin_us, end_us;
    std::vector<CameraEvent> events;
  };
  const std::vector<Part> parts = {{5, 5, {}},
                                   {5, 4096, {{5, 1, 2, true}, {4096, 1, 2, false}}},
                                   {4096, 3 * kEvt3Turn_us + 5, {}},
                                   {3 * kEvt3Turn_us + 5, 4 * kEvt3Turn_us + 9, {{4 * kEvt3Turn_us + 9, 7, 8, true}}},
                                   {4 * kEvt3Turn_us + 9, 5 * kEvt3Turn_us - 1, {{5 * kEvt3Turn_us - 1, 7, 8, true}}}};
  Evt3Reader all;
  for (const Part& part : parts) {
    const std::vector<std::uint8_t> words = encode_evt3(part.events, part.begin_us, part.end_us);
    CHECK(all.read(words) == fields_of(part.events));
    std::vector<EventFields> alone = Evt3Reader().read(words);
    for (EventFields& each : alone) std::get<0>(each) += part.begin_us / kEvt3Turn_us * kEvt3Turn_us;
    CHECK(alone == fields_of(part.events));
  }
}

TEST_CASE("the header of an EVT 3.0 file says the format and the size") {
  CHECK(evt3_header(346, 260) == "% evt 3.0\n% format EVT3;height=260;width=346\n% geometry 346x260\n% end\n");
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
