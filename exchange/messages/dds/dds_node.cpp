#include "exchange/messages/dds/dds_node.h"

#include <dds/dds.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <exception>
#include <mutex>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include <simvis/error.h>
#include "exchange/messages/dds/discovery.h"
#include "exchange/messages/dds/domain_sockets.h"
#include "exchange/messages/dds/names.h"
#include "exchange/messages/dds/raw_type.h"
#include "exchange/messages/types/follow_types.h"
#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/node_types.h"
#include "exchange/messages/types/sensor_types.h"
#include "exchange/messages/types/system_types.h"

namespace simvis::ros {

namespace {

// Of what this process sends; the protocol ends at 4 GiB.
constexpr std::size_t kMaxSentBytes = std::size_t{1} << 32;
constexpr int kSensorDepth = 5, kDepth = 100;
constexpr const char* kGraphTopic = "ros_discovery_info";  // without a prefix of ROS

dds_entity_t checked(dds_entity_t entity, const std::string& what) {
  if (entity < 0) throw MachineError("DDS: " + what + ": " + dds_strretcode(entity));
  return entity;
}

// Cyclone writes a line for what makes no sense to it. A flood of that does not fill the terminal.
void print_some(void*, const dds_log_data_t* line) {
  constexpr int kLines = 20;
  static std::atomic<int> lines = 0;
  const int number = ++lines;
  if (number > kLines) return;
  std::fprintf(stderr, "DDS: %s", line->message);
  if (number == kLines) std::fputs("DDS: more lines are not printed\n", stderr);
}

using Qos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

Qos make_qos(const std::string& user_data) {
  Qos qos(dds_create_qos(), &dds_delete_qos);
  dds_qset_userdata(qos.get(), user_data.data(), user_data.size());
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_durability(qos.get(), DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, kDepth);
  return qos;
}

Qos make_qos(const TypeDescription& type) { return make_qos("typehash=" + type_hash(type) + ";"); }

// Programs of ROS 2 take a participant with an enclave for one of their kind.
Qos participant_qos() {
  constexpr std::string_view kEnclave = "enclave=/;";
  Qos qos(dds_create_qos(), &dds_delete_qos);
  dds_qset_userdata(qos.get(), kEnclave.data(), kEnclave.size());
  return qos;
}

Gid gid_of(dds_entity_t entity) {
  dds_guid_t guid{};
  checked(dds_get_guid(entity, &guid), "an entity");
  Gid gid;
  static_assert(sizeof guid.v == sizeof gid.data);
  std::ranges::copy(guid.v, gid.data.begin());
  return gid;
}

bool is_measurement(const TypeDescription& type) {
  return type.name.starts_with("sensor_msgs/") || type.name.starts_with("stereo_msgs/") ||
         type.name == HostMeasurement::kName;
}

// Their writers repeat them, reliably or not; a reader with best effort takes both.
bool is_repeated_command(const TypeDescription& type) {
  return type.name == Twist::kName || type.name == TwistStamped::kName || type.name == JointState::kName ||
         type.name == Float64MultiArray::kName || type.name == Wrench::kName || type.name == WrenchStamped::kName;
}

// A late reader gets what a log has had so far. Its writer never waits: what it cannot send yet stays in the sink.
void keep_all(dds_qos_t* qos) {
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, 0);
  dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
  dds_qset_durability_service(qos, 0, DDS_HISTORY_KEEP_ALL, 0, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED);
}

Qos writer_qos(const TypeDescription& type, Durability durability, SensorQos sensors) {
  Qos qos = make_qos(type);
  if (is_measurement(type)) {
    if (sensors == SensorQos::best_effort) dds_qset_reliability(qos.get(), DDS_RELIABILITY_BEST_EFFORT, 0);
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, kSensorDepth);
  }
  if (durability == Durability::latched) {
    dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 1);
  }
  if (durability == Durability::log) keep_all(qos.get());
  return qos;
}

