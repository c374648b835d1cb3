// A program of another vendor's DDS (eProsima Fast DDS) without any code of SimVis: it prints what it receives, or
// sends a value.
//   fast_dds_peer receive DOMAIN SENSOR      one scan and the fixed transforms, field by field
//   fast_dds_peer send DOMAIN NAME VALUE     ROS 2's ParameterEvent on simvis/set, until it is killed
//   fast_dds_peer ask DOMAIN                 a request of rmw_fastrtps for the parameters of /simvis, until it is
//   killed fast_dds_peer flood DOMAIN               what makes no sense on simvis/set and simvis/request, and other
//   types than
//                                            theirs, until it is killed
#include <fastcdr/Cdr.h>

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <functional>
#include <random>
#include <string>
#include <thread>
#include <vector>

using namespace eprosima::fastdds::dds;
using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;
using eprosima::fastrtps::rtps::InstanceHandle_t;
using eprosima::fastrtps::rtps::SerializedPayload_t;

namespace {

using Bytes = std::vector<char>;
constexpr std::uint32_t kMaxBytes = 1 << 20;
constexpr auto kPatience = std::chrono::seconds(60);

/// A type whose samples are bytes in CDR.
class RawType : public TopicDataType {
 public:
  explicit RawType(const char* name) {
    setName(name);
    m_typeSize = kMaxBytes;
    m_isGetKeyDefined = false;
  }
  bool serialize(void* data, SerializedPayload_t* payload) override {
    const Bytes& bytes = *static_cast<Bytes*>(data);
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(SerializedPayload_t* payload, void* data) override {
    static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<Bytes*>(data)->size()); };
  }
  void* createData() override { return new Bytes; }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void*, InstanceHandle_t*, bool) override { return false; }
};

/// On this machine alone, without multicast, which a sandbox may not have.
DomainParticipant* join(std::uint32_t domain) {
  DomainParticipantQos qos;
  const auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.emplace_back("127.0.0.1");
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  constexpr std::uint32_t kParticipants = 10;
  for (std::uint32_t i = 0; i < kParticipants; ++i) {
    eprosima::fastrtps::rtps::Locator_t peer;
    eprosima::fastrtps::rtps::IPLocator::setIPv4(peer, 127, 0, 0, 1);
    eprosima::fastrtps::rtps::IPLocator::setPhysicalPort(peer, static_cast<std::uint16_t>(7410 + 250 * domain + 2 * i));
    qos.wire_protocol().builtin.initialPeersList.push_back(peer);
  }
  return DomainParticipantFactory::get_instance()->create_participant(domain, qos);
}

Topic* topic(DomainParticipant* participant, const std::string& name, const char* type) {
  TypeSupport(new RawType(type)).register_type(participant);
  return participant->create_topic(name, type, TOPIC_QOS_DEFAULT);
}

bool receive(DataReader* reader, Bytes& bytes) {
  SampleInfo info;
  return reader->take_next_sample(&bytes, &info) == ReturnCode_t::RETCODE_OK && info.valid_data;
}

void print_header(Cdr& cdr) {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  std::string frame;
  cdr >> sec >> nanosec >> frame;
  std::printf("%d.%09u %s\n", sec, nanosec, frame.c_str());
}

void print_scan(Bytes& bytes) {
  FastBuffer buffer(bytes.data(), bytes.size());
  Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
  cdr.read_encapsulation();
  print_header(cdr);
  for (int i = 0; i < 7; ++i) {
    float number = 0;
    cdr >> number;
    std::printf("%a ", static_cast<double>(number));
  }
  for (int i = 0; i < 2; ++i) {
    std::vector<float> values;
    cdr >> values;
    std::printf("\n%zu:", values.size());
    for (const float value : values) std::printf(" %a", static_cast<double>(value));
  }
  std::puts("");
}

void print_transforms(Bytes& bytes) {
  FastBuffer buffer(bytes.data(), bytes.size());
  Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
  cdr.read_encapsulation();
  std::uint32_t count = 0;
  cdr >> count;
  std::printf("%u transforms\n", count);
  for (std::uint32_t t = 0; t < count; ++t) {
    print_header(cdr);
    std::string child;
    cdr >> child;
    std::printf("%s", child.c_str());
    for (int i = 0; i < 7; ++i) {
      double number = 0;
      cdr >> number;
      std::printf(" %a", number);
    }
    std::puts("");
  }
}

