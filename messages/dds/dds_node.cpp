#include "messages/dds/dds_node.h"

#include <dds/dds.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <deque>
#include <set>
#include <span>
#include <utility>

#include <simvis/error.h>
#include "messages/dds/names.h"
#include "messages/dds/raw_type.h"
#include "messages/types/follow_types.h"

namespace simvis::ros {

namespace {

// Of what this process sends; the protocol ends at 4 GiB.
constexpr std::size_t kMaxSentBytes = std::size_t{1} << 32;
constexpr int kSensorDepth = 5, kDepth = 100;

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

Qos make_qos(const TypeDescription& type) {
  Qos qos(dds_create_qos(), &dds_delete_qos);
  const std::string user_data = "typehash=" + type_hash(type) + ";";
  dds_qset_userdata(qos.get(), user_data.data(), user_data.size());
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_durability(qos.get(), DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, kDepth);
  return qos;
}

bool is_measurement(const TypeDescription& type) {
  return type.name.starts_with("sensor_msgs/") || type.name.starts_with("stereo_msgs/") ||
         type.name == HostMeasurement::kName;
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
  if (type.name == HostMeasurement::kName) dds_qset_reliability(qos.get(), DDS_RELIABILITY_BEST_EFFORT, 0);
  if (durability == Durability::latched) dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
  if (durability == Durability::log) keep_all(qos.get());
  return qos;
}

}  // namespace

struct DdsNode::Participant {
  explicit Participant(std::optional<std::uint32_t> domain)
      : entity(checked(dds_create_participant(domain.value_or(DDS_DOMAIN_DEFAULT), nullptr, nullptr),
                       domain ? "domain " + std::to_string(*domain) : "the default domain")) {}
  ~Participant() { dds_delete(entity); }  // with all that belongs to it
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  /// A topic and its type, which lives as long as the topic.
  std::pair<dds_entity_t, const ddsi_sertype*> topic(const std::string& name, const TypeDescription& type,
                                                     std::size_t max_bytes) const {
    ddsi_sertype* raw = make_raw_type(dds_type(type.name), max_bytes);
    const dds_entity_t made =
        dds_create_topic_sertype(entity, dds_topic(name).c_str(), &raw, nullptr, nullptr, nullptr);
    if (made < 0) ddsi_sertype_unref(raw);
    return {checked(made, "topic " + name), raw};
  }

  dds_entity_t entity;
  dds_entity_t arrivals = checked(dds_create_waitset(entity), "waiting");
  std::map<std::string, dds_entity_t> readers;
};

class DdsNode::Sink : public RecorderSink {
 public:
  Sink(std::shared_ptr<Participant> participant, SensorQos qos) : participant_(std::move(participant)), qos_(qos) {}
  ~Sink() override { finish(); }

  void finish() override {
    for (const auto& [topic, writer] : writers_) dds_delete(writer.entity);
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
    const dds_entity_t made =
        checked(dds_create_writer(participant_->entity, entity, qos.get(), nullptr), "writer of " + topic.name);
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
  participant_ = std::make_shared<Participant>(domain);
}
DdsNode::~DdsNode() = default;

std::unique_ptr<RecorderSink> DdsNode::sink(SensorQos qos) { return std::make_unique<Sink>(participant_, qos); }

void DdsNode::subscribe(const std::string& topic, const TypeDescription& type, std::size_t max_bytes,
                        Durability durability) {
  const dds_entity_t made = participant_->topic(topic, type, max_bytes).first;
  const Qos qos = reader_qos(type, durability);
  const dds_entity_t reader =
      checked(dds_create_reader(participant_->entity, made, qos.get(), nullptr), "reader of " + topic);
  participant_->readers.emplace(topic, reader);
  const dds_entity_t arrival = checked(dds_create_readcondition(reader, DDS_ANY_STATE), "waiting for " + topic);
  checked(dds_waitset_attach(participant_->arrivals, arrival, 0), "waiting for " + topic);
}

std::vector<DdsNode::Received> DdsNode::take_with_writers(const std::string& topic) {
  std::vector<Received> taken;
  constexpr std::uint32_t kPiece = 64;
  std::array<ddsi_serdata*, kPiece> samples{};
  std::array<dds_sample_info_t, kPiece> infos{};
  const dds_entity_t reader = participant_->readers.at(topic);
  for (;;) {
    const dds_return_t count = dds_takecdr(reader, samples.data(), kPiece, infos.data(), DDS_ANY_STATE);
    checked(count, "topic " + topic);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      if (infos[i].valid_data) taken.push_back({std::string(bytes_of(*samples[i])), infos[i].publication_handle});
      ddsi_serdata_unref(samples[i]);
    }
    if (count < static_cast<dds_return_t>(kPiece) || taken.size() >= kMaxWaiting) return taken;
  }
}

std::vector<std::string> DdsNode::take(const std::string& topic) {
  std::vector<std::string> taken;
  for (Received& each : take_with_writers(topic)) taken.push_back(std::move(each.bytes));
  return taken;
}

bool DdsNode::has_writer(const std::string& topic, std::uint64_t writer) const {
  std::array<dds_instance_handle_t, 64> writers{};
  const dds_return_t count =
      dds_get_matched_publications(participant_->readers.at(topic), writers.data(), writers.size());
  const auto known = std::min(static_cast<std::size_t>(checked(count, "topic " + topic)), writers.size());
  return std::ranges::count(std::span(writers).first(known), writer) > 0;
}

void DdsNode::wait(int timeout_ms) const {
  checked(dds_waitset_wait(participant_->arrivals, nullptr, 0, DDS_MSECS(timeout_ms)), "waiting");
}

}  // namespace simvis::ros