// A flood overwrites what waits, instead of taking more memory.
Qos reader_qos(const TypeDescription& type, Durability durability) {
  Qos qos = make_qos(type);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, static_cast<std::int32_t>(DdsNode::kMaxWaiting));
  if (type.name == HostMeasurement::kName || is_repeated_command(type)) {
    dds_qset_reliability(qos.get(), DDS_RELIABILITY_BEST_EFFORT, 0);
  }
  if (durability == Durability::latched) dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
  if (durability == Durability::log) keep_all(qos.get());
  dds_qset_ignorelocal(qos.get(), DDS_IGNORELOCAL_PARTICIPANT);
  return qos;
}

}  // namespace

/// A domain whose configuration has more than CYCLONEDDS_URI. The participants of this process share it.
struct DdsNode::Domain {
  Domain(std::uint32_t number, const Discovery& discovery) : entity_(create(number, discovery, true)) {
    // Cyclone refuses an interface that both choose.
    if (entity_ < 0) entity_ = create(number, discovery, false);
    checked(entity_, "domain " + std::to_string(number));
  }
  ~Domain() { dds_delete(entity_); }
  Domain(const Domain&) = delete;
  Domain& operator=(const Domain&) = delete;

  static std::shared_ptr<Domain> shared(std::uint32_t number, const Discovery& discovery) {
    static std::mutex mutex;
    static std::map<std::uint32_t, std::weak_ptr<Domain>> domains;
    const std::lock_guard lock(mutex);
    std::shared_ptr<Domain> found = domains[number].lock();
    if (!found) domains[number] = found = std::make_shared<Domain>(number, discovery);
    return found;
  }

 private:
  static dds_entity_t create(std::uint32_t number, const Discovery& discovery, bool chooses_interface) {
    const char* const more = std::getenv("CYCLONEDDS_URI");
    const std::string config = cyclone_config(discovery, chooses_interface) + "," + (more == nullptr ? "" : more);
    return dds_create_domain(number, config.c_str());
  }

  dds_entity_t entity_;
};

struct DdsNode::Participant {
  Participant(std::optional<std::uint32_t> number, std::shared_ptr<Domain> of)
      : domain(std::move(of)),
        entity(checked(dds_create_participant(number.value_or(DDS_DOMAIN_DEFAULT), participant_qos().get(), nullptr),
                       number ? "domain " + std::to_string(*number) : "the default domain")) {
    try {
      find_reach();
    } catch (...) {
      dds_delete(entity);
      throw;
    }
  }
  ~Participant() { dds_delete(entity); }  // with all that belongs to it
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  /// A topic and its type, which lives as long as the topic.
  std::pair<dds_entity_t, const ddsi_sertype*> topic(const std::string& name, const TypeDescription& type,
                                                     std::size_t max_bytes) const {
    return topic_of_dds(dds_topic(name), dds_type(type.name), max_bytes);
  }
  /// As topic(); both names are those of DDS.
  std::pair<dds_entity_t, const ddsi_sertype*> topic_of_dds(const std::string& name, const std::string& type,
                                                            std::size_t max_bytes) const {
    ddsi_sertype* raw = make_raw_type(type, max_bytes);
    const dds_entity_t made = dds_create_topic_sertype(entity, name.c_str(), &raw, nullptr, nullptr, nullptr);
    if (made < 0) ddsi_sertype_unref(raw);
    return {checked(made, "topic " + name), raw};
  }

  dds_entity_t add_reader(dds_entity_t topic, const Qos& qos, const std::string& what) {
    const dds_entity_t made = checked(dds_create_reader(entity, topic, qos.get(), nullptr), "reader of " + what);
    change_graph([&] { node_.reader_gid_seq.push_back(gid_of(made)); });
    return made;
  }
  dds_entity_t add_writer(dds_entity_t topic, const Qos& qos, const std::string& what) {
    const dds_entity_t made = checked(dds_create_writer(entity, topic, qos.get(), nullptr), "writer of " + what);
    change_graph([&] { node_.writer_gid_seq.push_back(gid_of(made)); });
    return made;
  }
  void remove(dds_entity_t endpoint) {
    const Gid gid = gid_of(endpoint);
    dds_delete(endpoint);
    change_graph([&] {
      std::erase(node_.reader_gid_seq, gid);
      std::erase(node_.writer_gid_seq, gid);
    });
  }