int receive_both(DomainParticipant* participant, const std::string& sensor) {
  Subscriber* const subscriber = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  DataReaderQos qos = DATAREADER_QOS_DEFAULT;  // best effort
  DataReader* const scans = subscriber->create_datareader(
      topic(participant, "rt/" + sensor + "/scan", "sensor_msgs::msg::dds_::LaserScan_"), qos);
  qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;
  DataReader* const fixed =
      subscriber->create_datareader(topic(participant, "rt/tf_static", "tf2_msgs::msg::dds_::TFMessage_"), qos);
  Bytes scan, transforms;
  bool has_scan = false, has_transforms = false;
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (!has_scan || !has_transforms) {
    if (std::chrono::steady_clock::now() > end) return 1;
    has_scan = has_scan || receive(scans, scan);
    has_transforms = has_transforms || receive(fixed, transforms);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  print_scan(scan);
  print_transforms(transforms);
  return 0;
}

Bytes parameter_event(const std::string& name, double value) {
  FastBuffer buffer;
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  const std::string empty;
  constexpr std::uint8_t kDouble = 3;
  cdr << std::int32_t{0} << std::uint32_t{0} << empty;  // stamp, node
  cdr << std::uint32_t{0} << std::uint32_t{1};          // no new parameter, one that changes
  cdr << name << kDouble << false << std::int64_t{0} << value << empty;
  for (int arrays = 0; arrays < 5; ++arrays) cdr << std::uint32_t{0};
  cdr << std::uint32_t{0};  // no deleted parameter
  return {buffer.getBuffer(), buffer.getBuffer() + cdr.getSerializedDataLength()};
}

DataWriter* writer(DomainParticipant* participant, const std::string& name, const char* type) {
  DataWriterQos qos = DATAWRITER_QOS_DEFAULT;  // reliable
  qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::DYNAMIC_RESERVE_MEMORY_MODE;
  return participant->create_publisher(PUBLISHER_QOS_DEFAULT)->create_datawriter(topic(participant, name, type), qos);
}

constexpr const char* kEvent = "rcl_interfaces::msg::dds_::ParameterEvent_";
constexpr const char* kString = "std_msgs::msg::dds_::String_";

// A reader that has only just found the writer gets nothing of before: what it shall get is sent again and again.
[[noreturn]] void send(DomainParticipant* participant, const std::string& name, double value) {
  DataWriter* const to = writer(participant, "rt/simvis/set", kEvent);
  Bytes bytes = parameter_event(name, value);
  for (;;) {
    to->write(&bytes);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

// As rmw_fastrtps asks for all parameters of a node: the identity of the client is not in the message.
[[noreturn]] void ask(DomainParticipant* participant) {
  DataWriter* const to =
      writer(participant, "rq/simvis/list_parametersRequest", "rcl_interfaces::srv::dds_::ListParameters_Request_");
  FastBuffer buffer;
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  cdr << std::uint32_t{0} << std::uint64_t{0};  // no prefixes, any depth
  Bytes bytes(buffer.getBuffer(), buffer.getBuffer() + cdr.getSerializedDataLength());
  for (;;) {
    to->write(&bytes);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

[[noreturn]] void flood(DomainParticipant* participant, std::uint32_t domain) {
  constexpr std::size_t kTooLong = 200'000;
  constexpr int kPause = 200;  // in messages, so that others get their turn
  DataWriter* const set = writer(participant, "rt/simvis/set", kEvent);
  DataWriter* const request = writer(participant, "rt/simvis/request", kString);
  DomainParticipant* const other = join(domain);  // one participant has one type for each topic
  DataWriter* const wrong_set = writer(other, "rt/simvis/set", "sensor_msgs::msg::dds_::Image_");
  DataWriter* const wrong_request = writer(other, "rt/simvis/request", kEvent);
  std::mt19937 random(1);
  Bytes event = parameter_event("MOVE.x", 1);
  for (int i = 0;; ++i) {
    if (i % kPause == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    Bytes damaged = event;
    for (int damages = 0; damages < 4; ++damages) damaged[random() % damaged.size()] = static_cast<char>(random());
    if (i % 3 == 0) damaged.resize(1 + random() % damaged.size());
    if (i % 500 == 0) damaged.resize(kTooLong);
    (i % 2 == 0 ? set : request)->write(&damaged);
    if (i % 5 == 0) (i % 2 == 0 ? wrong_set : wrong_request)->write(&event);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const std::string what = argv[1];
  DomainParticipant* const participant = join(static_cast<std::uint32_t>(std::atoi(argv[2])));
  if (participant == nullptr) return 1;
  int status = 2;
  if (what == "receive" && argc == 4) status = receive_both(participant, argv[3]);
  if (what == "send" && argc == 5) send(participant, argv[3], std::atof(argv[4]));
  if (what == "ask") ask(participant);
  if (what == "flood") flood(participant, static_cast<std::uint32_t>(std::atoi(argv[2])));
  std::fflush(stdout);
  std::_Exit(status);
}
