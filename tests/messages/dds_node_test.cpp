// Two participants of a domain: what arrives, and what is too long.
#include "exchange/messages/dds/dds_node.h"

#include <doctest/doctest.h>
#ifdef SIMVIS_HAS_DDS
#include <dds/dds.h>
#endif

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <string_view>
#include <thread>

#include "exchange/messages/dds/names.h"
#ifdef SIMVIS_HAS_DDS
#include "exchange/messages/dds/raw_type.h"
#endif
#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/node_types.h"
#include "exchange/messages/types/sensor_types.h"
#include "exchange/messages/types/system_types.h"
#include "tests/support/loopback_dds.h"
#include "tests/support/skip.h"

using namespace simvis;
using namespace simvis::ros;

TEST_SUITE_BEGIN("messages");

namespace {

/// Writes a text until it has come; false: it has not. What else comes is one of `others`.
bool arrives(RecorderSink& sink, DdsNode& node, const std::string& text, const std::vector<std::string>& others) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (std::chrono::steady_clock::now() < end) {
    sink.write("/text", 0, String{text});
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
  const std::unique_ptr<RecorderSink> sink = sender.sink(SensorQos::best_effort);
  receiver.subscribe("/text", describe<String>(), kMax);
  std::vector<std::string> sent;
  for (const std::size_t length : {0, 1, 2, 3, 4, 5, 100, 4000}) {
    sent.emplace_back(length, 'x');
    CHECK(arrives(*sink, receiver, sent.back(), sent));
  }
  for (int i = 0; i < 3; ++i) sink->write("/text", 0, String{std::string(kMax, 'x')});
  CHECK(arrives(*sink, receiver, "after", sent));
  CHECK(sink->messages() > sent.size());
}

TEST_CASE("DDS: who comes late gets a log from its start, and of a latched topic the last message") {
  if (!has_dds()) return simvis::test::skip("this build has no DDS");
  const std::uint32_t domain = own_domain();
  constexpr std::size_t kEarly = 1500, kLater = 100, kLength = 2000;  // more than Cyclone's usual buffers take
  DdsNode sender(domain);
  const std::unique_ptr<RecorderSink> sink = sender.sink(SensorQos::best_effort);
  const auto say = [&](std::size_t number) {
    const std::string text = std::to_string(number);
    sink->write("/log", 0, String{text + std::string(kLength, 'x')}, Durability::log);
    sink->write("/last", 0, String{text}, Durability::latched);
  };
  for (std::size_t i = 0; i < kEarly; ++i) say(i);
  DdsNode late(domain);
  late.subscribe("/log", describe<String>(), DdsNode::kMaxBytes, Durability::log);
  late.subscribe("/last", describe<String>(), DdsNode::kMaxBytes, Durability::latched);
  std::vector<std::string> last;
  std::size_t count = 0;
  std::uint64_t writer = 0;
  const auto receive = [&](std::size_t until) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while ((count < until || last.empty()) && std::chrono::steady_clock::now() < end) {
      late.wait(100);
      for (const DdsNode::Received& received : late.take_with_writers("/log")) {
        REQUIRE(decode<String>(received.bytes).data.starts_with(std::to_string(count++) + "x"));
        writer = received.writer;
      }
      for (const std::string& bytes : late.take("/last")) last.push_back(decode<String>(bytes).data);
    }
    CHECK(count == until);
  };
  receive(kEarly);
  CHECK(last == std::vector<std::string>{std::to_string(kEarly - 1)});
  for (std::size_t i = kEarly; i < kEarly + kLater; ++i) say(i);
  receive(kEarly + kLater);
  CHECK(late.has_writer("/log", writer));
  sink->finish();
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (late.has_writer("/log", writer) && std::chrono::steady_clock::now() < end) late.wait(10);
  CHECK_FALSE(late.has_writer("/log", writer));
}