  /// As rmw_dds_common says it to other participants, on a topic without a name of ROS.
  void announce(const std::string& full_name) {
    const std::string topic_type = dds_type(ParticipantEntitiesInfo::kName);
    const auto [topic, type] = topic_of_dds(kGraphTopic, topic_type, kMaxSentBytes);
    Qos qos = make_qos("");
    dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 1);
    const dds_entity_t made = checked(dds_create_writer(entity, topic, qos.get(), nullptr), "writer of the graph");
    // Readers of the graph are no endpoints of the node.
    const dds_entity_t others = topic_of_dds(kGraphTopic, topic_type, kMaxBytes).first;
    const Qos reading = reader_qos(describe<ParticipantEntitiesInfo>(), Durability::latched);
    readers.emplace(
        kGraphTopic,
        Reader{checked(dds_create_reader(entity, others, reading.get(), nullptr), "reader of the graph"), others});
    change_graph([&, type = type] {  // clang 14 captures no structured binding by reference
      const std::size_t slash = full_name.rfind('/');
      node_.node_namespace = slash == 0 ? "/" : full_name.substr(0, slash);
      node_.node_name = full_name.substr(slash + 1);
      graph_ = {made, type};
    });
  }

  std::shared_ptr<Domain> domain;  // empty: one that Cyclone makes from CYCLONEDDS_URI alone
  dds_entity_t entity;
  DdsReach reach;
  dds_entity_t arrivals = checked(dds_create_waitset(entity), "waiting");
  struct Reader {
    dds_entity_t entity, topic;
  };
  std::map<std::string, Reader> readers;
  struct ReplyWriter {
    dds_entity_t entity;
    const ddsi_sertype* type;
    std::chrono::steady_clock::time_point resumes{};  // replies are lost before that
  };
  std::map<std::string, ReplyWriter> reply_writers;

 private:
  void find_reach() {
    checked(dds_get_domainid(entity, &reach.domain), "the domain");
    const auto [topic, type] = topic_of_dds("simvis_reach", "simvis_reach", 0);  // by its type the domain is found
    for (std::size_t i = 0; const char* const name = simvis_domain_interface(type, i); ++i) {
      reach.interfaces.emplace_back(name);
    }
    reach.is_local = simvis_is_domain_local(type) != 0;
    // Cyclone receives at every address of the machine, whatever interfaces it uses.
    const int error = reach.is_local ? simvis_bind_domain(type) : 0;
    dds_delete(topic);
    if (error != 0)
      throw MachineError("DDS: its sockets can't be kept to this machine: " + std::string(std::strerror(error)));
  }

  // Endpoints come and go on the threads of the simulation and of the sink.
  template <typename Change>
  void change_graph(const Change& change) {
    const std::lock_guard lock(mutex_);
    change();
    if (!graph_) return;
    const std::string bytes = encode(ParticipantEntitiesInfo{gid_of(entity), {node_}});
    const dds_return_t result = dds_writecdr(graph_->first, make_raw_sample(*graph_->second, bytes));
    if (result != DDS_RETCODE_TIMEOUT) checked(result, "the graph");  // lost to tools that are too slow
  }
  std::mutex mutex_;
  NodeEntitiesInfo node_;
  std::optional<std::pair<dds_entity_t, const ddsi_sertype*>> graph_;  // its writer; empty: not announced
};

class DdsNode::Sink : public RecorderSink {
 public:
  Sink(std::shared_ptr<Participant> participant, SensorQos qos) : participant_(std::move(participant)), qos_(qos) {}
  ~Sink() override {
    try {
      finish();
    } catch (const std::exception&) {  // finish() reports errors; the destructor ignores them
    }
  }

  void finish() override {
    for (const auto& [topic, writer] : writers_) participant_->remove(writer.entity);
    writers_.clear();
    logs_.clear();
  }
  std::uint64_t messages() const override { return messages_; }
  std::uint64_t bytes() const override { return bytes_; }

