// In place of dds_node.cpp in a build without Cyclone DDS.
#include <simvis/error.h>
#include "exchange/messages/dds/dds_node.h"

namespace simvis::ros {

struct DdsNode::Participant {};

DdsNode::DdsNode(std::optional<std::uint32_t>) {
  throw InputError("this build has no DDS: it was made without Eclipse Cyclone DDS (cyclonedds-dev)");
}
DdsNode::~DdsNode() = default;

// No object exists that these could be called on.
DdsReach DdsNode::reach() const { return {}; }
std::unique_ptr<RecorderSink> DdsNode::sink(SensorQos) { return nullptr; }
void DdsNode::subscribe_as(const std::string&, const std::string&, const TypeDescription&, std::size_t, Durability) {}
void DdsNode::unsubscribe(const std::string&) {}
void DdsNode::announce(const std::string&) {}
std::vector<std::string> DdsNode::take_other_nodes() { return {}; }
void DdsNode::serve(const std::string&, const std::string&) {}
bool DdsNode::reply(const std::string&, std::string_view) { return false; }
std::vector<std::string> DdsNode::take(const std::string&, std::size_t) { return {}; }
std::vector<DdsNode::Received> DdsNode::take_with_writers(const std::string&, std::size_t) { return {}; }
bool DdsNode::has_writer(const std::string&, std::uint64_t) const { return false; }
void DdsNode::wait(int) const {}

}  // namespace simvis::ros