TEST_CASE("DDS: a node does not receive what it sends itself, and takes as much as it is asked to") {
  if (!has_dds()) return simvis::test::skip("this build has no DDS");
  const std::uint32_t domain = own_domain();
  DdsNode sender(domain), receiver(domain);
  const std::unique_ptr<RecorderSink> sink = sender.sink(SensorQos::best_effort);
  sender.subscribe("/text", describe<String>());
  receiver.subscribe("/text", describe<String>());
  REQUIRE(arrives(*sink, receiver, "first", {}));
  for (int i = 0; i < 5; ++i) sink->write("/text", 0, String{"more"});
  REQUIRE(arrives(*sink, receiver, "last", {"first", "more"}));
  CHECK(sender.take("/text").empty());
  for (int i = 0; i < 5; ++i) sink->write("/text", 0, String{"again"});
  std::size_t taken = 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (taken < 5 && std::chrono::steady_clock::now() < end) {
    const std::size_t now = receiver.take("/text", 2).size();
    CHECK(now <= 2);
    taken += now;
  }
  CHECK(taken >= 5);
}

#ifdef SIMVIS_HAS_DDS

TEST_CASE("DDS: a subscription that ends leaves nothing in the participant") {
  const std::uint32_t domain = own_domain();
  DdsNode node(domain);
  dds_entity_t participant = 0;
  REQUIRE(dds_lookup_participant(domain, &participant, 1) == 1);
  const auto entities = [&] { return dds_get_children(participant, nullptr, 0); };
  node.subscribe("/kept", describe<String>());
  const dds_return_t before = entities();
  for (int i = 0; i < 3; ++i) {
    node.subscribe("/text", describe<String>());
    CHECK(entities() > before);
    node.unsubscribe("/text");
  }
  CHECK(entities() == before);
}

namespace {

/// What others find out about a writer before its first message.
struct FoundWriter {
  std::string type, user_data;
  bool is_latched = false, is_reliable = false;
};

FoundWriter describe_writer(const dds_builtintopic_endpoint_t& found) {
  FoundWriter writer{.type = found.type_name, .user_data = {}};
  void* data = nullptr;
  std::size_t size = 0;
  if (dds_qget_userdata(found.qos, &data, &size)) writer.user_data.assign(static_cast<const char*>(data), size);
  dds_free(data);
  dds_durability_kind_t durability{};
  dds_reliability_kind_t reliability{};
  dds_duration_t patience = 0;
  dds_qget_durability(found.qos, &durability);
  dds_qget_reliability(found.qos, &reliability, &patience);
  writer.is_latched = durability == DDS_DURABILITY_TRANSIENT_LOCAL;
  writer.is_reliable = reliability == DDS_RELIABILITY_RELIABLE;
  return writer;
}

/// The writers of these topics in the domain, once all have been found.
std::map<std::string, FoundWriter> writers_of(std::uint32_t domain, std::size_t count) {
  const dds_entity_t participant = dds_create_participant(domain, nullptr, nullptr);
  const dds_entity_t reader = dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr);
  std::map<std::string, FoundWriter> writers;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (writers.size() < count && std::chrono::steady_clock::now() < end) {
    void* sample = nullptr;
    dds_sample_info_t info;
    if (dds_take(reader, &sample, &info, 1, 1) == 1) {
      const auto& found = *static_cast<const dds_builtintopic_endpoint_t*>(sample);
      if (info.valid_data) writers[found.topic_name] = describe_writer(found);
      dds_return_loan(reader, &sample, 1);
    } else {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  dds_delete(participant);
  return writers;
}

}  // namespace

TEST_CASE("DDS: others find names, type hashes and qualities of service as ROS 2 has them") {
  const std::uint32_t domain = own_domain();
  DdsNode node(domain);
  const std::unique_ptr<RecorderSink> sink = node.sink(SensorQos::best_effort);
  sink->write("/A/scan", 0, LaserScan{});
  sink->write("/clock", 0, simvis::ros::Clock{});
  sink->write("/tf_static", 0, TFMessage{}, Durability::latched);
  std::map<std::string, FoundWriter> found = writers_of(domain, 3);
  CHECK(found["rt/A/scan"].type == "sensor_msgs::msg::dds_::LaserScan_");
  CHECK(found["rt/A/scan"].user_data == "typehash=" + type_hash(describe<LaserScan>()) + ";");
  CHECK_FALSE(found["rt/A/scan"].is_reliable);
  CHECK_FALSE(found["rt/A/scan"].is_latched);
  CHECK(found["rt/clock"].is_reliable);
  CHECK_FALSE(found["rt/clock"].is_latched);
  CHECK(found["rt/tf_static"].is_reliable);
  CHECK(found["rt/tf_static"].is_latched);
}

namespace {

/// A reader and a writer of DDS under names of any kind, in a participant of their own.
class RawPeer {
 public:
  explicit RawPeer(std::uint32_t domain) : participant_(dds_create_participant(domain, nullptr, nullptr)) {}
  ~RawPeer() { dds_delete(participant_); }
  RawPeer(const RawPeer&) = delete;
  RawPeer& operator=(const RawPeer&) = delete;