 private:
  struct Writer {
    dds_entity_t entity;
    const ddsi_sertype* type;
    std::deque<std::string> unsent;  // of a log
  };

  void put(const Topic& topic, std::int64_t, std::string_view bytes) override {
    Writer& to = writer(topic);
    if (topic.durability == Durability::log) {
      to.unsent.emplace_back(bytes);
      logs_.insert(topic.name);
    } else {
      send(to, topic.name, bytes);
    }
    ++messages_;
    bytes_ += bytes.size();
    for (const std::string& log : logs_) go_on(writers_.at(log), log);
  }

  // A writer is there from the first question on, so that readers have found it when the first message comes.
  bool is_read(const Topic& topic) override {
    dds_publication_matched_status_t matched{};
    checked(dds_get_publication_matched_status(writer(topic).entity, &matched), "readers of " + topic.name);
    return matched.current_count > 0;
  }

  // A message that a slow subscriber keeps from being sent in time is lost to it, as the quality of service says.
  static bool send(const Writer& to, const std::string& topic, std::string_view bytes) {
    const dds_return_t result = dds_writecdr(to.entity, make_raw_sample(*to.type, bytes));
    if (result == DDS_RETCODE_TIMEOUT) return false;
    checked(result, "a message of " + topic);
    return true;
  }

  static void go_on(Writer& to, const std::string& log) {
    while (!to.unsent.empty() && send(to, log, to.unsent.front())) to.unsent.pop_front();
  }

  Writer& writer(const Topic& topic) {
    const auto known = writers_.find(topic.name);
    if (known != writers_.end()) return known->second;
    const auto [entity, raw] = participant_->topic(topic.name, *topic.type, kMaxSentBytes);
    const Qos qos = writer_qos(*topic.type, topic.durability, qos_);
    const dds_entity_t made = participant_->add_writer(entity, qos, topic.name);
    return writers_.emplace(topic.name, Writer{made, raw, {}}).first->second;
  }

  std::shared_ptr<Participant> participant_;
  SensorQos qos_;
  std::map<std::string, Writer> writers_;
  std::set<std::string> logs_;
  std::uint64_t messages_ = 0, bytes_ = 0;
};

DdsNode::DdsNode(std::optional<std::uint32_t> domain) {
  dds_set_log_sink(print_some, nullptr);
  const Discovery discovery = discovery_of_environment();
  if (!domain) domain = discovery.domain;
  std::shared_ptr<Domain> configured;
  if (!cyclone_config(discovery).empty()) {
    domain = domain.value_or(0);
    configured = Domain::shared(*domain, discovery);
  }
  participant_ = std::make_shared<Participant>(domain, std::move(configured));
}
DdsNode::~DdsNode() = default;

DdsReach DdsNode::reach() const { return participant_->reach; }

std::unique_ptr<RecorderSink> DdsNode::sink(SensorQos qos) { return std::make_unique<Sink>(participant_, qos); }

void DdsNode::subscribe_as(const std::string& name, const std::string& topic, const TypeDescription& type,
                           std::size_t max_bytes, Durability durability) {
  const dds_entity_t made = participant_->topic(topic, type, max_bytes).first;
  const Qos qos = reader_qos(type, durability);
  const dds_entity_t reader = participant_->add_reader(made, qos, topic);
  participant_->readers.emplace(name, Participant::Reader{reader, made});
  const dds_entity_t arrival = checked(dds_create_readcondition(reader, DDS_ANY_STATE), "waiting for " + topic);
  checked(dds_waitset_attach(participant_->arrivals, arrival, 0), "waiting for " + topic);
}

void DdsNode::unsubscribe(const std::string& name) {
  const auto reader = participant_->readers.find(name);
  participant_->remove(reader->second.entity);  // with its condition
  dds_delete(reader->second.topic);
  participant_->readers.erase(reader);
}

void DdsNode::announce(const std::string& full_name) { participant_->announce(full_name); }

