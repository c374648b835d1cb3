#include "exchange/messages/dds/discovery.h"

#include <unistd.h>

#include <cstdlib>
#include <string_view>

#include <simvis/error.h>
#include "engine/base/words.h"

namespace simvis::ros {
namespace {

std::string_view variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

[[noreturn]] void refuse_variable(const char* name, const std::string& expected) {
  throw InputError(std::string(name) + " is \"" + std::string(variable(name)) + "\", expected " + expected);
}

bool is_localhost_only() {
  constexpr const char* kName = "ROS_LOCALHOST_ONLY";
  const std::string_view value = variable(kName);
  if (!value.empty() && value != "0" && value != "1") refuse_variable(kName, "0 or 1");
  return value == "1";
}

// The name of a range decides whether peers count.
struct NamedRange {
  std::string_view name;
  DiscoveryRange range;
  bool takes_peers;
};
constexpr NamedRange kRanges[] = {{"", DiscoveryRange::unset, true},
                                  {"SUBNET", DiscoveryRange::unset, true},
                                  {"LOCALHOST", DiscoveryRange::localhost, true},
                                  {"OFF", DiscoveryRange::off, false},
                                  {"SYSTEM_DEFAULT", DiscoveryRange::unset, false}};

const NamedRange& named_range() {
  constexpr const char* kName = "ROS_AUTOMATIC_DISCOVERY_RANGE";
  for (const NamedRange& each : kRanges) {
    if (each.name == variable(kName)) return each;
  }
  refuse_variable(kName, "SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT");
}

// The configuration is XML, so a peer has no other characters than names and addresses have.
std::vector<std::string> static_peers() {
  constexpr const char* kName = "ROS_STATIC_PEERS";
  constexpr std::string_view kAllowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789.:_-[]%";
  std::vector<std::string> peers;
  for (const std::string_view peer : words_of(variable(kName), ";")) {
    if (peer.find_first_not_of(kAllowed) != peer.npos) {
      refuse_variable(kName, "host names and addresses, with ; between");
    }
    peers.emplace_back(peer);
  }
  return peers;
}

std::optional<std::uint32_t> domain_id() {
  constexpr const char* kName = "ROS_DOMAIN_ID";
  constexpr std::uint32_t kMax = 232;  // of the ports that the protocol has for domains
  const std::string_view value = variable(kName);
  if (value.empty()) return std::nullopt;
  const std::optional<std::uint32_t> domain = as_number<std::uint32_t>(value);
  if (!domain || *domain > kMax) refuse_variable(kName, "a whole number from 0 to 232");
  return domain;
}

std::string element(std::string_view name, const std::string& content) {
  return "<" + std::string(name) + ">" + content + "</" + std::string(name) + ">";
}

}  // namespace

Discovery discovery_of_environment() {
  Discovery discovery{.domain = domain_id()};
  if (is_localhost_only()) {
    discovery.range = DiscoveryRange::localhost;
    return discovery;
  }
  const NamedRange& range = named_range();
  discovery.range = range.range;
  if (range.takes_peers) discovery.peers = static_peers();
  return discovery;
}

std::string cyclone_config(const Discovery& discovery, bool chooses_interface) {
  const bool is_off = discovery.range == DiscoveryRange::off;
  if (discovery.range == DiscoveryRange::unset && discovery.peers.empty()) return "";
  // Without multicast, participants are found at the ports of the first indices.
  constexpr const char* kMaxParticipants = "32";
  std::string general, finding, peers;
  if (discovery.range != DiscoveryRange::unset) general += element("AllowMulticast", "false");
  if (chooses_interface && discovery.range != DiscoveryRange::unset && discovery.peers.empty()) {
    general += element("Interfaces", "<NetworkInterface address='127.0.0.1'/>");
  }
  if (discovery.range == DiscoveryRange::localhost) peers += "<Peer address='127.0.0.1'/>";
  for (const std::string& peer : discovery.peers) peers += "<Peer address='" + peer + "'/>";
  if (is_off) {  // a tag that no other process has
    finding = element("ParticipantIndex", "none") + element("Tag", "simvis_off_" + std::to_string(::getpid()));
  } else {
    finding = element("ParticipantIndex", "auto") + element("MaxAutoParticipantIndex", kMaxParticipants) +
              element("Peers", peers);
  }
  return element("CycloneDDS", element("Domain", element("General", general) + element("Discovery", finding)));
}

}  // namespace simvis::ros
