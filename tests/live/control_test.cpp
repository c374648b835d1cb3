// What clients ask for and what waits for them: nothing is lost, and nothing grows without limit.
#include "program/live/control.h"

#include <doctest/doctest.h>

#include <string>

#include <simvis/error.h>
#include "program/live/text_queue.h"

TEST_SUITE_BEGIN("live");

namespace simvis::live {
namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20;

Control setting(ClientId client, std::size_t parameter, double value, const std::string& request = "") {
  return {.kind = Control::Kind::set, .client = client, .values = {{parameter, value}}, .request = request};
}

std::size_t count_waiting(ControlQueue& controls) {
  std::size_t count = 0;
  while (controls.next()) ++count;
  return count;
}

}  // namespace

TEST_CASE(
    "a slider takes one place, and a request of another client, of another parameter or with a name keeps its own") {
  ControlQueue controls;
  for (int i = 0; i < 100; ++i) CHECK(controls.add(setting(1, 3, i)));
  CHECK(controls.add(setting(2, 3, 0.5)));
  CHECK(controls.add(setting(2, 4, 0.75, "named")));
  CHECK(controls.add(setting(2, 4, 1)));
  CHECK(controls.next()->values.at(0).second == 99);
  CHECK(count_waiting(controls) == 3);
}

TEST_CASE("requests beyond the limits are refused until others are taken") {
  ControlQueue controls;
  for (std::size_t i = 0; i < ControlQueue::kMaxWaiting; ++i) CHECK(controls.add({.kind = Control::Kind::play}));
  CHECK_FALSE(controls.add({.kind = Control::Kind::play}));
  CHECK(count_waiting(controls) == ControlQueue::kMaxWaiting);
  const auto add = [&] { return controls.add({.kind = Control::Kind::execute, .text = std::string(kMiB, ' ')}); };
  // The last of the texts that would fill the space lacks that of the requests themselves.
  for (std::size_t i = 1; i < ControlQueue::kMaxBytes / kMiB; ++i) CHECK(add());
  CHECK_FALSE(add());
  controls.next();
  CHECK(add());
}

TEST_CASE("a client that reads too slowly is closed when too much waits for it") {
  TextQueue texts;
  for (std::size_t i = 0; i < TextQueue::kMaxBytes / kMiB; ++i) texts.add(std::string(kMiB, ' '));
  CHECK(texts.next());
  texts.add(std::string(kMiB, ' '));
  CHECK(texts.next());
  for (int i = 0; i < 2; ++i) texts.add(std::string(kMiB, ' '));
  CHECK_THROWS_AS(texts.next(), InputError);
}

}  // namespace simvis::live

TEST_SUITE_END();