  void read(const std::string& topic, const std::string& type, dds_durability_kind_t durability) {
    reader_ = dds_create_reader(participant_, make_topic(topic, type), qos(durability).get(), nullptr);
    REQUIRE(reader_ > 0);
  }
  /// A reader that has room for one message and takes none.
  void read_one(const std::string& topic, const std::string& type) {
    const RawQos full = qos(DDS_DURABILITY_VOLATILE);
    dds_qset_history(full.get(), DDS_HISTORY_KEEP_ALL, 0);
    dds_qset_resource_limits(full.get(), 1, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
    reader_ = dds_create_reader(participant_, make_topic(topic, type), full.get(), nullptr);
    REQUIRE(reader_ > 0);
  }
  void write_to(const std::string& topic, const std::string& type) {
    writer_ = dds_create_writer(participant_, make_topic(topic, type), qos(DDS_DURABILITY_VOLATILE).get(), nullptr);
    REQUIRE(writer_ > 0);
  }
  void write(std::string_view bytes) { CHECK(dds_writecdr(writer_, make_raw_sample(*type_, bytes)) == 0); }
  /// The last message that has come; empty: none.
  std::string take() {
    std::string last;
    ddsi_serdata* sample = nullptr;
    dds_sample_info_t info;
    while (dds_takecdr(reader_, &sample, 1, &info, DDS_ANY_STATE) == 1) {
      if (info.valid_data) last = bytes_of(*sample);
      ddsi_serdata_unref(sample);
    }
    return last;
  }

 private:
  using RawQos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;
  static RawQos qos(dds_durability_kind_t durability) {
    RawQos made(dds_create_qos(), &dds_delete_qos);
    dds_qset_reliability(made.get(), DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    dds_qset_durability(made.get(), durability);
    return made;
  }
  dds_entity_t make_topic(const std::string& topic, const std::string& type) {
    ddsi_sertype* made = make_raw_type(type, 1 << 20);
    const dds_entity_t entity = dds_create_topic_sertype(participant_, topic.c_str(), &made, nullptr, nullptr, nullptr);
    REQUIRE(entity > 0);
    type_ = made;
    return entity;
  }
  dds_entity_t participant_, reader_ = 0, writer_ = 0;
  const ddsi_sertype* type_ = nullptr;
};

template <typename Done>
bool comes_true(const Done& done) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (std::chrono::steady_clock::now() < end) {
    if (done()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

}  // namespace

TEST_CASE("DDS: a participant that is announced is a node of ROS 2 with its endpoints, as they come and go") {
  const std::uint32_t domain = own_domain();
  DdsNode node(domain);
  node.subscribe("/before", describe<String>());
  node.announce("/simvis");
  RawPeer peer(domain);
  peer.read("ros_discovery_info", "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_",
            DDS_DURABILITY_TRANSIENT_LOCAL);
  NodeEntitiesInfo info;
  const auto has = [&](std::size_t readers, std::size_t writers) {
    const std::string bytes = peer.take();
    if (!bytes.empty()) {
      const auto graph = decode<ParticipantEntitiesInfo>(bytes);
      REQUIRE(graph.node_entities_info_seq.size() == 1);
      info = graph.node_entities_info_seq[0];
      // An endpoint's number begins with that of its participant.
      for (const Gid& gid : info.reader_gid_seq) {
        CHECK(std::equal(gid.data.begin(), gid.data.begin() + 12, graph.gid.data.begin()));
      }
    }
    return info.reader_gid_seq.size() == readers && info.writer_gid_seq.size() == writers;
  };
  CHECK(comes_true([&] { return has(1, 0); }));
  CHECK(info.node_name == "simvis");
  CHECK(info.node_namespace == "/");
  std::unique_ptr<RecorderSink> sink = node.sink(SensorQos::best_effort);
  sink->write("/clock", 0, simvis::ros::Clock{});
  node.subscribe_as("second", "/more", describe<String>());
  CHECK(comes_true([&] { return has(2, 1); }));
  node.unsubscribe("second");
  sink->finish();
  CHECK(comes_true([&] { return has(1, 0); }));
}

TEST_CASE("DDS: a node in a namespace is found by its full name") {
  const std::uint32_t domain = own_domain();
  DdsNode one(domain), other(domain);
  one.announce("/fleet/cart_1/sim");
  RawPeer peer(domain);
  peer.read("ros_discovery_info", "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_",
            DDS_DURABILITY_TRANSIENT_LOCAL);
  CHECK(comes_true([&] {
    const std::string bytes = peer.take();
    if (bytes.empty()) return false;
    const NodeEntitiesInfo info = decode<ParticipantEntitiesInfo>(bytes).node_entities_info_seq.at(0);
    return info.node_namespace == "/fleet/cart_1" && info.node_name == "sim";
  }));
  other.announce("/simvis");
  std::vector<std::string> seen_by_one, seen_by_other;
  CHECK(comes_true([&] {
    if (seen_by_one.empty()) seen_by_one = one.take_other_nodes();
    if (seen_by_other.empty()) seen_by_other = other.take_other_nodes();
    return !seen_by_one.empty() && !seen_by_other.empty();
  }));
  CHECK(std::ranges::count(seen_by_other, "/fleet/cart_1/sim") == 1);
  CHECK(std::ranges::count(seen_by_one, "/simvis") == 1);
}

TEST_CASE("DDS: a service answers requests with the header of the client") {
  const std::uint32_t domain = own_domain();
  DdsNode node(domain);
  node.serve("/simvis/get_parameters", "rcl_interfaces/srv/GetParameters");
  RawPeer peer(domain);
  peer.read("rr/simvis/get_parametersReply", "rcl_interfaces::srv::dds_::GetParameters_Response_",
            DDS_DURABILITY_VOLATILE);
  peer.write_to("rq/simvis/get_parametersRequest", "rcl_interfaces::srv::dds_::GetParameters_Request_");
  const std::string request = encode(NamedParametersRequest{{7, 9}, {"ARM.angle"}});
  std::string answer;
  CHECK(comes_true([&] {
    peer.write(request);
    for (const std::string& bytes : node.take_requests("/simvis/get_parameters", 1)) {
      const auto asked = decode<NamedParametersRequest>(bytes);
      CHECK(asked.names == std::vector<std::string>{"ARM.angle"});
      node.reply("/simvis/get_parameters", encode(GetParametersReply{asked.header, {}}));
    }
    answer = peer.take();
    return !answer.empty();
  }));
  const auto reply = decode<GetParametersReply>(answer);
  CHECK(reply.header.client == 7);
  CHECK(reply.header.sequence == 9);
}

TEST_CASE("DDS: a client that takes no replies makes its service wait once, and not again at once") {
  const std::uint32_t domain = own_domain();
  DdsNode node(domain);
  node.serve("/simvis/get_parameters", "rcl_interfaces/srv/GetParameters");
  RawPeer peer(domain);
  peer.read_one("rr/simvis/get_parametersReply", "rcl_interfaces::srv::dds_::GetParameters_Response_");
  const std::string reply = encode(GetParametersReply{{7, 9}, {}});
  CHECK(comes_true([&] { return !node.reply("/simvis/get_parameters", reply); }));
  constexpr int kReplies = 50;
  constexpr std::chrono::milliseconds kWait{100};  // of one reply
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < kReplies; ++i) CHECK_FALSE(node.reply("/simvis/get_parameters", reply));
  const auto took = std::chrono::steady_clock::now() - start;
  CHECK(took < kReplies * kWait / 2);
  CHECK(took < DdsNode::kReplyPause);
}

#endif

TEST_SUITE_END();