std::vector<std::string> DdsNode::take_other_nodes() {
  std::vector<std::string> names;
  for (const std::string& bytes : take(std::string(kGraphTopic))) {
    try {
      for (const NodeEntitiesInfo& node : decode<ParticipantEntitiesInfo>(bytes).node_entities_info_seq) {
        names.push_back(node.node_namespace + (node.node_namespace.ends_with('/') ? "" : "/") + node.node_name);
      }
    } catch (const InputError&) {  // nonsense of a stranger
    }
  }
  return names;
}

// Both ends have the same number, by which clients of rmw_cyclonedds find the pair.
void DdsNode::serve(const std::string& service, const std::string& type) {
  const Gid gid = gid_of(participant_->entity);
  std::string id = "serviceid=";
  for (const std::size_t i : {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}) {
    char byte[4];
    std::snprintf(byte, sizeof byte, "%02x.", gid.data[i]);
    id += byte;
  }
  char number[16];
  std::snprintf(number, sizeof number, "%02x.00.00.00;", static_cast<unsigned>(participant_->reply_writers.size() + 1));
  id += number;
  const Qos qos = make_qos(id);
  const auto request = participant_->topic_of_dds("rq" + service + "Request", dds_type(type + "_Request"), kMaxBytes);
  participant_->readers.emplace(
      "rq" + service, Participant::Reader{participant_->add_reader(request.first, qos, service), request.first});
  const auto [reply, raw] =
      participant_->topic_of_dds("rr" + service + "Reply", dds_type(type + "_Response"), kMaxSentBytes);
  participant_->reply_writers.emplace(
      service, Participant::ReplyWriter{.entity = participant_->add_writer(reply, qos, service), .type = raw});
}

bool DdsNode::reply(const std::string& service, std::string_view bytes) {
  Participant::ReplyWriter& writer = participant_->reply_writers.at(service);
  if (std::chrono::steady_clock::now() < writer.resumes) return false;
  const dds_return_t result = dds_writecdr(writer.entity, make_raw_sample(*writer.type, bytes));
  if (result == DDS_RETCODE_TIMEOUT) writer.resumes = std::chrono::steady_clock::now() + kReplyPause;
  return result == DDS_RETCODE_OK;
}

std::vector<DdsNode::Received> DdsNode::take_with_writers(const std::string& topic, std::size_t max) {
  std::vector<Received> taken;
  constexpr std::uint32_t kPiece = 64;
  std::array<ddsi_serdata*, kPiece> samples{};
  std::array<dds_sample_info_t, kPiece> infos{};
  const dds_entity_t reader = participant_->readers.at(topic).entity;
  for (;;) {
    const auto piece = static_cast<std::uint32_t>(std::min<std::size_t>(kPiece, max - taken.size()));
    const dds_return_t count = dds_takecdr(reader, samples.data(), piece, infos.data(), DDS_ANY_STATE);
    checked(count, "topic " + topic);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      if (infos[i].valid_data) taken.push_back({std::string(bytes_of(*samples[i])), infos[i].publication_handle});
      ddsi_serdata_unref(samples[i]);
    }
    if (count < static_cast<dds_return_t>(piece) || taken.size() >= max) return taken;
  }
}

std::vector<std::string> DdsNode::take(const std::string& topic, std::size_t max) {
  std::vector<std::string> taken;
  for (Received& each : take_with_writers(topic, max)) taken.push_back(std::move(each.bytes));
  return taken;
}

bool DdsNode::has_writer(const std::string& topic, std::uint64_t writer) const {
  std::array<dds_instance_handle_t, 64> writers{};
  const dds_return_t count =
      dds_get_matched_publications(participant_->readers.at(topic).entity, writers.data(), writers.size());
  const auto known = std::min(static_cast<std::size_t>(checked(count, "topic " + topic)), writers.size());
  return std::ranges::count(std::span(writers).first(known), writer) > 0;
}

void DdsNode::wait(int timeout_ms) const {
  checked(dds_waitset_wait(participant_->arrivals, nullptr, 0, DDS_MSECS(timeout_ms)), "waiting");
}

}  // namespace simvis::ros
