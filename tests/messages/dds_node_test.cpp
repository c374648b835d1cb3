// Two participants of a domain: what arrives, and what is too long.
#include "messages/dds/dds_node.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "messages/dds/names.h"
#include "messages/types/std_types.h"
#include "tests/support/loopback_dds.h"
#include "tests/support/skip.h"

using namespace simvis;
using namespace simvis::ros;

TEST_SUITE_BEGIN("messages");

namespace {

/// Writes a text until it has come; false: it has not. What else comes is one of `others`.
bool arrives(MessageOutlet& outlet, DdsNode& node, const std::string& text, const std::vector<std::string>& others) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (std::chrono::steady_clock::now() < end) {
    outlet.write("/text", 0, String{text});
    for (const std::string& bytes : node.take("/text")) {
      const std::string got = decode<String>(bytes).data;
      if (got == text) return true;
      CHECK(std::ranges::count(others, got) > 0);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

}  // namespace

TEST_CASE("names of topics and types on DDS are those of ROS 2") {
  CHECK(dds_topic("/FRONT/scan") == "rt/FRONT/scan");
  CHECK(dds_type("sensor_msgs/msg/LaserScan") == "sensor_msgs::msg::dds_::LaserScan_");
}

TEST_CASE("DDS: messages of any length up to the limit arrive as they are") {
  if (!has_dds()) return simvis::test::skip("this build has no DDS");
  constexpr std::size_t kMax = 4096;
  const std::uint32_t domain = own_domain();
  DdsNode sender(domain), receiver(domain);
  const std::unique_ptr<MessageOutlet> outlet = sender.outlet(SensorQos::best_effort);
  receiver.subscribe("/text", describe<String>(), kMax);
  std::vector<std::string> sent;
  for (const std::size_t length : {0, 1, 2, 3, 4, 5, 100, 4000}) {
    sent.emplace_back(length, 'x');
    CHECK(arrives(*outlet, receiver, sent.back(), sent));
  }
  for (int i = 0; i < 3; ++i) outlet->write("/text", 0, String{std::string(kMax, 'x')});
  CHECK(arrives(*outlet, receiver, "after", sent));
  CHECK(outlet->messages() > sent.size());
}

TEST_SUITE_END();
